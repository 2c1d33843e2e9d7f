#pragma once

/// \file
/// A frame that is handed out in pieces, so that nobody has to hold the whole.
///
/// ```cpp
/// auto const largest_x = [](FrameSource const& frame) {
///   double largest = 0.0;
///   for (std::size_t first = 0; first < frame.size(); first += 1000) {
///     FrameValues const piece = frame.values(0, first, std::min<std::size_t>(1000, frame.size() - first));
///     for (double const x : std::get<std::vector<double>>(piece)) largest = std::max(largest, x);
///   }
///   return largest;
/// };
/// ```

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/frame.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// A population of any kind at one time, as a Frame is, whose rows are handed out in pieces, any of them in any order.
///
/// Rows are in the order of the Ids. Where they come from may be other processes: ask for long pieces, from one thread.
class FrameSource {
 public:
  FrameSource(FrameSource const&) = delete;
  FrameSource& operator=(FrameSource const&) = delete;
  virtual ~FrameSource() = default;

  [[nodiscard]] Box const& box() const { return head_.box; }
  [[nodiscard]] Clock const& clock() const { return head_.clock; }
  [[nodiscard]] std::uint64_t seed() const { return head_.seed; }
  /// The agents.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The names of the columns, and their types: FrameColumn::values has the type of the column and is empty.
  [[nodiscard]] std::vector<FrameColumn> const& columns() const { return head_.columns; }
  /// The place of a column among them, or nothing.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;

  /// The Ids of rows first … first + count − 1. Requires that there are such rows.
  [[nodiscard]] virtual std::vector<Id> ids(std::size_t first, std::size_t count) const = 0;
  /// The values of these rows in a column. Requires that there is such a column.
  [[nodiscard]] virtual FrameValues values(std::size_t column, std::size_t first, std::size_t count) const = 0;

  /// These rows with all columns.
  [[nodiscard]] Frame piece(std::size_t first, std::size_t count) const;
  /// All rows.
  [[nodiscard]] Frame whole() const { return piece(0, size()); }

 protected:
  /// Makes the source of so many agents from a frame without rows that has the box, clock, seed and columns.
  FrameSource(Frame head, std::size_t size) : head_(std::move(head)), size_(size) {}

 private:
  Frame head_;
  std::size_t size_;
};

/// Agents in memory. Valid as long as the view is. Cost: a sort of the Ids unless they are in order; no copy.
std::unique_ptr<FrameSource> frame_source_of(Box const& box, Clock const& clock, std::uint64_t seed,
                                             AgentsView const& agents);
/// A world, as long as no agent of it is born, dies or moves to another row.
template <class Model>
std::unique_ptr<FrameSource> frame_source_of(World<Model> const& world) {
  return frame_source_of(world.box, world.clock, world.seed, world.agents);
}
/// A frame that must outlive its source.
std::unique_ptr<FrameSource> frame_source_of(Frame const& frame);

/// The use that somebody makes of a frame.
using UseFrame = std::function<void(FrameSource const&)>;

/// The same with these columns only, by their places, in this order. The frame must outlive it.
std::unique_ptr<FrameSource> with_columns(FrameSource const& frame, std::vector<std::size_t> columns);

/// Calls visit(first, count) for pieces of at most so many rows that make up all, one after the other.
template <class Visit>
void for_each_piece(std::size_t rows, std::size_t max_rows, Visit visit) {
  for (std::size_t first = 0; first < rows; first += max_rows) visit(first, std::min(max_rows, rows - first));
}

}  // namespace gridlock
