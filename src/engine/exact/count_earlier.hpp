#pragma once

#include <cstddef>
#include <cstdint>

#include "gridlock/core/target.hpp"

namespace gridlock::exact {

/// Times are compared so many at once, whatever the registers.
inline constexpr std::size_t times_per_batch = 8;

/// For each time how many of all are earlier, which is its place in their order where no two are the same. Nothing
/// branches on a comparison: its outcome is a coin toss, and a processor that guesses wrong loses more than some
/// comparisons too many.
/// Contract: `batches` full batches, filled up with infinity.
using CountEarlier = void (*)(double const* times, std::size_t batches, std::uint64_t* earlier);

/// The kernel for the instructions of this target, which the processor must have.
CountEarlier count_earlier_kernel(Target target);

}  // namespace gridlock::exact
