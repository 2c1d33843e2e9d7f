#include "engine/tiled/shared_engine.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <iterator>
#include <limits>
#include <numeric>
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
#include "gridlock/parallel/detail/agent_exchange.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/domain.hpp"
#include "gridlock/parallel/detail/steps_together.hpp"
#include "parallel/disks_of_all.hpp"
#include "parallel/exchange.hpp"

namespace gridlock {

namespace tiled {

namespace {

/// The disks that one process has while it takes steps.
class PartOfProcess {
 public:
  /// Sends each disk, with its entry of `id_indices`, to the process of its tile; the values in the state may be freed
  /// then.
  PartOfProcess(Communicator& processes, TurnRule const& rule, CellLayout const& layout, State const& own,
                std::span<std::uint32_t const> id_indices)
      : processes_(processes),
        rule_(rule),
        rows_(division_of(processes, own.agents.size())),
        own_(own),
        domain_(Domain::of_tiles(processes, layout, [&](auto visit) {
          for (std::size_t i = 0; i < own.agents.size(); ++i) visit(position(own.agents, i));
        })) {
    hand_out(id_indices);
  }
  /// Constructs the share.
  void begin(std::uint64_t threads) {
    share_.emplace(std::move(domain_), rule_, threads, own_.clock.step, std::move(in_tiles_));
  }

  [[nodiscard]] Share& share() { return *share_; }

  /// Gives this process the disks that are in its tiles now, in the order of their Ids.
  void give_back(State& own, LargeArray<std::uint32_t>& id_indices) {
    LargeArray<DiskInTurn> const disks = share_->take_own_disks();
    note_long_substep(disks);
    std::vector<Arrival> const arrivals = arrivals_among(disks);
    LargeArray<std::uint32_t> const places = places_of_rows(disks);
    LargeArray<Id> ids;
    ids.resize(disks.size());
    Disks::AllValues values;
    values.resize(disks.size());
    id_indices.resize(disks.size());
    std::size_t row = 0;
    auto const put = [&](DiskInTurn const& disk, Id id) {
      ids[row] = id;
      id_indices[row] = disk.id_index;
      values.put(row, {disk.position.x, disk.position.y, disk.velocity.x, disk.velocity.y, disk.radius, disk.mass,
                       disk.image_x, disk.image_y});
      ++row;
    };
    auto arrival = arrivals.begin();
    for (std::size_t before = 0; before < places.size(); ++before) {
      if (places[before] == nobody) continue;
      Id const id = own_.agents.ids()[before];
      for (; arrival != arrivals.end() && arrival->id < id; ++arrival) put(disks[arrival->place], arrival->id);
      put(disks[places[before]], id);
    }
    for (; arrival != arrivals.end(); ++arrival) put(disks[arrival->place], arrival->id);
    own.agents.become(ids, values);
  }

  /// The disk that could have jumped over another. Contract: give_back() has been called.
  [[nodiscard]] std::optional<LongSubstep> const& long_substep() const { return long_substep_; }

  /// Returns the Ids of rows of any process.
  [[nodiscard]] std::vector<Id> ids_of(std::span<std::uint32_t const> rows) const {
    return ids_of_rows(processes_, rows_, own_.agents.ids(), rows);
  }

 private:
  static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

  /// A disk that came from another process.
  struct Arrival {
    Id id;
    std::uint32_t place;  ///< index among the disks of this process
  };

  [[nodiscard]] std::uint32_t first_row() const { return static_cast<std::uint32_t>(rows_.first(processes_.rank())); }
  [[nodiscard]] bool is_own(std::uint32_t row) const { return row - first_row() < own_.agents.size(); }

  /// Returns the disks that came from other processes, in the order of their Ids.
  [[nodiscard]] std::vector<Arrival> arrivals_among(LargeArray<DiskInTurn> const& disks) const {
    std::vector<std::uint32_t> rows;
    std::vector<Arrival> arrivals;
    for (std::uint32_t place = 0; place < disks.size(); ++place) {
      if (is_own(disks[place].row_in_state)) continue;
      rows.push_back(disks[place].row_in_state);
      arrivals.push_back({.id = 0, .place = place});
    }
    std::vector<Id> const ids = ids_of(rows);
    for (std::size_t k = 0; k < ids.size(); ++k) arrivals[k].id = ids[k];
    std::ranges::sort(arrivals, {}, &Arrival::id);
    return arrivals;
  }

  /// Returns for each row the index of its disk in `disks`, or `nobody` if another process has the disk now.
  [[nodiscard]] LargeArray<std::uint32_t> places_of_rows(LargeArray<DiskInTurn> const& disks) const {
    LargeArray<std::uint32_t> places(own_.agents.size(), nobody);
    for (std::uint32_t place = 0; place < disks.size(); ++place) {
      std::uint32_t const row = disks[place].row_in_state;
      if (is_own(row)) places[row - first_row()] = place;
    }
    return places;
  }

  void note_long_substep(LargeArray<DiskInTurn> const& disks) {
    std::optional<Jump> const& jump = share_->jump();
    if (!jump) return;
    double radius = 0.0;
    for (DiskInTurn const& disk : disks) {
      if (disk.row_in_state == jump->row_in_state) radius = disk.radius;
    }
    long_substep_ = LongSubstep{.id = ids_of(std::array{jump->row_in_state})[0],
                                .displacement = jump->displacement,
                                .contact = all_max(processes_, radius) + rule_.radii.smallest};
  }

  void hand_out(std::span<std::uint32_t const> id_indices) {
    Disks const& disks = own_.agents;
    in_tiles_.reserve(Share::room_for_rim(domain_.points_of_own_tiles()));
    exchange_values<DiskInTurn>(
        processes_, disks.size(),
        [&](std::size_t row, auto give) {
          DiskInTurn disk = disk_in_turn(disks, static_cast<std::uint32_t>(row), id_indices);
          disk.row_in_state += first_row();
          give(domain_.owner_of(disk.position), disk);
        },
        [&](DiskInTurn const& disk) { in_tiles_.push_back(disk); });
  }

  Communicator& processes_;
  TurnRule rule_;
  RowDivision rows_;  ///< division of the rows among processes before the steps
  State const& own_;
  Domain domain_;                    ///< empty once there is a share
  LargeArray<DiskInTurn> in_tiles_;  ///< the disks of this process until there is a share
  std::optional<Share> share_;
  std::optional<LongSubstep> long_substep_;
};

/// Takes up to `steps` steps together with all other processes.
StepsTaken take_steps(Communicator& processes, Share& share, std::uint64_t steps, Counters& counters) {
  std::uint64_t done = 0;
  while (done < steps && !share.jump()) {
    share.take_step();
    ++done;
  }
  AnswerOfSteps const all = answer_of_all(
      processes, {.is_stop_asked = processes.is_stop_asked(), .failure = {}, .counters = share.take_counters()});
  for (CountersOfStep const& of_step : all.counters) of_step.add_to(counters);
  // A step in which a disk could have jumped over another does not count.
  bool const has_failed = share.jump().has_value();
  return {.whole = done - (has_failed ? 1 : 0), .has_failed = has_failed};
}

/// Returns the problems of the disks of all processes.
std::vector<Problem> problems_of(Communicator& processes, PartOfProcess& part, double tolerance) {
  auto const sort = [](std::vector<Overlap>& overlaps) {
    std::ranges::sort(overlaps, {}, [](Overlap const& overlap) { return std::pair(overlap.row, overlap.other_row); });
  };
  std::vector<Overlap> own = part.share().find_overlaps(tolerance);
  sort(own);
  std::vector<Overlap> overlaps;
  std::span const first_of_own = std::span<Overlap const>(own).first(std::min(own.size(), max_overlaps_named));
  for (Message const& bytes : all_gather(processes, message_of_all(first_of_own))) {
    std::ranges::copy(MessageReader(bytes).rest<Overlap>(), std::back_inserter(overlaps));
  }
  sort(overlaps);
  overlaps.resize(std::min(overlaps.size(), max_overlaps_named));
  std::vector<std::uint32_t> rows;
  for (Overlap const& overlap : overlaps) rows.insert(rows.end(), {overlap.row, overlap.other_row});
  std::vector<Id> const ids = part.ids_of(rows);
  std::vector<OverlappingPair> pairs;
  for (std::size_t k = 0; k < overlaps.size(); ++k) pairs.push_back({ids[2 * k], ids[2 * k + 1], overlaps[k].gap});
  return problems_of_overlaps(pairs, all_sum(processes, own.size()));
}

/// Returns the problems of the rows of all processes.
RowProblems problems_of_rows(Communicator& processes, State const& own) {
  MessageWriter message_of_own;
  RowProblems(own).write(message_of_own);
  RowProblems problems;
  for (Message const& bytes : all_gather(processes, message_of_own.take())) {
    MessageReader message(bytes);
    problems.add(RowProblems(message));
  }
  return problems;
}

TurnRule rule_of(EngineSettings const& settings, State const& own, DisksOverview const& all) {
  double const duration = step_duration(settings, all.radii.smallest);
  return {.box = own.box,
          .duration = duration,
          .substeps = settings.substeps,
          .contact = settings.contact,
          .radii = all.radii,
          .heading = heading_rule(settings.propulsion, duration, own.seed),
          .walls = walls_of(settings.walls, own.box, all.radii.largest)};
}

}  // namespace

}  // namespace tiled

CellLayout tiled_layout(EngineSettings const& settings, Box const& box, DisksOverview const& all) {
  // The cells have room for disks of twice the speed to which the time step refers, whatever the present speeds: turns
  // depend on cells, so cells must be the same for a run and for its continuation from a file.
  double const displacement_at_speed = settings.time_step * 2.0 * all.radii.smallest;
  return packed_layout(box, all.radii, all.count, 2.0 * displacement_at_speed);
}

SharedTiledEngine::SharedTiledEngine(EngineSettings const& settings, State const& own)
    : settings_(settings),
      all_(overview_of_all(own.agents, settings.processes)),
      duration_(step_duration(settings, all_.radii.smallest)) {
  count_ids(own);
  require_all_valid(own);
}

void SharedTiledEngine::require_valid(State const& own) const { RowProblems(own).require_none(own.box); }

void SharedTiledEngine::take_restored(State& own) {
  AllProcesses const processes = settings_.processes;
  sort_by_ids(processes, own.agents);
  bool const are_sorted = are_in_order(processes, own.agents.ids());
  std::uint64_t const count = processes.sum(own.agents.size());
  processes.agree([&] {
    if (are_sorted && count == all_.count) return;
    throw Error(Problem{.what = are_sorted ? "the checkpoint holds another number of disks"
                                           : "two disks of the checkpoint have one name"});
  });
  count_ids(own);
  require_all_valid(own);
}

void SharedTiledEngine::count_ids(State const& own) {
  Communicator& processes = settings_.processes.communicator();
  id_indices_.resize(own.agents.size());
  std::iota(id_indices_.begin(), id_indices_.end(),
            static_cast<std::uint32_t>(division_of(processes, own.agents.size()).first(processes.rank())));
}

void SharedTiledEngine::require_all_valid(State const& own) const {
  Communicator& processes = settings_.processes.communicator();
  RowProblems const problems = tiled::problems_of_rows(processes, own);
  agree(processes, [&] { require_room_for_turns_of(settings_, own, all_, problems); });
  require_no_overlaps(own);
}

void SharedTiledEngine::advance(State& own, Counters& counters, StopCondition const& stop_condition) {
  if (stop_condition.is_reached(own.clock, counters.pair_collisions)) return;
  Communicator& processes = settings_.processes.communicator();
  std::exception_ptr thrown;
  std::optional<LongSubstep> long_substep;
  do_or_abandon(processes, [&] {
    tiled::PartOfProcess part(processes, tiled::rule_of(settings_, own, all_), tiled_layout(settings_, own.box, all_),
                              own, id_indices_);
    own.agents.forget_values();
    part.begin(settings_.threads);
    thrown = take_steps_together(processes, own.clock, duration_, counters, stop_condition, [&](std::uint64_t steps) {
      return tiled::take_steps(processes, part.share(), steps, counters);
    });
    part.give_back(own, id_indices_);
    long_substep = part.long_substep();
    note_traffic_of_all(processes);
  });
  if (thrown) std::rethrow_exception(thrown);
  agree(processes, [&] {
    if (long_substep) throw_long_substep(own.clock.step, *long_substep);
  });
}

void SharedTiledEngine::require_no_overlaps(State const& own) const {
  Communicator& processes = settings_.processes.communicator();
  std::vector<Problem> problems;
  do_or_abandon(processes, [&] {
    tiled::PartOfProcess part(processes, tiled::rule_of(settings_, own, all_), tiled_layout(settings_, own.box, all_),
                              own, id_indices_);
    part.begin(settings_.threads);
    problems = tiled::problems_of(processes, part, rounding_of_contact(own.box, all_.radii.smallest));
  });
  agree(processes, [&] {
    if (!problems.empty()) throw Error(problems);
  });
}

}  // namespace gridlock
