#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gridlock {

/// The exact sum of any doubles, rounded once, to nearest even: the same bits for any order and any division of the
/// terms.
///
///     limb k counts units of 2^(32 k − 1075)     │ … │ limb k+1 │ limb k │ … │ limb 0 │
///     a term of 53 bits goes to two limbs            └ 32 bits apart, of 64 bits each: room for the carries of 1000 terms
///
/// Infinities and NaN are those of a plain sum: +∞ with −∞ is NaN. Finite terms overflow only where their whole sum
/// does. A sum that is zero is +0, as that of terms to a first +0.
/// Cost: about 3 ns a term, 1 ns in a span of hundreds, as a plain sum; 552 bytes, trivially copyable, so that
/// processes can send it.
/// Source: R. M. Neal, Fast exact summation using small and large superaccumulators (2015), arXiv:1505.05571; U. W.
/// Kulisch, Computer Arithmetic and Validity (2013).
///
/// ```cpp
/// ExactSum sum;
/// for (double const term : {1e300, 1.0, -1e300}) sum.add(term);
/// double const one = sum.value();  // 1.0
/// ```
class ExactSum {
 public:
  void add(double term) {
    auto const bits = std::bit_cast<std::uint64_t>(term);
    auto const exponent = static_cast<std::uint32_t>(bits >> mantissa_bits) & largest_exponent;
    if (exponent - 1 >= largest_exponent - 1) [[unlikely]] {
      add_rare(term);
      return;
    }
    add_mantissa((bits & mantissa_mask) | hidden_bit, exponent, sign_of(bits));
  }

  /// The same as one by one, for a third of the cost where there are hundreds.
  void add(std::span<double const> terms);

  /// All terms of another sum.
  void add(ExactSum const& other);

  /// The sum in few numbers, for a message: it has one for each 32 bits between its highest bit and its lowest, and one
  /// more.
  [[nodiscard]] std::vector<std::int64_t> packed() const;
  /// All terms of a sum that was packed.
  void add_packed(std::span<std::int64_t const> numbers);

  [[nodiscard]] double value() const;

 private:
  static constexpr unsigned mantissa_bits = 52;
  static constexpr std::uint32_t largest_exponent = 0x7FF;
  static constexpr std::uint64_t hidden_bit = std::uint64_t{1} << mantissa_bits;
  static constexpr std::uint64_t mantissa_mask = hidden_bit - 1;
  static constexpr unsigned limb_bits = 32;
  static constexpr std::int64_t unit_of_next_limb = std::int64_t{1} << limb_bits;
  static constexpr std::int64_t limb_mask = unit_of_next_limb - 1;
  /// In the first number of a packed sum: beneath it is the place of a limb.
  static constexpr std::uint64_t first_flag = 256;
  /// The bits of the largest double end in limb 64; those of 2⁶⁴ such terms in the last one, which carries to no other.
  static constexpr std::uint32_t limbs = 67;
  /// A term is below 2⁵² in the unit of its upper limb, what a carry has left below 2³², and a limb holds 2⁶³.
  static constexpr std::uint32_t terms_between_carries = 1024;

  /// −1 for a negative number, 0 for others.
  static std::int64_t sign_of(std::uint64_t bits) { return -static_cast<std::int64_t>(bits >> 63U); }

  /// mantissa · 2^(exponent − 1075), for exponent ≥ 1, or less that where the sign is −1.
  void add_mantissa(std::uint64_t mantissa, std::uint32_t exponent, std::int64_t sign) {
    std::uint32_t const shift = exponent % limb_bits;
    auto const low = static_cast<std::int64_t>((mantissa << shift) & static_cast<std::uint64_t>(limb_mask));
    auto const high = static_cast<std::int64_t>(mantissa >> (limb_bits - shift));
    std::uint32_t const limb = exponent / limb_bits;
    if (limb < first_) first_ = limb;
    if (limb + 2 > end_) end_ = limb + 2;
    limbs_[limb] += (low ^ sign) - sign;
    limbs_[limb + 1] += (high ^ sign) - sign;
    if (--terms_until_carry_ == 0) [[unlikely]]
      carry();
  }
  /// A term that is zero, subnormal, infinite or no number.
  void add_rare(double term);
  /// Leaves less than 2³² in the magnitude of every limb but the last. Carries are rounded towards zero, so that those
  /// of a negative sum end where its bits do.
  void carry();

  std::array<std::int64_t, limbs> limbs_{};
  std::uint32_t first_ = limbs;  ///< all limbs before this one are 0, and
  std::uint32_t end_ = 0;        ///< those from this one on
  std::uint32_t terms_until_carry_ = terms_between_carries;
  bool has_positive_infinity_ = false;
  bool has_negative_infinity_ = false;
  bool has_nan_ = false;
};

}  // namespace gridlock
