#pragma once

#include <cstdint>
#include <memory>

#include "engine/chain/flight.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::chain {

/// The chains of a step. Chain k of a step begins with a disk drawn from (seed, step, k); straight chains go up and to
/// the right in turn.
struct StepOfChains {
  std::uint64_t seed;
  std::uint64_t step;
  std::uint64_t count;
  double length;  ///< of each chain; for chains by velocity the duration
  bool by_velocity;
  std::uint64_t most_contacts;  ///< of a chain
};

/// Disks in cells, in the order of their Ids, on which chains are carried out. All give the same bits.
class ChainDisks {
 public:
  ChainDisks() = default;
  ChainDisks(ChainDisks const&) = delete;
  ChainDisks& operator=(ChainDisks const&) = delete;
  virtual ~ChainDisks() = default;

  [[nodiscard]] virtual ChainSums take(StepOfChains const& step) = 0;
  /// Writes places, velocities and images to the state from which this was made.
  virtual void write_back(State& state) const = 0;
};

/// Chains on a grid of cells, for disks of any sizes.
std::unique_ptr<ChainDisks> chain_disks_of_any_size(State const& state);
/// Chains on cells of one disk each, for equal disks; nothing for others and where this build has no AVX-512.
std::unique_ptr<ChainDisks> chain_disks_with_avx512(State const& state);
/// Returns the faster of the two that there is.
std::unique_ptr<ChainDisks> chain_disks(State const& state, Target target);

}  // namespace gridlock::chain
