#include "gridlock/simulation/detail/rate_limiter.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace gridlock {
namespace {

/// A clock that is moved by hand and counts how often it is read.
struct HandClock {
  double now = 1000.0;
  std::uint64_t readings = 0;
  RateLimiter rate_limiter(double seconds) {
    return RateLimiter(seconds, [this] {
      ++readings;
      return now;
    });
  }
};

TEST(RateLimiter, OfNoTimeIsDueAfterEveryPiece) {
  HandClock clock;
  RateLimiter rate_limiter = clock.rate_limiter(0.0);
  for (int k = 0; k < 100; ++k) {
    EXPECT_TRUE(rate_limiter.is_due());
    clock.now += k % 3;
  }
}

TEST(RateLimiter, IsDueOnceInItsTimeHoweverShortThePieces) {
  for (double const piece : {1e-7, 1e-4, 0.03, 0.5, 7.0}) {
    SCOPED_TRACE(piece);
    HandClock clock;
    RateLimiter rate_limiter = clock.rate_limiter(0.1);
    double last = clock.now;
    for (int looks = 0; looks < 20;) {
      clock.now += piece;
      if (!rate_limiter.is_due()) continue;
      ++looks;
      EXPECT_GE(clock.now - last, 0.1 - 1e-9);
      EXPECT_LE(clock.now - last, 0.1 + 2.0 * piece);
      last = clock.now;
    }
  }
}

TEST(RateLimiter, ReadsTheClockRarely) {
  HandClock clock;
  RateLimiter rate_limiter = clock.rate_limiter(0.1);
  for (int k = 0; k < 10'000'000; ++k) {
    clock.now += 1e-7;
    static_cast<void>(rate_limiter.is_due());
  }
  EXPECT_LE(clock.readings, 100U);
}

TEST(RateLimiter, FollowsPiecesThatComeToTakeLonger) {
  HandClock clock;
  RateLimiter rate_limiter = clock.rate_limiter(0.1);
  double piece = 1e-6;
  double last = clock.now;
  for (int looks = 0; looks < 50;) {
    clock.now += piece;
    if (!rate_limiter.is_due()) continue;
    ++looks;
    // Those counted off beforehand take twice as long at most.
    EXPECT_LE(clock.now - last, 0.25 + 2.0 * piece);
    last = clock.now;
    piece *= 2.0;
  }
}

}  // namespace
}  // namespace gridlock
