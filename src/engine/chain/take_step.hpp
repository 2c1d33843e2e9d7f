#pragma once

#include "engine/chain/chains.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock::chain {

/// Carries out the chains of a step with kernels that are compiled where this is.
template <class SomeDisks>
[[gnu::always_inline]] inline ChainSums take_step(SomeDisks& disks, std::size_t agents, StepOfChains const& step) {
  ChainSums sums;
  for (std::uint64_t k = 0; k < step.count; ++k) {
    RandomStream random(step.seed, step.step, k, Purpose::event_chain);
    auto const first = static_cast<Number>(random.below(agents));
    if (step.by_velocity) {
      carry_out<Way::by_velocity>(disks, first, step.length, step.most_contacts, sums);
    } else if ((step.step * step.count + k) % 2 == 0) {
      carry_out<Way::up>(disks, first, step.length, step.most_contacts, sums);
    } else {
      carry_out<Way::right>(disks, first, step.length, step.most_contacts, sums);
    }
  }
  return sums;
}

}  // namespace gridlock::chain
