#pragma once

/// \file
/// The minimum of the energy of soft disks: steepest descent, then the quasi-Newton method L-BFGS, then Newton's
/// method.
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

/// How a minimum is looked for.
struct MinimizerSettings {
  Potential potential = Potential::harmonic;
  double residual = 1e-8;          ///< largest net force of a disk over the mean contact force at which it is found
  double descent_residual = 0.01;  ///< the same, at which the search leaves the steepest way down; infinity: at once
  double quasi_newton_residual = 1.0;  ///< the same, below which it goes on by L-BFGS and not by FIRE; 0: never
  double newton_residual = 1e-3;       ///< the same, at which Newton's method takes over; 0: never
  std::uint64_t iterations = 500'000;  ///< of all methods together; then it is given up
  std::uint64_t threads = 1;           ///< 0: all cores
};

/// The result of a minimization.
enum class MinimumStatus {
  searching,    ///< not finished
  converged,    ///< the residual is reached, and disks press on each other
  unjammed,     ///< E/N < 1e-16: the disks have moved apart
  unconverged,  ///< neither, after all iterations
};
char const* to_text(MinimumStatus status);

/// Moves soft disks downhill to the next minimum of their energy.
///
/// Which minimum that is, the way down decides. It is the steepest one, dx/dt = F, until the residual is
/// `descent_residual` or the energy of a disk 10⁻⁸ ε: by the other methods fewer packings jam. Explicit
/// Runge–Kutta–Chebyshev steps, whose error displaces no disk by more than 0.01 D.
///
/// Then steps by the inverse Hessian that the last five steps tell (L-BFGS). A step is halved up to six times until it
/// lowers the energy by 10⁻⁴ of what the slope promises or halves the residual; where none does, FIRE takes over, down
/// to a tenth of the residual.
///
/// FIRE 2.0, for that and above `quasi_newton_residual`, with unit masses: v ← v + F dt, v ← (1 − α) v + α |v| F/|F|, x
/// ← x + v dt; where F·v ≤ 0, half a step back and v ← 0. Delay 20, growth 1.1, shrinking 0.5, α₀ = 0.25, × 0.99; dt
/// from 0.1 to 0.45 √(m D²/ε), D the smallest diameter.
///
/// Below `newton_residual` Newton's method with H + s 1, factorized by Cholesky: s/(ε/D²) starts at 1e-9, grows tenfold
/// until the matrix is positive definite, and shrinks to a fifth after a full step. Where a step does not halve the
/// residual, L-BFGS takes over, down to a tenth of it. No step of either moves a disk by more than 0.1 D.
///
/// Where the forces balance at a saddle, with a curvature below −1e-7 ε/D², all disks are displaced by 1e-4 D and the
/// search goes downhill from there; not where `newton_residual` is 0, and not where a net force above 10⁻³ of the mean
/// contact force is as good as was asked for. Overlaps near the rounding of the positions set a limit to the residual:
/// it counts as reached at 2⁻⁵⁰ L/(D δ̄), L the longer side of the box, δ̄ the mean overlap. Same bits for any number
/// of threads, interrupted or not: each disk adds up its forces in the order of their numbers.
/// Errors: Error for a packing that find_contacts() refuses, and settings out of range.
/// Cost: 15 to 30 ns a disk and evaluation of the forces: one for an iteration of FIRE or L-BFGS, 2 to 200 for a step
/// of steepest descent; a Newton step of 10⁴ disks 0.2 s. Sources: B. P. Sommeijer et al. (1998),
/// doi:10.1016/S0377-0427(97)00219-7; J. Guénolé et al. (2020), doi:10.1016/j.commatsci.2020.109584; D. C. Liu and J.
/// Nocedal (1989), doi:10.1007/BF01589116.
class Minimizer {
 public:
  Minimizer(MinimizerSettings const& settings, Packing packing);
  ~Minimizer();

  /// Iterates until the search has ended or should_continue, asked after every few iterations, says no. Returns whether
  /// it has ended.
  bool advance(std::function<bool()> const& should_continue = {});

  /// Searches anew from these positions and radii, at rest. Contract: as many disks as before.
  void restart(Packing packing);

  /// The same from near a minimum, from which few contacts are missing: Newton's method begins. It is left when more
  /// than 20 of its steps have not halved the residual, for 2,000 iterations of the other methods. Contract: as many
  /// disks as before.
  void restart_near_minimum(Packing packing);

  [[nodiscard]] MinimumStatus status() const { return status_; }
  /// The disks; those of a periodic box may have left it on any side.
  [[nodiscard]] Packing const& packing() const { return packing_; }
  [[nodiscard]] double energy() const { return energy_; }
  /// Largest net force over the mean contact force; 0 without contacts.
  [[nodiscard]] double residual() const { return residual_; }
  /// P D²/ε.
  [[nodiscard]] double pressure() const;
  /// Iterations of all searches so far, by any method and by each.
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
