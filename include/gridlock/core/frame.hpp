#pragma once

/// \file
/// All agents and all columns at one step, as they are written to files and read back.
///
/// ```cpp
/// #include "gridlock/core/disks.hpp"
///
/// Population<X, Y> points;
/// points.add(0.25, 0.5);
/// Frame const frame = frame_of(Box(1.0, 1.0, Edge::wall), Clock{}, 7, points);
/// FrameColumn const* const x = frame.find("x");
/// ```

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// The values of one column, a number for each agent.
using FrameValues = std::variant<std::vector<double>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                                 std::vector<std::uint64_t>>;

struct FrameColumn {
  std::string name;  ///< the name of the column's tag, for example "velocity_x"
  FrameValues values;

  friend bool operator==(FrameColumn const&, FrameColumn const&) = default;
};

/// A population of any kind at one time, its columns known by name: what is written, drawn and exported.
///
/// Rows are in the order of the Ids, so that two frames of the same agents are the same whatever the order of the rows
/// in memory was.
struct Frame {
  Box box;
  Clock clock;
  std::uint64_t seed = 0;
  std::vector<Id> ids;
  std::vector<FrameColumn> columns;

  [[nodiscard]] std::size_t size() const { return ids.size(); }
  /// The column of that name, or nothing.
  [[nodiscard]] FrameColumn const* find(std::string_view name) const;

  friend bool operator==(Frame const&, Frame const&) = default;
};

/// The contacts between agents at one time, with their forces.
struct FrameContacts {
  Clock clock;
  std::vector<Id> ids;         ///< two for each contact
  std::vector<double> forces;  ///< of each contact

  [[nodiscard]] std::size_t size() const { return forces.size(); }

  friend bool operator==(FrameContacts const&, FrameContacts const&) = default;
};

/// Agents as a frame, every column of them. Cost: a sort of the Ids unless they are in order, and a copy.
Frame frame_of(Box const& box, Clock const& clock, std::uint64_t seed, AgentsView const& agents);

/// A world as a frame.
template <class Model>
Frame frame_of(World<Model> const& world) {
  return frame_of(world.box, world.clock, world.seed, world.agents);
}

}  // namespace gridlock
