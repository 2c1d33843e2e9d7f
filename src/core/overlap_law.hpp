#pragma once

#include <cmath>

namespace gridlock {

/// The potentials of disks that repel each other where they overlap, and their derivatives, as functions of the overlap
/// δ and the contact distance σ; all are 0 without overlap. Only square roots are used, so that every compiler gives
/// the same bits.
class OverlapLaw {
 public:
  explicit OverlapLaw(bool is_harmonic) : is_harmonic_(is_harmonic) {}

  /// Returns V = δ^α/α, where α is 2 (harmonic) or 5/2 (Hertzian).
  [[nodiscard]] double energy(double overlap) const {
    if (overlap <= 0.0) return 0.0;
    return is_harmonic_ ? 0.5 * overlap * overlap : 0.4 * overlap * overlap * std::sqrt(overlap);
  }
  /// Returns −dV/dr = δ^(α−1)/σ.
  [[nodiscard]] double force(double overlap, double contact_distance) const {
    if (overlap <= 0.0) return 0.0;
    return (is_harmonic_ ? overlap : overlap * std::sqrt(overlap)) / contact_distance;
  }
  /// Returns d²V/dr² = (α−1) δ^(α−2)/σ².
  [[nodiscard]] double stiffness(double overlap, double contact_distance) const {
    if (overlap <= 0.0) return 0.0;
    return (is_harmonic_ ? 1.0 : 1.5 * std::sqrt(overlap)) / (contact_distance * contact_distance);
  }

 private:
  bool is_harmonic_;
};

}  // namespace gridlock
