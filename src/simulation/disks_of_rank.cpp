#include "simulation/disks_of_rank.hpp"

#include <algorithm>
#include <utility>

#include "engine/stepped.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/tasks.hpp"
#include "simulation/disk_rows.hpp"
#include "simulation/patient_engine.hpp"

namespace gridlock {

namespace {

/// Rows in one message.
constexpr std::size_t rows_of_message = std::size_t{1} << 15;

/// Where the rows of the ranks come from.
enum class StartOfRows : std::uint64_t { made_by_each, handed_out, of_file };

}  // namespace

DisksOfRank::DisksOfRank(Communicator& ranks, Configuration const& configuration, State const* whole,
                         StartFile const* file)
    : ranks_(ranks) {
  struct Head {
    StartOfRows start;
    std::uint64_t rows;
  } head{.start = StartOfRows::made_by_each, .rows = count_of(configuration.disks)};
  if (whole != nullptr) head = {.start = StartOfRows::handed_out, .rows = whole->agents.size()};
  if (file != nullptr) head = {.start = StartOfRows::of_file, .rows = file->reader.count()};
  head = MessageReader(broadcast(ranks_, message_of(head))).next<Head>();
  rows_ = RowDivision::even(head.rows, ranks_.count());
  if (head.start == StartOfRows::of_file) {
    read_rows(configuration, file);
  } else {
    own_.box = make_box(configuration.box);
    head.start == StartOfRows::made_by_each ? make_rows(configuration)
    : whole != nullptr                      ? hand_out(*whole)
                                            : receive_rows();
  }
  own_.seed = configuration.run.seed;
  for (Message const& bytes : all_gather(ranks_, message_of(overview_of(own_.agents)))) {
    all_.add(MessageReader(bytes).next<DisksOverview>());
  }
  RowProblems const problems = problems_of_rows();
  agree_on_errors(ranks_, [&] { require_room_for_turns_of(configuration.engine, own_, all_, problems); });
}

void DisksOfRank::make_rows(Configuration const& configuration) {
  agree_on_errors(ranks_, [&] {
    own_ = make_start(own_.box, configuration.disks, configuration.run.seed, ShareOfRows(ranks_, rows_));
  });
  draw_velocities(configuration);
}

void DisksOfRank::read_rows(Configuration const& configuration, StartFile const* file) {
  RowsOfFile read = read_on_ranks(ranks_, configuration.disks, file);
  own_ = std::move(read.own);
  own_.seed = configuration.run.seed;
  if (!read.has_velocities || configuration.velocities.redraw) draw_velocities(configuration);
}

void DisksOfRank::draw_velocities(Configuration const& configuration) {
  // What is refused is of the settings: all refuse it, before anything is added up.
  agree_on_errors(ranks_,
                  [&] { gridlock::draw_velocities(own_, configuration.velocities, ShareOfRows(ranks_, rows_)); });
}

/// Of all ranks.
RowProblems DisksOfRank::problems_of_rows() const {
  MessageWriter own;
  RowProblems(own_).write(own);
  RowProblems problems;
  for (Message const& bytes : all_gather(ranks_, own.take())) {
    MessageReader message(bytes);
    problems.add(RowProblems(message));
  }
  return problems;
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
    Message const bytes = ranks_.receive(0);
    std::vector<DiskRow> const disks = MessageReader(bytes).rest<DiskRow>();
    for (DiskRow const& disk : disks) own.add(disk);
    come += disks.size();
  }
  own.become(own_.agents);
}

double DisksOfRank::patience() const {
  return patience_for(own_, all_,
                      [&](auto const& add) { return AllProcesses(ranks_).change_in_order(SpeedSums{}, add); });
}

void DisksOfRank::begin(EngineSettings const& settings, RunSettings const& run) {
  auto tiled = std::make_unique<TiledOnRanks>(settings, box(), all_, rows_);
  tiled_ = tiled.get();
  engine_ = std::move(tiled);
  tiled_->require_no_overlaps(own_);
  if (run.steps || run.time) return;
  send_task(ranks_, TaskOfRanks::find_patience);
  engine_ = std::make_unique<PatientEngine>(std::move(engine_), patience());
}

void DisksOfRank::serialize(Archive& archive) {
  gridlock::serialize(archive, own_);
  if (!archive.is_restoring()) return;
  archive.require(own_.agents.size() == rows_.rows_of(ranks_.rank()), "it holds another number of disks");
  archive.require(std::ranges::is_sorted(own_.agents.ids()),
                  "its disks are not in the order of their Ids, which one process can restore alone");
}

bool DisksOfRank::carry_out(TaskOfRanks task, MessageReader& message) {
  if (task == TaskOfRanks::steps_of_disks) {
    tiled::take_part(ranks_, message, own_);
    return true;
  }
  if (task != TaskOfRanks::find_patience) return false;
  static_cast<void>(patience());
  return true;
}

}  // namespace gridlock
