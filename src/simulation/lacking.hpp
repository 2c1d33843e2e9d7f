#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gridlock {

/// Returns a sentence on a feature that other programs have and Gridlock lacks, for a word such as "thermostat";
/// nothing for other words.
std::optional<std::string> sentence_on_lacking(std::string_view word);

/// Returns a hint on the substitute for a model that earlier versions had; nothing for other names.
std::optional<std::string> instead_of_model(std::string_view name);

}  // namespace gridlock
