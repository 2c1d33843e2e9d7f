#pragma once

#include <cstdint>
#include <span>

#include "gridlock/core/random.hpp"

namespace gridlock {

/// Draws the first two normal numbers of the stream of each agent, with the bits of RandomStream::normal() and in half
/// of its time. Contract: there are as many pairs as ids.
void draw_normal_pairs(std::uint64_t seed, std::uint64_t step, std::span<Id const> ids, Purpose purpose,
                       std::span<Vector> pairs);

}  // namespace gridlock
