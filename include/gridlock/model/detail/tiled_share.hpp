#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tile_division.hpp"
#include "gridlock/model/detail/share.hpp"
#include "gridlock/model/detail/turns_in_tiles.hpp"
#include "gridlock/parallel/detail/agents_message.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/domain.hpp"
#include "gridlock/parallel/detail/halo.hpp"
#include "gridlock/parallel/detail/lent_cells.hpp"

namespace gridlock {

/// The part of one process in the steps of a tiled model: the agents of its tiles, and copies of the agents in the ring
/// of cells around them, which other processes own.
///
/// A step has four rounds, one for each colour of tiles. After a round a process sends its neighbours the cells that
/// may have changed, see Halo. Messages keep the order of the agents in a cell, so that all processes visit them as one
/// process does. Late agents then take their turns one after the other, in the order of a run of one process: a process
/// borrows the cells that its late agents reach from other processes, and gives them back.
///
/// All processes construct it and call take_step() together. The bits are those of a run of one process.
template <class Model>
class TiledModelShare final : public AgentsOfShare<Model> {
  using Base = AgentsOfShare<Model>;
  using typename Base::Rows;

 public:
  using typename Base::Agents;
  using typename Base::AllValues;

  /// `ids` and `values` belong to the agents in the tiles of this process.
  TiledModelShare(Domain&& domain, Model const& model, SharedRun const& run, LargeArray<Id>&& ids, AllValues&& values,
                  NameBirths name_births = {})
      : Base(std::move(domain), model, run, std::move(ids), std::move(values), std::move(name_births)) {
    plan_rounds();
    begin_step();
  }

  /// Takes one step. Returns false if a turn of the last step has failed: then that step does not count.
  bool take_step() {
    if (has_turns_ && !complete_step()) return false;
    take_turns();
    return true;
  }

  /// Completes the last step if it counts, and moves the agents of this process into empty arrays, as ModelShare does.
  void take_agents(bool does_step_count, LargeArray<Id>& ids, AllValues& values) {
    Base::take_own_agents(does_step_count, ids, values, [this] { complete_step(); });
  }

 private:
  using Base::commands_;
  using Base::counters_;
  using Base::cutoff_;
  using Base::domain_;
  using Base::failure_;
  using Base::has_turns_;
  using Base::ids_;
  using Base::migration_;
  using Base::model_;
  using Base::order_;
  using Base::population_;
  using Base::processes_;
  using Base::thread_pool_;
  using Base::world_;

  friend class LentCells<TiledModelShare>;

  /// A cell and the number of its agents, in a message.
  struct CellHead {
    std::int32_t cell;
    std::uint32_t agents;
  };
  /// Tiles of one process whose late agents take their turns one after the other, with none of another process in
  /// between.
  struct LateTiles {
    std::size_t process;
    std::vector<std::uint32_t> tiles;
  };

  [[nodiscard]] CellLayout const& cells() const { return domain_.cells(); }

  /// Plans the rounds of all steps until the cells change.
  void plan_rounds() {
    Tiling const tiling(cells());
    Tiling::Rectangle const& own = domain_.own_tiles();
    rounds_ = tiling.rounds(own, thread_pool_.size());
    own_tiles_.clear();
    own.for_each_tile(
        [&](std::size_t column, std::size_t row) { own_tiles_.push_back(tiling.number_of(column, row)); });
    halo_ = Halo(domain_, 1);
    for (std::size_t k = 0; k < Tiling::colours; ++k) halo_.plan(k, rounds_[k], cells(), tiling);
  }

  /// Sorts the agents into the order that they have in a run of one process.
  void begin_step() {
    order_.sort_window(world_.agents, ids_, cells(), domain_.window_in(cells()), StoredCells::Which::all);
    AllValues const& values = world_.agents.values();
    margin_ = 0;
    grid_ = PackedGrid(cells(), domain_.window_in(cells()), values.size());
    for (std::uint32_t row = 0; row < values.size(); ++row) grid_.insert(row, Base::place(values, row));
    free_rows_.clear();
  }

  /// Takes all turns of a step. Afterwards order_.next() has the new values, and the world the values before the step.
  void take_turns() {
    has_turns_ = true;
    turns_.begin_step(cells(), world_.agents.size());
    std::size_t parts = 1;
    for (Tiling::Round const& round : rounds_) parts = std::max(parts, round.size());
    commands_.resize(parts);
    for (std::size_t round = 0; round < Tiling::colours; ++round) {
      take_round(rounds_[round]);
      for (Halo::Neighbour const& neighbour : halo_.neighbours()) {
        MessageWriter message;
        add_cells(message, neighbour.changed[round].all());
        processes_.send(neighbour.process, message.take());
      }
      for (Halo::Neighbour const& neighbour : halo_.neighbours()) {
        Message const bytes = processes_.receive(neighbour.process);
        MessageReader message(bytes);
        take_cells(message);
      }
    }
    if constexpr (has_late_turns<Model>()) take_late_turns();
    end_turns();
  }

  void take_round(Tiling::Round const& round) {
    thread_pool_.for_each(round.size(), [&](std::size_t part) {
      for (std::uint32_t const tile : round[part]) turns_.take_tile(model_, neighbourhood(commands_[part]), tile);
    });
    std::uint64_t turns = 0;
    for (Tiling::Part const& part : round) {
      for (std::uint32_t const tile : part) turns += turns_.result_of(tile).turns;
    }
    processes_.note_turns(turns);
  }

  Neighbourhood<Model> neighbourhood(DeferredCommands<Model>& commands) {
    Neighbourhood<Model> around = Base::neighbourhood(commands);
    around.grid = &grid_;
    return around;
  }

  void end_turns() {
    note_failure();
    if constexpr (keeps_counters<Model>()) {
      CountersOfStep& of_step = counters_.emplace_back();
      for (std::uint32_t const tile : own_tiles_) of_step.add(turns_.result_of(tile).counters);
    }
    own_rows_.clear();
    CellWindow const own = domain_.own_window(0);
    for (int row = own.first_row; row < own.end_row; ++row) {
      for (int column = own.first_column; column < own.end_column; ++column) {
        add_rows_in(row * cells().columns() + column, own_rows_);
      }
    }
    world_.agents.become(ids_, order_.next());
  }

  void note_failure() {
    if (!turns_.has_failed()) return;
    try {
      std::rethrow_exception(turns_.failure());
    } catch (std::exception const& error) {
      failure_ = FailedTurn{.cell = turns_.failed_tile(), .agent = 0, .reason = error.what()};
    }
  }

  [[nodiscard]] Vector place_of(std::uint32_t row) const { return Base::place(world_.agents.values(), row); }
  /// Returns the rows of a cell in the order in which they are visited; empty if the cell is not stored.
  [[nodiscard]] Rows rows_in(int cell) const {
    Rows rows;
    add_rows_in(cell, rows);
    return rows;
  }
  void add_rows_in(int cell, Rows& rows) const {
    grid_.for_each_in_cell(cell, [&](std::size_t row) { rows.push_back(static_cast<std::uint32_t>(row)); });
  }

  void add_cells(MessageWriter& message, std::span<int const> some) const {
    std::vector<CellHead> heads;
    Rows rows;
    for (int const cell : some) {
      std::size_t const before = rows.size();
      add_rows_in(cell, rows);
      heads.push_back({.cell = cell, .agents = static_cast<std::uint32_t>(rows.size() - before)});
    }
    message.add(std::uint64_t{heads.size()});
    message.add(std::uint64_t{rows.size()});
    message.add_all(std::span<CellHead const>(heads));
    message.add_chosen(turns_.has_turned().data(), rows);
    add_agents(message, world_.agents.ids().data(), world_.agents.values(), rows);
  }

  /// Replaces the agents of the cells of a message by those of the message.
  void take_cells(MessageReader& message) {
    auto const count = message.next<std::uint64_t>();
    auto const agents = message.next<std::uint64_t>();
    std::vector<CellHead> const heads = message.next_values<CellHead>(count);
    std::vector<std::uint8_t> const has_turned = message.next_values<std::uint8_t>(agents);
    LargeArray<Id> ids;
    AllValues values;
    append_agents(message, agents, ids, values);
    std::size_t next = 0;
    for (CellHead const& head : heads) {
      Rows const rows = rows_for(head.cell, std::span<Id const>(ids).subspan(next, head.agents));
      for (std::uint32_t const row : rows) {
        world_.agents.put_into_part(row, ids[next], values, next);
        turns_.set_turned(row, has_turned[next]);
        ++next;
      }
      grid_.insert_in_order(rows, [this](std::uint32_t row) { return place_of(row); });
    }
  }

  /// Empties a cell, and returns a row for each of `ids`. Agents that were in the cell before keep their rows, which
  /// lists of late agents may hold.
  [[nodiscard]] Rows rows_for(int cell, std::span<Id const> ids) {
    std::vector<std::pair<Id, std::uint32_t>> old;
    for (std::uint32_t const row : rows_in(cell)) {
      old.emplace_back(world_.agents.ids()[row], row);
      grid_.erase(row);
    }
    std::ranges::sort(old);
    std::vector<bool> stays(old.size(), false);
    constexpr auto none = static_cast<std::uint32_t>(-1);
    Rows rows;
    for (Id const id : ids) {
      auto const same = std::ranges::lower_bound(old, id, {}, [](auto const& agent) { return agent.first; });
      bool const was_here = same != old.end() && same->first == id;
      rows.push_back(was_here ? same->second : none);
      if (was_here) stays[static_cast<std::size_t>(same - old.begin())] = true;
    }
    for (std::size_t k = 0; k < old.size(); ++k) {
      if (!stays[k]) free_rows_.push_back(old[k].second);
    }
    auto next_new = static_cast<std::uint32_t>(world_.agents.size());
    for (std::uint32_t& row : rows) {
      if (row != none) continue;
      if (free_rows_.empty()) {
        row = next_new++;
      } else {
        row = free_rows_.back();
        free_rows_.pop_back();
      }
    }
    return rows;
  }

  void take_late_turns() {
    bool is_first = true;
    for (LateTiles const& late : late_tiles_of_all()) {
      bool const have_failed =
          late.process == processes_.rank() ? take_late_turns_of(late.tiles, is_first) : lent().lend_to(late.process);
      if (have_failed) return;
      is_first = false;
    }
  }

  /// Returns the tiles with late agents of all processes, in the order of their numbers; empty if a turn has failed.
  [[nodiscard]] std::vector<LateTiles> late_tiles_of_all() const {
    MessageWriter own;
    own.add(turns_.has_failed() ? std::uint64_t{1} : 0);
    for (std::uint32_t const tile : own_tiles_) {
      if (!turns_.result_of(tile).late.empty()) own.add(tile);
    }
    std::vector<std::pair<std::uint32_t, std::size_t>> all;  // tiles and their processes
    bool have_failed = false;
    std::vector<Message> const of_all = all_gather(processes_, own.take());
    for (std::size_t process = 0; process < of_all.size(); ++process) {
      MessageReader message(of_all[process]);
      have_failed = have_failed || message.next<std::uint64_t>() != 0;
      for (std::uint32_t const tile : message.rest<std::uint32_t>()) all.emplace_back(tile, process);
    }
    if (have_failed) return {};
    std::ranges::sort(all);
    std::vector<LateTiles> late;
    for (auto const& [tile, process] : all) {
      if (late.empty() || late.back().process != process) late.push_back({.process = process, .tiles = {}});
      late.back().tiles.push_back(tile);
    }
    return late;
  }

  /// Takes the turns of late agents in these tiles, while other processes lend cells. Returns whether a turn has
  /// failed.
  bool take_late_turns_of(std::span<std::uint32_t const> tiles, bool are_first) {
    std::vector<int> borrowed;  // cells, sorted
    std::function<void(Vector, int, int)> const get_cells = [&](Vector p, int columns, int rows) {
      borrow(p, columns, rows, are_first, borrowed);
    };
    Neighbourhood<Model> around = neighbourhood(commands_.front());
    around.get_cells = &get_cells;
    std::uint64_t turns = 0;
    for (std::size_t k = 0; k < tiles.size() && !turns_.has_failed(); ++k) {
      std::uint64_t const before = turns_.result_of(tiles[k]).turns;
      turns_.take_late(model_, around, tiles[k]);
      turns += turns_.result_of(tiles[k]).turns - before;
    }
    processes_.note_turns(turns);
    lent().give_back(borrowed, turns_.has_failed());
    return turns_.has_failed();
  }

  /// Fetches the cells around a point that other processes own, unless they are borrowed already. `has_ring`: the ring
  /// around the own tiles is up to date, since no late turn came before.
  void borrow(Vector p, int columns, int rows, bool has_ring, std::vector<int>& borrowed) {
    std::vector<int> asked;
    std::vector<int> missing;
    CellWindow const seen = domain_.own_window(1);
    cells().for_each_cell_in_block(cells().cell_of(p), columns, rows, [&](int cell) {
      if (is_own(cell) || std::ranges::binary_search(borrowed, cell)) return;
      missing.push_back(cell);
      if (!has_ring || !contains(seen, cell)) asked.push_back(cell);
    });
    if (missing.empty()) return;
    std::ranges::copy(missing, std::back_inserter(borrowed));
    std::ranges::sort(borrowed);
    for (int const cell : missing) make_room_for(cell);
    lent().borrow(asked);
  }

  [[nodiscard]] LentCells<TiledModelShare> lent() { return {domain_, *this}; }
  [[nodiscard]] bool is_own(int cell) const { return domain_.owner_of_cell(cell) == processes_.rank(); }
  [[nodiscard]] bool contains(CellWindow const& window, int cell) const {
    int const row = cell / cells().columns();
    int const column = cell - row * cells().columns();
    return overlap(cells(), window,
                   {.first_column = column, .end_column = column + 1, .first_row = row, .end_row = row + 1});
  }

  /// Widens the window of stored cells until it contains `cell`.
  void make_room_for(int cell) {
    int const row = cell / cells().columns();
    if (grid_.stores(cell - row * cells().columns(), row)) return;
    margin_ = std::max(4, 2 * margin_);
    while (!contains(domain_.own_window(margin_), cell)) margin_ *= 2;
    CellWindow const window = domain_.own_window(margin_);
    PackedGrid wider(cells(), window, world_.agents.size());
    for (int const stored : common_cells(cells(), window, window)) {
      wider.insert_in_order(rows_in(stored), [this](std::uint32_t agent) { return place_of(agent); });
    }
    grid_ = std::move(wider);
  }

  /// Applies the births and deaths of the last turns, in all processes. Returns false if a turn of any process has
  /// failed.
  bool complete_step() {
    std::size_t const agents = ids_.size();
    auto const follow_cells = [&](IdSet const& dead) {
      CellLayout const next = next_cells();
      if (next == cells()) return false;
      divide_anew(next, dead, agents);
      return true;
    };
    if (!this->let_turns_take_effect(
            agents, [&] { find_movers(agents); }, follow_cells))
      return false;
    begin_step();
    return true;
  }

  /// Finds the rows to be dropped, and the rows to be sent to each process. Rows from `agents` on are newborns.
  void find_movers(std::size_t agents) {
    migration_.begin();
    std::vector<bool> is_own(agents, false);
    for (std::uint32_t const row : own_rows_) is_own[row] = true;
    for (std::uint32_t row = 0; row < agents; ++row) {
      if (!is_own[row]) migration_.drop(row);
    }
    for (std::uint32_t const row : own_rows_) this->address(row);
    for (auto row = static_cast<std::uint32_t>(agents); row < ids_.size(); ++row) this->address(row);
  }

  /// Returns the cells of the next step: those that the model fixes, or else cells for the number of all agents.
  [[nodiscard]] CellLayout next_cells() const {
    if constexpr (requires { model_.cells(AgentSums<Model>(world_)); }) {
      return cells();
    } else {
      return cells_of_step(world_.box, cutoff_, population_).layout;
    }
  }

  /// Divides the tiles among the processes by the number of agents in each tile; the result is the same in all
  /// processes.
  void divide_anew(CellLayout const& layout, IdSet const& dead, std::size_t agents) {
    domain_ = Domain::of_tiles(processes_, layout, [&](auto visit) {
      for (std::uint32_t const row : own_rows_) {
        if (!dead.contains(ids_[row])) visit(Base::place(order_.next(), row));
      }
      for (std::size_t row = agents; row < ids_.size(); ++row) visit(Base::place(order_.next(), row));
    });
    plan_rounds();
  }

  Halo halo_;
  std::vector<std::uint32_t> own_tiles_;
  std::vector<Tiling::Round> rounds_;
  TurnsInTiles<Model> turns_;
  PackedGrid grid_;
  int margin_ = 0;  ///< width of the stored cells around the own tiles, if late agents needed more than the ring
  Rows free_rows_;  ///< rows without an agent
  Rows own_rows_;   ///< after the turns: the rows of the agents in the own tiles
};

}  // namespace gridlock
