#include "simulation/divided_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>
#include <variant>

#include "engine/tiled/on_ranks.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/frame_source.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/tasks.hpp"

namespace gridlock {

namespace {

/// What a sample needs besides the agents.
struct SampleOrder {
  std::uint64_t counts_for_average;
  Clock clock;
  Counters counters;
};

/// Rows of a frame that the leader asks for: of a column by its place, or the Ids.
struct RowsOrder {
  static constexpr std::uint64_t ids = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t frame;
  std::uint64_t column;
  std::uint64_t first;
  std::uint64_t count;
};

/// The members of a run around those of its simulation, see Run::serialize() and the run directory.
SerializeAll inside_of_run(std::function<void(Archive&)> serialize) {
  return [serialize = std::move(serialize)](Archive& archive) {
    serialize_inside(archive, "run", [&] { serialize_inside(archive, "simulation", [&] { serialize(archive); }); });
  };
}

void add_part(MessageWriter& message, CheckpointPart const& part) {
  message.add(part.rows);
  message.add(part.checksum);
  message.add(std::uint64_t{part.lengths.size()});
  message.add_all(std::span<std::uint64_t const>(part.lengths));
}

CheckpointPart next_part(MessageReader& message) {
  CheckpointPart part;
  part.rows = message.next<std::uint64_t>();
  part.checksum = message.next<std::array<std::uint64_t, 2>>();
  part.lengths = message.next_values<std::uint64_t>(message.next<std::uint64_t>());
  return part;
}

}  // namespace

void RunOfRank::observe(ObserveSettings const& settings) {
  for (auto& observable : agents_->make_observables(settings, agents_->snapshot(counters_, ranks_))) {
    observables_.add(std::move(observable));
  }
}

void RunOfRank::sample(std::span<double> row, bool counts_for_average) {
  observables_.sample(agents_->snapshot(counters_, ranks_), row, counts_for_average);
}

std::uint64_t RunOfRank::state_hash() const {
  std::uint64_t sum = 0;
  for (Message const& bytes : gather(ranks_, message_of(agents_->sum_of_hashes()))) {
    sum += MessageReader(bytes).next<std::uint64_t>();
  }
  if (ranks_.rank() > 0) return 0;
  return hash_of_world(agents_->box(), agents_->clock(), agents_->seed(), agents_->count(), sum);
}

CheckpointShare RunOfRank::share() const {
  CheckpointShare share{.part = ranks_.rank(), .count = ranks_.count()};
  if (RowDivision const* const rows = agents_->rows()) {
    share.first_row = rows->first(share.part);
    share.end_row = rows->end(share.part);
  }
  return share;
}

std::vector<CheckpointPart> RunOfRank::write_part(std::filesystem::path const& directory,
                                                  SerializeAll const& serialize) const {
  CheckpointPart own;
  std::string failure;
  auto const of_rank = [&](std::string const& why) {
    return ranks_.rank() == 0 ? why : fmt::format("rank {}: {}", ranks_.rank(), why);
  };
  try {
    own = write_checkpoint_part(directory, share(), serialize);
  } catch (RunFailure const& failed) {
    failure = of_rank(failed.what());
  } catch (std::bad_alloc const&) {
    failure = of_rank("not enough memory");
  }
  MessageWriter answer;
  add_part(answer, own);
  answer.add_text(failure);
  std::vector<CheckpointPart> parts;
  std::string first_failure;
  for (Message const& bytes : gather(ranks_, answer.take())) {
    MessageReader message(bytes);
    parts.push_back(next_part(message));
    std::string const next_failure = message.next_text();
    if (first_failure.empty()) first_failure = next_failure;
  }
  if (!first_failure.empty()) throw RunFailure(first_failure);
  return parts;
}

std::optional<Restored> RunOfRank::restore(std::filesystem::path const& directory, SerializeAll const& serialize) {
  std::optional<Restored> restored = restore_checkpoint(
      directory, serialize, share(), [&](std::string const& text) { return first_text_of_all(ranks_, text); });
  if (!restored || agents_->rows() != nullptr) return restored;
  agents_->bring_home();
  observables_.migrate(ranks_);
  return restored;
}

void RunOfRank::serialize(Archive& archive) {
  serialize_inside(archive, "world", [&] { agents_->serialize(archive); });
  serialize_inside(archive, "counters", [&] { gridlock::serialize(archive, counters_); });
  observables_.serialize(archive);
}

/// The rows of all ranks.
class DividedSimulation::Source final : public FrameSource {
 public:
  Source(Communicator& ranks, DividedSimulation const& simulation, std::uint64_t number, ArrangedAgents arranged)
      : FrameSource(head_of(simulation), simulation.agents()),
        ranks_(ranks),
        number_(number),
        arranged_(std::move(arranged)) {}
  Source(Source const&) = delete;
  Source& operator=(Source const&) = delete;
  ~Source() override { send_task(ranks_, TaskOfRanks::forget_frame, number_); }

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    std::vector<Id> ids;
    gather(RowsOrder::ids, first, count, ids, [&](std::size_t row) { return arranged_.own.ids()[row]; });
    return ids;
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    return std::visit(
        [&](auto own) {
          std::vector<std::remove_cvref_t<decltype(own[0])>> values;
          gather(column, first, count, values, [&](std::size_t row) { return own[row]; });
          return FrameValues(std::move(values));
        },
        arranged_.own.columns()[column].second);
  }

 private:
  static Frame head_of(DividedSimulation const& simulation) {
    AgentsOfRank const& own = simulation.own();
    return frame_source_of(own.box(), own.clock(), own.seed(), own.view())->piece(0, 0);
  }

  template <class Value, class OwnValue>
  void gather(std::uint64_t column, std::size_t first, std::size_t count, std::vector<Value>& values,
              OwnValue own_value) const {
    values.reserve(count);
    RowDivision const& rows = arranged_.rows;
    for (std::uint64_t row = first; row < first + count;) {
      std::size_t const rank = rows.rank_of(row);
      std::uint64_t const end = std::min<std::uint64_t>(rows.end(rank), first + count);
      std::uint64_t const begin = row - rows.first(rank);
      if (rank == 0) {
        for (; row < end; ++row) values.push_back(own_value(row));
        continue;
      }
      MessageWriter message;
      message.add(TaskOfRanks::give_rows);
      message.add(RowsOrder{.frame = number_, .column = column, .first = begin, .count = end - row});
      ranks_.send(rank, message.take());
      Message const bytes = ranks_.receive(rank);
      std::vector<Value> const piece = MessageReader(bytes).rest<Value>();
      values.insert(values.end(), piece.begin(), piece.end());
      row = end;
    }
  }

  Communicator& ranks_;
  std::uint64_t number_;
  ArrangedAgents arranged_;
};

void DividedSimulation::announce(Communicator& ranks, Configuration const& configuration) {
  Configuration described = configuration;
  send_task(ranks, TaskOfRanks::begin_run, to_toml(describing(described)));
}

DividedSimulation::~DividedSimulation() { send_task(ranks_, TaskOfRanks::forget_run); }

void DividedSimulation::observe(ObserveSettings const& settings) {
  send_task(ranks_, TaskOfRanks::observe_run);
  run_.observe(settings);
}

std::uint64_t DividedSimulation::state_hash() const {
  send_task(ranks_, TaskOfRanks::hash_run);
  return run_.state_hash();
}

void DividedSimulation::advance(StopCondition const& stop_condition) { own().advance(run_.counters(), stop_condition); }

void DividedSimulation::observe(std::unique_ptr<Observable> /*observable*/) {
  throw Error(Problem{.what = "an observable of a program cannot be measured on several ranks",
                      .hint = "use one process, or write frames and measure them afterwards"});
}

void DividedSimulation::sample(std::span<double> row, bool counts_for_average) {
  send_task(ranks_, TaskOfRanks::sample_run,
            SampleOrder{.counts_for_average = counts_for_average ? std::uint64_t{1} : 0,
                        .clock = clock(),
                        .counters = run_.counters()});
  run_.sample(row, counts_for_average);
}

std::unique_ptr<FrameSource> DividedSimulation::frame_source() const {
  std::uint64_t const number = frames_++;
  send_task(ranks_, TaskOfRanks::arrange_frame, number);
  return std::make_unique<Source>(ranks_, *this, number, own().arranged());
}

std::vector<CheckpointPart> DividedSimulation::write_parts(std::filesystem::path const& directory,
                                                           SerializeAll const& serialize) {
  send_task(ranks_, TaskOfRanks::write_rows, std::filesystem::absolute(directory).string());
  return run_.write_part(directory, serialize);
}

std::optional<Restored> DividedSimulation::restore(std::filesystem::path const& directory,
                                                   SerializeAll const& serialize) {
  send_task(ranks_, TaskOfRanks::restore_rows, std::filesystem::absolute(directory).string());
  std::optional<Restored> restored = run_.restore(directory, serialize);
  // A file can hold anything.
  if (restored) own().require_valid();
  return restored;
}

void RunHelper::begin(MessageReader& message) {
  run_.reset();
  frames_.clear();
  configuration_ = [&] {
    try {
      return read_configuration(SettingsFile::from_text(message.next_text(), "the settings of the leader"));
    } catch (Error const& error) {
      throw RunFailure(fmt::format("all ranks must be the same program: {}", error.what()));
    }
  }();
  // What is refused is the leader's to tell.
  try {
    run_.emplace(ranks_, configuration_.kind().agents_of_rank(ranks_, configuration_));
  } catch (Error const&) {
    run_.reset();
  }
}

void RunHelper::sample(MessageReader& message) {
  auto const order = message.next<SampleOrder>();
  run_->agents().set_clock(order.clock);
  run_->counters() = order.counters;
  std::vector<double> row(run_->observables().columns().size());
  run_->sample(row, order.counts_for_average != 0);
}

void RunHelper::give_rows(MessageReader& message) const {
  auto const order = message.next<RowsOrder>();
  AgentsView const& agents = frames_.at(order.frame).own;
  if (order.column == RowsOrder::ids) {
    ranks_.send(0, message_of_all(agents.ids().subspan(order.first, order.count)));
    return;
  }
  std::visit([&](auto values) { ranks_.send(0, message_of_all(values.subspan(order.first, order.count))); },
             agents.columns()[order.column].second);
}

void RunHelper::carry_out(TaskOfRanks task, MessageReader& message) {
  auto const serialize = inside_of_run([&](Archive& archive) { run_->serialize(archive); });
  switch (task) {
    case TaskOfRanks::begin_run:
      return begin(message);
    case TaskOfRanks::observe_run:
      return run_->observe(configuration_.observe);
    case TaskOfRanks::sample_run:
      return sample(message);
    case TaskOfRanks::hash_run:
      static_cast<void>(run_->state_hash());
      return;
    case TaskOfRanks::arrange_frame:
      frames_.emplace(message.next<std::uint64_t>(), run_->agents().arranged());
      return;
    case TaskOfRanks::give_rows:
      return give_rows(message);
    case TaskOfRanks::forget_frame:
      frames_.erase(message.next<std::uint64_t>());
      return;
    case TaskOfRanks::write_rows:
      static_cast<void>(run_->write_part(message.next_text(), serialize));
      return;
    case TaskOfRanks::restore_rows:
      try {
        run_->restore(message.next_text(), serialize);
      } catch (Error const&) {  // NOLINT(bugprone-empty-catch): the leader tells of it
      }
      return;
    case TaskOfRanks::forget_run:
      frames_.clear();
      run_.reset();
      return;
    case TaskOfRanks::steps_of_disks:
      // Of a leader that has all disks.
      if (!run_) {
        State none{.box = Box(1.0, 1.0, Edge::wall)};
        return tiled::take_part(ranks_, message, none);
      }
      [[fallthrough]];
    default:
      if (!run_ || !run_->agents().carry_out(task, message)) throw RunFailure("an unknown task of the leader");
  }
}

}  // namespace gridlock
