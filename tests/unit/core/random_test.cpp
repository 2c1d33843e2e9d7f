#include "gridlock/core/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <vector>

#include "core/normal_pairs.hpp"

namespace gridlock {
namespace {

using Words4 = std::array<std::uint64_t, 4>;
using Words2 = std::array<std::uint64_t, 2>;

/// High and low word of a product, from products of 32-bit halves.
Words2 product(std::uint64_t a, std::uint64_t b) {
  std::uint64_t const half = 0xFFFFFFFFU;
  std::uint64_t const low = (a & half) * (b & half);
  std::uint64_t const middle = (a >> 32) * (b & half) + (low >> 32);
  std::uint64_t const other = (a & half) * (b >> 32) + (middle & half);
  return {(a >> 32) * (b >> 32) + (middle >> 32) + (other >> 32), a * b};
}

/// Philox-4x64-10 from the description in Salmon et al. 2011, section 3.3 and table 2, without the library's Random123.
Words4 philox(Words4 counter, Words2 key) {
  for (int round = 0; round < 10; ++round) {
    auto const [high_0, low_0] = product(0xD2E7470EE14C6C93U, counter[0]);
    auto const [high_1, low_1] = product(0xCA5A826395121157U, counter[2]);
    counter = {high_1 ^ counter[1] ^ key[0], low_1, high_0 ^ counter[3] ^ key[1], low_0};
    key[0] += 0x9E3779B97F4A7C15U;  // the golden ratio
    key[1] += 0xBB67AE8584CAA73BU;  // √3 − 1
  }
  return counter;
}

Words4 first_block(RandomStream stream) { return {stream.bits(), stream.bits(), stream.bits(), stream.bits()}; }

TEST(RandomStream, TheTestsOwnPhiloxGivesTheKnownAnswersOfItsAuthors) {
  // The three vectors "philox4x64 10" of the file kat_vectors published with Random123.
  std::uint64_t const ones = ~std::uint64_t{0};
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}),
            (Words4{0x16554d9eca36314cU, 0xdb20fe9d672d0fdcU, 0xd7e772cee186176bU, 0x7e68b68aec7ba23bU}));
  EXPECT_EQ(philox({ones, ones, ones, ones}, {ones, ones}),
            (Words4{0x87b092c3013fe90bU, 0x438c3c67be8d0224U, 0x9cc7d7c69cd777b6U, 0xa09caebf594f0ba0U}));
  EXPECT_EQ(philox({0x243f6a8885a308d3U, 0x13198a2e03707344U, 0xa4093822299f31d0U, 0x082efa98ec4e6c89U},
                   {0x452821e638d01377U, 0xbe5466cf34e90c6cU}),
            (Words4{0xa528f45403e61d95U, 0x38c72dbd566e9788U, 0xa5a1610e72fd18b5U, 0x57bd43b5e52b7fe6U}));
}

TEST(RandomStream, IsPhiloxWithTheSeedAsKeyAndBlockStepIdPurposeAsCounter) {
  std::uint64_t seed = 1;
  for (int n = 0; n < 200; ++n) {
    seed = seed * 6364136223846793005U + 1442695040888963407U;
    std::uint64_t const step = seed >> 7;
    Id const id = seed * 3;
    RandomStream stream(seed, step, id, Purpose::start_velocity);
    for (std::uint64_t block = 0; block < 3; ++block) {
      Words4 const expected = philox({block, step, id, 2}, {seed, 0});
      for (std::uint64_t const word : expected) ASSERT_EQ(stream.bits(), word);
    }
  }
}

TEST(RandomStream, RestartsTheSameForTheSameName) {
  RandomStream a(7, 8, 9, Purpose::species);
  RandomStream b(7, 8, 9, Purpose::species);
  for (int n = 0; n < 100; ++n) ASSERT_EQ(a.bits(), b.bits());
}

TEST(RandomStream, UniformIsTheUpper53BitsInZeroToOne) {
  RandomStream a(1, 2, 3, Purpose::species);
  RandomStream b(1, 2, 3, Purpose::species);
  for (int n = 0; n < 1000; ++n) {
    double const u = a.uniform();
    ASSERT_EQ(u, std::ldexp(static_cast<double>(b.bits() >> 11), -53));
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
  }
}

/// Mean of f over draws, in units of its own standard error away from the expected value.
double standard_errors_off(int draws, double expected, std::function<double()> const& f) {
  double sum = 0.0;
  double squares = 0.0;
  for (int n = 0; n < draws; ++n) {
    double const value = f();
    sum += value;
    squares += value * value;
  }
  double const mean = sum / draws;
  double const variance = squares / draws - mean * mean;
  return (mean - expected) / std::sqrt(variance / draws);
}

constexpr int draws = 200'000;
// The seeds are fixed, so these either hold for ever or never; 4 standard errors happen once in 16000 by chance.
constexpr double max_errors = 4.0;

TEST(RandomStream, UniformHasTheMomentsOfTheUniformDistribution) {
  for (int power = 1; power <= 4; ++power) {
    RandomStream random(11, 0, static_cast<Id>(power), Purpose::species);
    // ⟨u^p⟩ = 1/(p + 1)
    EXPECT_LT(
        std::abs(standard_errors_off(draws, 1.0 / (power + 1), [&] { return std::pow(random.uniform(), power); })),
        max_errors)
        << "moment " << power;
  }
}

TEST(RandomStream, NormalHasTheMomentsOfTheNormalDistribution) {
  // ⟨x^p⟩ = 0 for odd p, (p − 1)!! for even p.
  std::array<double, 6> const moments{0.0, 1.0, 0.0, 3.0, 0.0, 15.0};
  for (int power = 1; power <= 6; ++power) {
    RandomStream random(12, 0, static_cast<Id>(power), Purpose::species);
    EXPECT_LT(std::abs(standard_errors_off(draws, moments[static_cast<std::size_t>(power - 1)],
                                           [&] { return std::pow(random.normal(), power); })),
              max_errors)
        << "moment " << power;
  }
}

TEST(RandomStream, NormalHasTheTailsOfTheNormalDistribution) {
  for (double const x : {-3.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0, 3.5}) {
    RandomStream random(13, 0, 0, Purpose::species);
    double const expected = 0.5 * std::erfc(-x / std::sqrt(2.0));
    EXPECT_LT(std::abs(standard_errors_off(draws, expected, [&] { return static_cast<double>(random.normal() < x); })),
              max_errors)
        << "P(normal < " << x << ")";
  }
}

TEST(RandomStream, NormalIsTheRatioOfUniformNumbersThatTheLogarithmAccepts) {
  RandomStream random(15, 0, 0, Purpose::species);
  RandomStream same(15, 0, 0, Purpose::species);
  for (int n = 0; n < draws; ++n) {
    double expected = std::numeric_limits<double>::infinity();
    for (double u = 1.0; !(expected * expected <= -4.0 * std::log(u));) {
      u = 1.0 - same.uniform();
      expected = 1.71552776992141359295 * (same.uniform() - 0.5) / u;
    }
    ASSERT_EQ(random.normal(), expected);
  }
}

TEST(NormalPairs, AreTheFirstTwoNormalNumbersOfEachStream) {
  for (std::size_t const count : {0U, 1U, 63U, 64U, 65U, 20'000U}) {
    std::vector<Id> ids(count);
    for (std::size_t k = 0; k < count; ++k) ids[k] = (7919 * k) % 20'011;
    std::vector<Vector> pairs(count);
    draw_normal_pairs(16, 3, ids, Purpose::thermostat, pairs);
    for (std::size_t k = 0; k < count; ++k) {
      RandomStream random(16, 3, ids[k], Purpose::thermostat);
      double const x = random.normal();
      ASSERT_EQ(pairs[k], (Vector{x, random.normal()}));
    }
  }
}

TEST(RandomStream, InUnitDiskIsUniformOverTheDisk) {
  // Density 1/π: ⟨x⟩ = ⟨y⟩ = ⟨xy⟩ = 0, ⟨r⟩ = 2/3, ⟨r²⟩ = 1/2, ⟨r⁴⟩ = 1/3, ⟨x²⟩ = 1/4.
  auto const expect_mean = [](double expected, auto f, char const* what) {
    RandomStream random(14, 0, 0, Purpose::species);
    EXPECT_LT(std::abs(standard_errors_off(draws, expected, [&] { return f(random.in_unit_disk()); })), max_errors)
        << what;
  };
  expect_mean(
      0.0, [](Vector p) { return p.x; }, "x");
  expect_mean(
      0.0, [](Vector p) { return p.y; }, "y");
  expect_mean(
      0.0, [](Vector p) { return p.x * p.y; }, "xy");
  expect_mean(
      0.25, [](Vector p) { return p.x * p.x; }, "x²");
  expect_mean(
      2.0 / 3.0, [](Vector p) { return std::sqrt(squared_length(p)); }, "r");
  expect_mean(
      0.5, [](Vector p) { return squared_length(p); }, "r²");
  expect_mean(
      1.0 / 3.0, [](Vector p) { return squared_length(p) * squared_length(p); }, "r⁴");
  RandomStream random(15, 0, 0, Purpose::species);
  for (int n = 0; n < 10000; ++n) ASSERT_LE(squared_length(random.in_unit_disk()), 1.0);
}

TEST(RandomStream, BelowReachesEveryNumberEquallyOften) {
  for (std::uint64_t const bound : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{3}, std::uint64_t{7},
                                    std::uint64_t{10}, std::uint64_t{100}}) {
    RandomStream random(16, 0, bound, Purpose::species);
    std::vector<int> counts(bound, 0);
    for (int n = 0; n < draws; ++n) ++counts.at(random.below(bound));
    double const expected = static_cast<double>(draws) / static_cast<double>(bound);
    double chi_squared = 0.0;
    for (int const count : counts) chi_squared += (count - expected) * (count - expected) / expected;
    // χ² of bound − 1 degrees of freedom has that mean and twice that variance.
    double const freedom = static_cast<double>(bound - 1);
    EXPECT_LE(chi_squared, freedom + max_errors * std::sqrt(2.0 * freedom) + 1e-9) << "bound " << bound;
  }
}

TEST(RandomStream, BelowHasNoModuloBias) {
  // 64 random bits modulo 3·2⁶² would fall below 2⁶² half of the time instead of a third.
  std::uint64_t const third = std::uint64_t{1} << 62;
  RandomStream random(17, 0, 0, Purpose::species);
  EXPECT_LT(std::abs(standard_errors_off(draws, 1.0 / 3.0,
                                         [&] { return static_cast<double>(random.below(3 * third) < third); })),
            max_errors);
}

TEST(RandomStream, NeighbouringStreamsAreUncorrelated) {
  // For independent uniform numbers 12 (u − ½)(w − ½) has mean 0 and variance 1.
  auto const expect_independent = [](auto stream_of, char const* what) {
    Id n = 0;
    EXPECT_LT(std::abs(standard_errors_off(draws / 4, 0.0,
                                           [&] {
                                             RandomStream a = stream_of(n);
                                             RandomStream b = stream_of(n + 1);
                                             ++n;
                                             return 12.0 * (a.uniform() - 0.5) * (b.uniform() - 0.5);
                                           })),
              max_errors)
        << what;
  };
  expect_independent([](Id n) { return RandomStream(n, 0, 0, Purpose::species); }, "seeds n and n + 1");
  expect_independent([](Id n) { return RandomStream(0, n, 0, Purpose::species); }, "steps n and n + 1");
  expect_independent([](Id n) { return RandomStream(0, 0, n, Purpose::species); }, "ids n and n + 1");
  expect_independent([](Id n) { return RandomStream(0, 0, 0, static_cast<Purpose>(n)); }, "purposes n and n + 1");
  expect_independent([](Id n) { return RandomStream(0, n / 2, n % 2, Purpose::species); }, "step against id");
}

TEST(RandomStream, EveryBitOfTheNameChangesHalfOfTheBits) {
  Words4 const reference = first_block(RandomStream(1, 2, 3, Purpose::start_position));
  auto const flipped_bits = [&](RandomStream const& stream) {
    Words4 const words = first_block(stream);
    int flipped = 0;
    for (std::size_t n = 0; n < 4; ++n) flipped += std::popcount(words[n] ^ reference[n]);
    return flipped;
  };
  // 256 fair coins: mean 128, standard deviation 8.
  for (unsigned bit = 0; bit < 64; ++bit) {
    std::uint64_t const flip = std::uint64_t{1} << bit;
    EXPECT_NEAR(flipped_bits(RandomStream(1 ^ flip, 2, 3, Purpose::start_position)), 128, 40) << "seed bit " << bit;
    EXPECT_NEAR(flipped_bits(RandomStream(1, 2 ^ flip, 3, Purpose::start_position)), 128, 40) << "step bit " << bit;
    EXPECT_NEAR(flipped_bits(RandomStream(1, 2, 3 ^ flip, Purpose::start_position)), 128, 40) << "id bit " << bit;
  }
  EXPECT_NEAR(flipped_bits(RandomStream(1, 2, 3, Purpose::start_velocity)), 128, 40);
}

TEST(RandomStream, PurposesKeepTheirNumbers) {
  // Old seeds must go on meaning the same runs.
  EXPECT_EQ(static_cast<int>(Purpose::start_position), 1);
  EXPECT_EQ(static_cast<int>(Purpose::start_velocity), 2);
  EXPECT_EQ(static_cast<int>(Purpose::species), 3);
  EXPECT_EQ(static_cast<int>(Purpose::paper_study), 4);
}

TEST(RandomStream, ExponentialNumbersHaveMeanVarianceAndTailOfTheExponentialDistribution) {
  constexpr int n = 200'000;
  RandomStream random(3, 0, 0, Purpose::model_step);
  double sum = 0.0;
  double squares = 0.0;
  int beyond_three = 0;
  for (int k = 0; k < n; ++k) {
    double const t = random.exponential();
    sum += t;
    squares += t * t;
    beyond_three += t > 3.0 ? 1 : 0;
  }
  // Five standard errors: of the mean 1/√n, of ⟨t²⟩ = 2 with ⟨t⁴⟩ = 24 √20/√n, of P(t > 3) = e⁻³ √(p(1−p)/n).
  EXPECT_NEAR(sum / n, 1.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 2.0, 5.0 * std::sqrt(20.0 / n));
  double const p = std::exp(-3.0);
  EXPECT_NEAR(static_cast<double>(beyond_three) / n, p, 5.0 * std::sqrt(p * (1.0 - p) / n));
}

}  // namespace
}  // namespace gridlock
