#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/mean_over_origins.hpp"
#include "observe/sites.hpp"

namespace gridlock {

/// The mean squared displacement against the lag, averaged over many origins, and the diffusion coefficient from its
/// slope.
///
///     mean_squared_displacement(t) = ⟨|r(t₀ + t) − r(t₀)|²⟩                                   length²
///     diffusion_coefficient = (msd(L) − msd(L/3)) / (4 (t(L) − t(L/3)))                       length² / time
///
/// The average is over all mobile agents that live at both times and over the origins t₀, which are the first sample
/// that counts and every `origin_every`-th after it. L is the longest lag, `max_lag` samples. Positions are unwrapped,
/// and the drift of the centre is not taken out. The series has the coefficient of an origin in the sample in which its
/// longest lag ends. Disks of infinite mass are fixed, and not counted.
///
/// Errors: origins whose lags overlap are correlated. Means of 2 L/origin_every neighbouring origins, which span twice
/// the longest lag, are the terms of a BlockAverage; with fewer than two such groups there is no error, and with fewer
/// than about ten it is rough. In two dimensions the slope of dense disks falls with log t, so that the coefficient
/// belongs to its window.
/// Cost: at a sample one pass over the agents (about 20 ns each) for each origin that has one of the lags then, on
/// average one or two. Memory: 24 bytes an agent and origin in use, of which there are L/origin_every, rounded up.
/// Source: D. Frenkel & B. Smit, Understanding Molecular Simulation (2002), section 4.4; A. Einstein (1905),
/// doi:10.1002/andp.19053220806.
class DisplacementCurve final : public Observable {
 public:
  /// The most origins in use at one time.
  static constexpr std::uint64_t max_origins = 64;
  static constexpr double bytes_per_agent = 24.0;  ///< for each origin in use
  /// Returns the number of origins in use at one time; 0 without a curve.
  static std::uint64_t origins_in_use(std::uint64_t max_lag, std::uint64_t origin_every);

  /// `origin_every` = 0 stands for an eighth of the longest lag, rounded up. Contract: max_lag ≥ 1.
  /// Errors: Error for more origins in use than max_origins.
  DisplacementCurve(std::uint64_t max_lag, std::uint64_t origin_every);

  [[nodiscard]] Requirements requirements(Box const& box) const override;
  [[nodiscard]] std::vector<ColumnInfo> columns() const override;
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  struct Origin {
    Attached<Site> sites;
    bool is_used = false;
    std::uint64_t age = 0;  ///< in samples
    double time = 0.0;
    double early_lag = no_value;           ///< lag at the start of the window of the slope, in time
    double early_displacement = no_value;  ///< squared displacement at that lag
  };

  void take_lag(Snapshot const& now, Origin& origin, std::span<double> row);
  void open_origin(Snapshot const& now);

  std::uint64_t max_lag_;
  std::uint64_t origin_every_;
  std::vector<std::uint64_t> lags_;  ///< in samples
  std::uint64_t early_;              ///< lag at which the window of the slope begins, in samples
  std::uint64_t origins_of_group_;

  bool has_begun_ = false;
  std::uint64_t samples_since_origin_ = 0;
  std::vector<Origin> origins_;
  std::vector<double> times_;  ///< each lag in time; NaN before it was seen
  std::vector<MeanOverOrigins> curve_;
  MeanOverOrigins coefficient_;
};

}  // namespace gridlock
