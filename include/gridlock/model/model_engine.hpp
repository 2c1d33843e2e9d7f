#pragma once

/// \file
/// The engine that steps a model, and the members that a model has.
///
/// ```cpp
/// struct Walkers {
///   static constexpr std::string_view name = "walkers";
///   static constexpr Schedule schedule = Schedule::synchronous;
///   using Agents = Population<X, Y>;
///   double cutoff() const { return 0.1; }
///   double time_step() const { return 1.0; }
///   void turn(Turn<Walkers>& self) const { self.move_by({0.01, 0.0}); }
/// };
/// inline void walk(World<Walkers>& world) {
///   ModelEngine<Walkers> engine({}, world.box, {.threads = 2});
///   Counters counters;
///   engine.advance(world, counters, {.step = 100});
/// }
/// ```

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/model/detail/agents_in_cell_order.hpp"
#include "gridlock/model/detail/cells_of_step.hpp"
#include "gridlock/model/detail/checks.hpp"
#include "gridlock/model/detail/turns_in_tiles.hpp"
#include "gridlock/model/fields.hpp"
#include "gridlock/model/mutable_world.hpp"
#include "gridlock/model/networks.hpp"
#include "gridlock/model/turn.hpp"

namespace gridlock {

/// The settings of the engine of a model; they do not change the bits of the results.
struct ModelEngineSettings {
  std::uint64_t threads = 1;       ///< used by synchronous and tiled models; 0: one for each core
  std::uint64_t verify_every = 0;  ///< steps between comparisons of searches with brute force; 0: never
  bool is_on_device = false;       ///< whether a graphics processor takes the steps of a model that can run there
};

template <class Model>
std::vector<Count> counts_of_events(World<Model> const& world) {
  std::vector<Count> counts;
  for (std::size_t k = 0; k < world.events.size(); ++k) {
    counts.push_back({std::string(event_names<Model>()[k]), world.events[k]});
  }
  return counts;
}

/// Throws Error if the box is too small for searches within `cutoff`.
void require_cutoff_fits(Box const& box, double cutoff, std::string_view model);

/// Advances a world step by step, with a grid whose cells fit the model's cutoff.
///
/// A model is a struct with
///
///     static constexpr std::string_view name, documentation;
///     static constexpr Schedule schedule;
///     using Agents = Population<X, Y, …>;            the columns of an agent
///     double cutoff() const;                         largest distance of a search
///     double time_step() const;
///     std::uint64_t agents_at_start() const;         number of agents at the start
///     Agents::Values first_agent(World<Model> const&, std::uint64_t number) const;   number 0 … agents_at_start() − 1
///     void turn(Turn<Model>&) const;                 synchronous, sequential, tiled: moves one agent in a step
///     void step(MutableWorld<Model>&) const;         events: changes the world in a step
///     using Fields = FieldSet<Grass, …>;             grids of numbers over the box
///     std::size_t columns(Grass) const;              cells of a field along x; rows(Grass) along y, else squares
///     void start_fields(World<Model>&) const;        fills the fields, 0 at first, before there are agents
///     void step_fields(FieldsOfStep<Model>&) const;  changes the fields at the end of each step
///     using Networks = NetworkSet<Friends, …>;       synchronous, sequential: edges between the agents
///     void start_networks(World<Model>&) const;      connects the first agents, of which agent k has the Id k
///     void step_networks(NetworksOfStep<Model>&) const;   changes the edges at the end of each step
///     bool is_awake(World<Model> const&, std::size_t row) const;   synchronous: whether an agent takes a turn
///     void observe(AgentSums<Model> const&, Observations&) const;
///     void describe(SettingVisitor&);                visits its settings
///     void check(Box const&) const;                  throws Error for settings with which no run is possible
///     double attempts_at_start(Box const&, std::uint64_t seed) const;   random places that start() will try
///     std::vector<std::string> notes(AgentSums<Model> const&) const;   reasons why results of a start mislead
///
/// The last thirteen may be left out. A model may add `static constexpr std::array<std::string_view, n> events`, the
/// names of the events it counts, and `static constexpr bool keeps_counters = true` if its turns update
/// Turn::counters(), from which the run measures collision rates and pressures.
///
/// cutoff() and time_step() may take the World: they are then called in every step. They may also take the AgentSums:
/// they are then called once when a run begins or continues, and must not change during a run (not checked). If first
/// agents depend on one another, `void start(World<Model>&) const` places all of them in place of first_agent();
/// agents_at_start() then only serves to estimate the memory, and the root process makes all agents. observe() and
/// notes() may take `World<Model> const&` for quantities that are no sums over agents. Several processes can divide the
/// agents of a model only if none of cutoff(), time_step(), observe() and notes() takes the World, and if it has no
/// fields, no networks and no is_awake().
///
/// In a tiled model no agent searches or moves farther than the cutoff from the point where its turn began. A model
/// with a few faster agents defines `bool is_local(Turn<Model> const&, double room) const`, where room is the shorter
/// side of a cell: agents for which it returns false take their turns one after the other at the end of the step. The
/// order of turns follows from the cells; a model may choose the cells in `CellLayout cells(AgentSums<Model> const&)
/// const`.
///
/// The bits do not depend on the number of threads, on the number of calls of advance(), or on the order of the rows.
/// Neighbours are visited cell by cell and in a cell in the order of their Ids when the step began, so that sums over
/// neighbours always round alike. Cost: synchronous, about 25 ns an agent and step besides searches and the model's own
/// work, less after steps in which no agent moved, died or was born: then nothing is sorted. An agent for which
/// is_awake() returns false keeps its values, for about a fifth of what an agent costs whose turn returns at once.
template <class Model>
class ModelEngine final : public EngineFor<Model> {
  static_assert(!has_networks<Model>() || Model::schedule == Schedule::synchronous ||
                    Model::schedule == Schedule::sequential,
                "networks are for models that are synchronous or sequential");
  static_assert(!has_sleepers<Model>() || Model::schedule == Schedule::synchronous,
                "is_awake() is for synchronous models");

 public:
  ModelEngine(Model model, Box const& box, ModelEngineSettings const& settings)
      : model_(std::move(model)), settings_(settings), thread_pool_(settings.threads), order_(thread_pool_) {
    if constexpr (requires { model_.cutoff(); }) require_cutoff_fits(box, model_.cutoff(), Model::name);
  }

  [[nodiscard]] Model const& model() const { return model_; }

  void advance(World<Model>& world, StopCondition const& stop_condition) {
    Counters unused;
    advance(world, unused, stop_condition);
  }

  /// Errors: RunFailure if a search differs from brute force, or if an agent is outside the box, searches beyond the
  /// cutoff or counts an event that is not declared; and any exception of the model.
  void advance(World<Model>& world, Counters& counters, StopCondition const& stop_condition) override {
    // The caller may have changed the world since the last call.
    bool knows_world = false;
    while (!stop_condition.is_reached(world.clock, counters.pair_collisions)) {
      prepare(world, knows_world);
      knows_world = true;
      if constexpr (Model::schedule == Schedule::synchronous) {
        step_synchronously(world);
      } else if constexpr (Model::schedule == Schedule::sequential) {
        step_in_turns(world, counters);
      } else if constexpr (Model::schedule == Schedule::tiled) {
        step_in_tiles(world, counters);
      } else {
        MutableWorld<Model> open(world, grid_, cutoff_, is_verified(world));
        model_.step(open);
      }
      step_fields(world);
      step_networks(world);
      ++world.clock.step;
      world.clock.time += time_step_;
      if (stop_condition.stops_here()) break;
    }
  }

  [[nodiscard]] double time_step_of(World<Model> const& world) const override {
    return gridlock::time_step_of(model_, world);
  }
  void require_valid(World<Model> const& world) const override {
    try {
      require_inside(world);
      require_fields(model_, world);
      require_networks(world);
    } catch (RunFailure const& failure) {
      throw Error(Problem{.what = failure.what()});
    }
  }
  [[nodiscard]] std::vector<Count> counts(World<Model> const& world, Counters const& /*counters*/) const override {
    return counts_of_events(world);
  }

  /// Throws RunFailure for an agent outside the box.
  static void require_inside(World<Model> const& world) {
    auto const x = world.agents.template column<X>();
    auto const y = world.agents.template column<Y>();
    std::size_t const row = find_outside(world.box, x, y);
    if (row < x.size()) throw_outside(world.clock.step, world.agents.ids()[row], {x[row], y[row]}, world.box);
  }

 private:
  [[nodiscard]] bool is_verified(World<Model> const& world) const {
    return settings_.verify_every > 0 && world.clock.step % settings_.verify_every == 0;
  }

  /// Sorts rows and fills the grid so that both depend on the state alone, not on earlier steps.
  void prepare(World<Model>& world, bool knows_world) {
    // A start or a checkpoint may have agents outside the box. In a step, each birth and move is checked by itself.
    if (!knows_world) {
      require_inside(world);
      require_fields(model_, world);
      require_networks(world);
    }
    find_neighbours_on_networks(world, knows_world);
    if (!knows_world || asks_world_in_every_step<Model>()) {
      cutoff_ = cutoff_of(model_, world);
      time_step_ = gridlock::time_step_of(model_, world);
      require_good_step(world.clock.step, cutoff_, time_step_);
    }
    [[maybe_unused]] CellLayout const before = layout_;
    find_layout(world, knows_world);
    if constexpr (Model::schedule == Schedule::synchronous) {
      bool const is_sorted = knows_world && stood_still_ && !asks_world_in_every_step<Model>();
      layout_ = is_sorted ? order_.layout() : order_.sort(world.agents, layout_, finer_layout_);
    } else if constexpr (Model::schedule == Schedule::tiled) {
      order_.sort(world.agents, layout_);
      grid_ = PackedGrid(layout_, world.agents.template column<X>(), world.agents.template column<Y>());
    } else if constexpr (Model::schedule == Schedule::events) {
      // The grid has followed every event, and no result of MutableWorld depends on the order of agents in a cell.
      if (knows_world && layout_ == before) return;
      grid_ = PackedGrid(layout_, world.agents.template column<X>(), world.agents.template column<Y>());
    } else {
      std::vector<std::uint32_t> const rows = rows_in_order(world.agents.ids());
      auto const x = world.agents.template column<X>();
      auto const y = world.agents.template column<Y>();
      grid_ = PackedGrid(layout_);
      for (std::size_t const row : rows) grid_.insert(row, {x[row], y[row]});
    }
  }

  void find_layout(World<Model> const& world, bool knows_world) {
    if (!knows_world || asks_world_in_every_step<Model>()) fixed_layout_ = cells_of(model_, world);
    finer_layout_.reset();
    if (fixed_layout_) {
      layout_ = *fixed_layout_;
      return;
    }
    CellsOfStep const cells = cells_of_step(world.box, cutoff_, world.agents.size());
    layout_ = cells.layout;
    // Other schedules never use the finer cells, since the order of their turns depends on the cells.
    if constexpr (Model::schedule == Schedule::synchronous) finer_layout_ = cells.finer;
  }

  void step_synchronously(World<Model>& world) {
    order_.begin_turns(world.agents.size());
    commands_.resize(order_.bands());
    order_.for_each_turn([&](std::size_t band) { return neighbourhood(world, commands_[band]); },
                         [&](std::size_t row) {
                           order_.copy_present(world.agents, row);
                           return is_awake(model_, world, row);
                         },
                         [&](Neighbourhood<Model>& around, std::size_t row, std::size_t /*band*/) {
                           Turn<Model> turn(around, row);
                           model_.turn(turn);
                         });
    stood_still_ = nobody_moves(world);
    ChangesOfFields<Model> const changes(world, commands_);
    world.agents.exchange(order_.next());
    changes.apply(world);
    births_ = apply_commands<Model>(world, commands_);
  }

  /// Synchronous: returns whether no agent moves, is born or dies in this step, so that all rows stay in order.
  [[nodiscard]] bool nobody_moves(World<Model> const& world) const {
    auto const is_same = [&](auto column_type) {
      using Column = typename decltype(column_type)::type;
      return std::ranges::equal(world.agents.template column<Column>(), order_.next().template values<Column>());
    };
    return is_same(std::type_identity<X>{}) && is_same(std::type_identity<Y>{}) &&
           std::ranges::all_of(commands_, [](DeferredCommands<Model> const& commands) {
             return commands.births.empty() && commands.deaths.empty();
           });
  }

  /// Returns the data that the turns of one thread share.
  Neighbourhood<Model> neighbourhood(World<Model>& world, DeferredCommands<Model>& commands,
                                     Counters* counters = nullptr) {
    constexpr bool is_synchronous = Model::schedule == Schedule::synchronous;
    return {.world = world,
            .commands = commands,
            .next = is_synchronous ? &order_.next() : nullptr,
            .grid = is_synchronous ? nullptr : &grid_,
            .counters = counters,
            .cutoff = cutoff_,
            .time_step = time_step_,
            .population = world.agents.size(),
            .is_verified = is_verified(world),
            .on_networks = on_networks_};
  }

  void step_in_turns(World<Model>& world, Counters& counters) {
    commands_.resize(1);
    Neighbourhood<Model> around = neighbourhood(world, commands_.front(), &counters);
    for (std::size_t const row : rows_in_order(world.agents.ids())) {
      Turn<Model> turn(around, row);
      model_.turn(turn);
    }
    births_ = apply_commands<Model>(world, commands_);
  }

  /// A step in which a turn fails leaves the world as it was before.
  void step_in_tiles(World<Model>& world, Counters& counters) {
    turns_.begin_step(layout_, world.agents.size());
    take_turns_of_tiles(world);
    auto const tiles = static_cast<std::uint32_t>(turns_.tiling().tiles().size());
    // Late agents take their turns in the order of the tiles, so that the bits do not depend on the number of threads.
    for (std::uint32_t tile = 0; tile < tiles && !turns_.has_failed(); ++tile) {
      turns_.take_late(model_, neighbourhood(world, commands_.front()), tile);
    }
    if (turns_.has_failed()) {
      commands_.clear();
      order_.undo(world.agents);
      std::rethrow_exception(turns_.failure());
    }
    if constexpr (has_fields<Model>()) change_fields(world);
    if constexpr (keeps_counters<Model>()) {
      CountersOfStep of_step;
      for (std::uint32_t tile = 0; tile < tiles; ++tile) of_step.add(turns_.result_of(tile).counters);
      of_step.add_to(counters);
    }
    births_ = apply_commands<Model>(world, commands_);
  }

  /// Tiled: an overflow of a field leaves the world as it was before the step.
  void change_fields(World<Model>& world) {
    try {
      ChangesOfFields<Model>(world, commands_).apply(world);
    } catch (...) {
      commands_.clear();
      order_.undo(world.agents);
      throw;
    }
  }

  void step_fields([[maybe_unused]] World<Model>& world) {
    if constexpr (requires(FieldsOfStep<Model> & fields) { model_.step_fields(fields); }) {
      FieldsOfStep<Model> fields(world, time_step_, thread_pool_);
      model_.step_fields(fields);
      fields.require_finite();
    }
  }

  void step_networks([[maybe_unused]] World<Model>& world) {
    if constexpr (requires(NetworksOfStep<Model> & networks) { model_.step_networks(networks); }) {
      NetworksOfStep<Model> networks(world, births_);
      try {
        model_.step_networks(networks);
      } catch (Error const& error) {
        throw failure_of_networks(world.clock.step, error);
      }
      for (std::size_t k = 0; k < on_networks_.size(); ++k) {
        if (!networks.is_changed(k)) continue;
        require_living_ends(world, world.networks[k]);
        on_networks_[k] = NeighboursOnNetwork(world.networks[k]);
      }
    }
  }

  /// Deaths make a network smaller; step_networks() looks after its changes itself.
  void find_neighbours_on_networks(World<Model> const& world, bool knows_world) {
    for (std::size_t k = 0; k < on_networks_.size(); ++k) {
      if (knows_world && on_networks_[k].edges() == world.networks[k].size()) continue;
      on_networks_[k] = NeighboursOnNetwork(world.networks[k]);
    }
  }

  void take_turns_of_tiles(World<Model>& world) {
    // One thread only: brute force reads all agents, which other threads would move at the same time.
    std::size_t const threads = is_verified(world) ? 1 : thread_pool_.size();
    if (rounds_.empty() || layout_ != layout_of_rounds_ || threads != threads_of_rounds_) {
      rounds_ = turns_.tiling().rounds(threads);
      layout_of_rounds_ = layout_;
      threads_of_rounds_ = threads;
    }
    std::size_t parts = 0;
    for (Tiling::Round const& round : rounds_) parts = std::max(parts, round.size());
    commands_.resize(parts);
    for (Tiling::Round const& round : rounds_) {
      thread_pool_.for_each(round.size(), [&](std::size_t part) {
        for (std::uint32_t const tile : round[part]) {
          turns_.take_tile(model_, neighbourhood(world, commands_[part]), tile);
        }
      });
    }
  }

  Model model_;
  ModelEngineSettings settings_;
  ThreadPool thread_pool_;
  double cutoff_ = 0.0;
  double time_step_ = 0.0;
  CellLayout layout_;
  std::optional<CellLayout> fixed_layout_;  ///< the cells that the model chooses
  std::optional<CellLayout> finer_layout_;  ///< synchronous: used if the agents crowd
  AgentsInCellOrder<Model> order_;
  bool stood_still_ = false;  ///< synchronous: whether the rows are as order_ has sorted them
  PackedGrid grid_;
  std::vector<DeferredCommands<Model>> commands_;
  std::vector<Birth> births_;  ///< of this step, if the model has networks
  std::array<NeighboursOnNetwork, NetworksOf<Model>::count> on_networks_;
  TurnsInTiles<Model> turns_;          ///< used by tiled models
  std::vector<Tiling::Round> rounds_;  ///< tiled: planned for threads_of_rounds_ threads
  std::size_t threads_of_rounds_ = 0;
  CellLayout layout_of_rounds_;
};

}  // namespace gridlock
