#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"

namespace gridlock {

inline constexpr double two_pi = 2.0 * std::numbers::pi;

/// Returns n xy/L_x: in an oblique box the wave vectors of column n are (2π n/L_x, 2π (m − n xy/L_x)/L_y).
inline double lean(Box const& box, std::int64_t column) {
  return static_cast<double>(column) * box.shift() / box.width();
}

/// exp(i q·r_j) of all points, for the wave vectors of one column of a box, row by row.
class PlaneWaves {
 public:
  PlaneWaves(Box const& box, std::span<double const> x, std::span<double const> y, std::int64_t column,
             std::int64_t row) {
    for (std::size_t j = 0; j < x.size(); ++j) {
      double const turn = two_pi / box.height() * y[j];
      double const start = two_pi / box.width() * static_cast<double>(column) * x[j] +
                           (static_cast<double>(row) - lean(box, column)) * turn;
      real_.push_back(std::cos(start));
      imaginary_.push_back(std::sin(start));
      step_real_.push_back(std::cos(turn));
      step_imaginary_.push_back(std::sin(turn));
    }
  }

  void next_row() {
    for (std::size_t j = 0; j < real_.size(); ++j) {
      double const real = real_[j] * step_real_[j] - imaginary_[j] * step_imaginary_[j];
      imaginary_[j] = real_[j] * step_imaginary_[j] + imaginary_[j] * step_real_[j];
      real_[j] = real;
    }
  }

  /// Calls add(sum of the real parts, sum of the imaginary parts) of points first … end − 1.
  template <class Add>
  void sum(std::size_t first, std::size_t end, Add add) const {
    double real = 0.0;
    double imaginary = 0.0;
    for (std::size_t j = first; j < end; ++j) {
      real += real_[j];
      imaginary += imaginary_[j];
    }
    add(real, imaginary);
  }

 private:
  std::vector<double> real_;
  std::vector<double> imaginary_;
  std::vector<double> step_real_;
  std::vector<double> step_imaginary_;
};

}  // namespace gridlock
