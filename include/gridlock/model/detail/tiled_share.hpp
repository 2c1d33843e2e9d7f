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
#include "gridlock/model/detail/agents_message.hpp"
#include "gridlock/model/detail/share.hpp"
#include "gridlock/model/detail/turns_in_tiles.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

/// The share that one rank has in the steps of a tiled model: the agents of its tiles, and of the ring of cells around
/// them that others own.
///
///     ┌ ─ ─ ─ ─ ─ ─ ─ ┐     A step is four rounds, one for each colour of tiles. In a round the tiles of a rank change their own cells
///       ┌───────────┐       and the ring around them. Then it sends to each neighbour these cells as they are now, as far as that one
///     │ │ its tiles │ │     sees them. No cell is changed by two ranks in one round. The agents of a cell travel in the order in which
///       └───────────┘       they are visited, so that it is that of one process on every rank.
///     └ ─ ─ ─ ring  ─ ┘
///
/// Late agents take their turns one after the other, in the order of one process: the rank whose turn it is asks others
/// for the cells that it comes to, and gives them back.
///
/// Between two steps it is as for ModelShare. All ranks construct it and call take_step() together. The bits are those
/// of one process.
template <class Model>
class TiledModelShare final : public AgentsOfShare<Model> {
  using Base = AgentsOfShare<Model>;
  using typename Base::Rows;
  using typename Base::Told;

 public:
  using typename Base::Agents;
  using typename Base::AllValues;

  /// `division` has the tiles of each rank; `ids` and `values` are those of the agents in the tiles of this rank.
  TiledModelShare(Communicator& ranks, Model const& model, ShareOrder const& order,
                  std::vector<Tiling::Rectangle> division, LargeArray<Id>&& ids, AllValues&& values,
                  NameBirths name_births = {})
      : Base(ranks, model, order, division_of(order, division, ranks.rank()), std::move(ids), std::move(values),
             std::move(name_births)),
        tiles_of_ranks_(std::move(division)) {
    begin_in(order.cells());
    begin_step();
  }

  static RankDivision division_of(ShareOrder const& order, std::span<Tiling::Rectangle const> division,
                                  std::size_t rank) {
    return division_in(order.cells(), division, rank);
  }

  /// False where a turn has failed: then the step does not count.
  bool take_step() {
    if (has_turns_ && !complete_step()) return false;
    take_turns();
    return true;
  }

  /// As ModelShare::take_agents().
  void take_agents(bool does_step_count, LargeArray<Id>& ids, AllValues& values) {
    Base::take_own_agents(does_step_count, ids, values, [this] { complete_step(); });
  }

 private:
  using Base::also_to_;
  using Base::commands_;
  using Base::counters_;
  using Base::cutoff_;
  using Base::division_;
  using Base::dropped_;
  using Base::failure_;
  using Base::has_turns_;
  using Base::ids_;
  using Base::model_;
  using Base::order_;
  using Base::population_;
  using Base::ranks_;
  using Base::rows_to_;
  using Base::thread_pool_;
  using Base::world_;

  /// Another rank that sees some of the same cells.
  struct Border {
    std::size_t rank;
    CellWindow seen;                                        ///< its tiles and the ring around them
    std::array<std::vector<int>, Tiling::colours> changed;  ///< of these, those that a round here may change
  };
  /// Some agents of a cell, in a message.
  struct CellHead {
    std::int32_t cell;
    std::uint32_t agents;
  };
  /// Tiles of one rank whose late agents take their turns without those of other ranks in between.
  struct LateTiles {
    std::size_t rank;
    std::vector<std::uint32_t> tiles;
  };
  /// What a rank whose late agents take their turns asks of others.
  enum class LateMessage : std::uint64_t { send_cells, turns_are_over };

  [[nodiscard]] CellLayout const& cells() const { return division_.cells(); }

  static RankDivision division_in(CellLayout const& cells, std::span<Tiling::Rectangle const> tiles, std::size_t rank) {
    Tiling const tiling(cells);
    std::vector<Tiling::Rectangle> rectangles;
    for (Tiling::Rectangle const& of_rank : tiles) {
      CellWindow const window = window_around(cells, tiling, of_rank, 0);
      rectangles.push_back({.first_column = static_cast<std::size_t>(window.first_column),
                            .end_column = static_cast<std::size_t>(window.end_column),
                            .first_row = static_cast<std::size_t>(window.first_row),
                            .end_row = static_cast<std::size_t>(window.end_row)});
    }
    return {cells, std::move(rectangles), Rim{.columns = 1.0, .rows = 1.0}, rank};
  }

  /// Plans the rounds of all steps in these cells.
  void begin_in(CellLayout const& layout) {
    Tiling const tiling(layout);
    std::size_t const rank = ranks_.rank();
    own_cells_ = window_around(layout, tiling, tiles_of_ranks_[rank], 0);
    seen_ = window_around(layout, tiling, tiles_of_ranks_[rank], 1);
    rounds_ = tiling.rounds(tiles_of_ranks_[rank], thread_pool_.size());
    own_tiles_.clear();
    tiles_of_ranks_[rank].for_each_tile(
        [&](std::size_t column, std::size_t row) { own_tiles_.push_back(tiling.number_of(column, row)); });
    borders_.clear();
    for (std::size_t other = 0; other < ranks_.count(); ++other) {
      CellWindow const seen = window_around(layout, tiling, tiles_of_ranks_[other], 1);
      if (other == rank || !overlap(layout, seen_, seen)) continue;
      Border border{.rank = other, .seen = seen, .changed = {}};
      for (std::size_t k = 0; k < Tiling::colours; ++k) border.changed[k] = changed_in(tiling, rounds_[k], seen);
      borders_.push_back(std::move(border));
    }
  }

  /// What tiles of a round may change in a window.
  [[nodiscard]] std::vector<int> changed_in(Tiling const& tiling, Tiling::Round const& round,
                                            CellWindow const& window) const {
    std::vector<int> changed;
    for (Tiling::Part const& part : round) {
      for (std::uint32_t const tile : part) {
        CellWindow const around = window_around(cells(), tiling.tiles()[tile], 1);
        std::ranges::copy(common_cells(cells(), around, window), std::back_inserter(changed));
      }
    }
    std::ranges::sort(changed);
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    return changed;
  }

  /// Puts the agents into the order that they have in one process.
  void begin_step() {
    order_.sort_window(world_.agents, ids_, cells(), division_.window_of(cells()), StoredCells::Which::all);
    AllValues const& values = world_.agents.values();
    margin_ = 0;
    grid_ = PackedGrid(cells(), division_.window_of(cells()), values.size());
    for (std::uint32_t row = 0; row < values.size(); ++row) grid_.insert(row, Base::place(values, row));
    free_rows_.clear();
  }

  /// After them order_.next() has what the agents are, and the world what they were before.
  void take_turns() {
    has_turns_ = true;
    turns_.begin_step(cells(), world_.agents.size());
    std::size_t parts = 1;
    for (Tiling::Round const& round : rounds_) parts = std::max(parts, round.size());
    commands_.resize(parts);
    for (std::size_t round = 0; round < Tiling::colours; ++round) {
      take_round(rounds_[round]);
      for (Border const& border : borders_) ranks_.send(border.rank, message_of_cells(border.changed[round]));
      for (Border const& border : borders_) take_cells(ranks_.receive(border.rank));
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
    ranks_.note_turns(turns);
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
    for (int row = own_cells_.first_row; row < own_cells_.end_row; ++row) {
      for (int column = own_cells_.first_column; column < own_cells_.end_column; ++column) {
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
  /// The agents of a cell, in the order in which they are visited; none where it is not stored.
  [[nodiscard]] Rows rows_in(int cell) const {
    Rows rows;
    add_rows_in(cell, rows);
    return rows;
  }
  void add_rows_in(int cell, Rows& rows) const {
    grid_.for_each_in_cell(cell, [&](std::size_t row) { rows.push_back(static_cast<std::uint32_t>(row)); });
  }

  // Cells in messages.

  [[nodiscard]] Message message_of_cells(std::span<int const> some) const {
    MessageWriter message;
    add_cells(message, some);
    return message.take();
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

  void take_cells(Message const& bytes) {
    MessageReader message(bytes);
    take_cells(message);
  }

  /// From now on these cells hold what the message says.
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

  /// Empties a cell. Returns rows for the agents that come: who was here keeps its row, which others may know.
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

  // Late agents.

  void take_late_turns() {
    bool is_first = true;
    for (LateTiles const& late : late_tiles_of_all()) {
      bool const have_failed =
          late.rank == ranks_.rank() ? take_late_turns_of(late.tiles, is_first) : follow(late.rank);
      if (have_failed) return;
      is_first = false;
    }
  }

  /// The tiles of all ranks that have late agents, in the order of one process; none where a turn has failed.
  [[nodiscard]] std::vector<LateTiles> late_tiles_of_all() const {
    MessageWriter own;
    own.add(turns_.has_failed() ? std::uint64_t{1} : 0);
    for (std::uint32_t const tile : own_tiles_) {
      if (!turns_.result_of(tile).late.empty()) own.add(tile);
    }
    std::vector<std::pair<std::uint32_t, std::size_t>> all;  // tiles and their ranks
    bool have_failed = false;
    std::vector<Message> const of_ranks = all_gather(ranks_, own.take());
    for (std::size_t rank = 0; rank < of_ranks.size(); ++rank) {
      MessageReader message(of_ranks[rank]);
      have_failed = have_failed || message.next<std::uint64_t>() != 0;
      for (std::uint32_t const tile : message.rest<std::uint32_t>()) all.emplace_back(tile, rank);
    }
    if (have_failed) return {};
    std::ranges::sort(all);
    std::vector<LateTiles> late;
    for (auto const& [tile, rank] : all) {
      if (late.empty() || late.back().rank != rank) late.push_back({.rank = rank, .tiles = {}});
      late.back().tiles.push_back(tile);
    }
    return late;
  }

  /// While others wait: they send cells and get them back. Returns whether a turn has failed.
  bool take_late_turns_of(std::span<std::uint32_t const> tiles, bool are_first) {
    std::vector<int> borrowed;  // sorted
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
    ranks_.note_turns(turns);
    give_back(borrowed);
    return turns_.has_failed();
  }

  /// Gets the cells around a point that others own, as far as they are not here. Before any late turn the ring is.
  void borrow(Vector p, int columns, int rows, bool has_ring, std::vector<int>& borrowed) {
    std::vector<std::vector<int>> asked(ranks_.count());
    std::vector<int> missing;
    cells().for_each_cell_in_block(cells().cell_of(p), columns, rows, [&](int cell) {
      if (is_own(cell) || std::ranges::binary_search(borrowed, cell)) return;
      missing.push_back(cell);
      if (!has_ring || !contains(seen_, cell)) asked[division_.owner_of_cell(cell)].push_back(cell);
    });
    if (missing.empty()) return;
    std::ranges::copy(missing, std::back_inserter(borrowed));
    std::ranges::sort(borrowed);
    for (int const cell : missing) make_room_for(cell);
    for (std::size_t rank = 0; rank < asked.size(); ++rank) {
      if (asked[rank].empty()) continue;
      MessageWriter message;
      message.add(LateMessage::send_cells);
      message.add_all(std::span<int const>(asked[rank]));
      ranks_.send(rank, message.take());
    }
    for (std::size_t rank = 0; rank < asked.size(); ++rank) {
      if (!asked[rank].empty()) take_cells(ranks_.receive(rank));
    }
  }

  void give_back(std::span<int const> borrowed) {
    std::vector<std::vector<int>> of_rank(ranks_.count());
    for (int const cell : borrowed) of_rank[division_.owner_of_cell(cell)].push_back(cell);
    for (std::size_t rank = 0; rank < of_rank.size(); ++rank) {
      if (rank == ranks_.rank()) continue;
      MessageWriter message;
      message.add(LateMessage::turns_are_over);
      message.add(turns_.has_failed() ? std::uint64_t{1} : 0);
      add_cells(message, of_rank[rank]);
      ranks_.send(rank, message.take());
    }
  }

  /// Lends cells to a rank whose late agents take their turns, until they have. Returns whether a turn has failed.
  bool follow(std::size_t rank) {
    while (true) {
      Message const bytes = ranks_.receive(rank);
      MessageReader message(bytes);
      if (message.next<LateMessage>() == LateMessage::send_cells) {
        ranks_.send(rank, message_of_cells(message.rest<int>()));
        continue;
      }
      bool const have_failed = message.next<std::uint64_t>() != 0;
      take_cells(message);
      return have_failed;
    }
  }

  [[nodiscard]] bool is_own(int cell) const { return division_.owner_of_cell(cell) == ranks_.rank(); }
  [[nodiscard]] bool contains(CellWindow const& window, int cell) const {
    int const row = cell / cells().columns();
    int const column = cell - row * cells().columns();
    return overlap(cells(), window,
                   {.first_column = column, .end_column = column + 1, .first_row = row, .end_row = row + 1});
  }

  /// Widens the window of cells that are stored, until it has this one.
  void make_room_for(int cell) {
    int const row = cell / cells().columns();
    if (grid_.stores(cell - row * cells().columns(), row)) return;
    margin_ = std::max(4, 2 * margin_);
    while (!contains(window_with(margin_), cell)) margin_ *= 2;
    CellWindow const window = window_with(margin_);
    PackedGrid wider(cells(), window, world_.agents.size());
    for (int const stored : common_cells(cells(), window, window)) {
      wider.insert_in_order(rows_in(stored), [this](std::uint32_t agent) { return place_of(agent); });
    }
    grid_ = std::move(wider);
  }

  [[nodiscard]] CellWindow window_with(int margin) const {
    return within(cells(), {.first_column = own_cells_.first_column - margin,
                            .end_column = own_cells_.end_column + margin,
                            .first_row = own_cells_.first_row - margin,
                            .end_row = own_cells_.end_row + margin});
  }

  // Between two steps.

  /// Lets what was asked for in the turns take effect, on all ranks. False where a turn of any rank has failed.
  bool complete_step() {
    std::size_t const agents = ids_.size();
    auto const follow_cells = [&](IdSet const& dead, Told& told) {
      CellLayout const next = next_cells();
      if (next == cells()) return;
      divide_anew(next, dead, agents);
      find_movers(agents);
      told.also_from.clear();
      for (std::size_t rank = 0; rank < ranks_.count(); ++rank) told.also_from.push_back(rank);
      also_to_ = told.also_from;
    };
    if (!this->let_turns_take_effect(
            agents, [&] { find_movers(agents); }, follow_cells))
      return false;
    begin_step();
    return true;
  }

  /// Finds out which rows do not stay here, and who has to be told of which. The first `agents` rows are no newborn
  /// ones.
  void find_movers(std::size_t agents) {
    for (Rows& rows : rows_to_) rows.clear();
    dropped_.clear();
    std::vector<bool> is_own(agents, false);
    for (std::uint32_t const row : own_rows_) is_own[row] = true;
    for (std::uint32_t row = 0; row < agents; ++row) {
      if (!is_own[row]) dropped_.push_back(row);
    }
    for (std::uint32_t const row : own_rows_) this->address(row);
    for (auto row = static_cast<std::uint32_t>(agents); row < ids_.size(); ++row) this->address(row);
  }

  /// The cells of the next step, which follow from the number of all agents where the model does not fix them.
  [[nodiscard]] CellLayout next_cells() const {
    if constexpr (requires { model_.cells(AgentSums<Model>(world_)); }) {
      return cells();
    } else {
      return cells_of_step(world_.box, cutoff_, population_).layout;
    }
  }

  /// All ranks learn how many agents each tile has, and divide the tiles alike.
  void divide_anew(CellLayout const& layout, IdSet const& dead, std::size_t agents) {
    Tiling const tiling(layout);
    TileFinder const finder(layout, tiling);
    std::vector<std::uint64_t> agents_of_tile(tiling.tiles().size(), 0);
    auto const count = [&](std::size_t row) { ++agents_of_tile[finder.tile_of(Base::place(order_.next(), row))]; };
    for (std::uint32_t const row : own_rows_) {
      if (!dead.contains(ids_[row])) count(row);
    }
    for (std::size_t row = agents; row < ids_.size(); ++row) count(row);
    all_sum(ranks_, agents_of_tile);
    tiles_of_ranks_ = divide_tiles(tiling, agents_of_tile, ranks_.count());
    division_ = division_in(layout, tiles_of_ranks_, ranks_.rank());
    begin_in(layout);
  }

  std::vector<Tiling::Rectangle> tiles_of_ranks_;
  CellWindow own_cells_;  ///< of its tiles
  CellWindow seen_;       ///< those and the ring around them
  std::vector<std::uint32_t> own_tiles_;
  std::vector<Tiling::Round> rounds_;
  std::vector<Border> borders_;
  TurnsInTiles<Model> turns_;
  PackedGrid grid_;
  int margin_ = 0;  ///< of the cells that are stored, where late agents have come to others
  Rows free_rows_;  ///< that no agent has any more
  Rows own_rows_;   ///< after the turns: of the agents in its tiles
};

}  // namespace gridlock
