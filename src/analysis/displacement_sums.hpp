#pragma once

#include <cstddef>

#include "analysis/bessel_table.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

constexpr std::size_t lane_count = 8;

/// Eight numbers in registers of any width. Lanes are summed singly, so sums have the same bits with every compiler.
using Eight = double __attribute__((vector_size(lane_count * sizeof(double)), aligned(alignof(double))));

/// Sums over agents in lanes: agent k is added to lane k modulo the number of lanes.
struct Lanes {
  Eight squares{};
  Eight fourths{};
  Eight near{};

  [[nodiscard]] double all_near() const {
    return ((near[0] + near[1]) + (near[2] + near[3])) + ((near[4] + near[5]) + (near[6] + near[7]));
  }
};

/// Sums over agents, with all lanes added up.
struct Sums {
  double squares = 0.0;
  double fourths = 0.0;
  double near = 0.0;
  double scattering = 0.0;

  void add(Lanes const& lanes) {
    for (std::size_t l = 0; l < lane_count; ++l) {
      squares += lanes.squares[l];
      fourths += lanes.fourths[l];
      near += lanes.near[l];
    }
  }
};

/// The coordinates of a block of agents in two frames.
struct Displacements {
  double const* x0;
  double const* y0;
  double const* x1;
  double const* y1;
  std::size_t count;

  [[nodiscard]] double squared(std::size_t k) const { return squared_length({x1[k] - x0[k], y1[k] - y0[k]}); }
};

/// The fastest functions of this processor that sum over displacements; all processors get the same bits.
struct DisplacementKernels {
  /// Adds Δr², Δr⁴ and the number of agents with Δr² ≤ the squared overlap length.
  void (*add)(Displacements const& moved, double squared_overlap, Lanes& lanes);
  /// Adds J₀(q |Δr|).
  void (*add_scattering)(Displacements const& moved, double squared_q, BesselTable const& table, Eight& sums);
};

DisplacementKernels fastest_displacement_kernels();

}  // namespace gridlock
