#pragma once

#include <span>
#include <string>
#include <string_view>

namespace gridlock {

/// Returns the name that a user most likely meant; empty if no name is close to the word.
///
/// A name is close if it is equal but for capitals and - for _, if the word is the beginning of this name only, or if
/// at most a third of the letters are wrong, missing, added or swapped with a neighbour (optimal string alignment
/// distance, Damerau 1964, doi:10.1145/363958.363994).
std::string nearest_name(std::string_view word, std::span<std::string const> names);

}  // namespace gridlock
