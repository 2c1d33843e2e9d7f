#pragma once

#include <span>

#include "gridlock/core/box.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// An upright rectangle.
struct Rectangle {
  Vector lower;
  Vector upper;

  [[nodiscard]] double width() const { return upper.x - lower.x; }
  [[nodiscard]] double height() const { return upper.y - lower.y; }
};

/// Where the centre of a disk may be between the walls of a box: [R, W − R] × [R, H − R].
Rectangle room_of_centres(Box const& box, double radius);

/// ⟨|q − p|⟩ for q uniform in a rectangle that holds p, exactly.
///
/// p cuts the rectangle into four with a corner at p, and for each of them, a × b with diagonal d,
///     ∫∫ |q − p| dq = (2abd + a³ arsinh(b/a) + b³ arsinh(a/b)) / 6.
/// Cost: O(1).
double mean_distance(Vector p, Rectangle const& rectangle);

/// The mean of mean_distance() over all sites: how far disks are from their starts, on average, once they have
/// forgotten them and their centres are uniform in the rectangle. Contract: at least one site (asserted).
double mean_distance(std::span<Vector const> sites, Rectangle const& rectangle);

/// ⟨|q − p|⟩ for both points uniform in a square: side · (2 + √2 + 5 arsinh 1)/15 = 0.5214054332 · side.
double mean_distance_in_square(double side);

/// ⟨|r(t) − r(0)|⟩ for points that start on the sites and diffuse between reflecting walls,
///     r(t) distributed as the sum over mirror images of normal distributions of variance 2Dt in x and in y,
/// from √(πDt) at first to mean_distance(sites, rectangle) in the end.
/// Cost: O(sites · 64²) and a relative error of about 1e-3. Contract: diffused = D·t ≥ 0 (asserted).
double mean_distance_after_diffusion(std::span<Vector const> sites, Rectangle const& rectangle, double diffused);

/// Enskog's coefficient of self-diffusion for equal hard disks of mass 1,
///     D = σ √(kT/π) / (2 ρσ² g(σ)),   ρσ² = 4φ/π,   g(σ) = (1 − 7φ/16)/(1 − φ)²  (Henderson 1975),
/// in length²/time. Good to a few percent in the fluid below φ ≈ 0.6; nothing is claimed for the solid.
/// Sources: S. Chapman & T. G. Cowling, The Mathematical Theory of Non-uniform Gases (1970), chapter 16;
/// D. Henderson, A simple equation of state for hard discs (1975), doi:10.1080/00268977500102511.
double enskog_diffusion(double packing_fraction, double radius, double temperature);

}  // namespace gridlock
