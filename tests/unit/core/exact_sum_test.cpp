#include "gridlock/core/detail/exact_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <type_traits>
#include <vector>

namespace gridlock {
namespace {

static_assert(std::is_trivially_copyable_v<ExactSum>);

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double largest = std::numeric_limits<double>::max();
constexpr double smallest = std::numeric_limits<double>::denorm_min();

double sum_of(std::span<double const> terms) {
  ExactSum sum;
  for (double const term : terms) sum.add(term);
  return sum.value();
}

std::uint64_t exact_bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// A sum bit by bit, in the manner of a school: positive and negative terms apart, each bit of a term carried at once.
class SumByBits {
 public:
  void add(double term) {
    int exponent = 0;
    double const fraction = std::frexp(std::abs(term), &exponent);
    auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    int lowest = exponent - 53;
    // A subnormal number has fewer bits than 53, and zeros beneath them.
    for (; mantissa != 0 && lowest < -1074; ++lowest) mantissa >>= 1U;
    Number& number = std::signbit(term) ? negative_ : positive_;
    for (std::size_t bit = static_cast<std::size_t>(lowest + 1074); mantissa != 0; mantissa >>= 1U, ++bit) {
      if ((mantissa & 1U) == 0) continue;
      std::size_t k = bit;
      for (; number[k]; ++k) number[k] = false;
      number[k] = true;
    }
  }

  [[nodiscard]] double value() const {
    bool const is_negative =
        std::lexicographical_compare(positive_.rbegin(), positive_.rend(), negative_.rbegin(), negative_.rend());
    Number const& larger = is_negative ? negative_ : positive_;
    Number const& less = is_negative ? positive_ : negative_;
    Number difference{};
    int borrowed = 0;
    for (std::size_t k = 0; k < bits_; ++k) {
      int digit = static_cast<int>(larger[k]) - static_cast<int>(less[k]) - borrowed;
      borrowed = digit < 0 ? 1 : 0;
      difference[k] = (digit & 1) != 0;
    }
    std::size_t top = bits_;
    while (top > 0 && !difference[top - 1]) --top;
    if (top == 0) return 0.0;
    std::size_t const lowest = top > 53 ? top - 53 : 0;
    double mantissa = 0.0;
    for (std::size_t k = top; k-- > lowest;) mantissa = 2.0 * mantissa + (difference[k] ? 1.0 : 0.0);
    if (lowest > 0 && difference[lowest - 1]) {
      bool const is_above_half =
          std::any_of(difference.begin(), difference.begin() + static_cast<std::ptrdiff_t>(lowest) - 1,
                      [](bool bit) { return bit; });
      if (is_above_half || std::fmod(mantissa, 2.0) == 1.0) mantissa += 1.0;
    }
    double const value = std::ldexp(mantissa, static_cast<int>(lowest) - 1074);
    return is_negative ? -value : value;
  }

 private:
  static constexpr std::size_t bits_ = 2200;
  using Number = std::array<bool, bits_>;
  Number positive_{};
  Number negative_{};
};

double sum_by_bits(std::span<double const> terms) {
  SumByBits sum;
  for (double const term : terms) sum.add(term);
  return sum.value();
}

/// Terms of every sign, of magnitudes between two powers of two.
std::vector<double> random_terms(std::size_t count, int min_exponent, int max_exponent, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> exponent(min_exponent, max_exponent);
  std::uniform_real_distribution<double> mantissa(-2.0, 2.0);
  std::vector<double> terms;
  for (std::size_t k = 0; k < count; ++k) terms.push_back(std::ldexp(mantissa(random), exponent(random)));
  return terms;
}

TEST(ExactSum, KeepsWhatAPlainSumLoses) {
  EXPECT_EQ(sum_of(std::array{1e300, 1.0, -1e300}), 1.0);
  EXPECT_EQ(sum_of(std::array{1.0, 0x1p-53, 0x1p-53}), 1.0 + 0x1p-52);
  EXPECT_EQ(sum_of(std::array{largest, smallest, -largest}), smallest);
  EXPECT_EQ(sum_of(std::array{0.1, 0.2, -0.3}), 0x1p-55) << "what 0.1, 0.2 and 0.3 are, exactly";
}

TEST(ExactSum, IsRoundedOnceToNearestEven) {
  EXPECT_EQ(sum_of(std::array{1.0, 0x1p-53}), 1.0) << "half, and 1 is even";
  EXPECT_EQ(sum_of(std::array{1.0 + 0x1p-52, 0x1p-53}), 1.0 + 0x1p-51) << "half, and up is even";
  EXPECT_EQ(sum_of(std::array{1.0, 0x1p-53, smallest}), 1.0 + 0x1p-52) << "above half by the last bit there is";
  EXPECT_EQ(sum_of(std::array{1.0, 0x1p-53, -smallest}), 1.0) << "below half";
  EXPECT_EQ(sum_of(std::array{-1.0, -0x1p-53, -smallest}), -1.0 - 0x1p-52);
  EXPECT_EQ(sum_of(std::array{2.0 - 0x1p-52, 0x1p-53}), 2.0) << "rounding comes to the next power of two";
}

TEST(ExactSum, OverflowsOnlyWhereTheWholeSumDoes) {
  EXPECT_EQ(sum_of(std::array{largest, largest, -largest}), largest);
  EXPECT_EQ(sum_of(std::array{largest, largest}), endless);
  EXPECT_EQ(sum_of(std::array{-largest, -largest}), -endless);
  double const half_a_bit = 0x1p970;
  EXPECT_EQ(sum_of(std::array{largest, std::nextafter(half_a_bit, 0.0)}), largest);
  EXPECT_EQ(sum_of(std::array{largest, half_a_bit}), endless);
  std::vector<double> const many(10'000, largest);
  ExactSum sum;
  for (double const term : many) sum.add(term);
  EXPECT_EQ(sum.value(), endless);
  for (double const term : many) sum.add(-term);
  EXPECT_EQ(sum.value(), 0.0);
  // 2⁶⁰ terms: doubled sixty times.
  for (double const term : {largest, -largest}) {
    ExactSum huge;
    huge.add(term);
    for (int k = 0; k < 60; ++k) huge.add(ExactSum(huge));
    EXPECT_EQ(huge.value(), term > 0.0 ? endless : -endless);
  }
}

TEST(ExactSum, TreatsInfinitiesAndNaNAsAPlainSumDoes) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sum_of(std::array{1.0, endless, -largest}), endless);
  EXPECT_EQ(sum_of(std::array{-endless, 1.0}), -endless);
  EXPECT_TRUE(std::isnan(sum_of(std::array{endless, -endless})));
  EXPECT_TRUE(std::isnan(sum_of(std::array{1.0, nan})));
  EXPECT_TRUE(std::isnan(sum_of(std::array{endless, nan})));
  for (double const rare : {endless, -endless, nan}) {
    std::vector<double> terms(1000, 1.0);
    terms[700] = rare;
    ExactSum sum;
    sum.add(terms);
    EXPECT_EQ(std::isnan(sum.value()), std::isnan(rare));
    EXPECT_TRUE(std::isnan(rare) || sum.value() == rare);
    ExactSum total;
    total.add(sum);
    EXPECT_EQ(std::isnan(total.value()), std::isnan(rare));
    std::ranges::fill(terms, 0.0);
    terms[100] = rare;
    ExactSum of_zeros;
    of_zeros.add(terms);
    EXPECT_EQ(std::isnan(of_zeros.value()), std::isnan(rare));
  }
}

TEST(ExactSum, OfNothingAndOfZerosIsPlusZero) {
  EXPECT_EQ(exact_bits(ExactSum().value()), exact_bits(0.0));
  EXPECT_EQ(exact_bits(sum_of(std::array{-0.0, -0.0})), exact_bits(0.0));
  EXPECT_EQ(exact_bits(sum_of(std::array{-1.5, 1.5})), exact_bits(0.0));
  std::vector<double> const zeros(1000, -0.0);
  ExactSum sum;
  sum.add(zeros);
  EXPECT_EQ(exact_bits(sum.value()), exact_bits(0.0));
}

TEST(ExactSum, OfAllMagnitudesIsThatOfASumBitByBit) {
  std::uint64_t seed = 0;
  for (auto const& [least, most] :
       {std::pair(-1074, 1023), std::pair(-1074, -1000), std::pair(-1040, -960), std::pair(-60, 0), std::pair(0, 0),
        std::pair(900, 1023), std::pair(-200, 200), std::pair(-52, 52)}) {
    for (std::size_t const count : {1U, 2U, 3U, 10U, 300U, 1500U}) {
      std::vector<double> terms = random_terms(count, least, most, ++seed);
      ASSERT_EQ(exact_bits(sum_of(terms)), exact_bits(sum_by_bits(terms)))
          << count << " from 2^" << least << " to 2^" << most;
      // The same with all but one term cancelled.
      for (std::size_t k = 0; k + 1 < count; ++k) terms.push_back(-terms[k]);
      std::ranges::shuffle(terms, std::mt19937_64(seed));
      ASSERT_EQ(exact_bits(sum_of(terms)), exact_bits(terms.size() == 1 ? terms[0] : sum_by_bits(terms)));
    }
  }
}

TEST(ExactSum, DependsOnNoOrderNorOnHowTermsAreDividedOrTakenTogether) {
  std::uint64_t seed = 100;
  for (auto const& [least, most] : {std::pair(-1074, 1023), std::pair(-30, 0), std::pair(-3, 3), std::pair(-120, 10),
                                    std::pair(-1074, -900), std::pair(1000, 1020)}) {
    std::vector<double> terms = random_terms(5000, least, most, ++seed);
    double const expected = sum_by_bits(terms);
    std::mt19937_64 random(seed);
    for (int repetition = 0; repetition < 5; ++repetition) {
      std::ranges::shuffle(terms, random);
      ExactSum total;
      std::span<double const> rest = terms;
      while (!rest.empty()) {
        auto const some = rest.first(std::min<std::size_t>(rest.size(), random() % 1200));
        rest = rest.subspan(some.size());
        ExactSum part;
        if (random() % 2 == 0) {
          part.add(some);
        } else {
          for (double const term : some) part.add(term);
        }
        total.add(part);
      }
      ASSERT_EQ(exact_bits(total.value()), exact_bits(expected)) << "from 2^" << least << " to 2^" << most;
    }
  }
}

TEST(ExactSum, OfManyTermsCarriesInTime) {
  // The largest mantissa at the shift that leaves most to the upper limb, of one sign.
  double const term = std::ldexp(2.0 - 0x1p-52, 31 - 1023 + 32 * 20);
  ExactSum sum;
  for (int k = 0; k < (1 << 20); ++k) sum.add(term);
  EXPECT_EQ(sum.value(), std::ldexp(term, 20));
  ExactSum less;
  for (int k = 0; k < (1 << 20); ++k) less.add(-term);
  EXPECT_EQ(less.value(), -std::ldexp(term, 20));
  sum.add(less);
  EXPECT_EQ(sum.value(), 0.0);
}

/// The same sum, packed and added to others.
double sent(ExactSum const& sum, double other) {
  ExactSum received;
  received.add(other);
  received.add_packed(sum.packed());
  received.add(-other);
  return received.value();
}

TEST(ExactSum, IsTheSameAfterItWasPacked) {
  std::uint64_t seed = 200;
  for (auto const& [least, most] :
       {std::pair(-1074, 1023), std::pair(-30, 0), std::pair(-3, 3), std::pair(-1074, -900), std::pair(1000, 1020)}) {
    for (std::size_t const count : {0U, 1U, 2U, 100U, 3000U}) {
      std::vector<double> const terms = random_terms(count, least, most, ++seed);
      ExactSum sum;
      for (double const term : terms) sum.add(term);
      for (double const other : {0.0, -1.0, 1e-300, largest}) {
        ASSERT_EQ(exact_bits(sent(sum, other)), exact_bits(sum_by_bits(terms)))
            << count << " from 2^" << least << " to 2^" << most << " and " << other;
      }
    }
  }
  for (double const rare : {endless, -endless}) {
    ExactSum sum;
    sum.add(rare);
    EXPECT_EQ(sent(sum, 1.0), rare);
    sum.add(-rare);
    EXPECT_TRUE(std::isnan(sent(sum, 1.0)));
  }
  ExactSum nan;
  nan.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(std::isnan(sent(nan, 1.0)));
}

TEST(ExactSum, OfTermsOfOneMagnitudeIsPackedInFewNumbers) {
  for (double const sign : {1.0, -1.0}) {
    ExactSum sum;
    for (double term : random_terms(3000, -3, 3, 300)) sum.add(sign * std::abs(term));
    EXPECT_LE(sum.packed().size(), 5U) << "of a negative sum too";
  }
  ExactSum cancelled;
  cancelled.add(-1.5);
  cancelled.add(1.5);
  EXPECT_EQ(cancelled.packed().size(), 1U);
}

TEST(ExactSum, OfPackedSumsCarriesInTime) {
  ExactSum term;
  for (int k = 0; k < 1000; ++k) term.add(-std::ldexp(2.0 - 0x1p-52, 31 - 1023 + 32 * 20));
  std::vector<std::int64_t> const packed = term.packed();
  ExactSum sum;
  for (int k = 0; k < (1 << 20); ++k) sum.add_packed(packed);
  EXPECT_EQ(sum.value(), std::ldexp(term.value(), 20));
}

}  // namespace
}  // namespace gridlock
