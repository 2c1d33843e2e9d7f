// What is measured of the same agents has the same bits, however their rows are ordered, and however they are divided
// among ranks, here threads.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/observe/pairs.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "io/checkpoint.hpp"
#include "reference/shuffled_rows.hpp"
#include "thread_ranks.hpp"

// The example of the page, without its program.
#define main example_program
#include "examples/own_observable.cpp"
#undef main

namespace gridlock {
namespace {

struct Case {
  Edge edge = Edge::periodic;
  std::optional<Edge> edge_y = {};
  std::size_t count = 0;
  double width = 1.0;
  double height = 1.0;
  bool is_mixture = false;
  bool has_gaps = false;  ///< between the Ids
  double crowd = 1.0;     ///< the part of the box with agents
  std::uint64_t seed = 0;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  std::uint64_t seed = 0;
  for (Edge const edge : {Edge::periodic, Edge::wall}) {
    for (std::size_t const count : {0U, 1U, 2U, 5U, 40U, 700U}) {
      for (bool const is_mixture : {false, true}) {
        all.push_back({.edge = edge, .count = count, .is_mixture = is_mixture, .has_gaps = is_mixture, .seed = ++seed});
      }
    }
    all.push_back({.edge = edge, .count = 900, .width = 9.0, .height = 0.5, .seed = ++seed});
    Edge const other = edge == Edge::wall ? Edge::periodic : Edge::wall;
    all.push_back({.edge = edge, .edge_y = other, .count = 700, .width = 2.0, .is_mixture = true, .seed = 1000 + seed});
    all.push_back({.edge = edge, .count = 900, .width = 0.5, .height = 9.0, .is_mixture = true, .seed = ++seed});
    all.push_back({.edge = edge, .count = 900, .crowd = 0.2, .seed = ++seed});
    all.push_back({.edge = edge, .count = 7000, .is_mixture = true, .seed = ++seed});
  }
  return all;
}

Box box_of(Case const& c) { return {c.width, c.height, c.edge, c.edge_y.value_or(c.edge)}; }

std::string name_of(Case const& c) {
  return std::to_string(c.count) + " in a box, " + std::string(edges_in_words(box_of(c))) + ", of " +
         std::to_string(c.width) + " × " + std::to_string(c.height) + (c.is_mixture ? ", a mixture" : "");
}

/// Disks anywhere, also on one another, with velocities of many magnitudes; in a mixture hardly two are alike.
State start_of(Case const& c) {
  State state{.box = box_of(c), .agents = {}, .clock = {}, .seed = c.seed};
  double const radius = 0.3 * std::sqrt(c.width * c.height / (1.0 + static_cast<double>(c.count)));
  for (std::size_t i = 0; i < c.count; ++i) {
    RandomStream random(c.seed, 0, i, Purpose::start_position);
    double const size = c.is_mixture ? 0.5 + random.uniform() : 1.0;
    double const speed = i % 7 == 0 ? 1e-9 : 1.0;
    bool const is_added = state.agents.add_as(c.has_gaps ? 3 * i + i % 2 : i, c.crowd * c.width * random.uniform(),
                                              c.crowd * c.height * random.uniform(), speed * random.normal(),
                                              speed * random.normal(), size * radius, size * size, 0, 0);
    EXPECT_TRUE(is_added);
  }
  return state;
}

/// The disks have flown freely, around the box or back from its walls, and turned a little.
void fly(State& state, double time) {
  state.clock.time += time;
  ++state.clock.step;
  Box const& box = state.box;
  Disks& d = state.agents;
  for (std::size_t i = 0; i < d.size(); ++i) {
    auto const fly_along = [&](double& p, double& v, std::int32_t& image, double side, bool is_periodic) {
      p += time * v;
      if (!is_periodic) {
        p = std::clamp(p, 0.0, side);
        if (p == 0.0 || p == side) v = -v;
        return;
      }
      while (p < 0.0) p += side, --image;
      while (p >= side) p -= side, ++image;
    };
    fly_along(d.column<X>()[i], d.column<VelocityX>()[i], d.column<ImageX>()[i], box.width(), box.is_periodic_x());
    fly_along(d.column<Y>()[i], d.column<VelocityY>()[i], d.column<ImageY>()[i], box.height(), box.is_periodic_y());
    double& x = d.column<VelocityX>()[i];
    double& y = d.column<VelocityY>()[i];
    x = 0.8 * x - 0.6 * y;
  }
}

Counters counters_at(std::uint64_t sample) {
  Counters counters;
  counters.pair_collisions = 10 * sample;
  counters.pair_virial = 0.1 * static_cast<double>(sample);
  counters.moves = 100 * sample;
  counters.halted_moves = 3 * sample;
  return counters;
}

ObserveSettings settings(Box const& box) {
  return {.structure_every = 2,
          .pair_correlation_range = 3.0,
          .pair_correlation_bins = 20,
          .orientation_correlation = true,
          .defects_every = box.is_periodic() ? 4U : 0U,
          .speed_bins = 13,
          .velocity_origin_every = 3,
          .density_profile = ProfileAxes::both,
          .density_profile_bins = 7,
          .clusters_every = 3,
          .local_density_every = 2,
          .local_density_side = 3.0,
          .displacement_lag = 3,
          .displacement_origin_every = 2,
          .temperature_by_kind = true,
          .flux_line = FluxLine::horizontal};
}

/// Every number that came out, bit by bit.
using Numbers = std::vector<std::uint64_t>;

void add(Numbers& numbers, double value) {
  numbers.push_back(std::isnan(value) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(value));
}

constexpr std::uint64_t samples = 8;
/// Between two origins of the velocity autocorrelation.
constexpr std::uint64_t resumed_at = 4;

class Recorder {
 public:
  explicit Recorder(Snapshot const& start) : observables_(make_observables(settings(start.box), start)) {}

  void sample(Snapshot const& now, bool counts_for_average) {
    for (auto const& observable : observables_) {
      std::vector<double> row(observable->columns().size());
      observable->sample(now, row, counts_for_average);
      for (double const value : row) add(numbers_, value);
    }
  }
  /// Goes on as a run does that was stopped and resumed: `start` is that of the whole run.
  void resume(Snapshot const& start) {
    auto const serialize_all = [this](Archive& archive) {
      for (std::size_t k = 0; k < observables_.size(); ++k) {
        serialize_inside(archive, std::to_string(k), [&] { observables_[k]->serialize(archive); });
      }
    };
    auto const saved = to_checkpoint(serialize_all);
    observables_ = make_observables(settings(start.box), start);
    from_checkpoint(saved, "saved", serialize_all);
  }
  Numbers finish() {
    for (auto const& observable : observables_) {
      for (NamedEstimate const& result : observable->results()) {
        add(numbers_, result.estimate.value);
        add(numbers_, result.estimate.error.value_or(-1.0));
      }
      for (Distribution const& distribution : observable->distributions()) {
        for (auto const& column : distribution.columns_of_values) {
          for (double const value : column) add(numbers_, value);
        }
      }
    }
    return std::move(numbers_);
  }

 private:
  std::vector<std::unique_ptr<Observable>> observables_;
  Numbers numbers_;
};

/// What one process measures of the rows in some order: anew for every sample where a seed is given, and in a run that
/// was stopped and resumed then.
Numbers measured(Case const& c, std::uint64_t shuffle_seed = 0) {
  State state = start_of(c);
  auto const shuffled = [&](std::uint64_t sample) {
    return shuffle_seed == 0 ? state : reference::with_rows_shuffled(state, shuffle_seed + sample);
  };
  State const start = shuffled(0);
  Counters const counters;
  Recorder recorder({start, counters});
  for (std::uint64_t sample = 1; sample <= samples; ++sample) {
    fly(state, 0.05);
    State const now = shuffled(sample);
    if (shuffle_seed != 0 && sample == resumed_at) recorder.resume({start, counters});
    recorder.sample({now, counters_at(sample)}, sample > 1);
  }
  return recorder.finish();
}

TEST(Observables, MeasureTheSameBitsInAnyOrderOfTheRows) {
  for (Case const& c : cases()) {
    Numbers const expected = measured(c);
    ASSERT_EQ(measured(c, 1000), expected) << name_of(c);
    ASSERT_EQ(measured(c, 2000), expected) << name_of(c);
  }
}

/// Rows first … end − 1 of a state.
State rows_of(State const& state, std::size_t first, std::size_t end) {
  State part{.box = state.box, .agents = {}, .clock = state.clock, .seed = state.seed};
  Disks const& d = state.agents;
  for (std::size_t i = first; i < end; ++i) {
    EXPECT_TRUE(part.agents.add_as(d.ids()[i], d.column<X>()[i], d.column<Y>()[i], d.column<VelocityX>()[i],
                                   d.column<VelocityY>()[i], d.column<Radius>()[i], d.column<Mass>()[i],
                                   d.column<ImageX>()[i], d.column<ImageY>()[i]));
  }
  return part;
}

/// Where the rows of each rank begin, and the end: blocks of any size, some of them empty.
std::vector<std::size_t> random_cuts(std::size_t rows, std::size_t ranks, std::uint64_t seed) {
  RandomStream random(seed, 2, ranks, Purpose::start_position);
  std::vector<std::size_t> cuts{0, rows};
  while (cuts.size() < ranks + 1) cuts.push_back(random.below(4) == 0 ? cuts.back() : random.below(rows + 1));
  std::ranges::sort(cuts);
  return cuts;
}

/// What each of several ranks measures, of the rows in the order of a seed, in a run that was stopped and resumed.
std::vector<Numbers> measured_on_ranks(Case const& c, std::size_t ranks, std::uint64_t shuffle_seed) {
  State const start = shuffle_seed == 0 ? start_of(c) : reference::with_rows_shuffled(start_of(c), shuffle_seed);
  std::vector<std::size_t> const cuts = random_cuts(c.count, ranks, c.seed);
  std::vector<Numbers> results(ranks);
  test::ThreadRanks(ranks).run([&](Communicator& here) {
    std::size_t const rank = here.rank();
    State state = rows_of(start, cuts[rank], cuts[rank + 1]);
    Counters const counters;
    State const own_start = state;
    Recorder recorder({state, counters, here, c.count});
    for (std::uint64_t sample = 1; sample <= samples; ++sample) {
      fly(state, 0.05);
      if (sample == resumed_at) recorder.resume({own_start, counters, here, c.count});
      recorder.sample({state, counters_at(sample), here, c.count}, sample > 1);
    }
    results[rank] = recorder.finish();
  });
  return results;
}

TEST(ObservablesOnRanks, MeasureTheBitsOfOneProcess) {
  for (Case const& c : cases()) {
    Numbers const expected = measured(c);
    for (auto const& [ranks, shuffle_seed] :
         {std::pair<std::size_t, std::uint64_t>{1, 0}, {2, 3000}, {3, 0}, {6, 3000}}) {
      for (Numbers const& numbers : measured_on_ranks(c, ranks, shuffle_seed)) {
        ASSERT_EQ(numbers, expected) << name_of(c) << " on " << ranks << " ranks";
      }
    }
  }
}

TEST(ObservablesOnRanks, MeasureTheBitsOfOneProcessWhereMassesAreTooManyToKeep) {
  Case const c{.count = 70'000, .is_mixture = true, .seed = 77};
  Numbers const expected = measured(c);
  for (Numbers const& numbers : measured_on_ranks(c, 3, 0)) ASSERT_EQ(numbers, expected);
}

TEST(ObservablesOnRanks, OfThePageMeasureTheFastestOfAllDisks) {
  Case const c{.count = 41, .width = 2.0, .seed = 8};
  State const start = start_of(c);
  double expected = 0.0;
  for (std::size_t i = 0; i < c.count; ++i) {
    expected = std::max(expected, std::hypot(start.agents.column<VelocityX>()[i], start.agents.column<VelocityY>()[i]));
  }
  for (std::size_t const ranks : {1U, 2U, 3U, 5U}) {
    std::vector<std::size_t> const cuts = random_cuts(c.count, ranks, 21);
    test::ThreadRanks(ranks).run([&](Communicator& here) {
      State const state = rows_of(start, cuts[here.rank()], cuts[here.rank() + 1]);
      Counters const counters;
      Snapshot const now(state, counters, here, c.count);
      LargestSpeed observable;
      observable.begin(now);
      std::vector<double> row(1);
      observable.sample(now, row, true);
      EXPECT_EQ(row[0], expected) << "rank " << here.rank() << " of " << ranks;
    });
  }
}

/// A snapshot's functions are told apart by their results alone: an agent counts once, wherever it is.
TEST(ObservablesOnRanks, SnapshotsCountEachAgentAndEachPairOnce) {
  Case const c{.edge = Edge::wall, .count = 60, .width = 3.0, .seed = 9};
  State const start = start_of(c);
  double const cutoff = 0.3;
  std::uint64_t twice_pairs = 0;
  for (std::size_t i = 0; i < c.count; ++i) {
    for (std::size_t j = 0; j < c.count; ++j) {
      Vector const from{start.agents.column<X>()[i], start.agents.column<Y>()[i]};
      Vector const to{start.agents.column<X>()[j], start.agents.column<Y>()[j]};
      if (i != j && squared_length(start.box.displacement(from, to)) < cutoff * cutoff) ++twice_pairs;
    }
  }
  ASSERT_GT(twice_pairs, 0U);
  for (std::size_t const ranks : {1U, 2U, 5U}) {
    std::vector<std::size_t> const cuts = random_cuts(c.count, ranks, 33);
    test::ThreadRanks(ranks).run([&](Communicator& here) {
      State const state = rows_of(start, cuts[here.rank()], cuts[here.rank() + 1]);
      Counters const counters;
      Snapshot const now(state, counters, here, c.count);
      EXPECT_EQ(now.sum([](std::size_t) { return 1.0; }), static_cast<double>(c.count));
      std::array<std::uint64_t, 1> found{};
      now.pairs(cutoff, [&](NearPair const& pair) {
        EXPECT_LT(squared_length(pair.separation), cutoff * cutoff);
        found[0] += pair.own;
      });
      now.counts(found);
      EXPECT_EQ(found[0], twice_pairs) << ranks;
      double const min_x = now.min([&](std::size_t i) { return state.agents.column<X>()[i]; });
      EXPECT_EQ(min_x, std::ranges::min(start.agents.column<X>()));
    });
  }
}

TEST(ObservablesOnRanks, SearchSlabsThatHoldEachPointOnceAndAboutAsManyEach) {
  Case const c{.count = 20'000, .crowd = 0.5, .seed = 5};
  State const start = start_of(c);
  constexpr std::size_t ranks = 4;
  std::vector<std::size_t> own(ranks);
  std::vector<std::size_t> all(ranks);
  test::ThreadRanks(ranks).run([&](Communicator& here) {
    std::size_t const rank = here.rank();
    State const state = rows_of(start, rank * c.count / ranks, (rank + 1) * c.count / ranks);
    Counters const counters;
    LocalPoints const points(Snapshot(state, counters, here, c.count), 0.01);
    own[rank] = points.own();
    all[rank] = points.size();
  });
  std::size_t sum = 0;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    sum += own[rank];
    EXPECT_NEAR(static_cast<double>(own[rank]), 5000.0, 500.0) << "one row of cells has 400";
    EXPECT_LT(all[rank], 7000U);
  }
  EXPECT_EQ(sum, c.count);
}

}  // namespace
}  // namespace gridlock
