#include "simulation/shared_start.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "parallel/disks_of_all.hpp"
#include "parallel/exchange.hpp"
#include "parallel/sort_among_ranks.hpp"

namespace gridlock {

namespace {

/// Maximum number of rows in a message.
constexpr std::size_t rows_of_piece = std::size_t{1} << 15;

/// The header of a start file, as a message to all processes.
struct FileHead {
  double width, height, shift;
  std::uint64_t edges;  ///< see number_of_edges()
  Clock clock;
  std::uint64_t count;         ///< number of rows
  std::uint64_t likely_count;  ///< rows to reserve memory for, even if `count` is damaged
  std::uint64_t has_radii;
  std::uint64_t has_velocities;
};

FileHead head_of(xyz::Reader const& reader) {
  Box const& box = reader.box();
  auto const number = [](bool is_true) { return is_true ? std::uint64_t{1} : 0; };
  return {.width = box.width(),
          .height = box.height(),
          .shift = box.shift(),
          .edges = number_of_edges(box),
          .clock = clock_of(reader.header()),
          .count = reader.count(),
          .likely_count = reader.likely_count(),
          .has_radii = number(reader.columns().has_radii()),
          .has_velocities = number(reader.columns().has_velocities())};
}

/// The first number of a message of the root: rows follow, or the file has ended.
enum class PieceOfFile : std::uint64_t { rows, end };

/// The Ids of a process: their number, first and last Id, and whether they ascend.
struct OrderOfRows {
  std::uint64_t count;
  Id first, last;
  std::uint64_t ascends;
};

/// The radii of a process: their number and range, and whether the settings allow them.
struct RadiiOfProcess {
  std::uint64_t count;
  RadiusRange radii;
  std::uint64_t are_as_asked;
};

/// Returns the process that checks a slot. All Ids with the same slot go to the same process; a hash spreads the slots.
std::size_t process_of_slot(std::uint64_t slot, std::size_t processes) {
  std::uint64_t const scattered = (slot * 0x9E3779B97F4A7C15ULL) >> 32;
  return static_cast<std::size_t>((scattered * processes) >> 32);
}

/// The rows of a start file that belong to one process.
class PartOfStart {
 public:
  PartOfStart(Communicator& processes, FileHead const& head, AskedRadii asked)
      : processes_(processes),
        head_(head),
        asked_(std::move(asked)),
        rows_(RowDivision::even(head.count, processes.count())) {
    disks_.reserve(std::min(rows_.rows_of(processes.rank()), head.likely_count));
  }

  /// Reads all rows on the root and sends each piece to its process. Errors: Error.
  void hand_out(xyz::Reader& reader, DisksSettings const& settings) {
    try {
      hand_out_rows(reader, radius_without_column(settings, reader.box(), reader.count()));
    } catch (...) {
      end();
      throw;
    }
    end();
  }

  /// Receives the rows of this process until the root has sent all or refuses the file.
  void receive() {
    while (true) {
      Message const bytes = processes_.receive(0);
      MessageReader message(bytes);
      if (message.next<PieceOfFile>() == PieceOfFile::end) return;
      std::vector<DiskRow> const rows = message.rest<DiskRow>();
      disks_.insert(disks_.end(), rows.begin(), rows.end());
    }
  }

  /// Sorts the rows of all processes by Id, unless an Id is wrong. All processes call it and get the same result.
  std::optional<xyz::WrongId> sort() {
    if (are_in_order()) return std::nullopt;
    if (auto const wrong = find_wrong_id()) return wrong;
    sort_among_ranks(processes_, disks_, rows_, [](DiskRow const& disk) { return disk.id; });
    return std::nullopt;
  }

  RowsOfFile finish() {
    Box const box = box_with_edges(head_.width, head_.height, head_.edges).shifted(head_.shift);
    RowsOfFile file{.own = {.box = box, .agents = disks_of(disks_), .clock = head_.clock}};
    file.has_velocities = head_.has_velocities != 0;
    disks_ = std::vector<DiskRow>();
    return file;
  }

  /// Returns a summary of the disks of all processes. All processes call it.
  [[nodiscard]] StartFileSummary summary(State const& own) const {
    StartFileSummary summary{.box = own.box, .has_radii = head_.has_radii != 0, .count = head_.count};
    RadiiOfProcess const radii{.count = own.agents.size(),
                               .radii = radius_range(own.agents),
                               .are_as_asked = asked_.are_of(own.agents) ? std::uint64_t{1} : 0};
    bool is_first = true;
    for (Message const& bytes : all_gather(processes_, message_of(radii))) {
      auto const next = MessageReader(bytes).next<RadiiOfProcess>();
      if (next.count == 0) continue;
      summary.radii = {
          .smallest = is_first ? next.radii.smallest : std::min(summary.radii.smallest, next.radii.smallest),
          .largest = std::max(summary.radii.largest, next.radii.largest)};
      summary.are_radii_as_asked = summary.are_radii_as_asked && next.are_as_asked != 0;
      is_first = false;
    }
    // The squares are added in the order of a single process, since floating-point sums depend on the order.
    double const squares = AllProcesses(processes_).change_in_order(0.0, [&](double& sum) {
      for (double const radius : own.agents.column<Radius>()) sum += radius * radius;
    });
    summary.covered_area = std::numbers::pi * squares;
    return summary;
  }

 private:
  void end() {
    for (std::size_t to = 1; to < processes_.count(); ++to) processes_.send(to, message_of(PieceOfFile::end));
  }
  void hand_out_rows(xyz::Reader& reader, double other_radius) {
    xyz::Rows piece;
    std::vector<DiskRow> leaving;
    while (reader.read(rows_of_piece, piece)) {
      for (std::size_t k = 0; k < piece.disks.size(); ++k) {
        std::size_t const to = rows_.rank_of(piece.disks[k].number);
        DiskRow disk = row_of(piece.disks[k]);
        if (head_.has_radii == 0) disk.radius = other_radius;
        (to == 0 ? disks_ : leaving).push_back(disk);
        bool const is_last = k + 1 == piece.disks.size() || rows_.rank_of(piece.disks[k + 1].number) != to;
        if (!is_last || to == 0) continue;
        MessageWriter message;
        message.add(PieceOfFile::rows);
        message.add_all(std::span<DiskRow const>(leaving));
        processes_.send(to, message.take());
        leaving.clear();
      }
      piece.disks.clear();
      piece.others.clear();
    }
  }

  static DiskRow row_of(xyz::Row const& row) {
    return {.id = row.id,
            .x = row.position.x,
            .y = row.position.y,
            .velocity_x = row.velocity.x,
            .velocity_y = row.velocity.y,
            .radius = row.radius,
            .mass = row.mass,
            .image_x = row.image_x,
            .image_y = row.image_y};
  }

  /// Returns whether the Ids of all processes ascend and are certain to be valid.
  [[nodiscard]] bool are_in_order() const {
    auto const descends = [](DiskRow const& one, DiskRow const& next) { return one.id >= next.id; };
    bool const ascends = std::ranges::adjacent_find(disks_, descends) == disks_.end();
    OrderOfRows own{.count = disks_.size(), .first = 0, .last = 0, .ascends = ascends ? std::uint64_t{1} : 0};
    if (!disks_.empty()) {
      own.first = disks_.front().id;
      own.last = disks_.back().id;
    }
    std::optional<OrderOfRows> before;
    for (Message const& bytes : all_gather(processes_, message_of(own))) {
      auto const next = MessageReader(bytes).next<OrderOfRows>();
      if (next.count == 0) continue;
      if (next.ascends == 0 || (before && before->last >= next.first)) return false;
      if (!xyz::are_plain(next.first, next.last, head_.count)) return false;
      before = next;
    }
    return true;
  }

  /// Returns the wrong Id with the lowest slot, the same that a single process would find.
  [[nodiscard]] std::optional<xyz::WrongId> find_wrong_id() const {
    std::vector<xyz::IdOfRow> ids;
    ids.reserve(disks_.size());
    std::uint64_t const first_row = rows_.first(processes_.rank());
    exchange_values<xyz::IdOfRow>(
        processes_, disks_.size(),
        [&](std::size_t k, auto give) {
          Id const id = disks_[k].id;
          give(process_of_slot(xyz::slot_of(id), processes_.count()), xyz::IdOfRow{.id = id, .row = first_row + k});
        },
        [&](xyz::IdOfRow const& id) { ids.push_back(id); });
    std::vector<xyz::WrongId> own;
    if (auto const wrong = xyz::find_wrong_id(ids, head_.count)) own.push_back(*wrong);
    std::optional<xyz::WrongId> lowest;
    for (Message const& bytes : all_gather(processes_, message_of_all(std::span<xyz::WrongId const>(own)))) {
      for (xyz::WrongId const& wrong : MessageReader(bytes).rest<xyz::WrongId>()) {
        if (!lowest || xyz::slot_of(wrong.id) < xyz::slot_of(lowest->id)) lowest = wrong;
      }
    }
    return lowest;
  }

  Communicator& processes_;
  FileHead head_;
  AskedRadii asked_;
  RowDivision rows_;            ///< division of the file's rows, and after sort() of the sorted rows
  std::vector<DiskRow> disks_;  ///< disks of this process
};

}  // namespace

RowsOfFile read_together(Communicator& processes, DisksSettings const& settings, StartFile const& file) {
  bool const is_root = processes.rank() == 0;
  Message head;
  if (is_root) head = message_of(head_of(*file.reader));
  PartOfStart part(processes, MessageReader(broadcast(processes, std::move(head))).next<FileHead>(),
                   AskedRadii(settings));
  agree(processes, [&] { is_root ? part.hand_out(*file.reader, settings) : part.receive(); });
  auto const wrong = part.sort();
  agree(processes, [&] {
    if (wrong && is_root) file.reader->refuse(*wrong);
  });
  RowsOfFile rows = part.finish();
  StartFileSummary const summary = part.summary(rows.own);
  agree(processes, [&] {
    if (is_root) file.take_summary(summary);
  });
  return rows;
}

}  // namespace gridlock
