#include "packing/hessian.hpp"

#include <algorithm>
#include <numeric>

namespace gridlock {

HessianBlock block_of(Contact const& contact, Potential potential, bool is_at_wall) {
  double const stiffness = stiffness_of(contact, potential);
  // A wall is straight: the direction of its force does not change as the disk slides along.
  double const stress = is_at_wall ? 0.0 : force_of(contact, potential) / contact.distance;
  Vector const n = contact.normal;
  double const along = stiffness + stress;
  return {.xx = along * n.x * n.x - stress, .xy = along * n.x * n.y, .yy = along * n.y * n.y - stress};
}

Unknowns::Unknowns(std::size_t all) : place(all), disks(all) {
  std::iota(place.begin(), place.end(), std::uint32_t{0});
}

Unknowns::Unknowns(std::vector<bool> const& takes_part) : place(takes_part.size(), none) {
  for (std::size_t i = 0; i < takes_part.size(); ++i) {
    if (takes_part[i]) place[i] = static_cast<std::uint32_t>(disks++);
  }
}

std::vector<HessianEntry> hessian_entries(std::span<Contact const> contacts, Potential potential,
                                          Unknowns const& unknowns) {
  std::size_t const all = unknowns.place.size();
  std::vector<HessianBlock> diagonal(unknowns.disks);
  std::vector<HessianEntry> entries;
  entries.reserve(4 * contacts.size() + 3 * unknowns.disks);
  for (Contact const& contact : contacts) {
    if (contact.overlap() <= 0.0) continue;
    bool const is_at_wall = contact.second >= all;
    HessianBlock const block = block_of(contact, potential, is_at_wall);
    std::uint32_t const a = unknowns.place[contact.first];
    std::uint32_t const b = is_at_wall ? Unknowns::none : unknowns.place[contact.second];
    if (a != Unknowns::none) diagonal[a] += block;
    if (b != Unknowns::none) diagonal[b] += block;
    if (a == Unknowns::none || b == Unknowns::none) continue;
    // Indices of unknowns ascend with those of disks, so b > a: the block is below the diagonal.
    auto const row = static_cast<int>(2 * b);
    auto const column = static_cast<int>(2 * a);
    entries.emplace_back(row, column, -block.xx);
    entries.emplace_back(row + 1, column, -block.xy);
    entries.emplace_back(row, column + 1, -block.xy);
    entries.emplace_back(row + 1, column + 1, -block.yy);
  }
  for (std::size_t k = 0; k < diagonal.size(); ++k) {
    auto const row = static_cast<int>(2 * k);
    entries.emplace_back(row, row, diagonal[k].xx);
    entries.emplace_back(row + 1, row, diagonal[k].xy);
    entries.emplace_back(row + 1, row + 1, diagonal[k].yy);
  }
  return entries;
}

SparseMatrix hessian_of(std::vector<HessianEntry> const& entries, std::size_t sites) {
  auto const size = static_cast<Eigen::Index>(2 * sites);
  SparseMatrix hessian(size, size);
  hessian.setFromTriplets(entries.begin(), entries.end());
  return hessian;
}

SparseMatrix hessian_of(std::span<Contact const> contacts, Potential potential, Unknowns const& unknowns) {
  return hessian_of(hessian_entries(contacts, potential, unknowns), unknowns.disks);
}

}  // namespace gridlock
