#pragma once

#include <functional>

#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/core/setting.hpp"

namespace gridlock {

/// Writes all settings that `describe` visits into a message, with every bit.
void add_settings(MessageWriter& message, std::function<void(SettingVisitor&)> const& describe);
/// Reads them from there, into those that the same `describe` visits.
void read_settings(MessageReader& message, std::function<void(SettingVisitor&)> const& describe);

}  // namespace gridlock
