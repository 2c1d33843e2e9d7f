#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/xyz_lines.hpp"

namespace gridlock::xyz {

/// One entry of the second line, key=value; a key alone has the value T.
struct Entry {
  std::string key;
  std::string value;  ///< without the quotes or braces around it and without escapes; brackets stay
  int column = 0;     ///< of the key, from 1
};

/// The entries of the present line, as the specification of extended XYZ has them (github.com/libAtoms/extxyz) and as
/// its parser and ASE read them.
///
/// Keys and values may stand in quotes, in which \" is a quote; values in brackets or braces besides. Blanks may stand
/// around the equals sign. Errors: Error where a quote, bracket or brace does not end.
std::vector<Entry> entries_of(Lines const& lines);

/// The elements of a value that is a vector or a matrix, row after row: [T, T, F], [[1, 0], [0, 1]], 1 0 0 or 1,0,0.
/// Nothing where a comma or a bracket is in the wrong place or the rows are not equally long.
std::optional<std::vector<std::string>> elements_of(std::string_view value);

}  // namespace gridlock::xyz
