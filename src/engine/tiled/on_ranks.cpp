#include "engine/tiled/on_ranks.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/hot_disks.hpp"
#include "engine/stepped.hpp"
#include "engine/tiled/share.hpp"
#include "grid/validate_rows.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/packed_layout.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/frame_of_all.hpp"
#include "gridlock/parallel/detail/steps_together.hpp"
#include "parallel/disks_of_all.hpp"
#include "parallel/exchange.hpp"

namespace gridlock {

namespace tiled {

namespace {

/// Each rank sends its disks to where they belong.
template <class DiskOf, class RankOf, class Take>
void exchange_disks(Communicator& ranks, std::size_t count, DiskOf disk_of, RankOf rank_of, Take take) {
  exchange_values<DiskInTurn>(
      ranks, count,
      [&](std::size_t k, auto give) {
        DiskInTurn const disk = disk_of(k);
        give(rank_of(disk), disk);
      },
      take);
}

/// The disks of one rank, from when they leave the rows of all ranks until they are back.
class PartOfRank {
 public:
  /// Hands the disks out. Their values in the state may go then.
  PartOfRank(Communicator& ranks, TurnRule const& rule, CellLayout const& layout, RowDivision const& rows,
             State const& own)
      : ranks_(ranks), rule_(rule), layout_(layout), tiling_(layout), rows_(rows), own_(own) {
    hand_out();
  }
  /// Makes the share.
  void begin(std::uint64_t threads) {
    share_.emplace(ranks_, rule_, layout_, division_, threads, std::move(in_tiles_));
  }

  [[nodiscard]] Share& share() { return *share_; }

  /// The disks go back to the rows that they have come from.
  void bring_home(State& own) {
    LargeArray<DiskInTurn> const disks = share_->take_own_disks();
    Disks::AllValues values;
    values.resize(own.agents.size());
    exchange_disks(
        ranks_, disks.size(), [&](std::size_t k) { return disks[k]; },
        [&](DiskInTurn const& disk) { return rows_.rank_of(disk.row_in_state); },
        [&](DiskInTurn const& disk) {
          values.put(disk.row_in_state - first_row(),
                     {disk.position.x, disk.position.y, disk.velocity.x, disk.velocity.y, disk.radius, disk.mass,
                      disk.image_x, disk.image_y});
        });
    own.agents.give_values(std::move(values));
  }

  /// The disk that could have jumped over another; after bring_home().
  [[nodiscard]] std::optional<LongSubstep> long_substep() {
    std::optional<Jump> const& jump = share_->jump();
    if (!jump) return std::nullopt;
    bool const is_own = rows_.rank_of(jump->row_in_state) == ranks_.rank();
    double const radius = is_own ? own_.agents.column<Radius>()[jump->row_in_state - first_row()] : 0.0;
    return LongSubstep{.id = ids_of(std::array{jump->row_in_state})[0],
                       .displacement = jump->displacement,
                       .contact = all_max(ranks_, radius) + rule_.radii.smallest};
  }

  /// The Ids of rows, whoever has them.
  [[nodiscard]] std::vector<Id> ids_of(std::span<std::uint32_t const> rows) const {
    std::vector<Id> ids;
    for (std::uint32_t const row : rows) {
      ids.push_back(rows_.rank_of(row) == ranks_.rank() ? own_.agents.ids()[row - first_row()] : 0);
    }
    all_sum(ranks_, ids);
    return ids;
  }

 private:
  [[nodiscard]] std::uint32_t first_row() const { return static_cast<std::uint32_t>(rows_.first(ranks_.rank())); }

  void hand_out() {
    Disks const& disks = own_.agents;
    TileFinder const finder(layout_, tiling_);
    std::uint64_t const disks_of_tiles = divide(finder);
    std::vector<std::uint32_t> rank_of_tile(tiling_.tiles().size());
    for (std::uint32_t rank = 0; rank < division_.size(); ++rank) {
      division_[rank].for_each_tile(
          [&](std::size_t column, std::size_t row) { rank_of_tile[tiling_.number_of(column, row)] = rank; });
    }
    std::vector<std::uint32_t> const id_index = id_indices(disks);
    in_tiles_.reserve(Share::room_for_rim(disks_of_tiles));
    exchange_disks(
        ranks_, disks.size(),
        [&](std::size_t row) {
          DiskInTurn disk = disk_in_turn(disks, static_cast<std::uint32_t>(row), id_index);
          disk.row_in_state += first_row();
          disk.id_index += first_row();
          return disk;
        },
        [&](DiskInTurn const& disk) { return rank_of_tile[finder.tile_of(disk.position)]; },
        [&](DiskInTurn const& disk) { in_tiles_.push_back(disk); });
  }

  /// All learn how many disks each tile has, and which rank has which tiles. Returns the number of disks in those of
  /// this rank.
  std::uint64_t divide(TileFinder const& finder) {
    std::vector<std::uint64_t> disks_of_tile(tiling_.tiles().size(), 0);
    for (std::size_t i = 0; i < own_.agents.size(); ++i) ++disks_of_tile[finder.tile_of(position(own_.agents, i))];
    all_sum(ranks_, disks_of_tile);
    division_ = divide_tiles(tiling_, disks_of_tile, ranks_.count());
    std::uint64_t disks = 0;
    division_[ranks_.rank()].for_each_tile(
        [&](std::size_t column, std::size_t row) { disks += disks_of_tile[tiling_.number_of(column, row)]; });
    return disks;
  }

  Communicator& ranks_;
  TurnRule rule_;
  CellLayout layout_;
  Tiling tiling_;
  RowDivision const& rows_;
  State const& own_;
  std::vector<Tiling::Rectangle> division_;  ///< of the tiles
  LargeArray<DiskInTurn> in_tiles_;          ///< the disks of this rank, until there is a share
  std::optional<Share> share_;
};

/// Takes at most so many steps together with all other ranks.
StepsTaken take_steps(Communicator& ranks, Share& share, std::uint64_t steps, Counters& counters) {
  std::uint64_t done = 0;
  while (done < steps && !share.jump()) {
    share.take_step();
    ++done;
  }
  AnswerOfSteps const all =
      answer_of_all(ranks, {.is_stop_asked = ranks.is_stop_asked(), .failure = {}, .counters = share.take_counters()});
  for (CountersOfStep const& of_step : all.counters) of_step.add_to(counters);
  // A step in which a disk could have jumped over another does not count.
  bool const has_failed = share.jump().has_value();
  return {.whole = done - (has_failed ? 1 : 0), .has_failed = has_failed};
}

/// What is wrong with all disks.
std::vector<Problem> problems_of(Communicator& ranks, PartOfRank& part, double tolerance) {
  auto const sort = [](std::vector<Overlap>& overlaps) {
    std::ranges::sort(overlaps, {}, [](Overlap const& overlap) { return std::pair(overlap.row, overlap.other_row); });
  };
  std::vector<Overlap> own = part.share().find_overlaps(tolerance);
  sort(own);
  std::vector<Overlap> overlaps;
  std::span const first_of_own = std::span<Overlap const>(own).first(std::min(own.size(), max_overlaps_named));
  for (Message const& bytes : all_gather(ranks, message_of_all(first_of_own))) {
    std::ranges::copy(MessageReader(bytes).rest<Overlap>(), std::back_inserter(overlaps));
  }
  sort(overlaps);
  overlaps.resize(std::min(overlaps.size(), max_overlaps_named));
  std::vector<std::uint32_t> rows;
  for (Overlap const& overlap : overlaps) rows.insert(rows.end(), {overlap.row, overlap.other_row});
  std::vector<Id> const ids = part.ids_of(rows);
  std::vector<OverlappingPair> pairs;
  for (std::size_t k = 0; k < overlaps.size(); ++k) pairs.push_back({ids[2 * k], ids[2 * k + 1], overlaps[k].gap});
  return problems_of_overlaps(pairs, all_sum(ranks, own.size()));
}

/// The problems of the rows of all ranks.
RowProblems problems_of_rows(Communicator& ranks, State const& own) {
  MessageWriter message_of_own;
  RowProblems(own).write(message_of_own);
  RowProblems problems;
  for (Message const& bytes : all_gather(ranks, message_of_own.take())) {
    MessageReader message(bytes);
    problems.add(RowProblems(message));
  }
  return problems;
}

TurnRule rule_of(EngineSettings const& settings, Box const& box, DisksOverview const& all) {
  return {.box = box,
          .duration = step_duration(settings, all.radii.smallest),
          .substeps = settings.substeps,
          .contact = settings.contact,
          .radii = all.radii};
}

}  // namespace

}  // namespace tiled

CellLayout tiled_layout(EngineSettings const& settings, Box const& box, DisksOverview const& all) {
  // Room for disks of twice the speed that the time step refers to, whatever the disks do now: the cells must be the
  // same for a run and for its continuation from a file, since the order of the turns depends on them.
  double const displacement_at_speed = settings.time_step * 2.0 * all.radii.smallest;
  return packed_layout(box, all.radii, all.count, 2.0 * displacement_at_speed);
}

TiledOnRanks::TiledOnRanks(EngineSettings const& settings, State const& own)
    : settings_(settings),
      all_(overview_of_all(own.agents, settings.processes)),
      rows_(division_of(settings.processes.communicator(), own.agents.size())),
      duration_(step_duration(settings, all_.radii.smallest)) {
  require_all_valid(own);
}

void TiledOnRanks::require_valid(State const& own) const { RowProblems(own).require_none(own.box); }

bool TiledOnRanks::take_restored(State& own) {
  Communicator& ranks = settings_.processes.communicator();
  rows_ = division_of(ranks, own.agents.size());
  bool const are_sorted = are_in_order(ranks, own.agents.ids());
  agree(ranks, [&] {
    if (are_sorted && rows_.rows() == all_.count) return;
    throw Error(Problem{.what = are_sorted ? "the checkpoint holds another number of disks"
                                           : "the disks of the checkpoint are not in the order of their Ids, which one "
                                             "process can restore alone"});
  });
  require_all_valid(own);
  return false;
}

void TiledOnRanks::require_all_valid(State const& own) const {
  Communicator& ranks = settings_.processes.communicator();
  RowProblems const problems = tiled::problems_of_rows(ranks, own);
  agree(ranks, [&] { require_room_for_turns_of(settings_, own, all_, problems); });
  require_no_overlaps(own);
}

void TiledOnRanks::advance(State& own, Counters& counters, StopCondition const& stop_condition) {
  if (stop_condition.is_reached(own.clock, counters.pair_collisions)) return;
  Communicator& ranks = settings_.processes.communicator();
  std::exception_ptr thrown;
  std::optional<LongSubstep> long_substep;
  do_or_abandon(ranks, [&] {
    tiled::PartOfRank part(ranks, tiled::rule_of(settings_, own.box, all_), tiled_layout(settings_, own.box, all_),
                           rows_, own);
    own.agents.forget_values();
    part.begin(settings_.threads);
    thrown = take_steps_together(ranks, own.clock, duration_, counters, stop_condition, [&](std::uint64_t steps) {
      return tiled::take_steps(ranks, part.share(), steps, counters);
    });
    part.bring_home(own);
    long_substep = part.long_substep();
    note_traffic_of_all(ranks);
  });
  if (thrown) std::rethrow_exception(thrown);
  agree(ranks, [&] {
    if (long_substep) throw_long_substep(own.clock.step, *long_substep);
  });
}

void TiledOnRanks::require_no_overlaps(State const& own) const {
  Communicator& ranks = settings_.processes.communicator();
  std::vector<Problem> problems;
  do_or_abandon(ranks, [&] {
    tiled::PartOfRank part(ranks, tiled::rule_of(settings_, own.box, all_), tiled_layout(settings_, own.box, all_),
                           rows_, own);
    part.begin(settings_.threads);
    problems = tiled::problems_of(ranks, part, rounding_of_contact(own.box, all_.radii.smallest));
  });
  agree(ranks, [&] {
    if (!problems.empty()) throw Error(problems);
  });
}

}  // namespace gridlock
