#include "gridlock/core/random.hpp"

#include <Random123/philox.h>

#include <cmath>

namespace gridlock {

void RandomStream::draw_block() {
  r123::Philox4x64 const philox;
  r123::Philox4x64::ctr_type const counter{{block_++, stream_[0], stream_[1], stream_[2]}};
  r123::Philox4x64::key_type const key{{seed_, 0}};
  auto const output = philox(counter, key);
  for (unsigned n = 0; n < numbers_.size(); ++n) numbers_[n] = output[n];
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
  // The logarithm only decides whether a candidate is accepted. The number returned comes from a division, which IEEE
  // 754 rounds exactly, so its last bit does not depend on the mathematical library.
  constexpr double width = 1.71552776992141359295;  // 2 √(2/e)
  // Bounds of −4 log u that spare most logarithms: with a margin for what rounds, they decide as the logarithm does.
  constexpr double margin = 1e-9;
  constexpr double slope_below = 5.136101666750965;  // 4 exp(1/4): the tangent 5 − 4 exp(1/4) u lies below
  constexpr double pole_above = 1.036961042583566;   // 4 exp(−1.35): 4 exp(−1.35)/u + 1.4 lies above
  for (;;) {
    double const u = 1.0 - uniform();
    double const v = width * (uniform() - 0.5);
    double const x = v / u;
    double const square = x * x;
    if (square <= 5.0 - slope_below * u - margin) return x;
    if (square >= pole_above / u + 1.4 + margin) continue;
    if (square <= -4.0 * std::log(u)) return x;
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
