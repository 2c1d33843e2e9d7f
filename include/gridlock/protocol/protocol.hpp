#pragma once

/// \file
/// A protocol: stages that take disks from a start to a fluid, a jammed packing or back.
///
/// ```cpp
/// #include "gridlock/lattice/start.hpp"
///
/// State state = make_start(Box(1.0, 1.0, Edge::periodic), {.count = 64, .packing_fraction = 0.4, .start = StartKind::random}, 1);
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
#include "gridlock/protocol/settings.hpp"

namespace gridlock {

/// All settings of a protocol.
struct ProtocolSettings {
  std::vector<StageSettings> stages;
  SoftSettings soft = {};
  double time_step = 1.0;     ///< of the clock of the engine "exact", in physical time
  std::uint64_t threads = 1;  ///< of soft disks; 0: all cores
};

/// The results of swap Monte Carlo, see SwapReport and SwapCorrelation.
struct SwapResult {
  std::optional<double> displacement_acceptance = {};
  std::optional<double> swap_acceptance = {};
  std::optional<double> overlap_relaxation_time = {};  ///< in sweeps, as the next
  std::optional<double> bond_relaxation_time = {};
  std::optional<double> relaxation_times = {};
  bool is_equilibrated = false;
  std::vector<double> lags = {};  ///< in sweeps
  std::vector<double> self_overlap = {};
  std::vector<double> bond_orientation = {};
};

/// The results of a stage.
struct StageResult {
  std::string kind;
  double packing_fraction = 0.0;
  /// βP/ρ for hard disks, P D²/ε for soft disks; none where it was not measured.
  std::optional<double> pressure = {};
  /// Soft disks: whether forces balance, or no disks press on each other.
  std::optional<bool> is_converged = {};
  /// Soft disks: where a minimization gave up.
  std::optional<double> packing_fraction_without_minimum = {};
  /// Soft disks: the mean of δ over the contacts at the end.
  std::optional<double> mean_overlap = {};
  /// Soft disks: what ContactNetwork::is_jammed() says of the packing at the end.
  std::optional<bool> is_jammed = {};
  double disks = 0.0;
  std::uint64_t work = 0;                   ///< iterations, events or trial moves
  std::uint64_t pair_collisions = 0;        ///< of hard disks that fly
  std::vector<PressureLevel> levels = {};   ///< of soft disks, the last one the end of the stage
  std::optional<double> softest_mode = {};  ///< ω² in ε/D² of unit masses, at the end
  std::optional<SwapResult> swap = {};
  std::optional<double> jamming_packing_fraction = {};
  std::optional<double> error_of_jamming_packing_fraction = {};
};

/// Carries out stages, one after the other.
///
/// The clock of the state stays as it is while soft disks move downhill, and passes while hard disks fly.
/// Errors: Error for stages that require_valid() refuses, and a start that the first of them cannot begin with;
/// RunFailure where a later stage cannot begin, a minimization gives up, or a pressure or packing fraction cannot be
/// reached.
class Protocol {
 public:
  Protocol(ProtocolSettings settings, State const& start);
  ~Protocol();

  /// Goes on until the last stage has ended, or should_continue says no. Returns whether the last stage has ended.
  bool advance(State& state, std::function<bool()> const& should_continue = {});

  [[nodiscard]] std::size_t stages() const { return settings_.stages.size(); }
  /// The stage that is carried out, from 0; stages() after the last.
  [[nodiscard]] std::size_t stage() const { return results_.size(); }
  /// "quench"; empty after the last.
  [[nodiscard]] std::string name_of_stage() const;
  /// Iterations, events and trial moves done in all stages.
  [[nodiscard]] std::uint64_t work() const;
  /// The results of the stages that have ended.
  [[nodiscard]] std::vector<StageResult> const& results() const { return results_; }

  /// The state is serialized by its owner, before.
  void serialize(Archive& archive, State const& state);

 private:
  void begin_stage(State const& state);

  ProtocolSettings settings_;
  std::unique_ptr<class Stage> current_;  ///< nothing before a stage begins and after the last
  std::vector<StageResult> results_;
};

}  // namespace gridlock
