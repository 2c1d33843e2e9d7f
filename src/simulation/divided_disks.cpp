#include "simulation/divided_disks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include "engine/stepped.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/frame_source.hpp"
#include "lattice/rows_of_start.hpp"
#include "simulation/patient_engine.hpp"

namespace gridlock {

namespace {

/// Rows in one message.
constexpr std::size_t rows_of_message = std::size_t{1} << 15;

/// All that a row of a state holds.
struct DiskRow {
  Id id;
  double x, y, velocity_x, velocity_y, radius, mass;
  std::int32_t image_x, image_y;
};

DiskRow row_of(Disks const& disks, std::size_t i) {
  return {.id = disks.ids()[i],
          .x = disks.column<X>()[i],
          .y = disks.column<Y>()[i],
          .velocity_x = disks.column<VelocityX>()[i],
          .velocity_y = disks.column<VelocityY>()[i],
          .radius = disks.column<Radius>()[i],
          .mass = disks.column<Mass>()[i],
          .image_x = disks.column<ImageX>()[i],
          .image_y = disks.column<ImageY>()[i]};
}

/// Rows that come one after the other, until they are a population.
class ComingRows {
 public:
  explicit ComingRows(std::size_t rows) {
    ids_.resize(rows);
    values_.resize(rows);
  }
  void add(DiskRow const& row) {
    ids_[next_] = row.id;
    values_.put(next_, {row.x, row.y, row.velocity_x, row.velocity_y, row.radius, row.mass, row.image_x, row.image_y});
    ++next_;
  }
  void become(Disks& disks) {
    assert(next_ == ids_.size());
    disks.become(ids_, values_);
  }

 private:
  LargeArray<Id> ids_;
  Disks::AllValues values_;
  std::size_t next_ = 0;
};

/// What a sample needs besides the disks.
struct SampleOrder {
  std::uint64_t counts_for_average;
  Clock clock;
  Counters counters;
};

/// Rows that the leader asks for: of a column by its place, or the Ids.
struct RowsOrder {
  static constexpr std::uint64_t ids = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t column;
  std::uint64_t first;
  std::uint64_t count;
};

/// What becomes of the parts of a checkpoint.
struct PartAnswer {
  std::uint64_t is_written;
  CheckpointPart part;
};

/// What is wrong, in a message; places in files are not known yet.
Ranks::Bytes message_of_problems(std::optional<Error> const& error) {
  MessageWriter message;
  if (!error) return message.take();
  for (Problem const& problem : error->problems()) {
    for (std::string const& text : {problem.what, problem.hint, problem.key}) message.add_text(text);
  }
  return message.take();
}

/// The members of a run around those of its simulation, see Run::serialize() and the run directory.
SerializeAll inside_of_run(std::function<void(Archive&)> serialize) {
  return [serialize = std::move(serialize)](Archive& archive) {
    serialize_inside(archive, "run", [&] { serialize_inside(archive, "simulation", [&] { serialize(archive); }); });
  };
}

}  // namespace

DisksOfRank::DisksOfRank(Ranks& ranks, Configuration const& configuration, State const* whole)
    : ranks_(ranks), own_{.box = make_box(configuration.box)} {
  struct Head {
    std::uint64_t is_handed_out;
    std::uint64_t rows;
  } head{.is_handed_out = whole != nullptr ? 1U : 0U,
         .rows = whole != nullptr ? whole->agents.size() : count_of(configuration.disks)};
  if (ranks_.rank() == 0) {
    send_to_others(ranks_, message_of(head));
  } else {
    head = MessageReader(ranks_.receive(0)).next<Head>();
  }
  rows_ = RowDivision::even(head.rows, ranks_.count());
  if (head.is_handed_out != 0) {
    whole != nullptr ? hand_out(*whole) : receive_rows();
  } else {
    agreed([&] {
      own_ = make_rows_of_start(own_.box, configuration.disks, configuration.run.seed,
                                {.first = rows_.first(ranks_.rank()), .end = rows_.end(ranks_.rank())});
    });
    // What is refused is of the settings: all refuse it, before anything is added up.
    agreed([&] {
      draw_velocities_of_rows(own_, configuration.velocities, rows_.rows(), [&](DriftSums& sums) {
        sums = add_in_order(ranks_, sums, [&](DriftSums& so_far) { so_far.add(own_.agents); });
      });
    });
  }
  own_.seed = configuration.run.seed;
  for (Ranks::Bytes const& bytes : ranks_.gather_for_all(message_of(overview_of(own_.agents)))) {
    all_.add(MessageReader(bytes).next<DisksOverview>());
  }
  agreed([&] { require_room_for_turns_of(configuration.engine, own_, all_); });
}

void DisksOfRank::hand_out(State const& whole) {
  own_.clock = whole.clock;
  send_to_others(ranks_, message_of(whole.clock));
  std::vector<std::uint32_t> const order = rows_in_order(whole.agents.ids());
  ComingRows own(rows_.rows_of(0));
  std::vector<DiskRow> waiting;
  for (std::size_t rank = 0; rank < ranks_.count(); ++rank) {
    for (std::uint64_t row = rows_.first(rank); row < rows_.end(rank); ++row) {
      DiskRow const disk = row_of(whole.agents, order[row]);
      if (rank == 0) {
        own.add(disk);
        continue;
      }
      waiting.push_back(disk);
      if (waiting.size() < rows_of_message && row + 1 < rows_.end(rank)) continue;
      ranks_.send(rank, message_of_all(std::span<DiskRow const>(waiting)));
      waiting.clear();
    }
  }
  own.become(own_.agents);
}

void DisksOfRank::receive_rows() {
  own_.clock = MessageReader(ranks_.receive(0)).next<Clock>();
  std::size_t const rows = rows_.rows_of(ranks_.rank());
  ComingRows own(rows);
  for (std::size_t come = 0; come < rows;) {
    Ranks::Bytes const bytes = ranks_.receive(0);
    std::vector<DiskRow> const disks = MessageReader(bytes).rest<DiskRow>();
    for (DiskRow const& disk : disks) own.add(disk);
    come += disks.size();
  }
  own.become(own_.agents);
}

std::string DisksOfRank::first_of_all(std::string const& text) const {
  for (Ranks::Bytes const& bytes : ranks_.gather_for_all(message_of_all(std::span<char const>(text)))) {
    if (!bytes.empty()) return {reinterpret_cast<char const*>(bytes.data()), bytes.size()};
  }
  return {};
}

void DisksOfRank::agreed(std::function<void()> const& work) const {
  std::optional<Error> error;
  try {
    work();
  } catch (Error const& refused) {
    error = refused;
  }
  for (Ranks::Bytes const& bytes : ranks_.gather_for_all(message_of_problems(error))) {
    MessageReader message(bytes);
    std::vector<Problem> problems;
    while (!message.is_at_end()) {
      Problem problem;
      for (std::string* text : {&problem.what, &problem.hint, &problem.key}) *text = message.next_text();
      problems.push_back(std::move(problem));
    }
    if (!problems.empty()) throw Error(std::move(problems));
  }
}

void DisksOfRank::observe(ObserveSettings const& settings) {
  others_ = std::make_unique<AgentsOnRanks>(ranks_, own_.agents.size());
  Snapshot const start(own_, counters_, others_.get());
  for (auto& observable : make_observables(settings, start)) observables_.add(std::move(observable));
}

void DisksOfRank::sample(std::span<double> row, bool counts_for_average) {
  observables_.sample(Snapshot(own_, counters_, others_.get()), row, counts_for_average);
}

std::uint64_t DisksOfRank::state_hash() const {
  std::uint64_t sum = sum_of_hashes(own_.agents);
  if (ranks_.rank() > 0) {
    ranks_.send(0, message_of(sum));
    return 0;
  }
  for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
    sum += MessageReader(ranks_.receive(rank)).next<std::uint64_t>();
  }
  return hash_of_world(own_.box, own_.clock, own_.seed, rows_.rows(), sum);
}

double DisksOfRank::patience() const {
  return patience_for(own_, all_, [&](auto const& add) { return add_in_order(ranks_, SpeedSums{}, add); });
}

CheckpointShare DisksOfRank::share() const {
  return {.rank = ranks_.rank(),
          .count = ranks_.count(),
          .first_row = rows_.first(ranks_.rank()),
          .end_row = rows_.end(ranks_.rank())};
}

std::vector<CheckpointPart> DisksOfRank::write_part(std::filesystem::path const& directory,
                                                    SerializeAll const& serialize) const {
  PartAnswer own{};
  std::string failure;
  try {
    own = {.is_written = 1, .part = write_checkpoint_part(directory, share(), serialize)};
  } catch (RunFailure const& failed) {
    failure = failed.what();
  } catch (std::bad_alloc const&) {
    failure = "not enough memory";
  }
  if (ranks_.rank() > 0) {
    MessageWriter answer;
    answer.add(own);
    answer.add_text(failure);
    ranks_.send(0, answer.take());
    return {};
  }
  std::vector<CheckpointPart> parts{own.part};
  for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
    Ranks::Bytes const bytes = ranks_.receive(rank);
    MessageReader answer(bytes);
    parts.push_back(answer.next<PartAnswer>().part);
    std::string const of_rank = answer.next_text();
    if (failure.empty() && !of_rank.empty()) failure = fmt::format("rank {}: {}", rank, of_rank);
  }
  if (!failure.empty()) throw RunFailure(failure);
  return parts;
}

std::optional<Restored> DisksOfRank::restore(std::filesystem::path const& directory, SerializeAll const& serialize) {
  return restore_checkpoint(directory, serialize, share(), [&](std::string const& text) { return first_of_all(text); });
}

void DisksOfRank::serialize(Archive& archive) {
  serialize_inside(archive, "world", [&] { gridlock::serialize(archive, own_); });
  if (archive.is_restoring()) {
    archive.require(own_.agents.size() == rows_.rows_of(ranks_.rank()), "it holds another number of disks");
    auto const ids = own_.agents.ids();
    archive.require(std::ranges::is_sorted(ids),
                    "its disks are not in the order of their Ids, which one process can restore alone");
  }
  serialize_inside(archive, "counters", [&] { gridlock::serialize(archive, counters_); });
  observables_.serialize(archive);
}

/// The rows of all ranks.
class DividedDisks::Source final : public FrameSource {
 public:
  explicit Source(DividedDisks const& disks)
      : FrameSource(head_of(disks), disks.agents()), ranks_(disks.ranks_), disks_(disks.disks_) {}

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    std::vector<Id> ids;
    gather(RowsOrder::ids, first, count, ids, [&](std::size_t row) { return disks_.own().agents.ids()[row]; });
    return ids;
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    return std::visit(
        [&](auto own) {
          std::vector<std::remove_cvref_t<decltype(own[0])>> values;
          gather(column, first, count, values, [&](std::size_t row) { return own[row]; });
          return FrameValues(std::move(values));
        },
        AgentsView(disks_.own().agents).columns()[column].second);
  }

 private:
  static Frame head_of(DividedDisks const& disks) { return frame_source_of(disks.disks_.own())->piece(0, 0); }

  template <class Value, class OwnValue>
  void gather(std::uint64_t column, std::size_t first, std::size_t count, std::vector<Value>& values,
              OwnValue own_value) const {
    values.reserve(count);
    RowDivision const& rows = disks_.rows();
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
      message.add(RowsOrder{.column = column, .first = begin, .count = end - row});
      ranks_.send(rank, message.take());
      Ranks::Bytes const bytes = ranks_.receive(rank);
      std::vector<Value> const piece = MessageReader(bytes).rest<Value>();
      values.insert(values.end(), piece.begin(), piece.end());
      row = end;
    }
  }

  Ranks& ranks_;
  DisksOfRank const& disks_;
};

namespace {

/// The leader says what is to be done before it does its own part of it.
void send_order(Ranks& ranks, TaskOfRanks task, std::string const& text) {
  MessageWriter message;
  message.add(task);
  message.add_text(text);
  send_to_others(ranks, message.take());
}

DisksOfRank begun(Ranks& ranks, Configuration const& configuration, State const* whole) {
  Configuration described = configuration;
  send_order(ranks, TaskOfRanks::begin_disks, to_toml(describing(described)));
  return {ranks, configuration, whole};
}

}  // namespace

DividedDisks::DividedDisks(Ranks& ranks, Configuration const& configuration, std::optional<State> whole)
    : ranks_(ranks), disks_(begun(ranks, configuration, whole ? &*whole : nullptr)) {}

DividedDisks::~DividedDisks() { send(TaskOfRanks::forget_disks); }

void DividedDisks::send(TaskOfRanks task) const { send_to_others(ranks_, message_of(task)); }

void DividedDisks::begin(EngineSettings const& settings, RunSettings const& run, ObserveSettings const& observe) {
  auto tiled = std::make_unique<TiledOnRanks>(settings, box(), disks_.all(), disks_.rows());
  tiled_ = tiled.get();
  engine_ = std::move(tiled);
  tiled_->require_no_overlaps(disks_.own());
  if (!run.steps && !run.time) {
    send(TaskOfRanks::find_patience);
    engine_ = std::make_unique<PatientEngine>(std::move(engine_), disks_.patience());
  }
  send(TaskOfRanks::observe_disks);
  disks_.observe(observe);
}

std::uint64_t DividedDisks::state_hash() const {
  send(TaskOfRanks::hash_disks);
  return disks_.state_hash();
}

void DividedDisks::require_valid() const { tiled_->require_no_overlaps(disks_.own()); }

void DividedDisks::advance(StopCondition const& stop_condition) {
  engine_->advance(disks_.own(), disks_.counters(), stop_condition);
}

void DividedDisks::observe(std::unique_ptr<Observable> /*observable*/) {
  throw Error(Problem{.what = "an observable of a program cannot be measured on several ranks",
                      .hint = "use one process, or write frames and measure them afterwards"});
}

void DividedDisks::sample(std::span<double> row, bool counts_for_average) {
  MessageWriter message;
  message.add(TaskOfRanks::sample_disks);
  message.add(SampleOrder{.counts_for_average = counts_for_average ? std::uint64_t{1} : 0,
                          .clock = clock(),
                          .counters = disks_.counters()});
  send_to_others(ranks_, message.take());
  disks_.sample(row, counts_for_average);
}

std::unique_ptr<FrameSource> DividedDisks::frame_source() const { return std::make_unique<Source>(*this); }

std::vector<CheckpointPart> DividedDisks::write_parts(std::filesystem::path const& directory,
                                                      SerializeAll const& serialize) {
  send_order(ranks_, TaskOfRanks::write_rows, std::filesystem::absolute(directory).string());
  return disks_.write_part(directory, serialize);
}

std::optional<Restored> DividedDisks::restore(std::filesystem::path const& directory, SerializeAll const& serialize) {
  send_order(ranks_, TaskOfRanks::restore_rows, std::filesystem::absolute(directory).string());
  std::optional<Restored> restored = disks_.restore(directory, serialize);
  // A file can hold anything.
  if (restored) tiled_->require_no_overlaps(disks_.own());
  return restored;
}

void DisksHelper::give_rows(MessageReader& message) const {
  auto const order = message.next<RowsOrder>();
  Disks const& disks = disks_->own().agents;
  if (order.column == RowsOrder::ids) {
    ranks_.send(0, message_of_all(disks.ids().subspan(order.first, order.count)));
    return;
  }
  std::visit([&](auto values) { ranks_.send(0, message_of_all(values.subspan(order.first, order.count))); },
             AgentsView(disks).columns()[order.column].second);
}

bool DisksHelper::carry_out(TaskOfRanks task, MessageReader& message) {
  switch (task) {
    case TaskOfRanks::begin_disks: {
      disks_.reset();
      configuration_ = read_configuration(SettingsFile::from_text(message.next_text(), "the settings of the leader"));
      // What is refused is the leader's to tell.
      try {
        disks_.emplace(ranks_, configuration_, nullptr);
      } catch (Error const&) {
        disks_.reset();
      }
      return true;
    }
    case TaskOfRanks::steps_of_disks: {
      State none{.box = Box(1.0, 1.0, Edge::wall)};
      tiled::take_part(ranks_, message, disks_ ? disks_->own() : none);
      return true;
    }
    case TaskOfRanks::observe_disks:
      disks_->observe(configuration_.observe);
      return true;
    case TaskOfRanks::sample_disks: {
      auto const order = message.next<SampleOrder>();
      disks_->own().clock = order.clock;
      disks_->counters() = order.counters;
      std::vector<double> row(disks_->observables().columns().size());
      disks_->sample(row, order.counts_for_average != 0);
      return true;
    }
    case TaskOfRanks::hash_disks:
      static_cast<void>(disks_->state_hash());
      return true;
    case TaskOfRanks::find_patience:
      static_cast<void>(disks_->patience());
      return true;
    case TaskOfRanks::give_rows:
      give_rows(message);
      return true;
    case TaskOfRanks::write_rows:
      static_cast<void>(disks_->write_part(message.next_text(),
                                           inside_of_run([&](Archive& archive) { disks_->serialize(archive); })));
      return true;
    case TaskOfRanks::restore_rows:
      try {
        disks_->restore(message.next_text(), inside_of_run([&](Archive& archive) { disks_->serialize(archive); }));
      } catch (Error const&) {  // NOLINT(bugprone-empty-catch): the leader tells of it
      }
      return true;
    case TaskOfRanks::forget_disks:
      disks_.reset();
      return true;
    case TaskOfRanks::leave:
    case TaskOfRanks::steps_of_model:
      break;
  }
  return false;
}

}  // namespace gridlock
