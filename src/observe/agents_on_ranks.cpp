#include "observe/agents_on_ranks.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/add_up_over_ranks.hpp"
#include "gridlock/core/detail/agent_homes.hpp"
#include "gridlock/core/detail/exchange.hpp"

namespace gridlock {

namespace {

/// The rows of a layout, or its columns: whichever there are more of.
class Lines {
 public:
  Lines(CellLayout const& layout, double cutoff)
      : layout_(layout),
        are_rows_(layout.rows() >= layout.columns()),
        rim_(are_rows_ ? layout.rows_within(cutoff) : layout.columns_within(cutoff)) {}

  [[nodiscard]] int count() const { return are_rows_ ? layout_.rows() : layout_.columns(); }
  [[nodiscard]] int line_of(double x, double y) const { return are_rows_ ? layout_.row_of(y) : layout_.column_of(x); }
  [[nodiscard]] int rim() const { return rim_; }

  /// Lines begin … end − 1 with the rim around them.
  [[nodiscard]] CellWindow window(int begin, int end) const {
    CellWindow window{.first_column = 0, .end_column = layout_.columns(), .first_row = 0, .end_row = layout_.rows()};
    if (are_rows_) {
      window.first_row = begin - rim_;
      window.end_row = end + rim_;
    } else {
      window.first_column = begin - rim_;
      window.end_column = end + rim_;
    }
    return within(layout_, window);
  }
  /// The line beyond an edge, around a periodic box; −1 for none.
  [[nodiscard]] int image(int line) const {
    if (line >= 0 && line < count()) return line;
    return layout_.is_periodic() ? (line + 2 * count()) % count() : -1;
  }

 private:
  CellLayout const& layout_;
  bool are_rows_;
  int rim_;
};

/// Where the lines of each rank begin, and the end: each rank gets about as many points.
std::vector<int> cuts_between(std::span<std::uint64_t const> points_of_lines, std::size_t ranks) {
  std::uint64_t all = 0;
  for (std::uint64_t const points : points_of_lines) all += points;
  std::vector<int> cuts{0};
  std::uint64_t before = 0;
  for (std::size_t line = 0; line < points_of_lines.size(); ++line) {
    // Rank k begins at the line in whose first half the k-th part of the points ends, or at the one after it.
    while (cuts.size() < ranks && (2 * before + points_of_lines[line]) * ranks >= 2 * all * cuts.size()) {
      cuts.push_back(static_cast<int>(line));
    }
    before += points_of_lines[line];
  }
  cuts.resize(ranks + 1, static_cast<int>(points_of_lines.size()));
  return cuts;
}

/// Which lines each rank searches, and who needs to know the points of a line for it.
class Slabs {
 public:
  Slabs(Lines const& lines, std::vector<int> cuts)
      : cuts_(std::move(cuts)), ranks_around_(static_cast<std::size_t>(lines.count())) {
    for (std::size_t rank = 0; rank + 1 < cuts_.size(); ++rank) {
      if (cuts_[rank] == cuts_[rank + 1]) continue;
      for (int k = 1; k <= lines.rim(); ++k) {
        add_around(lines.image(cuts_[rank] - k), rank);
        add_around(lines.image(cuts_[rank + 1] - 1 + k), rank);
      }
    }
  }

  [[nodiscard]] std::size_t owner(int line) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(cuts_, line) - cuts_.begin() - 1);
  }
  /// The ranks in whose rim a line lies.
  [[nodiscard]] std::span<std::size_t const> ranks_around(int line) const {
    return ranks_around_[static_cast<std::size_t>(line)];
  }

 private:
  void add_around(int line, std::size_t rank) {
    if (line < 0 || owner(line) == rank) return;
    // A rim that meets itself on the other side of the box has a line once.
    std::vector<std::size_t>& ranks = ranks_around_[static_cast<std::size_t>(line)];
    if (ranks.empty() || ranks.back() != rank) ranks.push_back(rank);
  }

  std::vector<int> cuts_;
  std::vector<std::vector<std::size_t>> ranks_around_;
};

/// A point on its way.
struct SentPoint {
  double x;
  double y;
  std::uint64_t is_of_rim;
};

}  // namespace

void AgentsOnRanks::add_up(std::span<ExactSum> sums) const { add_up_over_ranks(ranks_, sums); }

void AgentsOnRanks::add_up(std::span<std::uint64_t> counts) const { add_up_over_ranks(ranks_, counts); }

double AgentsOnRanks::least(double value) const { return least_over_ranks(ranks_, value); }

std::vector<CountedValue> AgentsOnRanks::merge(std::vector<CountedValue> values) const {
  Ranks::Bytes const all =
      merge_for_all(ranks_, message_of_all(std::span<CountedValue const>(values)),
                    [](Ranks::Bytes const& left, Ranks::Bytes const& right) {
                      std::vector<CountedValue> const first = MessageReader(left).rest<CountedValue>();
                      std::vector<CountedValue> const second = MessageReader(right).rest<CountedValue>();
                      std::vector<CountedValue> sorted;
                      std::merge(first.begin(), first.end(), second.begin(), second.end(), std::back_inserter(sorted),
                                 [](CountedValue const& a, CountedValue const& b) { return a.value < b.value; });
                      std::vector<CountedValue> merged;
                      for (CountedValue const& next : sorted) add_counted(merged, next);
                      return message_of_all(std::span<CountedValue const>(merged));
                    });
  return MessageReader(all).rest<CountedValue>();
}

PointsOfCells AgentsOnRanks::points_of_cells(CellLayout const& layout, double cutoff, std::span<double const> x,
                                             std::span<double const> y) const {
  Lines const lines(layout, cutoff);
  std::vector<int> line_of_point;
  std::vector<std::uint64_t> points_of_lines(static_cast<std::size_t>(lines.count()));
  line_of_point.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    line_of_point.push_back(lines.line_of(x[i], y[i]));
    ++points_of_lines[static_cast<std::size_t>(line_of_point.back())];
  }
  add_up(points_of_lines);
  std::vector<int> const cuts = cuts_between(points_of_lines, ranks_.count());

  Slabs const slabs(lines, cuts);
  PointsOfCells points{
      .x = {}, .y = {}, .own = 0, .window = lines.window(cuts[ranks_.rank()], cuts[ranks_.rank() + 1])};
  std::vector<SentPoint> rim;
  exchange_values<SentPoint>(
      ranks_, x.size(),
      [&](std::size_t i, auto give) {
        give(slabs.owner(line_of_point[i]), SentPoint{x[i], y[i], 0});
        for (std::size_t const rank : slabs.ranks_around(line_of_point[i])) give(rank, SentPoint{x[i], y[i], 1});
      },
      [&](SentPoint const& point) {
        if (point.is_of_rim != 0) {
          rim.push_back(point);
        } else {
          points.x.push_back(point.x);
          points.y.push_back(point.y);
        }
      });
  points.own = points.x.size();
  for (SentPoint const& point : rim) {
    points.x.push_back(point.x);
    points.y.push_back(point.y);
  }
  return points;
}

std::vector<NotedVector> AgentsOnRanks::at_home(std::vector<NotedVector> noted) const {
  std::vector<NotedVector> arrived;
  exchange_values<NotedVector>(
      ranks_, noted.size(), [&](std::size_t k, auto give) { give(home_of(noted[k].id, ranks_.count()), noted[k]); },
      [&](NotedVector const& one) { arrived.push_back(one); });
  return arrived;
}

}  // namespace gridlock
