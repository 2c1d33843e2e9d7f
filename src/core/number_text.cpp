#include "core/number_text.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace gridlock {

namespace {

/// Bounds of magnitudes that are written without an exponent.
constexpr double min_plain = 1e-4;
constexpr double end_of_plain = 1e16;

}  // namespace

std::string number_text(double value) {
  double const magnitude = std::abs(value);
  bool const is_plain = (magnitude >= min_plain && magnitude < end_of_plain) || !(magnitude > 0.0);
  // The longest text has a sign, 17 digits, a point and e-308.
  std::array<char, 32> text;
  auto const end = std::to_chars(text.begin(), text.end(), value,
                                 is_plain ? std::chars_format::fixed : std::chars_format::scientific);
  return {text.begin(), end.ptr};
}

}  // namespace gridlock
