#include "engine/exact/calendar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/exact/count_earlier.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock::exact {
namespace {

TEST(CountEarlier, CountsTheSameWithEveryTarget) {
  RandomStream random(5, 0, 0, Purpose::start_position);
  for (std::size_t count = 1; count <= 64; ++count) {
    // Few different times, so that many are the same.
    std::vector<double> times(count);
    for (double& time : times) time = count % 3 == 0 ? random.uniform() : std::floor(8.0 * random.uniform());
    std::vector<std::uint64_t> expected;
    for (double const time : times) {
      expected.push_back(static_cast<std::uint64_t>(std::ranges::count_if(times, [&](double t) { return t < time; })));
    }
    std::size_t const batches = (count + times_per_batch - 1) / times_per_batch;
    times.resize(batches * times_per_batch, std::numeric_limits<double>::infinity());
    for (Target const target : available_targets()) {
      std::vector<std::uint64_t> found(times.size());
      count_earlier_kernel(target)(times.data(), batches, found.data());
      found.resize(count);
      EXPECT_EQ(found, expected) << to_text(target) << ", " << count << " times";
    }
  }
}

/// Disks whose order at the same time is not that of their indices.
std::vector<MovingDisk> some_disks(std::size_t count) {
  std::vector<MovingDisk> disks(count);
  for (std::size_t i = 0; i < count; ++i) {
    disks[i].id_index = static_cast<Index>((i * 7919) % count);
    disks[i].event_time = std::numeric_limits<double>::infinity();
  }
  return disks;
}

struct CalendarCase {
  std::string name;
  std::size_t disks;
  std::uint64_t events_in_epoch;
  std::uint64_t expected;
  double grid;  ///< times are multiples of this part of the epoch; 0: any
};

class CalendarProperty : public testing::TestWithParam<CalendarCase> {};

INSTANTIATE_TEST_SUITE_P(Cases, CalendarProperty,
                         testing::Values(CalendarCase{"few_disks", 50, 40, 2000, 0.0},
                                         CalendarCase{"many_disks", 5000, 20, 100'000, 0.0},
                                         CalendarCase{"more_than_expected", 4000, 20, 10, 0.0},
                                         CalendarCase{"fewer_than_expected", 30, 20, 1'000'000, 0.0},
                                         CalendarCase{"same_times", 500, 30, 15'000, 1.0 / 256},
                                         CalendarCase{"all_at_once", 5000, 4, 20'000, 0.25}),
                         [](auto const& tested) { return tested.param.name; });

// Every event is handed out, in the order of time and id; events that became void may be, too.
TEST_P(CalendarProperty, HandsEventsOutInTheOrderOfTimeAndId) {
  CalendarCase const& c = GetParam();
  std::vector<MovingDisk> disks = some_disks(c.disks);
  RandomStream random(11, 0, 0, Purpose::start_position);
  constexpr double length = 4.0;
  double const mean_wait = length / static_cast<double>(c.events_in_epoch);
  auto const time_after = [&](double now) {
    double const time = now + 2.0 * mean_wait * random.uniform();
    double const step = length * c.grid;
    // Later in any case, or an event at the same time could go on for ever.
    return c.grid > 0.0 ? (std::floor(time / step) + 1.0) * step : time;
  };
  Calendar calendar;
  calendar.open(length, c.expected, c.disks);
  std::set<std::pair<double, Index>> pending;  // what a calendar holds
  auto const schedule = [&](Index i, double time) {
    pending.erase({disks[i].event_time, disks[i].id_index});
    disks[i].event_time = time;
    calendar.add(time, i, disks.data());
    if (time < length) pending.insert({time, disks[i].id_index});
  };
  for (Index i = 0; i < c.disks; ++i) schedule(i, time_after(0.0));
  std::uint64_t handed_out = 0;
  while (ScheduledEvent const* const next = calendar.next(disks.data())) {
    ScheduledEvent const event = *next;
    calendar.pop(next, disks.data());
    if (disks[event.disk].event_time != event.time) continue;
    ASSERT_EQ(std::pair(event.time, disks[event.disk].id_index), *pending.begin());
    ++handed_out;
    // Like a collision: the disk gets a new event, and so does another, whose old one is void.
    schedule(event.disk, time_after(event.time));
    schedule(static_cast<Index>(random.uniform() * static_cast<double>(c.disks)), time_after(event.time));
  }
  EXPECT_TRUE(pending.empty());
  EXPECT_GT(handed_out, c.disks / 2);
}

}  // namespace
}  // namespace gridlock::exact
