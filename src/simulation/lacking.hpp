#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gridlock {

/// A sentence on something that other programs have and Gridlock has not, by the word that one looks for, such as
/// "thermostat"; nothing for any other word.
std::optional<std::string> sentence_on_lacking(std::string_view word);

}  // namespace gridlock
