#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/mean_over_origins.hpp"

namespace gridlock {

/// The stress of hard disks between samples, and the viscosities from the growth of its time integral.
///
///     G_ab(t) = ∫ Σ_i m_i v_a v_b dt + Σ_collisions J_a r_b          J from disk i to j, r = r_j − r_i at contact
///     stress_ab = −(G_ab(t) − G_ab(t − Δt)) / (A Δt)                  mass / time²; the mean since the last sample
///     growth(t) = ⟨(G(t₀ + t) − 2 G(t₀) + G(t₀ − t))²⟩ / (4 A kT)     mass
///     viscosity = (growth(L) − growth(L/3)) / (t(L) − t(L/3))         mass / time
///
/// The shear growth is the mean of those of G = G_xy and (G_xx − G_yy)/2, the bulk growth is that of (G_xx + G_yy)/2.
/// A constant mean, the pressure, drops out of second differences; of a G without mean the growth has the slope of
/// ⟨(G(t₀ + t) − G(t₀))²⟩/(2 A kT), Helfand's moment. Velocities are relative to the centre. L is the longest lag,
/// `max_lag` samples, and every sample is an origin t₀. Stresses remember each other for a few mean free times, below
/// which viscosities are too small.
///
///     stress_autocorrelation(t) = (A / kT) ⟨stress(t₀) stress(t₀ + t)⟩      mass / time²; of the shear stresses
///
/// Its stresses are means between samples, so that impulses, a δ function at t = 0, stay at lag 0, which is left out.
/// Integrals are exact but for rounding: a collision at t_c that changes K = Σ m v_a v_b by δ adds −(t_c − t_s) δ to
/// K Δt, where t_s is the time of the last sample.
///
/// Contract: elastic disks in a periodic box without fixed ones, which nothing else moves: momentum and energy stay.
/// Errors: Error for walls and fixed disks; of a viscosity, one standard error from groups of origins that span twice
/// the time that an origin looks at, 2 L, absent for fewer than two groups, and rough for fewer than about ten.
/// Cost: about 60 ns a collision; at a sample a pass over the disks, and some 30 ns for each lag of the curve.
/// Memory: 48 bytes for each sample in the longest lag, and 2 KiB for each lag.
/// Source: E. Helfand (1960), doi:10.1103/PhysRev.119.1; B. J. Alder, D. M. Gass, T. E. Wainwright (1970),
/// doi:10.1063/1.1673845, for hard disks; P. J. Daivis, D. J. Evans (1994), doi:10.1063/1.466970, for (xx − yy)/2.
class Viscosity final : public AveragingObservable {
 public:
  /// Contract: max_lag ≥ 1.
  explicit Viscosity(std::uint64_t max_lag);

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {VelocityX::name, VelocityY::name, Mass::name}, .collisions = true, .reports = true};
  }
  void begin(Snapshot const& start) override;
  void collided(PairCollision const& collision) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  /// The components xy, (xx − yy)/2 and (xx + yy)/2 of a symmetric tensor.
  struct Tensor {
    double xy = 0.0;
    double difference = 0.0;
    double mean = 0.0;
  };
  /// The means of one lag.
  struct Lag {
    std::uint64_t samples;
    MeanOverOrigins shear, bulk, correlation;
  };
  [[nodiscard]] static Tensor product(Vector a, Vector b);
  [[nodiscard]] static Tensor sum_of_motion(Snapshot const& now);
  [[nodiscard]] Tensor const& integral_before(std::uint64_t samples) const;
  void remember(Tensor const& growth, double duration);
  void take_lags(double area, double temperature, std::span<double> row);

  std::uint64_t max_lag_;
  std::uint64_t origins_of_group_;
  std::vector<Lag> lags_;
  MeanOverOrigins shear_viscosity_, bulk_viscosity_;

  double last_time_ = 0.0;
  Tensor collisions_;              ///< impulses, and the change of ∫ Σ m v v dt by them, since the last sample
  double interval_ = 0.0;          ///< time between samples that count; 0 before the first
  std::vector<Tensor> integrals_;  ///< G at the last samples, in a ring
  std::uint64_t taken_ = 0;        ///< number of values of G so far, of equally distant samples
};

}  // namespace gridlock
