#pragma once

#include <memory>

#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// Returns the model of hard disks, with the tables [disks], [velocities] and [engine].
std::unique_ptr<ModelKind> disks_kind();

}  // namespace gridlock
