#pragma once

#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// What every rank but the leader does: its part of what the leader asks for, until it releases it.
void help(Communicator& ranks);

}  // namespace gridlock
