#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <vector>

#include "engine/exact/dynamics.hpp"
#include "engine/exact/near_pairs.hpp"
#include "engine/exact/prediction.hpp"

namespace gridlock::reference {

/// Compares the predictions of every kernel that this processor has with the reference, for all disks as they are now;
/// false where the box has no room for kernels.
inline bool compare_kernels(exact::Dynamics& dynamics) {
  exact::PredictionInput const& input = dynamics.prediction_input();
  if (!exact::has_room_for_registers(input)) return false;
  exact::Predictor const plain = exact::reference_predictor();
  double const now = dynamics.now();
  for (Target const target : {Target::scalar, Target::sse4, Target::neon, Target::avx2, Target::avx512}) {
    if (!is_available(target)) continue;
    SCOPED_TRACE(to_text(target));
    exact::Predictor const kernel = exact::predictor_for(target, input.is_growing()).value();
    for (exact::Index i = 0; i < dynamics.size(); ++i) {
      exact::Prediction const expected = plain.one(input, i, now);
      exact::Prediction const found = kernel.one(input, i, now);
      EXPECT_EQ(expected.time, found.time);
      EXPECT_EQ(expected.partner, found.partner);
      // Any neighbour may be the one it just met; the one it waits for is the one whose absence shows.
      exact::Index const apart = dynamics.disks()[i].partner;
      if (apart >= exact::vertical_border) continue;
      exact::PairPrediction const both = plain.pair(input, i, apart, now);
      exact::PairPrediction const found_both = kernel.pair(input, i, apart, now);
      // Without having touched, the reference may still choose `apart`; a kernel does only where growth overtakes the
      // two.
      EXPECT_TRUE(both.of_i.partner == apart ||
                  (both.of_i.time == found_both.of_i.time && both.of_i.partner == found_both.of_i.partner));
      EXPECT_TRUE(both.of_j.partner == i ||
                  (both.of_j.time == found_both.of_j.time && both.of_j.partner == found_both.of_j.partner));
    }
  }
  return true;
}

/// Compares the events for which the disks of a new dynamics wait with the reference, disk by disk, and the times of
/// contact of all pairs with every target, where the box has room for kernels. Contract: there are no obstacles.
inline void compare_start(exact::Dynamics& dynamics) {
  exact::PredictionInput const& input = dynamics.prediction_input();
  if (!exact::has_room_for_registers(input)) return;
  std::vector<exact::Prediction> found;
  for (exact::Index i = 0; i < dynamics.size(); ++i) {
    found.push_back({dynamics.disks()[i].event_time, dynamics.disks()[i].partner});
  }
  for (exact::Index i = 0; i < dynamics.size(); ++i) dynamics.disks()[i].event_time = exact::never;
  exact::Pairs pairs;
  pairs.make_room_for(dynamics.size() * dynamics.size() / 2);
  for (exact::Index i = 0; i < dynamics.size(); ++i) {
    exact::Prediction const expected = exact::reference_predictor().one(input, i, 0.0);
    EXPECT_EQ(expected.time, found[i].time);
    EXPECT_EQ(expected.partner, found[i].partner);
    for (exact::Index j = 0; j < i; ++j) pairs.add(i, j, true);
  }
  auto const times_with = [&](Target target) {
    exact::near_pairs_for(target, input).find_times(input, pairs);
    return std::vector(pairs.times.begin(), pairs.times.begin() + static_cast<std::ptrdiff_t>(pairs.count));
  };
  std::vector<double> const expected = times_with(Target::scalar);
  for (Target const target : available_targets()) EXPECT_EQ(times_with(target), expected) << to_text(target);
  for (exact::Index i = 0; i < dynamics.size(); ++i) dynamics.disks()[i].event_time = found[i].time;
}

}  // namespace gridlock::reference
