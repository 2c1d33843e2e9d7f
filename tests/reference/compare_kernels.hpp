#pragma once

#include <gtest/gtest.h>

#include <limits>

#include "engine/exact/dynamics.hpp"
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

}  // namespace gridlock::reference
