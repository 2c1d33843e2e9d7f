#pragma once

#include <string_view>

#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// Returns the choice because of which a setting of `[observe]` has no effect, such as "observe.clusters_every = 0";
/// empty for a setting that has one.
std::string_view unused_because_of(ObserveSettings const& settings, std::string_view setting);

}  // namespace gridlock
