#include "engine/soft/disks.hpp"

#include <limits>
#include <utility>

#include "gridlock/core/detail/rows_in_order.hpp"

namespace gridlock::soft {

Disks::Disks(State const& state) {
  gridlock::Disks const& agents = state.agents;
  std::vector<std::uint32_t> const order = rows_in_order(agents.ids());
  for (std::size_t k = 0; k < order.size(); ++k) {
    std::uint32_t const row = order[k];
    places.push_back(position(agents, row));
    motions.push_back({.velocity = velocity(agents, row), .force = {}, .listed_at = {}});
    identities.push_back({.id = agents.ids()[row],
                          .radius = agents.column<Radius>()[row],
                          .mass = agents.column<Mass>()[row],
                          .row_in_state = row,
                          .id_index = static_cast<std::uint32_t>(k),
                          .image_x = agents.column<ImageX>()[row],
                          .image_y = agents.column<ImageY>()[row]});
  }
  constexpr double far = std::numeric_limits<double>::infinity();
  places.push_back({far, far});
}

void Disks::reorder(std::span<std::uint32_t const> order) {
  UninitializedArray<Vector> new_places(places.size());
  UninitializedArray<Motion> new_motions(motions.size());
  UninitializedArray<Identity> new_identities(identities.size());
  for (std::size_t row = 0; row < order.size(); ++row) {
    new_places[row] = places[order[row]];
    new_motions[row] = motions[order[row]];
    new_identities[row] = identities[order[row]];
  }
  new_places[size()] = places[size()];
  places = std::move(new_places);
  motions = std::move(new_motions);
  identities = std::move(new_identities);
}

void Disks::write_back(State& state) const {
  gridlock::Disks& agents = state.agents;
  for (std::size_t row = 0; row < size(); ++row) {
    Identity const& identity = identities[row];
    std::uint32_t const to = identity.row_in_state;
    agents.column<X>()[to] = places[row].x;
    agents.column<Y>()[to] = places[row].y;
    agents.column<VelocityX>()[to] = motions[row].velocity.x;
    agents.column<VelocityY>()[to] = motions[row].velocity.y;
    agents.column<ImageX>()[to] = identity.image_x;
    agents.column<ImageY>()[to] = identity.image_y;
  }
}

}  // namespace gridlock::soft
