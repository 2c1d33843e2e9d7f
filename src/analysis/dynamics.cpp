#include "gridlock/analysis/dynamics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "analysis/bessel_table.hpp"
#include "analysis/lags.hpp"
#include "core/avx512.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

namespace {

constexpr std::size_t lane_count = 8;

/// Eight numbers in registers of any width. Lanes are summed singly, so sums have the same bits with every compiler.
using Eight = double __attribute__((vector_size(lane_count * sizeof(double)), aligned(alignof(double))));

/// Sums over agents in lanes: agent k is added to lane k modulo the number of lanes.
struct Lanes {
  Eight squares{};
  Eight fourths{};
  Eight near{};
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

/// The coordinates of some agents in all frames: x of all agents of a frame, then y.
struct AgentBlock {
  std::size_t agents = 0;
  std::vector<double> coordinates;

  [[nodiscard]] double const* x(std::size_t frame) const { return coordinates.data() + 2 * frame * agents; }
  [[nodiscard]] double const* y(std::size_t frame) const { return x(frame) + agents; }
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

[[gnu::always_inline]] inline void add_eight(Displacements const& moved, std::size_t k, std::size_t count,
                                             double squared_overlap, Lanes& sums) {
  Eight x0{}, y0{}, x1{}, y1{};
  std::memcpy(&x0, moved.x0 + k, count * sizeof(double));
  std::memcpy(&y0, moved.y0 + k, count * sizeof(double));
  std::memcpy(&x1, moved.x1 + k, count * sizeof(double));
  std::memcpy(&y1, moved.y1 + k, count * sizeof(double));
  Eight const dx = x1 - x0;
  Eight const dy = y1 - y0;
  Eight const squares = dx * dx + dy * dy;
  Eight const one = Eight{} + 1.0;
  sums.squares += squares;
  sums.fourths += squares * squares;
  sums.near += squares <= Eight{} + squared_overlap ? one : Eight{};
}

[[gnu::always_inline]] inline void add_all(Displacements const& moved, double squared_overlap, Lanes& lanes) {
  Lanes sums = lanes;  // a local copy stays in registers
  std::size_t k = 0;
  for (; k + lane_count <= moved.count; k += lane_count) add_eight(moved, k, lane_count, squared_overlap, sums);
  if (std::size_t const rest = moved.count - k; rest > 0) {
    add_eight(moved, k, rest, squared_overlap, sums);
    // Lanes without an agent have counted as an agent that has not moved.
    for (std::size_t l = rest; l < lane_count; ++l) sums.near[l] -= 1.0;
  }
  lanes = sums;
}

/// Adds J₀(q |Δr|) of agents from `first` on, with the same bits as add_scattering_avx512().
void add_scattering_from(std::size_t first, Displacements const& moved, double squared_q, BesselTable const& table,
                         Eight& sums) {
  for (std::size_t k = first; k < moved.count; ++k) sums[k % lane_count] += table(squared_q * moved.squared(k));
}

void add_scattering_scalar(Displacements const& moved, double squared_q, BesselTable const& table, Eight& sums) {
  add_scattering_from(0, moved, squared_q, table, sums);
}

void add_scalar(Displacements const& moved, double squared_overlap, Lanes& lanes) {
  add_all(moved, squared_overlap, lanes);
}

#ifdef GRIDLOCK_AVX512
GRIDLOCK_AVX512 void add_avx512(Displacements const& moved, double squared_overlap, Lanes& lanes) {
  add_all(moved, squared_overlap, lanes);
}

struct Coefficients {
  __m512d c0;
  __m512d c1;
  __m512d c2;
  __m512d c3;
};

/// Loads four coefficients of each of eight polynomials by loads and a transposition, which is faster than gathers.
GRIDLOCK_AVX512 inline Coefficients coefficients_of(double const* pieces, __m256i piece) {
  alignas(32) std::array<std::int32_t, lane_count> at;
  _mm256_store_si256(reinterpret_cast<__m256i*>(at.data()), _mm256_slli_epi32(piece, 2));
  __m512d rows[4];
  for (std::size_t l = 0; l < 4; ++l) {
    rows[l] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(pieces + at[l])),
                                 _mm256_loadu_pd(pieces + at[l + 4]), 1);
  }
  __m512d const even_low = _mm512_unpacklo_pd(rows[0], rows[1]);
  __m512d const odd_low = _mm512_unpackhi_pd(rows[0], rows[1]);
  __m512d const even_high = _mm512_unpacklo_pd(rows[2], rows[3]);
  __m512d const odd_high = _mm512_unpackhi_pd(rows[2], rows[3]);
  __m512i const first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  __m512i const second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  return {_mm512_permutex2var_pd(even_low, first, even_high), _mm512_permutex2var_pd(odd_low, first, odd_high),
          _mm512_permutex2var_pd(even_low, second, even_high), _mm512_permutex2var_pd(odd_low, second, odd_high)};
}

/// Adds J₀(q |Δr|) for eight agents at a time, and one by one for agents beyond the table.
GRIDLOCK_AVX512 void add_scattering_avx512(Displacements const& moved, double squared_q, BesselTable const& table,
                                           Eight& sums) {
  std::size_t k = 0;
  for (; k + lane_count <= moved.count; k += lane_count) {
    __m512d const dx = _mm512_sub_pd(_mm512_loadu_pd(moved.x1 + k), _mm512_loadu_pd(moved.x0 + k));
    __m512d const dy = _mm512_sub_pd(_mm512_loadu_pd(moved.y1 + k), _mm512_loadu_pd(moved.y0 + k));
    __m512d const square = _mm512_add_pd(_mm512_mul_pd(dx, dx), _mm512_mul_pd(dy, dy));
    __m512d const s = _mm512_mul_pd(_mm512_set1_pd(squared_q), square);
    __mmask8 const inside = _mm512_cmp_pd_mask(s, _mm512_set1_pd(BesselTable::end), _CMP_LT_OQ);
    __m512d const scaled = _mm512_mul_pd(s, _mm512_set1_pd(1.0 / BesselTable::width));
    __m256i const piece = _mm512_maskz_cvttpd_epi32(inside, scaled);
    __m512d const t = _mm512_sub_pd(scaled, _mm512_cvtepi32_pd(piece));
    auto const [c0, c1, c2, c3] = coefficients_of(table.pieces(), piece);
    Eight value = _mm512_add_pd(c2, _mm512_mul_pd(t, c3));
    value = _mm512_add_pd(c1, _mm512_mul_pd(t, value));
    value = _mm512_add_pd(c0, _mm512_mul_pd(t, value));
    for (std::size_t l = 0; inside != 0xFF && l < lane_count; ++l) {
      if ((inside >> l & 1U) == 0) value[l] = table(squared_q * moved.squared(k + l));
    }
    sums += value;
  }
  add_scattering_from(k, moved, squared_q, table, sums);
}
#endif

auto* fastest_add() {
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) return &add_avx512;
#endif
  return &add_scalar;
}

auto* fastest_add_scattering() {
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) return &add_scattering_avx512;
#endif
  return &add_scattering_scalar;
}

/// Returns which pairs of a lag are independent: pairs whose intervals do not overlap, chosen from the first on.
std::vector<bool> independent_pairs(FramesOfLag const& frames, std::span<double const> times) {
  std::vector<bool> result(frames.size(), false);
  double free_from = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    auto const [first, second] = frames[k];
    if (times[first] < free_from) continue;
    result[k] = true;
    free_from = times[second] - 1e-3 * frames.lag();
  }
  return result;
}

/// The sums of one lag for one kind of agents.
struct LagSums {
  Lanes lanes;                  ///< sums over pairs of frames that are not independent
  Sums sums;                    ///< sums over independent pairs, and scattering of all pairs
  std::vector<Sums> by_origin;  ///< sums of each independent pair

  [[nodiscard]] Sums total() const {
    Sums total = sums;
    total.add(lanes);
    return total;
  }
};

class Walk {
 public:
  Walk(TrajectoryInMemory const& trajectory, DynamicsSettings const& settings)
      : trajectory_(trajectory), settings_(settings), lags_(lags_between(trajectory.times, settings.max_lags)) {
    for (FramesOfLag const& frames : lags_) independent_.push_back(independent_pairs(frames, trajectory.times));
    if (settings.wave_number > 0.0) bessel_.emplace();
    drift_.assign(trajectory.frames, Vector{});
    if (!settings.keeps_drift) find_drift();
  }

  [[nodiscard]] Dynamics run() const {
    Dynamics result;
    for (std::size_t l = 0; l < lags_.size(); ++l) {
      result.lag.push_back(lags_[l].lag());
      result.origins.push_back(lags_[l].size());
      result.independent_origins.push_back(static_cast<std::uint64_t>(std::ranges::count(independent_[l], true)));
    }
    ThreadPool pool(settings_.threads);
    for (std::vector<std::uint32_t> const& agents : agents_by_kind()) {
      result.kinds.push_back(curves(sums_over(agents, pool), static_cast<double>(agents.size())));
    }
    return result;
  }

 private:
  void find_drift() {
    for (std::size_t f = 0; f < trajectory_.frames; ++f) {
      double const* const frame = trajectory_.positions + 2 * f * trajectory_.agents;
      for (std::size_t i = 0; i < trajectory_.agents; ++i)
        drift_[f] = drift_[f] + Vector{frame[2 * i], frame[2 * i + 1]};
      drift_[f] = (1.0 / static_cast<double>(trajectory_.agents)) * drift_[f];
    }
  }

  [[nodiscard]] std::vector<std::vector<std::uint32_t>> agents_by_kind() const {
    std::vector<std::vector<std::uint32_t>> result(1);
    for (std::uint32_t i = 0; i < trajectory_.agents; ++i) {
      std::size_t const kind = trajectory_.kinds.empty() ? 0 : trajectory_.kinds[i];
      if (kind >= result.size()) result.resize(kind + 1);
      result[kind].push_back(i);
    }
    return result;
  }

  /// Number of agents of which all frames stay in the second cache while the pairs of frames are visited.
  [[nodiscard]] std::size_t block_size() const {
    std::size_t const fits = (std::size_t{1} << 20) / (2 * sizeof(double) * trajectory_.frames);
    return std::clamp<std::size_t>(fits / lane_count * lane_count, 2 * lane_count, 4096);
  }

  [[nodiscard]] AgentBlock block_of(std::span<std::uint32_t const> agents) const {
    AgentBlock block{.agents = agents.size(), .coordinates = {}};
    block.coordinates.resize(2 * agents.size() * trajectory_.frames);
    double* to = block.coordinates.data();
    for (std::size_t f = 0; f < trajectory_.frames; ++f, to += 2 * agents.size()) {
      double const* const frame = trajectory_.positions + 2 * f * trajectory_.agents;
      for (std::size_t k = 0; k < agents.size(); ++k) {
        double const* const agent = frame + 2 * std::size_t{agents[k]};
        to[k] = agent[0] - drift_[f].x;
        to[k + agents.size()] = agent[1] - drift_[f].y;
      }
    }
    return block;
  }

  [[nodiscard]] std::vector<LagSums> sums_over(std::vector<std::uint32_t> const& agents, ThreadPool& pool) const {
    std::vector<LagSums> result(lags_.size());
    for (std::size_t l = 0; l < lags_.size(); ++l) {
      result[l].by_origin.resize(static_cast<std::size_t>(std::ranges::count(independent_[l], true)));
    }
    for (std::size_t begin = 0; begin < agents.size(); begin += block_size()) {
      std::size_t const count = std::min(block_size(), agents.size() - begin);
      AgentBlock const block = block_of(std::span(agents).subspan(begin, count));
      pool.for_each(lags_.size(), [&](std::size_t l) { add_lag(block, l, result[l]); });
    }
    return result;
  }

  void add_lag(AgentBlock const& block, std::size_t lag, LagSums& sums) const {
    FramesOfLag const& frames = lags_[lag];
    double const squared_overlap = settings_.overlap_length * settings_.overlap_length;
    auto origin = sums.by_origin.begin();
    for (std::size_t k = 0; k < frames.size(); ++k) {
      auto const [first, second] = frames[k];
      Displacements const moved{block.x(first), block.y(first), block.x(second), block.y(second), block.agents};
      double const scattering = bessel_ ? scattering_of(moved) : 0.0;
      sums.sums.scattering += scattering;
      if (!independent_[lag][k]) {
        add_(moved, squared_overlap, sums.lanes);
        continue;
      }
      Lanes lanes;
      add_(moved, squared_overlap, lanes);
      sums.sums.add(lanes);
      origin->add(lanes);
      origin->scattering += scattering;
      ++origin;
    }
  }

  [[nodiscard]] double scattering_of(Displacements const& moved) const {
    Eight sums{};
    add_scattering_(moved, settings_.wave_number * settings_.wave_number, *bessel_, sums);
    double sum = 0.0;
    for (std::size_t l = 0; l < lane_count; ++l) sum += sums[l];
    return sum;
  }

  /// Returns the mean with its standard error from the values of the independent pairs.
  template <class Value>
  static Estimate estimate(double mean, std::vector<Sums> const& by_origin, Value value) {
    BlockAverage average;
    for (Sums const& origin : by_origin) average.add(value(origin));
    auto const scatter = average.estimate();
    return {.value = mean, .error = scatter ? scatter->error : std::nullopt};
  }

  [[nodiscard]] DynamicsOfKind curves(std::vector<LagSums> const& lags, double agents) const {
    DynamicsOfKind result;
    for (std::size_t l = 0; l < lags_.size(); ++l) {
      Sums const total = lags[l].total();
      double const pairs = agents * static_cast<double>(lags_[l].size());
      double const second = total.squares / pairs;
      double const fourth = total.fourths / pairs;
      auto const mean = [&](double sum, double Sums::*member) {
        return estimate(sum / pairs, lags[l].by_origin, [&](Sums const& origin) { return origin.*member / agents; });
      };
      result.squared_displacement.push_back(mean(total.squares, &Sums::squares));
      // The ratio changes with its two means to first order. Without any motion the ratio is undefined.
      bool const is_defined = second > 0.0;
      result.non_gaussian.push_back(
          estimate(is_defined ? fourth / (2.0 * second * second) - 1.0 : std::numeric_limits<double>::quiet_NaN(),
                   is_defined ? lags[l].by_origin : std::vector<Sums>{}, [&](Sums const& origin) {
                     return (origin.fourths / agents - fourth) / (2.0 * second * second) -
                            fourth / (second * second * second) * (origin.squares / agents - second);
                   }));
      if (bessel_) result.scattering.push_back(mean(total.scattering, &Sums::scattering));
      if (settings_.overlap_length > 0.0) result.overlap.push_back(mean(total.near, &Sums::near));
    }
    return result;
  }

  TrajectoryInMemory const& trajectory_;
  DynamicsSettings const& settings_;
  std::vector<FramesOfLag> lags_;
  std::vector<std::vector<bool>> independent_;
  std::optional<BesselTable> bessel_;
  std::vector<Vector> drift_;
  decltype(fastest_add()) add_ = fastest_add();
  decltype(fastest_add_scattering()) add_scattering_ = fastest_add_scattering();
};

void require_finite_positions(TrajectoryInMemory const& trajectory) {
  for (std::size_t k = 0; k < 2 * trajectory.frames * trajectory.agents; ++k) {
    if (std::isfinite(trajectory.positions[k])) continue;
    std::size_t const row = k / 2;
    throw Error({.what = fmt::format("the position of agent {} in frame {} is not finite", row % trajectory.agents,
                                     row / trajectory.agents),
                 .hint = "every coordinate must be finite"});
  }
}

void require_kinds(TrajectoryInMemory const& trajectory) {
  if (trajectory.kinds.empty()) return;
  if (trajectory.kinds.size() != trajectory.agents) {
    throw Error(
        {.what = fmt::format("there are kinds of {} agents, but {} agents", trajectory.kinds.size(), trajectory.agents),
         .hint = "give one kind for each agent"});
  }
  std::vector<std::uint32_t> sorted(trajectory.kinds.begin(), trajectory.kinds.end());
  std::ranges::sort(sorted);
  for (std::uint32_t expected = 0; std::uint32_t const kind : sorted) {
    if (kind > expected) {
      throw Error({.what = fmt::format("there are agents of kind {} and none of kind {}", kind, expected),
                   .hint = "number the kinds from 0 without a gap"});
    }
    expected = kind + 1;
  }
}

void require_lengths(DynamicsSettings const& settings) {
  auto const require = [](char const* name, double value) {
    if (value >= 0.0 && std::isfinite(value)) return;
    throw Error(
        {.what = fmt::format("the {} is {}", name, value), .hint = "use a positive number, or 0 to leave it out"});
  };
  require("wave number", settings.wave_number);
  require("overlap length", settings.overlap_length);
}

}  // namespace

Dynamics find_dynamics(TrajectoryInMemory const& trajectory, DynamicsSettings const& settings) {
  if (trajectory.agents == 0) {
    throw Error(Problem{.what = "a trajectory without agents", .hint = "use at least one agent"});
  }
  if (trajectory.times.size() != trajectory.frames) {
    throw Error(
        {.what = fmt::format("there are times of {} frames, but {} frames", trajectory.times.size(), trajectory.frames),
         .hint = "give one time for each frame"});
  }
  require_lengths(settings);
  require_kinds(trajectory);
  require_finite_positions(trajectory);
  return Walk(trajectory, settings).run();
}

}  // namespace gridlock
