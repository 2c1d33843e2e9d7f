#pragma once

#include <cstdint>
#include <span>

#include "gridlock/core/population.hpp"

namespace gridlock::exact {

/// Disks that get a kick together.
struct KickedDisks {
  std::span<Id const> ids;
  std::span<std::uint32_t const> id_indices;
  std::span<double const> masses;
};

}  // namespace gridlock::exact
