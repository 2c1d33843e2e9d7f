#pragma once

/// \file
/// Engines advance a world: their interface, their settings and the list of them.
///
/// ```cpp
/// #include "gridlock/lattice/start.hpp"
///
/// State state = make_start(Box(1.0, 1.0, Edge::wall), {.count = 100, .packing_fraction = 0.5}, 1);
/// draw_velocities(state, {});
/// Counters counters;
/// make_engine({.kind = "tiled"}, state)->advance(state, counters, {.step = 1000});
/// ```

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/counters.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/frame_source.hpp"
#include "gridlock/core/pair_potential.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/engine/device.hpp"
#include "gridlock/engine/flow.hpp"
#include "gridlock/engine/grains.hpp"
#include "gridlock/engine/pair_drag.hpp"
#include "gridlock/engine/propulsion.hpp"
#include "gridlock/engine/thermostat.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// The conditions at which an engine stops; it stops at the first that holds.
struct StopCondition {
  std::uint64_t step = std::numeric_limits<std::uint64_t>::max();             ///< state.clock.step to reach
  double time = std::numeric_limits<double>::infinity();                      ///< state.clock.time to reach
  std::uint64_t pair_collisions = std::numeric_limits<std::uint64_t>::max();  ///< counters.pair_collisions to reach
  /// Called after every step; the engine stops if it returns false. `exact` also calls it within a step, which may have
  /// any number of collisions; on several threads, which take some steps together, it calls it less often. During the
  /// call counters and whole steps are up to date, but time and disks only after advance() has returned. Empty: never
  /// called. It must not throw.
  std::function<bool()> should_continue = {};

  /// Returns whether the clock or the number of collisions has reached its end.
  [[nodiscard]] bool is_reached(Clock const& clock, std::uint64_t pair_collisions_so_far) const {
    return clock.step >= step || clock.time >= time || pair_collisions_so_far >= pair_collisions;
  }
  [[nodiscard]] bool stops_here() const { return should_continue && !should_continue(); }
};

/// A number of events since the start with its name, for example "pair_collisions".
struct Count {
  std::string name;
  std::uint64_t value = 0;
};

/// A collision of two disks, as the engine `exact` reports it.
struct PairCollision {
  double time;        ///< on the clock of the run
  std::uint32_t i;    ///< index of a disk among those that move, in the order of the Ids
  std::uint32_t j;    ///< index of its partner
  Vector separation;  ///< from i to j, to the nearest image
  Vector velocity_i;  ///< before the collision
  Vector velocity_j;
  double mass_i;
  double mass_j;
  Vector impulse;  ///< momentum that i gives to j
};
using ReportCollision = std::function<void(PairCollision const&)>;
/// Throws Error for an engine that does not report collisions.
[[noreturn]] void refuse_to_report_collisions();

/// An engine advances the world of a model. A virtual call advances many steps, so that its cost does not matter.
template <class Model>
class EngineFor {
 public:
  EngineFor() = default;
  EngineFor(EngineFor const&) = delete;
  EngineFor& operator=(EngineFor const&) = delete;
  virtual ~EngineFor() = default;

  /// Advances the world until the stop condition holds, and adds the events to the counters. Between calls the world is
  /// up to date, and the caller may change it. Errors: RunFailure, with step, Ids and gap, if the physics breaks an
  /// invariant.
  virtual void advance(World<Model>& world, Counters& counters, StopCondition const& stop_condition) = 0;

  /// Returns the physical time of the next step.
  [[nodiscard]] virtual double time_step_of(World<Model> const& world) const = 0;

  /// Throws Error for a world that this engine cannot advance correctly, as its constructor does. If processes share
  /// the world, it checks only the agents of this process, one by one.
  virtual void require_valid(World<Model> const& world) const = 0;

  /// Called by all processes that share a world after each has restored its part of a checkpoint; agents may move to
  /// other processes. Errors: Error, in all processes, for a world that this engine cannot advance correctly.
  virtual void take_restored(World<Model>& /*world*/) {}

  /// Returns the counters of events, by name.
  [[nodiscard]] virtual std::vector<Count> counts(World<Model> const& world, Counters const& counters) const = 0;

  /// Returns the number of checks made for EngineSettings::audit_every, by name; empty if audit_every is 0.
  [[nodiscard]] virtual std::vector<Count> audits() const { return {}; }

  /// Serializes the data that the engine keeps between two calls of advance(), after the world. Restored into an engine
  /// made for the same start, the run continues with the same bits. Most engines keep no data.
  virtual void serialize(Archive& /*archive*/, World<Model> const& /*world*/) {}

  /// From now on advance() calls report() at each collision of two disks, in the order of time. It must not throw.
  /// Several threads then do not share the work. Errors: Error if the engine knows no collisions one by one.
  virtual void report_collisions(ReportCollision /*report*/) { refuse_to_report_collisions(); }

  /// Calls use() with a frame of the world and the columns that the engine alone knows, such as headings.
  virtual void give_frame(FrameSource const& of_world, UseFrame const& use) const { use(of_world); }
};

/// The rule for a disk that halts at another disk: they collide always (the rule of the paper), or only if they
/// approach each other.
enum class CollisionRule { always, approaching };

/// The grid that finds the neighbours of a disk in `stepped`: the linked lists of the paper, or cells packed into cache
/// lines. Both give the same bits.
enum class GridKind { linked, packed };

/// The chains of `event_chain`: a disk moves straight on until it meets another, which goes on in its place, or each
/// disk moves by its velocity and exchanges momentum with the next one.
enum class ChainKind { straight, newtonian };

/// The settings `[engine]`.
struct EngineSettings {
  std::string kind = "stepped";
  double time_step = 0.1;       ///< in units of the smallest diameter over `speed`
  std::optional<double> speed;  ///< unit of speed of time_step; default: velocities.max, for soft disks √(ε/m)
  std::uint64_t substeps = 5;
  std::optional<std::uint64_t> cells;  ///< k of the k × k linked lists; default: from the sizes of the disks
  CollisionRule contact = CollisionRule::always;
  std::uint64_t audit_every = 0;  ///< exact: pair collisions between two audits; 0: never
  GridKind grid = GridKind::packed;
  ChainKind chains = ChainKind::straight;     ///< event_chain: how disks move
  std::optional<std::uint64_t> chain_length;  ///< event_chain: contacts of a chain; default: 8 √N, 1,000 at most
  std::uint64_t threads = 0;                  ///< exact and tiled: number of threads; 0: one for each core
  Device device = Device::cpu;                ///< tiled: the processor; device_of() says which is used
  ThermostatSettings thermostat = {};         ///< exact and soft: the settings `[thermostat]`
  CollisionSettings collisions = {};          ///< exact: the settings `[collisions]`
  GravitySettings gravity = {};               ///< exact: the settings `[gravity]`
  std::vector<WallSettings> walls = {};       ///< the walls inside the box, `[[walls]]`
  PropulsionSettings propulsion = {};         ///< the settings `[propulsion]`
  PotentialSettings potential = {};           ///< soft: the settings `[potential]`
  FlowSettings flow = {};                     ///< soft: the settings `[flow]`
  PairDragSettings pair_drag = {};            ///< soft: the settings `[pair_drag]`
  AllProcesses processes = {};                ///< tiled: processes that share the run; not set by a file
};
void describe(EngineSettings& settings, SettingVisitor& visitor);
/// Describe only the threads or the device, the only settings of `[engine]` that models other than hard disks use.
void describe_threads(EngineSettings& settings, SettingVisitor& visitor);
void describe_device(EngineSettings& settings, SettingVisitor& visitor);

/// An engine for hard disks.
class Engine : public EngineFor<HardDisks> {
 public:
  /// Returns the physical time of one step.
  [[nodiscard]] virtual double time_step() const = 0;
  [[nodiscard]] double time_step_of(State const& /*world*/) const final { return time_step(); }

  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override;
};

/// The properties of an engine. Other code uses this record, and never compares the name of an engine.
struct EngineRecord {
  std::string_view name;           ///< name of the engine, the value of engine.kind
  std::string_view documentation;  ///< a description, which is printed after the name
  bool has_time_step = true;       ///< false: it is event-driven, and a run can end within a step
  bool uses_threads = false;
  bool uses_device = false;                   ///< whether it runs on graphics processors
  bool uses_processes = false;                ///< whether it uses EngineSettings::processes
  bool has_free_flight = false;               ///< whether it uses thermostat, collisions and gravity of EngineSettings
  bool has_potential = false;                 ///< whether disks are soft: they may overlap, and nothing collides
  bool has_oblique_boxes = false;             ///< whether the box may have a tilt
  bool is_monte_carlo = false;                ///< whether it has no dynamics, and a time is only a number of moves
  double bytes_per_disk = 0.0;                ///< largest memory of the whole program during a run
  double bytes_per_disk_of_threads = 0.0;     ///< additional memory for several threads
  double bytes_per_disk_of_checkpoint = 0.0;  ///< additional memory for writing a checkpoint
  double bytes_per_cell = 0.0;                ///< for the cells of engine.cells
  /// Returns the setting of `[engine]` that makes another setting of it have no effect: "kind", or "grid" for cells
  /// that the packed grid chooses by itself. Empty if the setting has an effect.
  std::string_view (*unused_because_of)(EngineSettings const& settings, std::string_view setting) = nullptr;
  /// Returns the expected cost of a move, relative to a move with cells that the program chooses.
  double (*cost_of_move)(EngineSettings const& settings, State const& state) = nullptr;
  /// Makes the engine. Errors: Error with the setting for a set-up that the engine cannot advance correctly.
  std::unique_ptr<Engine> (*make)(EngineSettings const& settings, State const& state) = nullptr;
};

/// Returns the memory of kicks and headings that an engine of free flight keeps, in bytes for each disk.
double bytes_per_kicked_disk(EngineSettings const& settings);

/// Returns the records of all engines.
std::span<EngineRecord const> engine_records();

/// Returns the record of the engine named `kind`. Errors: Error for the setting "engine.kind" if there is none.
EngineRecord const& engine_record(std::string_view kind);

/// Errors: Error for a thermostat, a loss of energy, gravity, self-propulsion, a flow or a drag that the engine does
/// not know, and for a potential that is none.
void require_known(EngineRecord const& engine, EngineSettings const& settings);

/// Makes the engine named by settings.kind for a valid state.
/// Errors: Error with the setting for an unknown kind, or for a set-up that the engine cannot advance correctly.
std::unique_ptr<Engine> make_engine(EngineSettings const& settings, State const& state);

/// Returns the names of all engines.
std::vector<std::string> engine_kinds();

/// Returns the physical time of one step, time_step · σ_min / speed; an absent or zero speed counts as 1.
double step_duration(EngineSettings const& settings, State const& state);
/// Returns the physical time of one step for disks whose smallest radius is `smallest_radius`.
double step_duration(EngineSettings const& settings, double smallest_radius);

}  // namespace gridlock
