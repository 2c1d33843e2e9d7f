#include "observe/mean_over_runs.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

namespace gridlock {

Estimate mean_over_runs(std::span<double const> values) {
  assert(!values.empty());
  std::vector<Block> runs;
  for (double const value : values) runs.push_back({.sum = value, .weight = 1.0});
  return *estimate_from(runs);
}

CombinedEstimate combine(std::span<Estimate const> runs) {
  assert(!runs.empty());
  std::vector<double> values;
  for (Estimate const& run : runs) values.push_back(run.value);
  CombinedEstimate result{
      .mean = mean_over_runs(values), .error_by_scatter = {}, .error_by_runs = {}, .chi_squared = {}};
  result.error_by_scatter = result.mean.error;
  bool const have_errors =
      std::ranges::all_of(runs, [](Estimate const& run) { return run.error && std::isfinite(*run.error); });
  if (have_errors) {
    double squares = 0.0;
    double chi_squared = 0.0;
    for (Estimate const& run : runs) {
      squares += *run.error * *run.error;
      double const deviation = run.value - result.mean.value;
      if (deviation != 0.0) chi_squared += deviation * deviation / (*run.error * *run.error);
    }
    result.error_by_runs = std::sqrt(squares) / static_cast<double>(runs.size());
    result.chi_squared = chi_squared;
  }
  // An absent error compares as less than any other.
  result.mean.error = std::max(result.error_by_scatter, result.error_by_runs);
  return result;
}

}  // namespace gridlock
