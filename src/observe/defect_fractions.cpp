#include "observe/defect_fractions.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/voronoi.hpp"
#include "gridlock/observe/defects.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

namespace {

/// Returns the places of all agents of all processes, in the order of their coordinates.
std::vector<Vector> sorted_places(Snapshot const& now) {
  auto const x = now.agents.column<X>();
  auto const y = now.agents.column<Y>();
  std::vector<Vector> places;
  for (std::size_t i = 0; i < now.agents.size(); ++i) places.push_back({x[i], y[i]});
  Communicator& processes = now.processes.communicator();
  if (processes.count() > 1) {
    std::vector<Message> const messages = all_gather(processes, message_of_all(std::span<Vector const>(places)));
    places.clear();
    for (Message const& message : messages) {
      std::vector<Vector> const some = MessageReader(message).rest<Vector>();
      places.insert(places.end(), some.begin(), some.end());
    }
  }
  std::ranges::sort(places, {}, [](Vector const& place) { return std::pair(place.x, place.y); });
  return places;
}

}  // namespace

void DefectFractions::begin(Snapshot const& start) {
  if (!start.box.is_periodic()) {
    throw Error(Problem{.what = "observe.defects_every needs a box that is periodic in x and y",
                        .hint = "between walls leave it out: gridlock.defects() finds the defects inside",
                        .key = "observe.defects_every"});
  }
  reset({{"defect_fraction", "", "Share of the agents whose Voronoi cell has not six sides."},
         {"disclination_fraction", "", "Share of the agents that are single defects with five or seven neighbours."},
         {"dislocation_fraction", "", "Share of the agents in pairs of defects with five and seven neighbours."},
         {"dislocation_pair_fraction", "",
          "Share of the agents in clusters of defects such as 5-7-5-7 and 5-8-5: bound dislocations, vacancies, "
          "interstitials."},
         {"other_defect_fraction", "", "Share of the agents in all other clusters of defects."}});
  schedule_.reset();
}

void DefectFractions::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  std::ranges::fill(row, no_value);
  if (!schedule_.is_due(counts_for_average) || now.count() == 0) return;
  std::vector<Vector> const places = sorted_places(now);
  PointsInMemory const points{.x = &places[0].x, .y = &places[0].y, .count = places.size(), .stride = 2};
  Defects const defects = find_defects(now.box, points, find_voronoi_cells(now.box, points).neighbours);
  auto const all = static_cast<double>(places.size());
  row[0] = static_cast<double>(defects.points) / all;
  for (std::size_t kind = 0; kind < defect_kinds; ++kind) {
    row[1 + kind] = static_cast<double>(defects.points_in(static_cast<DefectKind>(kind))) / all;
  }
  if (!counts_for_average) return;
  for (std::size_t column = 0; column < row.size(); ++column) average(column, row[column]);
}

void DefectFractions::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  schedule_.serialize(archive);
}

}  // namespace gridlock
