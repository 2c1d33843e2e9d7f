#pragma once

/// \file
/// A frame: all agents with all columns at one step, as files store them.
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
#include "gridlock/core/field.hpp"
#include "gridlock/core/network.hpp"
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

/// The agents of any model at one time with named columns, for writing, drawing and export.
///
/// Rows are in the order of the Ids: frames of equal agents are equal, even if the agents were in another order in
/// memory.
struct Frame {
  Box box;
  Clock clock;
  std::uint64_t seed = 0;
  std::vector<Id> ids;
  std::vector<FrameColumn> columns;
  std::vector<Field> fields = {};      ///< numbers over the box, in the order of their names
  std::vector<Network> networks = {};  ///< edges between the agents, in the order of their names

  [[nodiscard]] std::size_t size() const { return ids.size(); }
  /// Returns the column named `name`, or nullptr.
  [[nodiscard]] FrameColumn const* find(std::string_view name) const;

  friend bool operator==(Frame const&, Frame const&) = default;
};

/// The contacts between agents at one time, with their forces.
struct FrameContacts {
  Clock clock;
  std::vector<Id> ids;         ///< of the agents in contact: two for each contact
  std::vector<double> forces;  ///< one for each contact

  [[nodiscard]] std::size_t size() const { return forces.size(); }

  friend bool operator==(FrameContacts const&, FrameContacts const&) = default;
};

/// Copies agents with all columns to a frame without fields and networks. Cost: one copy, and a sort of the Ids unless
/// they are in order.
Frame frame_of(Box const& box, Clock const& clock, std::uint64_t seed, AgentsView const& agents);

/// Copies the agents of a world with all columns, its fields and its networks, to a frame.
template <class Model>
Frame frame_of(World<Model> const& world) {
  Frame frame = frame_of(world.box, world.clock, world.seed, world.agents);
  frame.fields = world.fields;
  frame.networks = world.networks;
  return frame;
}

}  // namespace gridlock
