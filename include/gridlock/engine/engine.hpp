#pragma once

/// \file
/// Engines advance a world: their interface, settings and records.
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
#include "gridlock/core/setting.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// When an engine stops: at whichever comes first.
struct StopCondition {
  std::uint64_t step = std::numeric_limits<std::uint64_t>::max();             ///< state.clock.step to reach
  double time = std::numeric_limits<double>::infinity();                      ///< state.clock.time to reach
  std::uint64_t pair_collisions = std::numeric_limits<std::uint64_t>::max();  ///< counters.pair_collisions to reach
  /// Asked after every step, and by exact, whose step may hold any number of collisions, within it as well; where exact
  /// has several threads, which fly some steps at once, now and then. Where the answer is no, the engine stops there.
  /// Counters and whole steps are up to date then, time and disks only when advance() has returned. Empty: never asked.
  /// Must not throw.
  std::function<bool()> should_continue = {};

  /// Whether a run that has come so far has come to its end.
  [[nodiscard]] bool is_reached(Clock const& clock, std::uint64_t pair_collisions_so_far) const {
    return clock.step >= step || clock.time >= time || pair_collisions_so_far >= pair_collisions;
  }
  [[nodiscard]] bool stops_here() const { return should_continue && !should_continue(); }
};

/// How often something happened since the start, for example "pair_collisions".
struct Count {
  std::string name;
  std::uint64_t value = 0;
};

/// An engine advances the world of a model. One virtual call per chunk of work, never per agent.
template <class Model>
class EngineFor {
 public:
  EngineFor() = default;
  EngineFor(EngineFor const&) = delete;
  EngineFor& operator=(EngineFor const&) = delete;
  virtual ~EngineFor() = default;

  /// Moves the world on until the stop condition holds and adds what happened to the counters. Between calls the world
  /// is plain and up to date, and the caller may change it.
  /// Errors: RunFailure where the physics breaks an invariant, naming step, ids and gap.
  virtual void advance(World<Model>& world, Counters& counters, StopCondition const& stop_condition) = 0;

  /// The physical time of the next step.
  [[nodiscard]] virtual double time_step_of(World<Model> const& world) const = 0;

  /// Throws Error for a world that this engine cannot advance rightly, as its constructor does; where processes share
  /// the world, for agents of this one that are wrong by themselves.
  virtual void require_valid(World<Model> const& world) const = 0;

  /// The world has been restored from a checkpoint by the processes that share it, which call this together: the
  /// agents may go to others. Errors: Error, in all of them, for a world that cannot be advanced rightly.
  virtual void take_restored(World<Model>& /*world*/) {}

  /// The counters of events, by name.
  [[nodiscard]] virtual std::vector<Count> counts(World<Model> const& world, Counters const& counters) const = 0;

  /// How often the checks were made that EngineSettings::audit_every asks for, by name; empty where it asks for none.
  [[nodiscard]] virtual std::vector<Count> audits() const { return {}; }

  /// Serializes what the engine keeps between two calls of advance() besides the world, which has been serialized
  /// before: restored into an engine made for the same start, it continues with the same bits. Most keep nothing.
  virtual void serialize(Archive& /*archive*/, World<Model> const& /*world*/) {}
};

/// Whether a disk that halts collides with its partner whatever their motion (the paper's rule) or only when the two
/// approach each other.
enum class CollisionRule { always, approaching };

/// The grid that finds the neighbours of a disk in `stepped`: the paper's linked lists, the readable reference, or
/// cells packed into cache lines. Both give the same bits.
enum class GridKind { linked, packed };

/// The settings `[engine]`.
struct EngineSettings {
  std::string kind = "stepped";
  double time_step = 0.1;       ///< in diameters of the smallest disk per `speed`
  std::optional<double> speed;  ///< the speed time_step refers to; left out: velocities.max
  std::uint64_t substeps = 5;
  std::optional<std::uint64_t> cells;  ///< k of the k × k linked lists; left out: chosen from the sizes
  CollisionRule contact = CollisionRule::always;
  std::uint64_t audit_every = 0;  ///< pair collisions between two audits of the exact engine; 0: never
  GridKind grid = GridKind::packed;
  std::uint64_t threads = 0;    ///< of the engines exact and tiled; 0: all cores
  AllProcesses processes = {};  ///< that share the steps of tiled with this one; nothing that a file can set
};
void describe(EngineSettings& settings, SettingVisitor& visitor);
/// Describes the threads alone, which is all that other models use.
void describe_threads(EngineSettings& settings, SettingVisitor& visitor);

/// A dynamics of hard disks.
class Engine : public EngineFor<HardDisks> {
 public:
  /// The physical time of one step.
  [[nodiscard]] virtual double time_step() const = 0;
  [[nodiscard]] double time_step_of(State const& /*world*/) const final { return time_step(); }

  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override;
};

/// The record of an engine: nothing outside its own two files compares its name.
struct EngineRecord {
  std::string_view name;           ///< engine.kind
  std::string_view documentation;  ///< what it is, in words that follow its name
  bool has_time_step = true;       ///< false: it goes from event to event, and a run can end within a step
  bool uses_threads = false;
  bool uses_processes = false;                ///< EngineSettings::processes
  double bytes_per_disk = 0.0;                ///< at the peak of a run, all of the program counted
  double bytes_per_disk_of_threads = 0.0;     ///< what more than one thread add to that peak
  double bytes_per_disk_of_checkpoint = 0.0;  ///< what a checkpoint adds to that peak
  double bytes_per_cell = 0.0;                ///< of the cells that engine.cells asks for
  /// The setting of the table [engine] because of which a run does not depend on another one of it: "kind", or "grid"
  /// for cells that the packed grid chooses by itself. Empty where it depends on it.
  std::string_view (*unused_because_of)(EngineSettings const& settings, std::string_view setting) = nullptr;
  /// The expected cost of a move, in moves on cells chosen from the sizes.
  double (*cost_of_move)(EngineSettings const& settings, State const& state) = nullptr;
  /// Errors: Error naming the setting for a set-up that the engine cannot treat rightly.
  std::unique_ptr<Engine> (*make)(EngineSettings const& settings, State const& state) = nullptr;
};

/// Those of all engines.
std::span<EngineRecord const> engine_records();

/// The one of that name. Errors: Error under "engine.kind" where there is none.
EngineRecord const& engine_record(std::string_view kind);

/// Makes the engine named by settings.kind for a valid state.
/// Errors: Error naming the setting for an unknown kind, or for a set-up the engine cannot treat rightly.
std::unique_ptr<Engine> make_engine(EngineSettings const& settings, State const& state);

/// The kinds make_engine() knows.
std::vector<std::string> engine_kinds();

/// The physical length of one step, time_step · σ_min / speed, where an absent or zero speed counts as 1.
double step_duration(EngineSettings const& settings, State const& state);
/// The same of disks of which the smallest has this radius.
double step_duration(EngineSettings const& settings, double smallest_radius);

}  // namespace gridlock
