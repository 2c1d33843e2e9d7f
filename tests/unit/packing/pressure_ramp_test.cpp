#include "gridlock/packing/pressure_ramp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "io/checkpoint.hpp"
#include "reference/random_packing.hpp"
#include "unit/packing/same_levels.hpp"

namespace gridlock {
namespace {

using reference::random_packing;

TEST(PressureRamp, FindsWhereATriangularLatticeJams) {
  // Six columns and three pairs of rows; the height makes all six neighbours equally far.
  double const spacing = 1.0 / 6.0;
  double const row = spacing * std::sqrt(3.0) / 2.0;
  Packing packing{
      .box = Box(1.0, 6.0 * row, Edge::periodic), .x = {}, .y = {}, .radius = std::vector<double>(36, 0.09)};
  for (int k = 0; k < 36; ++k) {
    packing.x.push_back((k % 6 + 0.25 + 0.5 * (k / 6 % 2)) * spacing);
    packing.y.push_back((k / 6 + 0.5) * row);
  }
  for (Potential const potential : {Potential::harmonic, Potential::hertzian}) {
    PressureRamp ramp({.minimizer = {.potential = potential}, .pressure = 1e-7}, packing);
    ASSERT_TRUE(ramp.advance());
    ASSERT_EQ(ramp.status(), RampStatus::reached);
    EXPECT_NEAR(ramp.levels().back().pressure, 1e-7, 1e-9);
    EXPECT_NEAR(ramp.levels().back().jamming_packing_fraction, std::numbers::pi / std::sqrt(12.0), 1e-8);
  }
}

TEST(PressureRamp, LeavesASquareLatticeWhichIsASaddle) {
  Packing packing{.box = Box(1.0, 1.0, Edge::periodic), .x = {}, .y = {}, .radius = std::vector<double>(36, 0.09)};
  for (int k = 0; k < 36; ++k) {
    packing.x.push_back((k % 6 + 0.5) / 6);
    packing.y.push_back((k / 6 + 0.5) / 6);
  }
  Minimizer minimizer({}, packing);
  ASSERT_TRUE(minimizer.advance());
  EXPECT_EQ(minimizer.status(), MinimumStatus::converged);
  EXPECT_LT(minimizer.energy(), 0.9 * energy_of(find_contacts(packing), Potential::harmonic));
  PressureRamp ramp({.pressure = 1e-6}, packing);
  ramp.advance();
  EXPECT_GT(ramp.levels().back().jamming_packing_fraction, std::numbers::pi / 4.0 + 0.02);
}

TEST(PressureRamp, ReachesAPressureFromBelow) {
  PressureRamp ramp({.pressure = 1e-4}, random_packing(64, 0.7, 1));
  ASSERT_TRUE(ramp.advance());
  ASSERT_EQ(ramp.status(), RampStatus::reached);
  // Disks count as apart where overlaps of 1e-8 may be left.
  EXPECT_LT(ramp.levels().front().pressure, 1e-8);
  EXPECT_NEAR(ramp.levels().back().pressure, 1e-4, 1e-6);
  // Two minima that press have a slope; the first one has none with those before, which do not.
  ASSERT_GT(ramp.levels()[1].pressure, 0.0);
  EXPECT_TRUE(std::isnan(ramp.levels()[1].jamming_packing_fraction));
  EXPECT_FALSE(std::isnan(ramp.levels().back().jamming_packing_fraction));
}

TEST(PressureRamp, HasLevelsThatAreWhatTheirPackingSays) {
  PressureRamp ramp({.pressure = 1e-3}, random_packing(48, 0.95, 3));
  ASSERT_TRUE(ramp.advance());
  ContactNetwork const network = find_contact_network(ramp.packing(), Potential::harmonic);
  ElasticModuli const moduli = find_elastic_moduli(ramp.packing(), network).value();
  PressureLevel const& level = ramp.levels().back();
  EXPECT_EQ(level.packing_fraction, packing_fraction(ramp.packing()));
  EXPECT_EQ(level.pressure, network.pressure);
  EXPECT_EQ(level.energy, network.energy);
  EXPECT_EQ(level.residual, network.residual_force);
  EXPECT_EQ(level.backbone_disks, network.backbone_disks);
  EXPECT_EQ(level.backbone_contacts, network.backbone_contacts);
  EXPECT_EQ(level.contact_number, network.contact_number());
  EXPECT_EQ(level.excess_contacts, static_cast<double>(network.excess_contacts()));
  EXPECT_EQ(level.bulk_modulus, moduli.bulk());
  EXPECT_EQ(level.shear_modulus, moduli.shear());
  EXPECT_EQ(level.least_shear_modulus, moduli.min_shear());
  std::uint64_t iterations = 0;
  for (PressureLevel const& each : ramp.levels()) iterations += each.iterations;
  EXPECT_EQ(iterations, ramp.minimizer().iterations());
}

TEST(PressureRamp, ComesBackFromBelowToThePackingThatItLeft) {
  PressureRamp down({.pressure = 1e-8}, random_packing(64, 0.9, 2));
  ASSERT_TRUE(down.advance());
  Packing apart = down.packing();
  for (double& radius : apart.radius) radius *= 1.0 - 1e-5;
  PressureRamp up({.pressure = 1e-6}, apart);
  ASSERT_TRUE(up.advance());
  ASSERT_EQ(up.status(), RampStatus::reached);
  EXPECT_EQ(up.levels().front().pressure, 0.0);
  EXPECT_NEAR(up.levels().back().jamming_packing_fraction, down.levels().back().jamming_packing_fraction, 1e-7);
  for (PressureLevel const& level : up.levels()) EXPECT_LT(level.pressure, 1e-4) << "steps are as short as the gaps";
}

TEST(PressureRamp, ReachesAPressureFromJustBelowJammingForMostStarts) {
  int reached = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PressureRamp ramp({.pressure = 1e-6}, random_packing(64, 0.82, seed));
    ASSERT_TRUE(ramp.advance());
    if (ramp.status() != RampStatus::reached) continue;
    ++reached;
    EXPECT_NEAR(ramp.levels().back().pressure, 1e-6, 1e-8);
  }
  EXPECT_GE(reached, 18) << "disks that rearrange at once";
}

TEST(PressureRamp, ComesDownFromTooHighAPressureByAThirdAtATime) {
  int comes_down = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    double const wanted = 1e-6;
    PressureRamp ramp({.pressure = wanted, .step = 5e-3}, random_packing(32, 0.8, seed));
    ASSERT_TRUE(ramp.advance());
    std::vector<PressureLevel> const& levels = ramp.levels();
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
      double const from = levels[k].pressure;
      if (!(from > 12.0 * wanted)) continue;
      ++comes_down;
      EXPECT_GT(levels[k + 1].pressure, 0.09 * from) << "0.32 of it, and 0.3 of that at the least";
    }
  }
  EXPECT_GT(comes_down, 3);
}

TEST(PressureRamp, ReachesHighPressuresAndTakesManySmallStepsToThem) {
  for (double const pressure : {1e-3, 2e-2, 0.3}) {
    PressureRamp ramp({.pressure = pressure}, random_packing(64, 0.5, 1));
    ASSERT_TRUE(ramp.advance());
    ASSERT_EQ(ramp.status(), RampStatus::reached) << pressure;
    EXPECT_NEAR(ramp.levels().back().pressure, pressure, 0.01 * pressure);
  }
  PressureRamp ramp({.pressure = 1e-3, .step = 1e-4}, random_packing(64, 0.83, 1));
  ASSERT_TRUE(ramp.advance());
  EXPECT_EQ(ramp.status(), RampStatus::reached);
}

TEST(PressureRamp, EndsWithinOnePercentOfItsPressure) {
  int missed = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    for (double const pressure : {3e-3, 1e-4, 2e-6}) {
      PressureRamp ramp({.pressure = pressure}, random_packing(32, 0.9, seed));
      ASSERT_TRUE(ramp.advance());
      PressureLevel const& last = ramp.levels().back();
      EXPECT_EQ(last.packing_fraction, packing_fraction(ramp.packing())) << "the last level is the packing at the end";
      bool const is_near = std::abs(last.pressure - pressure) <= 0.01 * pressure;
      EXPECT_EQ(ramp.status() == RampStatus::reached, is_near) << to_text(ramp.status()) << last.pressure;
      if (!is_near) ++missed;
      for (std::size_t k = 1; k < ramp.levels().size(); ++k)
        EXPECT_LT(ramp.levels()[k].pressure, ramp.levels()[k - 1].pressure);
    }
  }
  EXPECT_LE(missed, 2) << "disks that rearrange at once";
}

TEST(PressureRamp, HasTheDistanceOfItsLastTwoEstimatesAsTheError) {
  int falls = 0;
  int rises = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    PressureRamp ramp({.pressure = 1e-4}, random_packing(48, 0.9, seed));
    ASSERT_TRUE(ramp.advance());
    std::optional<double> const error = ramp.error_of_jamming_packing_fraction();
    std::vector<PressureLevel> const& levels = ramp.levels();
    double const last = levels.back().jamming_packing_fraction;
    double const before = levels.size() < 2 ? std::nan("") : levels[levels.size() - 2].jamming_packing_fraction;
    ASSERT_EQ(error.has_value(), std::isfinite(last - before));
    if (!error) continue;
    EXPECT_EQ(*error, std::abs(last - before));
    ++(last < before ? falls : rises);
  }
  EXPECT_GT(falls, 0);
  EXPECT_GT(rises, 0);
}

TEST(PressureRamp, ReachesAPackingFractionFromBothSides) {
  for (double const start : {0.86, 0.9}) {
    PressureRamp ramp({.packing_fraction = 0.88, .step = 0.005}, random_packing(64, start, 1));
    ASSERT_TRUE(ramp.advance());
    ASSERT_EQ(ramp.status(), RampStatus::reached);
    EXPECT_EQ(ramp.levels().size(), 5U);
    EXPECT_NEAR(packing_fraction(ramp.packing()), 0.88, 1e-13);
  }
}

class PressureRampFrom : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(BothSides, PressureRampFrom, testing::Values(0.8, 0.9));

TEST_P(PressureRampFrom, HasTheSameBitsWhenItIsInterruptedAndRestored) {
  Packing const start = random_packing(64, GetParam(), 4);
  PressureRampSettings const settings{.pressure = 1e-5};
  PressureRamp whole(settings, start);
  whole.advance();
  PressureRamp current(settings, start);
  int pieces = 0;
  for (bool is_done = false; !is_done; ++pieces) {
    is_done = current.advance([] { return false; });
    if (pieces % 29 != 3) continue;
    PressureRamp restored(settings, random_packing(64, 0.5, 77));
    from_checkpoint(to_checkpoint([&](Archive& archive) { current.serialize(archive); }), "saved",
                    [&](Archive& archive) { restored.serialize(archive); });
    restored.advance();
    ASSERT_EQ(restored.packing().x, whole.packing().x) << pieces;
    ASSERT_EQ(restored.packing().radius, whole.packing().radius);
    expect_same(restored.levels(), whole.levels());
  }
  EXPECT_GT(pieces, 100);
  EXPECT_EQ(current.packing().x, whole.packing().x);
}

/// An archive that restores from another, but for one number.
class WithNumber final : public Archive {
 public:
  WithNumber(Archive& archive, std::string_view name, std::uint64_t number)
      : archive_(archive), name_(name), number_(number) {}

  [[nodiscard]] bool is_restoring() const override { return archive_.is_restoring(); }
  [[nodiscard]] bool has(std::string_view name) const override { return archive_.has(name); }
  void enter(std::string_view name) override { archive_.enter(name); }
  void leave() override { archive_.leave(); }
  void visit(std::string_view name, std::uint64_t& value) override {
    archive_.visit(name, value);
    if (name == name_) value = number_;
  }
  void visit(std::string_view name, bool& value) override { archive_.visit(name, value); }
  void visit(std::string_view name, double& value) override { archive_.visit(name, value); }
  void visit(std::string_view name, std::string& value) override { archive_.visit(name, value); }
  void visit(std::string_view name, std::vector<double>& values) override { archive_.visit(name, values); }
  void visit(std::string_view name, std::vector<std::int32_t>& values) override { archive_.visit(name, values); }
  void visit(std::string_view name, std::vector<std::uint32_t>& values) override { archive_.visit(name, values); }
  void visit(std::string_view name, std::vector<std::uint64_t>& values) override { archive_.visit(name, values); }

 private:
  Archive& archive_;
  std::string_view name_;
  std::uint64_t number_;
};

TEST(PressureRamp, KnowsWhenItIsRestoredHowOftenItHasBeenNearItsEnd) {
  // A ramp that has been near its end twenty times gives up at the next minimum that is near and not there.
  int missed = 0;
  int missed_at_once = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Packing const start = random_packing(32, 0.9, seed);
    PressureRampSettings const settings{.pressure = 1e-4};
    PressureRamp current(settings, start);
    std::size_t levels = 0;
    for (bool is_done = false; !is_done;) {
      is_done = current.advance([] { return false; });
      // One look for each level; the last one leads to the end.
      if (current.levels().size() == levels) continue;
      levels = current.levels().size();
      std::string const saved = to_checkpoint([&](Archive& archive) { current.serialize(archive); });
      for (std::uint64_t const times : {0U, 20U}) {
        PressureRamp restored(settings, start);
        from_checkpoint(saved, "saved", [&](Archive& archive) {
          WithNumber edited(archive, "minima_near_end", times);
          restored.serialize(edited);
        });
        ASSERT_TRUE(restored.advance());
        if (restored.status() == RampStatus::missed) ++(times == 0 ? missed_at_once : missed);
      }
    }
  }
  EXPECT_GT(missed, 0);
  EXPECT_EQ(missed_at_once, 0);
}

TEST(PressureRamp, TellsWhereAMinimizationGaveUp) {
  PressureRamp ramp({.minimizer = {.iterations = 10}}, random_packing(64, 0.9, 1));
  EXPECT_TRUE(ramp.advance());
  EXPECT_EQ(ramp.status(), RampStatus::unconverged);
}

TEST(PressureRamp, SavesAsManyLevelsAsItHas) {
  std::vector<PressureLevel> levels(150'000);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    levels[k].packing_fraction = 0.8 + 1e-7 * static_cast<double>(k);
    levels[k].backbone_disks = k;
  }
  std::string const saved = to_checkpoint([&](Archive& archive) { serialize(archive, levels); });
  std::vector<PressureLevel> restored(3);
  from_checkpoint(saved, "saved", [&](Archive& archive) { serialize(archive, restored); });
  ASSERT_EQ(restored.size(), levels.size());
  EXPECT_EQ(restored[149'999].packing_fraction, levels[149'999].packing_fraction);
  EXPECT_EQ(restored[77'777].backbone_disks, 77'777U);
  EXPECT_TRUE(std::isnan(restored[5].bulk_modulus)) << "no number stays none";
}

TEST(PressureRamp, RefusesMoreLevelsThanAnybodyKeeps) {
  Packing const start = random_packing(16, 0.5, 1);
  EXPECT_THROW(PressureRamp({.packing_fraction = 0.7, .step = 1e-7}, start), Error);
  EXPECT_THROW(PressureRamp({.packing_fraction = 0.3, .step = 1e-7}, start), Error);
  EXPECT_NO_THROW(PressureRamp({.packing_fraction = 0.59, .step = 1e-7}, start));
}

TEST(PressureRamp, RefusesEndsThatCannotBeReached) {
  Packing const start = random_packing(16, 0.5, 1);
  EXPECT_THROW(PressureRamp({.pressure = 0.0}, start), Error);
  EXPECT_THROW(PressureRamp({.pressure = 2.0}, start), Error);
  EXPECT_THROW(PressureRamp({.packing_fraction = 5.0}, start), Error);
  EXPECT_THROW(PressureRamp({.levels_per_decade = 0}, start), Error);
  EXPECT_THROW(PressureRamp({.step = 0.0}, start), Error);
}

}  // namespace
}  // namespace gridlock
