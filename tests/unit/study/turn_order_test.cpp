#include "study/turn_order.hpp"

#include <gtest/gtest.h>

#include <string>

#include "unit/study/holds.hpp"

namespace gridlock {
namespace {

/// A quantity of value 1 in `stepped`, with errors of 1 % over 8 starts and of 0.1 % from start to start.
TurnOrderComparison quantity(double tiled) {
  return {.by_id = {.value = 1.0, .error = 0.01},
          .by_tile = {.value = tiled, .error = 0.01},
          .reference = {.value = 1.25, .error = 0.01},
          .difference = {.value = tiled - 1.0, .error = 0.001},
          .seeds = 8};
}

TurnOrderRow row(double time_step, double tiled) {
  return {.packing_fraction = 0.6,
          .time_step = time_step,
          .times = {128.0},
          .displacements = {quantity(1.0)},
          .centres = {quantity(1.0)},
          .whole = quantity(1.0),
          .rates = {quantity(1.0), quantity(1.0), quantity(tiled)}};
}

std::string text_of(std::vector<TurnOrderRow> const& rows, std::vector<double> const& steps) {
  std::string text;
  for (std::string const& conclusion : conclusions_from(rows, steps)) text += conclusion + "\n";
  return text;
}

TEST(TurnOrder, SaysThatNothingShowsWhereNothingDoesAndHowMuchWould) {
  std::string const text = text_of({row(0.1, 1.0), row(0.025, 1.0)}, {0.1, 0.025});
  EXPECT_TRUE(holds(text, "no difference shows with steps of 0.1 or 0.025")) << text;
  EXPECT_TRUE(holds(text, "4 of 4 comparisons")) << text;
  EXPECT_TRUE(holds(text, "from 0.45 % on")) << text;  // Student's t of 7 degrees of freedom: 4.53 errors
  EXPECT_FALSE(holds(text, "finite time step")) << text;
}

TEST(TurnOrder, ComparesPressuresAndCollisionsStartByStart) {
  // 1.2 %: less than an error of two independent means, and 12 of the difference.
  std::string const text = text_of({row(0.1, 1.012), row(0.025, 1.0)}, {0.1, 0.025});
  EXPECT_TRUE(holds(text, "3 of 4 comparisons")) << text;
  EXPECT_TRUE(holds(text, "collisions per disk and time at φ = 0.6 square (+1.2 %, +12.0 standard errors)")) << text;
  EXPECT_TRUE(holds(text, "So it is an effect of the finite time step")) << text;
  EXPECT_TRUE(holds(text, "differ by at most 1.2 % with steps of 0.1, which themselves shift them by up to 20 %"))
      << text;
}

TEST(TurnOrder, DoesNotCallItTheTimeStepWhereTheShorterOneChangesNothing) {
  std::string text = text_of({row(0.1, 1.02), row(0.025, 1.02)}, {0.1, 0.025});
  EXPECT_TRUE(holds(text, "1 of 4 comparisons differ with steps of 0.1, and 1 of 4 with steps of 0.025")) << text;
  EXPECT_TRUE(holds(text, "the shorter step does not take it away")) << text;
  EXPECT_FALSE(holds(text, "effect of the finite time step")) << text;
  text = text_of({row(0.1, 1.02)}, {0.1});
  EXPECT_TRUE(holds(text, "with steps of 0.1 the order of the turns changes what is measured")) << text;
}

TEST(TurnOrder, SaysHowFarTheCentreTravelsInAPeriodicBox) {
  TurnOrderRow periodic = row(0.1, 1.0);
  periodic.edge = Edge::periodic;
  periodic.rates[0] = {};  // no walls
  periodic.centres = {quantity(0.5)};
  periodic.centres[0].by_id.value = 4.0;
  periodic.centres[0].reference.value = 1e-15;
  std::string text = text_of({periodic}, {0.1});
  EXPECT_TRUE(holds(text, "4 of the side in stepped and 0.5 in tiled at φ = 0.6 with steps of 0.1")) << text;
  EXPECT_TRUE(holds(text, "up to 4 times the root mean square displacement about the centre")) << text;
  EXPECT_TRUE(holds(text, "3 of 3 comparisons")) << text;
  periodic.centres[0].by_id.value = 0.001;
  periodic.centres[0].by_tile.value = 0.001;
  text = text_of({periodic}, {0.1});
  EXPECT_TRUE(holds(text, "It does not matter")) << text;
  EXPECT_FALSE(holds(text_of({row(0.1, 1.0)}, {0.1}), "periodic box"));
}

}  // namespace
}  // namespace gridlock
