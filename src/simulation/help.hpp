#pragma once

#include "gridlock/core/detail/ranks.hpp"

namespace gridlock {

/// What every rank but the leader does: its part of what the leader asks for, until it releases it.
void help(Ranks& ranks);

}  // namespace gridlock
