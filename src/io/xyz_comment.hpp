#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/xyz_lines.hpp"

namespace gridlock::xyz {

/// An entry key=value of the second line; a key without a value has the value T.
struct Entry {
  std::string key;
  std::string value;  ///< without quotes, braces and escapes; with brackets
  int column = 0;     ///< column of the key, from 1
};

/// Returns the entries of the current line, by the specification of extended XYZ (github.com/libAtoms/extxyz), its
/// parser and ASE.
///
/// Keys and values may be in quotes, where \" is a quote, and values also in brackets or braces. Blanks may surround
/// the equals sign. Errors: Error if a quote, bracket or brace is not closed.
std::vector<Entry> entries_of(Lines const& lines);

/// Returns the elements of a vector or matrix by rows: [T, T, F], [[1, 0], [0, 1]], 1 0 0 or 1,0,0. Returns nothing if
/// a comma or bracket is misplaced or rows differ in length.
std::optional<std::vector<std::string>> elements_of(std::string_view value);

}  // namespace gridlock::xyz
