#pragma once

/// \file
/// A frame that is read in pieces, so that it need not fit into memory.
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
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/frame.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// The agents of any model at one time, like a Frame, but read in ranges of rows, any rows in any order.
///
/// Rows are in the order of the Ids. A call may fetch rows from other processes: read long ranges, from one thread
/// only.
class FrameSource {
 public:
  FrameSource(FrameSource const&) = delete;
  FrameSource& operator=(FrameSource const&) = delete;
  virtual ~FrameSource() = default;

  [[nodiscard]] Box const& box() const { return head_.box; }
  [[nodiscard]] Clock const& clock() const { return head_.clock; }
  [[nodiscard]] std::uint64_t seed() const { return head_.seed; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Returns the fields, which only whole() copies, as it does the networks.
  [[nodiscard]] std::span<Field const> fields() const { return fields_; }
  [[nodiscard]] std::span<Network const> networks() const { return networks_; }
  /// Returns the names and types of the columns: FrameColumn::values is empty and has the type of the column.
  [[nodiscard]] std::vector<FrameColumn> const& columns() const { return head_.columns; }
  /// Returns the index in columns() of the column named `name`, or nothing.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;

  /// Returns the Ids of rows first … first + count − 1. Contract: these rows exist.
  [[nodiscard]] virtual std::vector<Id> ids(std::size_t first, std::size_t count) const = 0;
  /// Returns the values of rows first … first + count − 1 in a column. Contract: the rows and the column exist.
  [[nodiscard]] virtual FrameValues values(std::size_t column, std::size_t first, std::size_t count) const = 0;

  /// Returns rows first … first + count − 1 with all columns.
  [[nodiscard]] Frame piece(std::size_t first, std::size_t count) const;
  [[nodiscard]] Frame whole() const;

 protected:
  /// Makes a source of `size` agents; `head` is a frame without rows that has the box, clock, seed and columns.
  FrameSource(Frame head, std::size_t size, std::span<Field const> fields, std::span<Network const> networks)
      : head_(std::move(head)), size_(size), fields_(fields), networks_(networks) {}

 private:
  Frame head_;
  std::size_t size_;
  std::span<Field const> fields_;
  std::span<Network const> networks_;
};

/// Makes a source of agents in memory, valid as long as `agents`, `fields` and `networks` are. Cost: a sort of the Ids
/// unless they are in order.
std::unique_ptr<FrameSource> frame_source_of(Box const& box, Clock const& clock, std::uint64_t seed,
                                             AgentsView const& agents, std::span<Field const> fields = {},
                                             std::span<Network const> networks = {});
/// Makes a source of the agents of a world, valid as long as no agent is born, dies or moves to another row.
template <class Model>
std::unique_ptr<FrameSource> frame_source_of(World<Model> const& world) {
  return frame_source_of(world.box, world.clock, world.seed, world.agents, world.fields, world.networks);
}
/// Makes a source of the rows of a frame. Contract: the frame outlives the source.
std::unique_ptr<FrameSource> frame_source_of(Frame const& frame);

/// A function that reads a frame, for example to write it to a file.
using UseFrame = std::function<void(FrameSource const&)>;

/// Makes a source of some columns of a frame, in the order of the indices `columns`. Contract: the frame outlives it.
std::unique_ptr<FrameSource> with_columns(FrameSource const& frame, std::vector<std::size_t> columns);

/// Calls visit(first, count) for consecutive ranges of at most max_rows rows, which together are all rows.
template <class Visit>
void for_each_piece(std::size_t rows, std::size_t max_rows, Visit visit) {
  for (std::size_t first = 0; first < rows; first += max_rows) visit(first, std::min(max_rows, rows - first));
}

}  // namespace gridlock
