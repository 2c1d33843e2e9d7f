#include "observe/displacement.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "observe/mobile.hpp"

namespace gridlock {

std::vector<ColumnInfo> Displacement::columns() const {
  return {
      {"mean_displacement", "sides of the box", "Mean distance of the agents from where they started."},
      {"mean_squared_displacement", "length²", "Mean squared distance of the agents from where they started."},
      {"centre_displacement", "sides of the box",
       "Distance of the centre of the agents from where it started; no physics in a periodic box under a time step."}};
}

Requirements Displacement::requirements(Box const& box) const {
  Requirements required{.columns = {X::name, Y::name}};
  // Without image columns it is unknown how often an agent has crossed the box.
  if (box.is_periodic_x()) required.columns.push_back(ImageX::name);
  if (box.is_periodic_y()) required.columns.push_back(ImageY::name);
  return required;
}

void Displacement::begin(Snapshot const& start) {
  Sites const sites(start.box, start.agents);
  sites_ = start.attached<Site>([&](std::size_t i) { return sites[i]; });
  blocks_ = IdBlocks(start, sites_.agents());
  length_ = {};
  squared_length_ = {};
  centre_ = {};
}

void Displacement::sample(Snapshot const& now, std::span<double> row, bool) {
  Box const& box = now.box;
  double const side = box.side();
  auto const ids = now.agents.ids();
  Sites const sites(now.box, now.agents);
  MobileAgents const mobile(now.agents);
  enum Sum : std::size_t { of_length, of_square, of_x, of_y, sums };
  SumsOfBlocks<agent_blocks, sums> terms;
  std::array<std::uint64_t, agent_blocks> counts{};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Site const* const from = sites_.find(ids[i], i);
    if (from == nullptr || !mobile.has(i)) continue;
    Vector const moved = sites.moved(*from, i);
    double const squared = squared_length(moved);
    std::size_t const block = blocks_.block_of(ids[i]);
    terms.add(block, {std::sqrt(squared) / side, squared, moved.x, moved.y});
    ++counts[block];
  }
  std::vector<ExactSum> of_blocks = terms.take_all();
  now.sum(of_blocks);
  now.counts(counts);
  ExactSum x_of_all;
  ExactSum y_of_all;
  double count = 0.0;
  for (std::size_t block = 0; block < agent_blocks; ++block) {
    auto const of_block = std::span(of_blocks).subspan(block * sums, sums);
    auto const weight = static_cast<double>(counts[block]);
    length_[block] = {of_block[of_length].value(), weight};
    squared_length_[block] = {of_block[of_square].value(), weight};
    x_of_all.add(of_block[of_x]);
    y_of_all.add(of_block[of_y]);
    count += weight;
  }
  double const length_of_sum = std::sqrt(squared_length({x_of_all.value(), y_of_all.value()}));
  centre_ = {length_of_sum / side, count};
  auto const length = estimate_from(length_);
  auto const squared_length = estimate_from(squared_length_);
  row[0] = length ? length->value : no_value;
  row[1] = squared_length ? squared_length->value : no_value;
  row[2] = count > 0.0 ? centre_.sum / centre_.weight : no_value;
}

std::vector<NamedEstimate> Displacement::results() const {
  std::vector<NamedEstimate> results;
  std::vector<ColumnInfo> const infos = columns();
  if (auto const estimate = estimate_from(length_)) results.push_back({infos[0].name, *estimate, infos[0].unit});
  if (auto const estimate = estimate_from(squared_length_)) {
    results.push_back({infos[1].name, *estimate, infos[1].unit});
  }
  if (auto const estimate = estimate_from({&centre_, 1})) results.push_back({infos[2].name, *estimate, infos[2].unit});
  return results;
}

void Displacement::serialize(Archive& archive) {
  gridlock::serialize(archive, "length", length_);
  gridlock::serialize(archive, "squared_length", squared_length_);
  gridlock::serialize(archive, "centre", std::span(&centre_, 1));
}

}  // namespace gridlock
