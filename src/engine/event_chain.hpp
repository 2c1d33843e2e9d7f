#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/engine/engine.hpp"

namespace gridlock {

EngineRecord event_chain_record();

/// Visits the settings `chains` and `chain_length`, which the engine and the stage of this name have.
void describe_chains(ChainKind& chains, std::optional<std::uint64_t>& chain_length, SettingVisitor& visitor);

/// The engine `event_chain`: Monte Carlo of hard disks in a periodic box by event chains, which has no dynamics but
/// finds equilibrium with less work than `exact`; docs/explanation/event_chain.md has the rules and the pressure.
///
/// A disk moves until it touches another, which goes on in its place, until the chain has its length (straight chains)
/// or duration (Newtonian chains). A step has so many chains that about N disks move. The time is the mean time for
/// which a disk has moved, at the root mean square speed in straight chains, so that Counters::pair_virial gives the
/// pressure as for `exact`. Between two calls it keeps nothing: the chains of a step are a function of the disks, the
/// seed and the step. One thread.
/// Errors: Error for a box with walls or with a side below four contact distances, for fixed disks and for a state that
/// validate() refuses; for Newtonian chains also for different masses and for disks at rest.
/// Cost: docs/notebook/dynamics.md, 30 to 150 ns a contact.
/// Source: E. P. Bernard, W. Krauth & D. B. Wilson (2009), doi:10.1103/PhysRevE.80.056704; M. Klement & M. Engel
/// (2019), doi:10.1063/1.5090882.
class EventChainEngine final : public Engine {
 public:
  EventChainEngine(EngineSettings const& settings, State const& state);

  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override;
  void require_valid(State const& state) const override;
  /// Serializes lengths and durations, which follow from the disks with which the engine was made.
  void serialize(Archive& archive, State const& state) override;

 private:
  ChainKind kind_;
  std::uint64_t chains_ = 1;    ///< in a step
  double length_ = 0.0;         ///< of a straight chain, or the duration of a Newtonian one
  double speed_ = 1.0;          ///< in straight chains: the root mean square speed
  double duration_ = 1.0;       ///< of a step
  double virial_factor_ = 0.0;  ///< of Newtonian chains: 2 kT over the mean squared velocity, their mass
};

}  // namespace gridlock
