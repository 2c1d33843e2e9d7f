#pragma once

/// \file
/// A protocol: stages that change disks from a start to a fluid, to a jammed packing or back.
///
/// ```cpp
/// #include "gridlock/lattice/start.hpp"
///
/// State state = make_start(Box(1.0, 1.0, Edge::periodic),
///                          {.count = 64, .packing_fraction = 0.4, .start = StartKind::random}, 1);
/// Protocol protocol({.stages = {{.kind = "quench", .packing_fraction = 0.9},
///                               {.kind = "decompress", .until_pressure = 1e-6}}},
///                   state);
/// protocol.advance(state);
/// double const jamming_packing_fraction = *protocol.results().back().jamming_packing_fraction;
/// ```

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/packing/pressure_ramp.hpp"
#include "gridlock/packing/quasistatic_shear.hpp"
#include "gridlock/protocol/settings.hpp"

namespace gridlock {

/// All settings of a protocol.
struct ProtocolSettings {
  std::vector<StageSettings> stages;
  SoftSettings soft = {};
  double time_step = 1.0;     ///< physical time of a step of the clock, for hard disks
  std::uint64_t threads = 1;  ///< threads for soft disks; 0: one for each core
};

/// The results of Monte Carlo, see SwapReport, SwapCorrelation and SwapDensity.
struct SwapResult {
  std::optional<double> displacement_acceptance = {};
  std::optional<double> swap_acceptance = {};
  std::optional<double> area_acceptance = {};
  std::optional<double> overlap_relaxation_time = {};  ///< in sweeps, also the next
  std::optional<double> bond_relaxation_time = {};
  std::optional<double> relaxation_times = {};
  std::optional<double> density_drift = {};
  bool is_equilibrated = false;
  std::vector<double> lags = {};  ///< lags in sweeps
  std::vector<double> self_overlap = {};
  std::vector<double> bond_orientation = {};
  std::vector<double> density_sweeps = {};     ///< sweeps at the ends of the stretches
  std::vector<double> packing_fractions = {};  ///< means over the stretches
  std::uint64_t adjusting_stretches = 0;       ///< number of stretches, at the start, that averages leave out
};

/// The results of quasi-static shear, see QuasistaticShear.
struct ShearResult {
  std::vector<ShearedMinimum> minima = {};
  std::vector<ShearEvent> events = {};
  std::vector<EventMotion> motions = {};
  std::vector<ShearCycle> cycles = {};
};

/// The results of a stage.
struct StageResult {
  std::string kind;
  double packing_fraction = 0.0;
  /// βP/ρ for hard disks, P D²/ε for soft disks; empty if not measured.
  std::optional<double> pressure = {};
  /// Soft disks: whether forces balance, or the pressure is 0.
  std::optional<bool> is_converged = {};
  /// Soft disks: packing fraction at which a minimization found no minimum.
  std::optional<double> packing_fraction_without_minimum = {};
  /// Soft disks: mean overlap δ of the contacts at the end.
  std::optional<double> mean_overlap = {};
  /// Soft disks: ContactNetwork::is_jammed() of the packing at the end.
  std::optional<bool> is_jammed = {};
  double disks = 0.0;
  std::uint64_t work = 0;                   ///< iterations, events or trial moves
  std::uint64_t pair_collisions = 0;        ///< pair collisions of moving hard disks
  std::uint64_t state_hash = 0;             ///< of the disks at the end
  std::vector<PressureLevel> levels = {};   ///< soft disks: kept minima; the last is the end of the stage
  std::optional<double> softest_mode = {};  ///< ω² for unit masses at the end, in ε/D²
  std::optional<SwapResult> swap = {};
  std::optional<ShearResult> shear = {};
  std::optional<double> jamming_packing_fraction = {};
  std::optional<double> error_of_jamming_packing_fraction = {};
};

/// Carries out the stages of a protocol, one after the other.
///
/// The clock of the state advances while hard disks move, but not in minimizations of soft disks. Errors: Error for
/// stages that require_valid() refuses, or a start that the first stage cannot use; RunFailure if a later stage cannot
/// begin, a minimization finds no minimum, or a pressure or packing fraction cannot be reached.
class Protocol {
 public:
  Protocol(ProtocolSettings settings, State const& start);
  ~Protocol();

  /// Continues until the last stage ends or should_continue() returns false. Returns whether the last stage has ended.
  bool advance(State& state, std::function<bool()> const& should_continue = {});

  [[nodiscard]] std::size_t stages() const { return settings_.stages.size(); }
  /// Returns the number of the present stage, from 0; stages() after the last.
  [[nodiscard]] std::size_t stage() const { return results_.size(); }
  /// Returns the kind of the present stage: "quench"; empty after the last.
  [[nodiscard]] std::string name_of_stage() const;
  /// Returns the iterations, events and trial moves done in all stages.
  [[nodiscard]] std::uint64_t work() const;
  /// Returns the results of the stages that have ended.
  [[nodiscard]] std::vector<StageResult> const& results() const { return results_; }
  /// Returns the state hash at the end of each of them.
  [[nodiscard]] std::vector<std::uint64_t> state_hashes() const;
  /// Returns what the present stage has measured if it is a shear; nothing for another kind, and after the last stage.
  [[nodiscard]] std::optional<ShearResult> shear_so_far() const;

  /// Serializes the protocol. Contract: the caller has serialized the state before.
  void serialize(Archive& archive, State const& state);

 private:
  void begin_stage(State const& state);

  ProtocolSettings settings_;
  std::unique_ptr<class Stage> current_;  ///< nullptr before a stage begins and after the last
  std::vector<StageResult> results_;
};

}  // namespace gridlock
