#pragma once

#include <span>
#include <string>
#include <string_view>

namespace gridlock {

/// The name a user most likely meant; empty where none is close.
///
/// Close is: equal but for capitals and - for _, the beginning of exactly one name, or at most a third of the letters
/// wrong, missing, too many or swapped with their neighbour (the optimal string alignment distance, Damerau 1964,
/// doi:10.1145/363958.363994).
std::string nearest_name(std::string_view word, std::span<std::string const> names);

}  // namespace gridlock
