#pragma once

/// \file
/// Minimizes the energy of soft disks: steepest descent, then the quasi-Newton method L-BFGS, then Newton's method.
///
/// ```cpp
/// Packing const start{.box = Box(1.0, 1.0, Edge::periodic), .x = {0.3, 0.45}, .y = {0.5, 0.5}, .radius = {0.1, 0.1}};
/// Minimizer minimizer({.potential = Potential::harmonic}, start);
/// minimizer.advance();
/// bool const is_unjammed = minimizer.status() == MinimumStatus::unjammed;  // the two have moved apart
/// ```

#include <cstdint>
#include <functional>
#include <memory>

#include "gridlock/core/archive.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// The settings of a minimization. A residual is the largest net force on a disk over the mean contact force; where the
/// shape of the box is free, √A |σ| of the shear stress σ is one of these forces.
struct MinimizerSettings {
  Potential potential = Potential::harmonic;
  BoxShape box_shape = BoxShape::fixed;
  double residual = 1e-8;              ///< residual at which the minimum is found
  double descent_residual = 0.01;      ///< residual at which steepest descent ends; infinity: at once
  double quasi_newton_residual = 1.0;  ///< residual below which L-BFGS replaces FIRE; 0: never
  double newton_residual = 1e-3;       ///< residual below which Newton's method is used; 0: never
  std::uint64_t iterations = 500'000;  ///< limit for all methods together
  std::uint64_t threads = 1;           ///< 0: one for each core
};

/// The result of a minimization.
enum class MinimumStatus {
  searching,    ///< not finished
  converged,    ///< the residual is reached, and the pressure is above 0
  unjammed,     ///< E/N < 1e-16: no disks overlap
  unconverged,  ///< neither after all iterations
};
char const* to_text(MinimumStatus status);

/// Moves soft disks downhill to a minimum of their energy.
///
/// The method determines the minimum that is found. Steepest descent, dx/dt = F, is used until the residual is
/// `descent_residual` or the energy of a disk 10⁻⁸ ε, since fewer packings jam with the other methods. Its steps are
/// explicit Runge–Kutta–Chebyshev steps, whose error displaces no disk by more than 0.01 D.
///
/// L-BFGS follows, with an inverse Hessian from the last five steps. A step is halved up to six times until it lowers
/// the energy by 10⁻⁴ of the linear prediction or halves the residual; if it does not, FIRE is used down to a tenth of
/// the residual.
///
/// FIRE 2.0 is also used above `quasi_newton_residual`, with unit masses: v ← v + F dt, v ← (1 − α) v + α |v| F/|F|, x
/// ← x + v dt; if F·v ≤ 0, half a step back and v ← 0. Delay 20, growth 1.1, shrinking 0.5, α₀ = 0.25, × 0.99; dt from
/// 0.1 to 0.45 √(m D²/ε), D the smallest diameter.
///
/// Below `newton_residual` Newton's method is used with the matrix H + s 1 in Cholesky factors: s/(ε/D²) starts at
/// 1e-9, grows tenfold until the matrix is positive definite, and shrinks to a fifth after a full step. If a step does
/// not halve the residual, L-BFGS is used down to a tenth of it. No step of these methods moves a disk by more than 0.1
/// D.
///
/// With `box_shape = free` the energy is also minimized over pure and simple shear of the box at constant area, once
/// steepest descent has ended: at the minimum no shear stress is left, and every shear costs energy. With the two
/// strains as unknowns, a packing at the jamming transition needs two contacts more.
///
/// At a saddle, where forces balance and a curvature is below −1e-7 ε/D², all disks are displaced by 1e-4 D and the
/// search continues downhill; not if `newton_residual` is 0 or `residual` is above 10⁻³. Overlaps near the rounding of
/// positions limit the residual: it counts as reached at 2⁻⁵⁰ L/(D δ̄), L the longer side of the box, δ̄ the mean
/// overlap. The bits do not depend on threads or interruptions: each disk adds its forces in the order of the numbers
/// of its neighbours.
/// Errors: Error for a packing that find_contacts() refuses, settings out of range, and a free box with walls.
/// Cost: 15 to 30 ns a disk and evaluation of the forces, with one evaluation for an iteration of FIRE or L-BFGS, 2 to
/// 200 for a step of steepest descent; 0.2 s for a Newton step of 10⁴ disks. Sources: B. P. Sommeijer et al. (1998),
/// doi:10.1016/S0377-0427(97)00219-7; J. Guénolé et al. (2020), doi:10.1016/j.commatsci.2020.109584; D. C. Liu and J.
/// Nocedal (1989), doi:10.1007/BF01589116; the free box: S. Dagois-Bohy et al. (2012),
/// doi:10.1103/PhysRevLett.109.095703.
class Minimizer {
 public:
  Minimizer(MinimizerSettings const& settings, Packing packing);
  ~Minimizer();

  /// Iterates until the search ends or should_continue(), called after every few iterations, returns false. Returns
  /// whether the search has ended.
  bool advance(std::function<bool()> const& should_continue = {});

  /// Starts a new search from other positions and radii. Contract: the number of disks is the same.
  void restart(Packing packing);

  /// Starts a new search near a minimum, of which few contacts are missing, with Newton's method. If more than 20 of
  /// its steps have not halved the residual, 2,000 iterations of the other methods follow. Contract: the number of
  /// disks is the same.
  void restart_near_minimum(Packing packing);

  [[nodiscard]] MinimumStatus status() const { return status_; }
  /// Returns the disks; in a periodic box positions may be outside.
  [[nodiscard]] Packing const& packing() const { return packing_; }
  [[nodiscard]] double energy() const { return energy_; }
  /// Returns the largest net force over the mean contact force; 0 without contacts.
  [[nodiscard]] double residual() const { return residual_; }
  /// Returns the pressure P D²/ε.
  [[nodiscard]] double pressure() const;
  /// Return the iterations of all searches so far: of all methods together, and of each method.
  [[nodiscard]] std::uint64_t iterations() const {
    return descent_iterations_ + fire_iterations_ + quasi_newton_iterations_ + newton_iterations_;
  }
  [[nodiscard]] std::uint64_t descent_iterations() const { return descent_iterations_; }
  [[nodiscard]] std::uint64_t fire_iterations() const { return fire_iterations_; }
  [[nodiscard]] std::uint64_t quasi_newton_iterations() const { return quasi_newton_iterations_; }
  [[nodiscard]] std::uint64_t newton_iterations() const { return newton_iterations_; }
  [[nodiscard]] std::vector<Contact> contacts() const;

  void serialize(Archive& archive);

 private:
  class Search;

  MinimizerSettings settings_;
  Packing packing_;
  std::unique_ptr<Search> search_;
  MinimumStatus status_ = MinimumStatus::searching;
  double energy_ = 0.0;
  double residual_ = 0.0;
  std::uint64_t descent_iterations_ = 0;
  std::uint64_t fire_iterations_ = 0;
  std::uint64_t quasi_newton_iterations_ = 0;
  std::uint64_t newton_iterations_ = 0;
};

}  // namespace gridlock
