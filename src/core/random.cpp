#include "gridlock/core/random.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/normal_pairs.hpp"

namespace gridlock {

namespace {

using Block = std::array<std::uint64_t, 4>;
/// Draws one block of a stream. The numbers are written one by one: a copy of the whole would wait for them.
inline void draw_block_of(Block& numbers, std::uint64_t seed, Block const& counter) {
  auto const drawn = r123::Philox4x64()({{counter[0], counter[1], counter[2], counter[3]}}, {{seed, 0}});
  for (unsigned n = 0; n < numbers.size(); ++n) numbers[n] = drawn[n];
}

double uniform_of(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; }

/// A uniform point of a rectangle. Where v² ≤ −4 u² log u, the ratio v/u is a normal number: a division, which IEEE 754
/// rounds exactly, so its last bit does not depend on the mathematical library.
struct UniformPoint {
  double u;
  double v;
};
UniformPoint point_of(std::uint64_t first, std::uint64_t second) {
  constexpr double width = 1.71552776992141359295;  // 2 √(2/e)
  return {1.0 - uniform_of(first), width * (uniform_of(second) - 0.5)};
}

/// The curve lies between two ellipses, on which this form has the values below (Leva 1992, doi:10.1145/138351.138364).
/// On the curve it is between 0.275975 and 0.278459, so rounding changes no decision.
constexpr double inner_ellipse = 0.27597;
constexpr double outer_ellipse = 0.27846;
double form_of_ellipses(UniformPoint point) {
  double const x = point.u - 0.449871;
  double const y = std::abs(point.v) + 0.386595;
  return x * x + y * (0.196 * y - 0.25472 * x);
}

/// Decides by the logarithm, which is needed for one point in a hundred.
bool is_below_curve_by_logarithm(UniformPoint point) {
  double const x = point.v / point.u;
  return x * x <= -4.0 * std::log(point.u);
}

bool is_between_ellipses(double form) { return (form >= inner_ellipse) & (form <= outer_ellipse); }

bool is_below_curve(UniformPoint point) {
  double const form = form_of_ellipses(point);
  return form < inner_ellipse || (form <= outer_ellipse && is_below_curve_by_logarithm(point));
}

/// The pairs that are drawn together: their points stay in the first cache.
constexpr std::size_t pairs_at_once = 64;

/// Draws up to `pairs_at_once` pairs in rounds, one block of each stream in a round: two points, of which none, one or
/// two give a number. No branch depends on a point but for the few that need a logarithm.
class NormalPairs {
 public:
  NormalPairs(std::span<Id const> ids, std::span<Vector> pairs) : ids_(ids), pairs_(pairs), left_(ids.size()) {
    for (std::size_t k = 0; k < left_; ++k) stream_[k] = static_cast<std::uint32_t>(k);
  }
  void draw(std::uint64_t seed, std::uint64_t step, Purpose purpose) {
    for (std::uint64_t block = 0; left_ > 0; ++block) {
      for (std::size_t k = 0; k < left_; ++k) {
        draw_block_of(blocks_[k], seed, {block, step, ids_[stream_[k]], static_cast<std::uint64_t>(purpose)});
      }
      decide();
      take();
    }
  }

 private:
  void decide() {
    for (std::size_t k = 0; k < 2 * left_; ++k) {
      Block const& bits = blocks_[k / 2];
      UniformPoint const point = k % 2 == 0 ? point_of(bits[0], bits[1]) : point_of(bits[2], bits[3]);
      u_[k] = point.u;
      v_[k] = point.v;
    }
    for (std::size_t k = 0; k < 2 * left_; ++k) {
      form_[k] = form_of_ellipses({u_[k], v_[k]});
      number_[k] = v_[k] / u_[k];
    }
    std::array<std::uint32_t, 2 * pairs_at_once + 1> between;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 2 * left_; ++k) {
      between[count] = static_cast<std::uint32_t>(k);
      count += is_between_ellipses(form_[k]) ? 1 : 0;
    }
    for (std::uint32_t const k : std::span(between).first(count)) {
      form_[k] = is_below_curve_by_logarithm({u_[k], v_[k]}) ? 0.0 : 1.0;
    }
  }
  /// Hands out the numbers; the streams that need another block move to the front.
  void take() {
    std::size_t still_left = 0;
    for (std::size_t k = 0; k < left_; ++k) {
      std::uint32_t const stream = stream_[k];
      Vector& pair = pairs_[stream];
      double one_too_many = 0.0;
      double* const places[3] = {&pair.x, &pair.y, &one_too_many};
      std::size_t count = count_[stream];
      *places[count] = number_[2 * k];
      count += form_[2 * k] < inner_ellipse ? 1 : 0;
      *places[count] = number_[2 * k + 1];
      count += form_[2 * k + 1] < inner_ellipse ? 1 : 0;
      count_[stream] = static_cast<std::uint8_t>(count);
      stream_[still_left] = stream;
      still_left += count < 2 ? 1 : 0;
    }
    left_ = still_left;
  }

  std::span<Id const> ids_;
  std::span<Vector> pairs_;
  std::size_t left_;
  std::array<std::uint32_t, pairs_at_once> stream_;
  std::array<std::uint8_t, pairs_at_once> count_{};
  std::array<Block, pairs_at_once> blocks_;
  std::array<double, 2 * pairs_at_once> u_;
  std::array<double, 2 * pairs_at_once> v_;
  std::array<double, 2 * pairs_at_once> form_;
  std::array<double, 2 * pairs_at_once> number_;
};

}  // namespace

void RandomStream::draw_block() {
  draw_block_of(numbers_, seed_, {block_++, stream_[0], stream_[1], stream_[2]});
  used_ = 0;
}

std::uint64_t RandomStream::below(std::uint64_t bound) {
  // Numbers below the remainder of 2⁶⁴ / bound would make low residues likelier, so they are drawn again.
  std::uint64_t const remainder = (0 - bound) % bound;
  std::uint64_t drawn = bits();
  while (drawn < remainder) drawn = bits();
  return drawn % bound;
}

double RandomStream::normal() {
  for (;;) {
    std::uint64_t const first = bits();
    UniformPoint const point = point_of(first, bits());
    if (is_below_curve(point)) return point.v / point.u;
  }
}

void draw_normal_pairs(std::uint64_t seed, std::uint64_t step, std::span<Id const> ids, Purpose purpose,
                       std::span<Vector> pairs) {
  for (std::size_t k = 0; k < ids.size(); k += pairs_at_once) {
    std::size_t const count = std::min(pairs_at_once, ids.size() - k);
    NormalPairs(ids.subspan(k, count), pairs.subspan(k, count)).draw(seed, step, purpose);
  }
}

double RandomStream::exponential() {
  // A descending run u1 ≥ u2 ≥ … of odd length accepts u1 as the fraction; every rejection adds 1.
  for (double whole = 0.0;; whole += 1.0) {
    double const first = uniform();
    double last = first;
    bool is_odd = true;
    for (double next = uniform(); next <= last; next = uniform()) {
      last = next;
      is_odd = !is_odd;
    }
    if (is_odd) return whole + first;
  }
}

Vector RandomStream::in_unit_disk() {
  for (;;) {
    Vector const p{2.0 * uniform() - 1.0, 2.0 * uniform() - 1.0};
    if (squared_length(p) <= 1.0) return p;
  }
}

}  // namespace gridlock
