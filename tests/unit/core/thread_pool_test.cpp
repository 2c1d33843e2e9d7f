#include "gridlock/core/detail/thread_pool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

namespace gridlock {
namespace {

TEST(ThreadPool, CarriesOutEveryPartOnceWhateverItsSize) {
  for (std::uint64_t const threads : {1, 2, 3, 8}) {
    ThreadPool thread_pool(threads);
    EXPECT_EQ(thread_pool.size(), threads);
    for (std::size_t const parts : {0, 1, 2, 7, 100}) {
      std::vector<int> times(parts);
      thread_pool.for_each(parts, [&](std::size_t part) { ++times[part]; });
      EXPECT_EQ(times, std::vector<int>(parts, 1));
    }
  }
}

/// Rounds so short that threads come late, help one another and are still leaving when the next round begins.
TEST(ThreadPool, KeepsShortRoundsOfUnequalPartsApart) {
  for (std::uint64_t const threads : {2, 3, 8}) {
    ThreadPool thread_pool(threads);
    std::vector<std::uint64_t> sums(9, 0);
    std::vector<std::uint64_t> expected(9, 0);
    for (std::uint64_t round = 0; round < 3000; ++round) {
      std::size_t const parts = 2 + round % 8;
      thread_pool.for_each(parts, [&](std::size_t part) {
        // Later parts take longer, so that their owners get help.
        for (std::uint64_t n = 0; n <= 20 * part; ++n) sums[part] = sums[part] * 3 + round + n;
      });
      for (std::size_t part = 0; part < parts; ++part) {
        for (std::uint64_t n = 0; n <= 20 * part; ++n) expected[part] = expected[part] * 3 + round + n;
      }
      ASSERT_EQ(sums, expected) << round;
    }
  }
}

/// Threads that come late to a round may see its end and the end of the pool at once.
TEST(ThreadPool, EndsWhileThreadsAreStillOnTheirWay) {
  for (int n = 0; n < 20'000; ++n) {
    std::array<int, 2> times{};
    {
      ThreadPool thread_pool(3);
      for (int round = 0; round <= n % 4; ++round)
        thread_pool.for_each(times.size(), [&](std::size_t part) { ++times[part]; });
    }
    ASSERT_EQ(times, (std::array{n % 4 + 1, n % 4 + 1}));
  }
}

TEST(ThreadPool, ThrowsOnWhatTheLowestFailingPartThrewWhenAllAreDoneAndGoesOnWorking) {
  for (std::uint64_t const threads : {1, 3}) {
    ThreadPool thread_pool(threads);
    std::array<int, 50> times{};
    try {
      thread_pool.for_each(times.size(), [&](std::size_t part) {
        ++times[part];
        if (part >= 20) throw std::runtime_error(std::to_string(part));
      });
      FAIL() << "nothing was thrown";
    } catch (std::runtime_error const& error) {
      EXPECT_EQ(std::string(error.what()), "20");
    }
    EXPECT_EQ(std::ranges::count(times, 1), 50);
    int done = 0;
    thread_pool.for_each(1, [&](std::size_t) { ++done; });
    EXPECT_EQ(done, 1);
  }
}

}  // namespace
}  // namespace gridlock
