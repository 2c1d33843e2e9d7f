#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gridlock {

/// A sentence on something that other programs have and Gridlock has not, by the word that one looks for, such as
/// "thermostat"; nothing for any other word.
std::optional<std::string> sentence_on_lacking(std::string_view word);

/// A hint on what to use in place of a model that earlier versions shipped; nothing for any other name.
std::optional<std::string> instead_of_model(std::string_view name);

}  // namespace gridlock
