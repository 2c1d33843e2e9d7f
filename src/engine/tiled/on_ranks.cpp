#include "engine/tiled/on_ranks.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include "engine/hot_disks.hpp"
#include "engine/stepped.hpp"
#include "engine/tiled/share.hpp"
#include "grid/validate_rows.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/packed_layout.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/exchange.hpp"
#include "gridlock/parallel/detail/tasks.hpp"

namespace gridlock {

namespace tiled {

namespace {

/// What the leader asks for, and what a rank must know of a run besides its disks.
struct Order {
  std::uint64_t is_search;  ///< for overlaps; otherwise steps are taken
  double tolerance;         ///< of overlaps
  double width, height;
  std::uint64_t is_periodic;
  double duration;
  std::uint64_t substeps;
  std::uint64_t contact;
  RadiusRange radii;
  std::uint64_t columns, rows;  ///< of cells
  std::uint64_t threads;

  [[nodiscard]] TurnRule rule() const {
    return {.box = Box(width, height, is_periodic != 0 ? Edge::periodic : Edge::wall),
            .duration = duration,
            .substeps = substeps,
            .contact = static_cast<CollisionRule>(contact),
            .radii = radii};
  }
  [[nodiscard]] CellLayout layout() const { return {rule().box, columns, rows}; }
};

Order order_of(TurnRule const& rule, CellLayout const& layout, std::uint64_t threads) {
  return {.is_search = 0,
          .tolerance = 0.0,
          .width = rule.box.width(),
          .height = rule.box.height(),
          .is_periodic = rule.box.is_periodic() ? std::uint64_t{1} : 0,
          .duration = rule.duration,
          .substeps = rule.substeps,
          .contact = static_cast<std::uint64_t>(rule.contact),
          .radii = rule.radii,
          .columns = static_cast<std::uint64_t>(layout.columns()),
          .rows = static_cast<std::uint64_t>(layout.rows()),
          .threads = threads};
}

/// What ranks say of some steps that they have taken.
struct Answer {
  bool is_stop_asked = false;
  std::vector<CountersOfStep> counters;  ///< of each step

  [[nodiscard]] Message message() const {
    MessageWriter message;
    message.add(is_stop_asked);
    for (CountersOfStep const& of_step : counters) of_step.write(message);
    return message.take();
  }
  static Answer read(Message const& bytes) {
    MessageReader message(bytes);
    Answer answer{.is_stop_asked = message.next<bool>(), .counters = {}};
    while (!message.is_at_end()) answer.counters.push_back(CountersOfStep::read(message));
    return answer;
  }
};

/// This rank and all others say what they have counted in the last steps. All call it; for the leader.
Answer gather_answers(Communicator& ranks, Share& share) {
  Answer const own{.is_stop_asked = ranks.is_stop_asked(), .counters = share.take_counters()};
  Message const all = reduce(ranks, own.message(), [](Message const& left, Message const& right) {
    Answer sum = Answer::read(left);
    Answer const others = Answer::read(right);
    sum.is_stop_asked = sum.is_stop_asked || others.is_stop_asked;
    for (std::size_t k = 0; k < sum.counters.size(); ++k) sum.counters[k].add(others.counters[k]);
    return sum.message();
  });
  return ranks.rank() == 0 ? Answer::read(all) : own;
}

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

/// Adds up counts that two ranks have. An empty message has none.
Message add_counts(Message left, Message right) {
  if (left.empty()) return right;
  if (right.empty()) return left;
  std::vector<std::uint64_t> sums = MessageReader(left).rest<std::uint64_t>();
  MessageReader others(right);
  for (std::uint64_t& sum : sums) sum += others.next<std::uint64_t>();
  return message_of_all(std::span<std::uint64_t const>(sums));
}

/// The part of one rank, from when the disks leave the rows of all ranks until they are back.
class PartOfRank {
 public:
  /// Hands the disks out. Their values in the state may go then.
  PartOfRank(Communicator& ranks, Order const& order, RowDivision const& rows, State const& own)
      : ranks_(ranks), order_(order), rows_(rows), layout_(order.layout()), tiling_(layout_), own_(own) {
    hand_out();
  }
  /// Makes the share.
  void begin() { share_.emplace(ranks_, order_.rule(), layout_, division_, order_.threads, std::move(in_tiles_)); }

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

  /// The disk that could have jumped over another, which one rank has; for the leader.
  [[nodiscard]] std::optional<LongSubstep> long_substep(double smallest_radius) {
    std::optional<Jump> const& jump = share_->jump();
    if (!jump) return std::nullopt;
    std::size_t const rank = rows_.rank_of(jump->row_in_state);
    if (rank == ranks_.rank()) {
      std::size_t const row = jump->row_in_state - first_row();
      LongSubstep const disk{.id = own_.agents.ids()[row],
                             .displacement = jump->displacement,
                             .contact = own_.agents.column<Radius>()[row] + smallest_radius};
      if (rank == 0) return disk;
      ranks_.send(0, message_of(disk));
    } else if (ranks_.rank() == 0) {
      return MessageReader(ranks_.receive(rank)).next<LongSubstep>();
    }
    return std::nullopt;
  }

  /// The Ids of rows, whoever has them; for the leader, who alone knows the rows.
  [[nodiscard]] std::vector<Id> ids_of(std::vector<std::uint32_t> rows) {
    Message const message = message_of_all(std::span<std::uint32_t const>(rows));
    if (ranks_.rank() == 0) {
      send_to_others(ranks_, message);
    } else {
      rows = MessageReader(ranks_.receive(0)).rest<std::uint32_t>();
    }
    std::vector<Id> known;
    for (std::uint32_t const row : rows) {
      if (rows_.rank_of(row) == ranks_.rank()) known.push_back(own_.agents.ids()[row - first_row()]);
    }
    if (ranks_.rank() > 0) {
      ranks_.send(0, message_of_all(std::span<Id const>(known)));
      return {};
    }
    std::vector<std::vector<Id>> of_ranks{std::move(known)};
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
      of_ranks.push_back(MessageReader(ranks_.receive(rank)).rest<Id>());
    }
    std::vector<std::size_t> next(ranks_.count(), 0);
    std::vector<Id> ids;
    for (std::uint32_t const row : rows) {
      std::size_t const rank = rows_.rank_of(row);
      ids.push_back(of_ranks[rank][next[rank]++]);
    }
    return ids;
  }

 private:
  [[nodiscard]] std::uint32_t first_row() const { return static_cast<std::uint32_t>(rows_.first(ranks_.rank())); }

  void hand_out() {
    Disks const& disks = own_.agents;
    TileFinder const finder(layout_, tiling_);
    divide(finder);
    std::vector<std::uint32_t> rank_of_tile(tiling_.tiles().size());
    for (std::uint32_t rank = 0; rank < division_.size(); ++rank) {
      division_[rank].for_each_tile(
          [&](std::size_t column, std::size_t row) { rank_of_tile[tiling_.number_of(column, row)] = rank; });
    }
    std::vector<std::uint32_t> const id_index = id_indices(disks);
    in_tiles_.reserve(Share::room_for_rim(disks_of_tiles_));
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

  /// The leader learns how many disks each tile has, and tells all which rank has which tiles and how many disks.
  void divide(TileFinder const& finder) {
    std::vector<std::uint64_t> const disks_of_tile = disks_of_tiles(finder);
    MessageWriter message;
    if (ranks_.rank() == 0) {
      std::vector<Tiling::Rectangle> const division = divide_tiles(tiling_, disks_of_tile, ranks_.count());
      for (Tiling::Rectangle const& rectangle : division) {
        std::uint64_t disks = 0;
        rectangle.for_each_tile(
            [&](std::size_t column, std::size_t row) { disks += disks_of_tile[tiling_.number_of(column, row)]; });
        message.add(disks);
      }
      message.add_all(std::span<Tiling::Rectangle const>(division));
    }
    Message const bytes = broadcast(ranks_, message.take());
    MessageReader reader(bytes);
    disks_of_tiles_ = reader.next_values<std::uint64_t>(ranks_.count())[ranks_.rank()];
    division_ = reader.rest<Tiling::Rectangle>();
  }

  /// Of all ranks, for the leader.
  [[nodiscard]] std::vector<std::uint64_t> disks_of_tiles(TileFinder const& finder) const {
    std::vector<std::uint64_t> own(tiling_.tiles().size(), 0);
    for (std::size_t i = 0; i < own_.agents.size(); ++i) ++own[finder.tile_of(position(own_.agents, i))];
    bool const has_none = own_.agents.empty();
    Message const all =
        reduce(ranks_, has_none ? Message() : message_of_all(std::span<std::uint64_t const>(own)), add_counts);
    return all.empty() ? own : MessageReader(all).rest<std::uint64_t>();
  }

  Communicator& ranks_;
  Order order_;
  RowDivision const& rows_;
  CellLayout layout_;
  Tiling tiling_;
  State const& own_;
  std::vector<Tiling::Rectangle> division_;  ///< of the tiles
  std::uint64_t disks_of_tiles_ = 0;         ///< of this rank
  LargeArray<DiskInTurn> in_tiles_;          ///< these, until there is a share
  std::optional<Share> share_;
};

/// All others learn what to do.
void send_order(Communicator& ranks, Order const& order, RowDivision const& rows) {
  MessageWriter message;
  message.add(TaskOfRanks::steps_of_disks);
  message.add(order);
  message.add_all(rows.begins());
  send_to_others(ranks, message.take());
}

/// The leader's side of one advance().
class Leading {
 public:
  Leading(Communicator& ranks, Order const& order, RowDivision const& rows, State& own, Counters& counters)
      : ranks_(ranks), order_(order), state_(own), counters_(counters), part_(ranks, order, rows, own) {
    own.agents.forget_values();
    part_.begin();
  }

  /// All ranks are back from their steps when it returns, whatever the stop condition has thrown.
  void run(StopCondition const& stop_condition) {
    StepsBetweenLooks looks(ranks_);
    while (!is_reached(stop_condition)) {
      looks.begin();
      std::uint64_t const done = take_steps(steps_until(stop_condition, looks.steps()));
      if (share().jump()) break;
      try {
        if (stop_condition.stops_here()) break;
      } catch (...) {
        failure_ = std::current_exception();
        break;
      }
      looks.end(done);
    }
    static_cast<void>(broadcast(ranks_, message_of(std::uint64_t{0})));
    part_.bring_home(state_);
    long_substep_ = part_.long_substep(order_.radii.smallest);
    std::vector<Message> const traffic = gather(ranks_, message_of(ranks_.traffic()));
    for (std::size_t rank = 0; rank < traffic.size(); ++rank) {
      ranks_.note_traffic(rank, MessageReader(traffic[rank]).next<Traffic>());
    }
  }

  /// Throws what the stop condition has thrown, or RunFailure for a disk that could have jumped over another.
  void require_good_end() const {
    if (failure_) std::rethrow_exception(failure_);
    if (long_substep_) throw_long_substep(state_.clock.step, *long_substep_);
  }

 private:
  [[nodiscard]] Share& share() { return part_.share(); }
  [[nodiscard]] bool is_reached(StopCondition const& stop) const {
    return stop.is_reached(state_.clock, counters_.pair_collisions);
  }

  /// How many steps may be taken before a look at the stop condition.
  [[nodiscard]] std::uint64_t steps_until(StopCondition const& stop, std::uint64_t most) const {
    // Who waits for collisions stops at the first step that has enough.
    if (stop.pair_collisions != StopCondition().pair_collisions) return 1;
    Clock clock = state_.clock;
    std::uint64_t steps = 0;
    while (steps < most && !stop.is_reached(clock, 0)) {
      ++clock.step;
      clock.time += order_.duration;
      ++steps;
    }
    return steps;
  }

  /// Returns how many steps were taken.
  std::uint64_t take_steps(std::uint64_t steps) {
    static_cast<void>(broadcast(ranks_, message_of(steps)));
    std::uint64_t done = 0;
    while (done < steps && !share().jump()) {
      share().take_step();
      ++done;
    }
    take_answers();
    // A step in which a disk could have jumped over another does not count.
    std::uint64_t const whole = done - (share().jump() ? 1 : 0);
    for (std::uint64_t n = 0; n < whole; ++n) {
      ++state_.clock.step;
      state_.clock.time += order_.duration;
    }
    return done;
  }

  void take_answers() {
    Answer const all = gather_answers(ranks_, share());
    if (all.is_stop_asked) ranks_.ask_to_stop();
    for (CountersOfStep const& of_step : all.counters) of_step.add_to(counters_);
  }

  Communicator& ranks_;
  Order order_;
  State& state_;
  Counters& counters_;
  PartOfRank part_;
  std::exception_ptr failure_;  ///< of the stop condition
  std::optional<LongSubstep> long_substep_;
};

void take_steps(Communicator& ranks, PartOfRank& part, State& own, double smallest_radius) {
  Share& share = part.share();
  while (true) {
    auto const steps = MessageReader(broadcast(ranks, {})).next<std::uint64_t>();
    if (steps == 0) break;
    for (std::uint64_t n = 0; n < steps && !share.jump(); ++n) share.take_step();
    static_cast<void>(gather_answers(ranks, share));
  }
  part.bring_home(own);
  static_cast<void>(part.long_substep(smallest_radius));
  static_cast<void>(gather(ranks, message_of(ranks.traffic())));
}

/// Tells the leader how many overlaps this rank has found, and the first of them.
void tell_of_overlaps(Communicator& ranks, PartOfRank& part, double tolerance) {
  std::vector<Overlap> const overlaps = part.share().find_overlaps(tolerance);
  MessageWriter answer;
  answer.add(std::uint64_t{overlaps.size()});
  answer.add_all(std::span(overlaps).first(std::min(overlaps.size(), max_overlaps_named)));
  ranks.send(0, answer.take());
  static_cast<void>(part.ids_of({}));
}

/// What is wrong with all disks.
std::vector<Problem> gather_overlaps(Communicator& ranks, PartOfRank& part, double tolerance) {
  std::vector<Overlap> overlaps = part.share().find_overlaps(tolerance);
  std::size_t count = overlaps.size();
  for (std::size_t rank = 1; rank < ranks.count(); ++rank) {
    Message const bytes = ranks.receive(rank);
    MessageReader message(bytes);
    count += message.next<std::uint64_t>();
    std::ranges::copy(message.rest<Overlap>(), std::back_inserter(overlaps));
  }
  std::ranges::sort(overlaps, {}, [](Overlap const& overlap) { return std::pair(overlap.row, overlap.other_row); });
  overlaps.resize(std::min(overlaps.size(), max_overlaps_named));
  std::vector<std::uint32_t> rows;
  for (Overlap const& overlap : overlaps) rows.insert(rows.end(), {overlap.row, overlap.other_row});
  std::vector<Id> const ids = part.ids_of(rows);
  std::vector<OverlappingPair> pairs;
  for (std::size_t k = 0; k < overlaps.size(); ++k) pairs.push_back({ids[2 * k], ids[2 * k + 1], overlaps[k].gap});
  return problems_of_overlaps(pairs, count);
}

}  // namespace

void take_part(Communicator& ranks, MessageReader& message, State& own) {
  auto const order = message.next<Order>();
  RowDivision const rows(message.rest<std::uint64_t>());
  PartOfRank part(ranks, order, rows, own);
  if (order.is_search == 0) own.agents.forget_values();
  part.begin();
  if (order.is_search != 0) {
    tell_of_overlaps(ranks, part, order.tolerance);
  } else {
    take_steps(ranks, part, own, order.radii.smallest);
  }
}

}  // namespace tiled

CellLayout tiled_layout(EngineSettings const& settings, Box const& box, DisksOverview const& all) {
  // Room for disks of twice the speed that the time step refers to, whatever the disks do now: the cells must be the
  // same for a run and for its continuation from a file, since the order of the turns depends on them.
  double const displacement_at_speed = settings.time_step * 2.0 * all.radii.smallest;
  return packed_layout(box, all.radii, all.count, 2.0 * displacement_at_speed);
}

TiledOnRanks::TiledOnRanks(EngineSettings const& settings, State const& state)
    : TiledOnRanks(settings, state.box, overview_of(state.agents),
                   RowDivision::of_leader(state.agents.size(), settings.processes.count())) {
  require_room_for_turns(settings, state);
}

TiledOnRanks::TiledOnRanks(EngineSettings const& settings, Box const& box, DisksOverview const& all,
                           RowDivision const& rows)
    : settings_(settings), box_(box), all_(all), rows_(rows), duration_(step_duration(settings, all.radii.smallest)) {}

void TiledOnRanks::require_valid(State const& state) const { require_room_for_turns(settings_, state); }

tiled::TurnRule TiledOnRanks::rule() const {
  return {.box = box_,
          .duration = duration_,
          .substeps = settings_.substeps,
          .contact = settings_.contact,
          .radii = all_.radii};
}

void TiledOnRanks::advance(State& own, Counters& counters, StopCondition const& stop_condition) {
  if (stop_condition.is_reached(own.clock, counters.pair_collisions)) return;
  box_ = own.box;
  tiled::Order const order = tiled::order_of(rule(), tiled_layout(settings_, box_, all_), settings_.threads);
  std::optional<tiled::Leading> leading;
  do_or_abandon(settings_.processes.communicator(), [&] {
    tiled::send_order(settings_.processes.communicator(), order, rows_);
    leading.emplace(settings_.processes.communicator(), order, rows_, own, counters);
    leading->run(stop_condition);
  });
  leading->require_good_end();
}

void TiledOnRanks::require_no_overlaps(State const& own) const {
  Communicator& ranks = settings_.processes.communicator();
  tiled::Order order = tiled::order_of(rule(), tiled_layout(settings_, box_, all_), settings_.threads);
  order.is_search = 1;
  order.tolerance = rounding_of_contact(box_, all_.radii.smallest);
  std::vector<Problem> problems;
  do_or_abandon(ranks, [&] {
    tiled::send_order(ranks, order, rows_);
    tiled::PartOfRank part(ranks, order, rows_, own);
    part.begin();
    problems = tiled::gather_overlaps(ranks, part, order.tolerance);
  });
  if (!problems.empty()) throw Error(std::move(problems));
}

}  // namespace gridlock
