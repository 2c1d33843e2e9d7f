#pragma once

#include "gridlock/core/direction.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/model/model_engine.hpp"
#include "gridlock/model/observations.hpp"

namespace gridlock {

/// What a model needs is all in here: ModelEngine says what a model is.

}  // namespace gridlock
