#include "packing/steepest_descent.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "packing/hessian.hpp"

namespace gridlock {

namespace {

constexpr double max_error = 0.01;  // largest error of a step, in diameters D
constexpr double first_time = 0.1;  // duration of the first step, in D²/ε
constexpr int max_stages = 200;
constexpr double damping = 2.0 / 13.0;

/// The Chebyshev polynomial T_j and its first two derivatives at a point w.
struct Chebyshev {
  double value = 1.0;
  double slope = 0.0;
  double curvature = 0.0;

  /// Returns T_{j+1}(w) = 2 w T_j − T_{j−1}.
  static Chebyshev next(double w, Chebyshev const& here, Chebyshev const& last) {
    return {.value = 2.0 * w * here.value - last.value,
            .slope = 2.0 * here.value + 2.0 * w * here.slope - last.slope,
            .curvature = 4.0 * here.slope + 2.0 * w * here.curvature - last.curvature};
  }
  /// Returns the weight b_j of a stage.
  [[nodiscard]] double weight() const { return curvature / (slope * slope); }
};

/// Returns an upper bound of the eigenvalues of the Hessian. As (n·(u − v))² ≤ 2 (n·u)² + 2 (n·v)², it is twice the
/// largest eigenvalue of the blocks that the contacts of one disk add to its own. Stresses only lower it.
double bound_of_eigenvalues(std::span<Contact const> contacts, Potential potential, std::size_t disks) {
  std::vector<HessianBlock> blocks(disks);
  for (Contact const& contact : contacts) {
    double const stiffness = stiffness_of(contact, potential);
    Vector const n = contact.normal;
    HessianBlock const block{.xx = stiffness * n.x * n.x, .xy = stiffness * n.x * n.y, .yy = stiffness * n.y * n.y};
    blocks[contact.first] += block;
    if (contact.second < disks) blocks[contact.second] += block;
  }
  double largest = 0.0;
  for (HessianBlock const& block : blocks) {
    double const difference = 0.5 * (block.xx - block.yy);
    double const root = std::sqrt(difference * difference + block.xy * block.xy);
    largest = std::max(largest, 0.5 * (block.xx + block.yy) + root);
  }
  return 2.0 * largest;
}

}  // namespace

void SteepestDescent::restart(double diameter) {
  diameter_ = diameter;
  time_ = first_time * diameter * diameter;
}

ForceSums SteepestDescent::step(Packing& packing, SoftForces& forces, Potential potential, Columns const& velocities,
                                Columns& force) {
  from_.x = packing.x;
  from_.y = packing.y;
  double const bound = bound_of_eigenvalues(forces.contacts(packing), potential, packing.size());
  while (true) {
    // A method of s stages is stable for steps up to 0.65 (s² − 1) over the largest eigenvalue.
    double const most = (max_stages - 1.0) * (max_stages - 1.0) - 1.0;
    double const wanted = std::min(1.54 * time_ * bound, most);
    if (bound > 0.0) time_ = std::min(time_, most / (1.54 * bound));
    int const stages = std::max(2, 1 + static_cast<int>(std::sqrt(1.0 + wanted)));
    ForceSums const sums = try_step(packing, forces, stages, velocities, force);
    double const error = find_error(packing, force) / (max_error * diameter_);
    bool const is_good = error <= 1.0;
    // The error grows with the third power of the time. A fourth root is safe and gives the same bits everywhere.
    time_ *= std::clamp(0.8 / std::sqrt(std::sqrt(std::max(error, 1e-9))), 0.2, is_good ? 3.0 : 0.6);
    if (is_good) {
      // `force` may have a row more, for the box.
      std::ranges::copy(force_.x, force.x.begin());
      std::ranges::copy(force_.y, force.y.begin());
      return sums;
    }
    packing.x = from_.x;
    packing.y = from_.y;
  }
}

/// Moves by time_ from from_, where the forces are `force`; writes the forces at the end to force_.
ForceSums SteepestDescent::try_step(Packing& packing, SoftForces& forces, int stages, Columns const& velocities,
                                    Columns const& force) {
  std::size_t const disks = packing.size();
  double const w = 1.0 + damping / (stages * stages);
  std::vector<Chebyshev> polynomials{{}, {.value = w, .slope = 1.0}};
  for (int j = 2; j <= stages; ++j) polynomials.push_back(Chebyshev::next(w, polynomials[j - 1], polynomials[j - 2]));
  double const w_1 = polynomials.back().slope / polynomials.back().curvature;
  auto const weight = [&](int j) {
    return j == 0 ? polynomials[2].weight() : j == 1 ? 1.0 / w : polynomials[j].weight();
  };
  before_.x = packing.x;
  before_.y = packing.y;
  double const first = weight(1) * w_1 * time_;
  for (std::size_t i = 0; i < disks; ++i) {
    packing.x[i] += first * force.x[i];
    packing.y[i] += first * force.y[i];
  }
  for (int j = 2; j <= stages; ++j) {
    forces.evaluate(packing, velocities, force_);
    double const here = 2.0 * weight(j) * w / weight(j - 1);
    double const last = -weight(j) / weight(j - 2);
    double const start = 1.0 - here - last;
    double const push = 2.0 * weight(j) * w_1 / weight(j - 1) * time_;
    double const first_push = (weight(j - 1) * polynomials[j - 1].value - 1.0) * push;
    for (std::size_t i = 0; i < disks; ++i) {
      after_.x[i] =
          start * from_.x[i] + here * packing.x[i] + last * before_.x[i] + push * force_.x[i] + first_push * force.x[i];
      after_.y[i] =
          start * from_.y[i] + here * packing.y[i] + last * before_.y[i] + push * force_.y[i] + first_push * force.y[i];
    }
    std::swap(before_.x, packing.x);
    std::swap(before_.y, packing.y);
    std::swap(packing.x, after_.x);
    std::swap(packing.y, after_.y);
  }
  return forces.evaluate(packing, velocities, force_);
}

/// Returns the largest error of a disk's position in a step.
double SteepestDescent::find_error(Packing const& packing, Columns const& force) const {
  double square = 0.0;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    double const x = 0.8 * (from_.x[i] - packing.x[i]) + 0.4 * time_ * (force.x[i] + force_.x[i]);
    double const y = 0.8 * (from_.y[i] - packing.y[i]) + 0.4 * time_ * (force.y[i] + force_.y[i]);
    square = std::max(square, x * x + y * y);
  }
  return std::sqrt(square);
}

void SteepestDescent::serialize(Archive& archive) {
  archive.visit("diameter", diameter_);
  archive.visit("time", time_);
}

}  // namespace gridlock
