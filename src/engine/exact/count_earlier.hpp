#pragma once

#include <cstddef>
#include <cstdint>

#include "gridlock/core/target.hpp"

namespace gridlock::exact {

/// Times in a batch, for any width of register.
inline constexpr std::size_t times_per_batch = 8;

/// Counts for each time how many times are earlier: its index in their order where no two are equal. Nothing branches
/// on a comparison, because a processor cannot guess its outcome and a wrong guess costs more than a few comparisons.
/// Contract: `batches` full batches, filled up with infinity.
using CountEarlier = void (*)(double const* times, std::size_t batches, std::uint64_t* earlier);

/// The kernel for the instructions of this target, which the processor must have.
CountEarlier count_earlier_kernel(Target target);

}  // namespace gridlock::exact
