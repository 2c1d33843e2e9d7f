#pragma once

#include "gridlock/core/detail/ranks.hpp"

namespace gridlock {

/// What every rank but the leader does: takes part in the steps of disks and of known models until the leader releases it.
void help(Ranks& ranks);

}  // namespace gridlock
