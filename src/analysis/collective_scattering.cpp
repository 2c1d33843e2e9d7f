#include "gridlock/analysis/collective_scattering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/lags.hpp"
#include "analysis/trajectory.hpp"
#include "gridlock/core/detail/thread_pool.hpp"

namespace gridlock {

namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;
constexpr double max_waves = 1e8;
constexpr std::size_t block_of_waves = 64;  ///< agents whose powers stay in the cache

/// The wave vector (2π n/L_x, 2π (m − n xy/L_x)/L_y).
struct WaveVector {
  std::int64_t n = 0;
  std::int64_t m = 0;
  double length = 0.0;
};

/// Returns the wave vectors of the box in a ring, one of each two opposite ones.
std::vector<WaveVector> vectors_in_ring(Box const& box, double wave_number, double width) {
  std::vector<WaveVector> found;
  double const largest = wave_number + 0.5 * width;
  auto const columns = static_cast<std::int64_t>(largest * box.width() / full_turn);
  auto const rows = static_cast<std::int64_t>(largest * box.height() / full_turn) + 1;
  for (std::int64_t n = 0; n <= columns; ++n) {
    double const lowered = static_cast<double>(n) * box.shift() / box.width();
    auto const middle = static_cast<std::int64_t>(std::round(lowered));
    for (std::int64_t m = n == 0 ? 1 : middle - rows; m <= middle + rows; ++m) {
      double const x = full_turn * static_cast<double>(n) / box.width();
      double const y = full_turn * (static_cast<double>(m) - lowered) / box.height();
      double const length = std::sqrt(x * x + y * y);
      if (std::abs(length - wave_number) <= 0.5 * width) found.push_back({.n = n, .m = m, .length = length});
    }
  }
  return found;
}

/// exp(2π i k f) of some agents for k = 0, 1, 2 …, where f is a coordinate in units of the side.
class Powers {
 public:
  explicit Powers(std::size_t count) : real_(count), imaginary_(count) {}

  using Row = std::array<double, block_of_waves>;

  void fill(Row const& coordinates) {
    real_[0].fill(1.0);
    imaginary_[0].fill(0.0);
    if (real_.size() == 1) return;
    for (std::size_t k = 0; k < block_of_waves; ++k) {
      double const angle = full_turn * (coordinates[k] - std::floor(coordinates[k]));
      real_[1][k] = std::cos(angle);
      imaginary_[1][k] = std::sin(angle);
    }
    for (std::size_t power = 2; power < real_.size(); ++power) {
      for (std::size_t k = 0; k < block_of_waves; ++k) {
        real_[power][k] = real_[power - 1][k] * real_[1][k] - imaginary_[power - 1][k] * imaginary_[1][k];
        imaginary_[power][k] = real_[power - 1][k] * imaginary_[1][k] + imaginary_[power - 1][k] * real_[1][k];
      }
    }
  }

  [[nodiscard]] Row const& real(std::size_t power) const { return real_[power]; }
  [[nodiscard]] Row const& imaginary(std::size_t power) const { return imaginary_[power]; }

 private:
  std::vector<Row> real_;
  std::vector<Row> imaginary_;
};

/// A wave of the density: Σ exp(i q·r).
struct Wave {
  double real = 0.0;
  double imaginary = 0.0;
};

/// Returns Σ exp(i q·r) over the first `count` agents of a block.
Wave wave_of(Powers const& along_x, Powers const& along_y, WaveVector const& q, std::size_t count) {
  constexpr std::size_t lanes = 8;
  auto const n = static_cast<std::size_t>(q.n);
  auto const m = static_cast<std::size_t>(std::abs(q.m));
  double const sign = q.m < 0 ? -1.0 : 1.0;
  double const* const a = along_x.real(n).data();
  double const* const b = along_x.imaginary(n).data();
  double const* const c = along_y.real(m).data();
  double const* const d = along_y.imaginary(m).data();
  std::array<double, lanes> real{}, imaginary{};
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) {
      real[l] += a[k + l] * c[k + l] - sign * (b[k + l] * d[k + l]);
      imaginary[l] += b[k + l] * c[k + l] + sign * (a[k + l] * d[k + l]);
    }
  }
  Wave sum;
  for (; k < count; ++k) {
    sum.real += a[k] * c[k] - sign * (b[k] * d[k]);
    sum.imaginary += b[k] * c[k] + sign * (a[k] * d[k]);
  }
  for (std::size_t l = 0; l < lanes; ++l) {
    sum.real += real[l];
    sum.imaginary += imaginary[l];
  }
  return sum;
}

/// The waves of all frames: those of a frame are rows of kinds, one entry for each wave vector.
class DensityWaves {
 public:
  DensityWaves(Box const& box, TrajectoryInMemory const& trajectory, std::vector<WaveVector> const& vectors,
               ThreadPool& pool)
      : vectors_(vectors), kinds_(agents_by_kind(trajectory)) {
    waves_.resize(trajectory.frames * kinds_.size() * vectors.size());
    std::size_t columns = 0, rows = 0;
    for (WaveVector const& q : vectors) {
      columns = std::max(columns, static_cast<std::size_t>(q.n));
      rows = std::max(rows, static_cast<std::size_t>(std::abs(q.m)));
    }
    pool.for_each(trajectory.frames, [&](std::size_t frame) {
      Powers along_x(columns + 1), along_y(rows + 1);
      for (std::size_t kind = 0; kind < kinds_.size(); ++kind) {
        add(box, points_of(trajectory, frame), kinds_[kind], along_x, along_y,
            waves_.data() + (frame * kinds_.size() + kind) * vectors_.size());
      }
    });
  }

  [[nodiscard]] std::size_t kinds() const { return kinds_.size(); }

  /// Returns the mean of Re ρ_a(second) ρ_b*(first) over the wave vectors, symmetric in a and b, over √(N_a N_b).
  [[nodiscard]] double correlation(std::size_t first, std::size_t second, std::size_t a, std::size_t b) const {
    Wave const* const waves[4] = {of(second, a), of(first, b), of(second, b), of(first, a)};
    double sum = 0.0;
    for (std::size_t v = 0; v < vectors_.size(); ++v) {
      sum += waves[0][v].real * waves[1][v].real + waves[0][v].imaginary * waves[1][v].imaginary;
      if (a != b) sum += waves[2][v].real * waves[3][v].real + waves[2][v].imaginary * waves[3][v].imaginary;
    }
    double const agents = std::sqrt(static_cast<double>(kinds_[a].size()) * static_cast<double>(kinds_[b].size()));
    return (a == b ? sum : 0.5 * sum) / (agents * static_cast<double>(vectors_.size()));
  }

 private:
  [[nodiscard]] Wave const* of(std::size_t frame, std::size_t kind) const {
    return waves_.data() + (frame * kinds_.size() + kind) * vectors_.size();
  }

  void add(Box const& box, PointsInMemory const& points, Agents const& agents, Powers& along_x, Powers& along_y,
           Wave* to) const {
    for (std::size_t begin = 0; begin < agents.size(); begin += block_of_waves) {
      std::size_t const count = std::min(block_of_waves, agents.size() - begin);
      Powers::Row x{}, y{};
      for (std::size_t k = 0; k < count; ++k) {
        std::size_t const row = std::size_t{agents[begin + k]} * points.stride;
        y[k] = points.y[row] / box.height();
        x[k] = (points.x[row] - y[k] * box.shift()) / box.width();
      }
      along_x.fill(x);
      along_y.fill(y);
      for (std::size_t v = 0; v < vectors_.size(); ++v) {
        Wave const wave = wave_of(along_x, along_y, vectors_[v], count);
        to[v].real += wave.real;
        to[v].imaginary += wave.imaginary;
      }
    }
  }

  std::vector<WaveVector> const& vectors_;
  std::vector<Agents> kinds_;
  std::vector<Wave> waves_;
};

void require_positive(char const* name, double value) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw Error({.what = fmt::format("the {} is {}", name, value), .hint = "use a positive number"});
}

void require_few(char const* name, double waves) {
  if (waves <= max_waves) return;
  throw Error({.what = fmt::format("there are {:.3g} {}; the most is {:.0g}", waves, name, max_waves),
               .hint = "use a smaller wave number, a narrower ring or fewer frames"});
}

/// Returns the wave vectors of the ring. Errors: those of find_collective_scattering().
std::vector<WaveVector> require_ring(Box const& box, TrajectoryInMemory const& trajectory,
                                     CollectiveScatteringSettings const& settings) {
  require_positive("wave number", settings.wave_number);
  require_positive("width of the ring of wave vectors", settings.width);
  if (!box.is_periodic()) {
    throw Error(Problem{.what = "the collective scattering function needs a box that is periodic in x and y",
                        .hint = "between walls there are no plane waves"});
  }
  double const largest = settings.wave_number + 0.5 * settings.width;
  require_few("wave vectors inside the ring",
              0.5 * std::numbers::pi * largest * largest * box.area() / (full_turn * full_turn));
  std::vector<WaveVector> vectors = vectors_in_ring(box, settings.wave_number, settings.width);
  if (vectors.empty()) {
    throw Error({.what = fmt::format("the box has no wave vector of length {:.6g} ± {:.3g}", settings.wave_number,
                                     0.5 * settings.width),
                 .hint = "use a wider ring, such as 2π over the shorter side"});
  }
  require_few("waves of all frames and kinds", static_cast<double>(vectors.size() * agents_by_kind(trajectory).size()) *
                                                   static_cast<double>(trajectory.frames));
  return vectors;
}

/// Writes F_ab of one lag, for all kinds.
void write_lag(DensityWaves const& waves, FramesOfLag const& frames, std::vector<bool> const& independent,
               std::size_t lag, CollectiveScattering& result) {
  std::vector<double> values(frames.size());
  std::size_t const lags = result.lag.size();
  for (std::size_t a = 0; a < result.kinds; ++a) {
    for (std::size_t b = a; b < result.kinds; ++b) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        auto const [first, second] = frames[k];
        values[k] = waves.correlation(first, second, a, b);
      }
      Estimate const mean = mean_over_origins(values, independent);
      result.scattering[(a * result.kinds + b) * lags + lag] = mean;
      result.scattering[(b * result.kinds + a) * lags + lag] = mean;
    }
  }
}

}  // namespace

CollectiveScattering find_collective_scattering(Box const& box, TrajectoryInMemory const& trajectory,
                                                CollectiveScatteringSettings const& settings) {
  require_trajectory(trajectory);
  std::vector<WaveVector> const vectors = require_ring(box, trajectory, settings);
  std::vector<FramesOfLag> lags{FramesOfLag(0.0, 0, trajectory.frames)};
  for (FramesOfLag& frames : lags_between(trajectory.times, settings.max_lags)) lags.push_back(std::move(frames));
  ThreadPool pool(settings.threads);
  DensityWaves const waves(box, trajectory, vectors, pool);
  CollectiveScattering result{.vectors = vectors.size(), .kinds = waves.kinds()};
  for (WaveVector const& q : vectors) result.wave_number += q.length / static_cast<double>(vectors.size());
  std::vector<std::vector<bool>> independent;
  for (FramesOfLag const& frames : lags) {
    independent.push_back(independent_pairs(frames, trajectory.times));
    result.lag.push_back(frames.lag());
    result.origins.push_back(frames.size());
    result.independent_origins.push_back(static_cast<std::uint64_t>(std::ranges::count(independent.back(), true)));
  }
  result.scattering.resize(result.kinds * result.kinds * lags.size());
  pool.for_each(lags.size(), [&](std::size_t l) { write_lag(waves, lags[l], independent[l], l, result); });
  return result;
}

}  // namespace gridlock
