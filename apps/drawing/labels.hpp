#pragma once

#include <string>
#include <string_view>

namespace gridlock {

/// What an axis says that shows the number of this name: words, symbol and unit of the observables and settings that
/// plots are made of; for any other the words of its name, without its table.
std::string axis_label(std::string_view name);

/// Whether a result is what a model itself observes, not one of the observables that every model can have.
bool is_of_model(std::string_view name);

}  // namespace gridlock
