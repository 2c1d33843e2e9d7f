#include "study/distance_checks.hpp"

#include <vector>

#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

namespace {

double squared(double x) { return x * x; }

}  // namespace

double paper_checks(std::uint64_t disks, std::uint64_t k) {
  return 9.0 * squared(static_cast<double>(disks) / static_cast<double>(k));
}

double mean_block_size(std::uint64_t k) {
  double const side = static_cast<double>(k);
  return squared((3.0 * side - 2.0) / side);
}

double uniform_checks(std::uint64_t disks, std::uint64_t k) {
  double const n = static_cast<double>(disks);
  return n * (n - 1.0) * mean_block_size(k) / squared(static_cast<double>(k));
}

std::uint64_t checks_of_one_look(State const& state, std::uint64_t k) {
  CellLayout const layout(state.box, k, k);
  std::vector<std::uint64_t> disks_in(static_cast<std::size_t>(layout.count()), 0);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    ++disks_in[static_cast<std::size_t>(layout.cell_of(position(state.agents, i)))];
  }
  std::uint64_t checks = 0;
  for (int cell = 0; cell < layout.count(); ++cell) {
    std::uint64_t const here = disks_in[static_cast<std::size_t>(cell)];
    if (here == 0) continue;
    std::uint64_t in_block = 0;
    layout.for_each_cell_in_block(cell, 1, 1, [&](int c) { in_block += disks_in[static_cast<std::size_t>(c)]; });
    checks += here * (in_block - 1);
  }
  return checks;
}

}  // namespace gridlock
