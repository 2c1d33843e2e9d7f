#include "observe/mean_over_runs.hpp"

#include <cassert>
#include <vector>

namespace gridlock {

Estimate mean_over_runs(std::span<double const> values) {
  assert(!values.empty());
  std::vector<Block> runs;
  for (double const value : values) runs.push_back({.sum = value, .weight = 1.0});
  return *estimate_from(runs);
}

}  // namespace gridlock
