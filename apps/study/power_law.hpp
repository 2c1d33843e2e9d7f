#pragma once

#include <optional>
#include <span>
#include <vector>

#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// One measured point of a power law: y at x_1, x_2, …; all positive.
struct PowerLawPoint {
  std::vector<double> x;
  double y = 0.0;
};

/// y = c · x_1^p_1 · x_2^p_2 · …
struct PowerLaw {
  double prefactor = 0.0;
  std::vector<Estimate> exponents;
};

/// The power law nearest to the points, by least squares of ln y, all points alike.
///
/// Errors of the exponents come from the scatter of the points about the law, so they are absent where there are no more
/// points than parameters. Where the points follow no power law they measure the misfit, not noise.
/// Absent for fewer points than parameters or where the points do not fix all exponents (one x never changes).
/// Contract: every point has the same number of x (asserted).
std::optional<PowerLaw> fit_power_law(std::span<PowerLawPoint const> points);

}  // namespace gridlock
