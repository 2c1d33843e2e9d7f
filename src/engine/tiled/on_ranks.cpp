#include "engine/tiled/on_ranks.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include "engine/stepped.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock::tiled {

namespace {

/// What a rank must know of a run besides its disks.
struct Order {
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

/// Disks in one message, so that the memory of messages does not grow with the system.
constexpr std::size_t disks_of_message = 1 << 15;
/// Numbers that the leader keeps before it adds them up.
constexpr std::size_t most_sums = std::size_t{1} << 22;
/// What another rank says of some steps, before its sums.
struct AnswerHead {
  std::uint64_t is_stop_asked;
  Counters whole_numbers;
};

/// Disks for one rank, in messages of bounded length; an empty one is the last.
class DiskSender {
 public:
  DiskSender(Ranks& ranks, std::size_t to) : ranks_(ranks), to_(to) {}

  void add(DiskInTurn const& disk) {
    waiting_.push_back(disk);
    if (waiting_.size() == disks_of_message) flush();
  }
  void end() {
    if (!waiting_.empty()) flush();
    flush();
  }

 private:
  void flush() {
    MessageWriter message;
    message.add_all(std::span<DiskInTurn const>(waiting_));
    ranks_.send(to_, message.take());
    waiting_.clear();
  }

  Ranks& ranks_;
  std::size_t to_;
  std::vector<DiskInTurn> waiting_;
};

template <class Visit>
void receive_disks(Ranks& ranks, std::size_t from, Visit visit) {
  while (true) {
    Ranks::Bytes const bytes = ranks.receive(from);
    std::vector<DiskInTurn> const disks = MessageReader(bytes).rest<DiskInTurn>();
    if (disks.empty()) return;
    for (DiskInTurn const& disk : disks) visit(disk);
  }
}

/// For each column or row of cells the one of tiles that it is in, by where those end.
template <class EndOf>
std::vector<std::size_t> tiles_of_cells(std::size_t tiles, EndOf end_of) {
  std::vector<std::size_t> tile_of_cell;
  for (std::size_t k = 0; k < tiles; ++k) tile_of_cell.resize(static_cast<std::size_t>(end_of(k)), k);
  return tile_of_cell;
}

/// The tile of a point.
class TileFinder {
 public:
  TileFinder(CellLayout const& layout, Tiling const& tiling)
      : layout_(layout),
        tiling_(tiling),
        column_of_(tiles_of_cells(tiling.columns(),
                                  [&](std::size_t k) { return tiling.tiles()[tiling.number_of(k, 0)].end_column; })),
        row_of_(tiles_of_cells(tiling.rows(),
                               [&](std::size_t k) { return tiling.tiles()[tiling.number_of(0, k)].end_row; })) {}

  [[nodiscard]] std::uint32_t tile_of(Vector p) const {
    return tiling_.number_of(column_of_[static_cast<std::size_t>(layout_.column_of(p.x))],
                             row_of_[static_cast<std::size_t>(layout_.row_of(p.y))]);
  }

 private:
  CellLayout const& layout_;
  Tiling const& tiling_;
  std::vector<std::size_t> column_of_;
  std::vector<std::size_t> row_of_;
};

/// The leader's side of one advance().
class Leading {
 public:
  Leading(Ranks& ranks, Order const& order, State& state, Counters& counters)
      : ranks_(ranks), order_(order), layout_(order.layout()), tiling_(layout_), state_(state), counters_(counters) {
    hand_out();
  }

  /// All ranks are back from their steps when it returns, whatever the stop condition has thrown.
  void run(StopCondition const& stop_condition) {
    StepsBetweenLooks looks(ranks_);
    while (!is_reached(stop_condition)) {
      looks.begin();
      std::uint64_t const done = take_steps(steps_until(stop_condition, looks.steps()));
      if (share_->jump()) break;
      try {
        if (stop_condition.stops_here()) break;
      } catch (...) {
        failure_ = std::current_exception();
        break;
      }
      looks.end(done);
    }
    send_to_others(ranks_, message_of(std::uint64_t{0}));
    gather_disks();
  }

  /// Throws what the stop condition has thrown, or RunFailure for a disk that could have jumped over another.
  void require_good_end() const {
    if (failure_) std::rethrow_exception(failure_);
    if (auto const& jump = share_->jump()) throw_long_substep(state_, jump->row_in_state, jump->displacement);
  }

 private:
  [[nodiscard]] bool is_reached(StopCondition const& stop) const {
    return stop.is_reached(state_.clock, counters_.pair_collisions);
  }

  void hand_out() {
    Disks const& disks = state_.agents;
    TileFinder const finder(layout_, tiling_);
    std::vector<std::uint64_t> disks_of_tile(tiling_.tiles().size(), 0);
    for (std::size_t i = 0; i < disks.size(); ++i) ++disks_of_tile[finder.tile_of(position(disks, i))];
    std::vector<Tiling::Rectangle> const division = divide(tiling_, disks_of_tile, ranks_.count());
    MessageWriter message;
    message.add(TaskOfRanks::steps_of_disks);
    message.add(order_);
    message.add_all(std::span<Tiling::Rectangle const>(division));
    send_to_others(ranks_, message.take());
    find_places(division);

    std::vector<DiskSender> senders;
    for (std::size_t rank = 0; rank < ranks_.count(); ++rank) senders.emplace_back(ranks_, rank);
    std::uint64_t own_disks = 0;
    division[0].for_each_tile(
        [&](std::size_t column, std::size_t row) { own_disks += disks_of_tile[tiling_.number_of(column, row)]; });
    LargeArray<DiskInTurn> own;
    own.reserve(own_disks);
    std::vector<std::uint32_t> const id_index = id_indices(disks);
    for (std::uint32_t row = 0; row < disks.size(); ++row) {
      DiskInTurn const disk = disk_in_turn(disks, row, id_index);
      std::uint32_t const rank = places_[finder.tile_of(disk.position)].rank;
      if (rank == 0) {
        own.push_back(disk);
      } else {
        senders[rank].add(disk);
      }
    }
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) senders[rank].end();
    share_.emplace(ranks_, order_.rule(), layout_, division, order_.threads, std::move(own));
  }

  /// Where the sums of each tile are, in the order of tiles.
  void find_places(std::vector<Tiling::Rectangle> const& division) {
    places_.resize(tiling_.tiles().size());
    for (std::uint32_t rank = 0; rank < division.size(); ++rank) {
      division[rank].for_each_tile(
          [&](std::size_t column, std::size_t row) { places_[tiling_.number_of(column, row)].rank = rank; });
    }
    tiles_of_rank_.assign(ranks_.count(), 0);
    for (auto& [rank, place] : places_) place = static_cast<std::uint32_t>(tiles_of_rank_[rank]++);
  }

  /// How many steps may be taken before a look at the stop condition.
  [[nodiscard]] std::uint64_t steps_until(StopCondition const& stop, std::uint64_t most) const {
    // Who waits for collisions stops at the first step that has enough.
    if (stop.pair_collisions != StopCondition().pair_collisions) return 1;
    std::size_t const numbers_of_step = places_.size() * (layout_.is_periodic() ? 1 : 5);
    most = std::clamp<std::uint64_t>(most, 1, most_sums / numbers_of_step + 1);
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
    send_to_others(ranks_, message_of(steps));
    std::uint64_t done = 0;
    while (done < steps && !share_->jump()) {
      share_->take_step();
      ++done;
    }
    add_sums(done);
    // A step in which a disk could have jumped over another does not count.
    std::uint64_t const whole = done - (share_->jump() ? 1 : 0);
    for (std::uint64_t n = 0; n < whole; ++n) {
      ++state_.clock.step;
      state_.clock.time += order_.duration;
    }
    return done;
  }

  void add_sums(std::uint64_t steps) {
    std::vector<ShareSums> of_ranks{share_->take_sums()};
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
      Ranks::Bytes const bytes = ranks_.receive(rank);
      MessageReader message(bytes);
      auto const head = message.next<AnswerHead>();
      if (head.is_stop_asked != 0) ranks_.ask_to_stop();
      ShareSums sums{.whole_numbers = head.whole_numbers, .pair_virial = {}, .wall_impulses = {}};
      sums.pair_virial.resize(steps * tiles_of_rank_[rank]);
      message.read_into(std::span(sums.pair_virial));
      sums.wall_impulses = message.rest<double>();
      of_ranks.push_back(std::move(sums));
    }
    for (ShareSums& sums : of_ranks) {
      sums.whole_numbers.pair_virial = 0.0;
      sums.whole_numbers.wall_impulse = {};
      add(counters_, sums.whole_numbers);
    }
    // One after the other and in the order of one process: sums of floating point numbers depend on it.
    for (std::uint64_t n = 0; n < steps; ++n) {
      for (auto const& [rank, place] : places_) {
        ShareSums const& sums = of_ranks[rank];
        std::size_t const at = n * tiles_of_rank_[rank] + place;
        counters_.pair_virial += sums.pair_virial[at];
        if (sums.wall_impulses.empty()) continue;
        for (std::size_t wall = 0; wall < 4; ++wall) counters_.wall_impulse[wall] += sums.wall_impulses[4 * at + wall];
      }
    }
  }

  void gather_disks() {
    for (DiskInTurn const& disk : share_->own_disks()) write_back(disk, state_.agents);
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
      receive_disks(ranks_, rank, [&](DiskInTurn const& disk) { write_back(disk, state_.agents); });
      Ranks::Bytes const bytes = ranks_.receive(rank);
      ranks_.note_traffic(rank, MessageReader(bytes).next<Traffic>());
    }
    ranks_.note_traffic(0, ranks_.traffic());
  }

  struct Place {
    std::uint32_t rank;
    std::uint32_t place;  ///< among the tiles of the rank
  };

  Ranks& ranks_;
  Order order_;
  CellLayout layout_;
  Tiling tiling_;
  State& state_;
  Counters& counters_;
  std::optional<Share> share_;
  std::exception_ptr failure_;  ///< of the stop condition
  std::vector<Place> places_;
  std::vector<std::size_t> tiles_of_rank_;
};

}  // namespace

void advance_on_ranks(Ranks& ranks, TurnRule const& rule, CellLayout const& layout, std::uint64_t threads, State& state,
                      Counters& counters, StopCondition const& stop_condition) {
  if (stop_condition.is_reached(state.clock, counters.pair_collisions)) return;
  Order const order{.width = rule.box.width(),
                    .height = rule.box.height(),
                    .is_periodic = rule.box.is_periodic() ? std::uint64_t{1} : 0,
                    .duration = rule.duration,
                    .substeps = rule.substeps,
                    .contact = static_cast<std::uint64_t>(rule.contact),
                    .radii = rule.radii,
                    .columns = static_cast<std::uint64_t>(layout.columns()),
                    .rows = static_cast<std::uint64_t>(layout.rows()),
                    .threads = threads};
  std::optional<Leading> leading;
  do_or_abandon(ranks, [&] { leading.emplace(ranks, order, state, counters).run(stop_condition); });
  leading->require_good_end();
}

void take_part(Ranks& ranks, MessageReader& message) {
  auto const order = message.next<Order>();
  std::vector<Tiling::Rectangle> const division = message.rest<Tiling::Rectangle>();
  LargeArray<DiskInTurn> own;
  receive_disks(ranks, 0, [&](DiskInTurn const& disk) { own.push_back(disk); });
  Share share(ranks, order.rule(), order.layout(), division, order.threads, std::move(own));
  while (true) {
    Ranks::Bytes const bytes = ranks.receive(0);
    auto const steps = MessageReader(bytes).next<std::uint64_t>();
    if (steps == 0) break;
    for (std::uint64_t n = 0; n < steps && !share.jump(); ++n) share.take_step();
    ShareSums const sums = share.take_sums();
    MessageWriter answer;
    answer.add(
        AnswerHead{.is_stop_asked = ranks.is_stop_asked() ? std::uint64_t{1} : 0, .whole_numbers = sums.whole_numbers});
    answer.add_all(std::span<double const>(sums.pair_virial));
    answer.add_all(std::span<double const>(sums.wall_impulses));
    ranks.send(0, answer.take());
  }
  DiskSender sender(ranks, 0);
  for (DiskInTurn const& disk : share.own_disks()) sender.add(disk);
  sender.end();
  ranks.send(0, message_of(ranks.traffic()));
}

}  // namespace gridlock::tiled
