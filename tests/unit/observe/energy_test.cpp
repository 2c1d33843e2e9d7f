#include "observe/energy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

State two_masses() {
  State state = empty_state(Box(1, 1, Edge::wall));
  add_disk(state, {0.2, 0.5}, {3, 4}, 0.01, 2.0);  // ½·2·25
  add_disk(state, {0.8, 0.5}, {0, 1}, 0.01, 6.0);  // ½·6·1
  return state;
}

TEST(Energy, IsHalfTheSumOfMassTimesSquaredSpeed) {
  State const state = two_masses();
  Energy energy;
  energy.begin({state, {}});
  EXPECT_DOUBLE_EQ(cell(energy, sample(energy, state), "kinetic_energy"), 28.0);
}

TEST(Energy, DriftIsTheRelativeChangeSinceTheStart) {
  State state = two_masses();
  Energy energy;
  energy.begin({state, {}});
  state.agents.column<VelocityY>()[1] = 3.0;  // +24
  auto const row = sample(energy, state, {}, false);
  EXPECT_DOUBLE_EQ(cell(energy, row, "kinetic_energy_drift"), 24.0 / 28.0);
  ASSERT_TRUE(result(energy, "kinetic_energy_drift"));
  EXPECT_DOUBLE_EQ(result(energy, "kinetic_energy_drift")->value, 24.0 / 28.0);
  EXPECT_FALSE(result(energy, "kinetic_energy_drift")->error);
  EXPECT_FALSE(result(energy, "kinetic_energy")) << "no sample counted";
}

TEST(Energy, AConstantEnergyHasErrorZeroAndAChangingOneHasNot) {
  State state = two_masses();
  Energy energy;
  energy.begin({state, {}});
  for (int n = 0; n < 5; ++n) sample(energy, state);
  EXPECT_EQ(*result(energy, "kinetic_energy")->error, 0.0);
  state.agents.column<VelocityY>()[1] = 3.0;
  sample(energy, state);
  EXPECT_GT(*result(energy, "kinetic_energy")->error, 0.0);
}

TEST(Energy, DisksAtRestHaveNoDrift) {
  State state = empty_state(Box(1, 1, Edge::wall));
  add_disk(state, {0.5, 0.5});
  Energy energy;
  energy.begin({state, {}});
  auto const row = sample(energy, state);
  EXPECT_EQ(cell(energy, row, "kinetic_energy"), 0.0);
  EXPECT_TRUE(std::isnan(cell(energy, row, "kinetic_energy_drift")));
  EXPECT_FALSE(result(energy, "kinetic_energy_drift"));
}

}  // namespace
}  // namespace gridlock
