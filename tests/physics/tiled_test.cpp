// `tiled` takes the turns of `stepped` in another order. It is the same rule: what is measured of the two differs as far as
// the time step is finite, and the differences go away with it (docs/explanation/paper.md, "The order of the turns").

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "gridlock/simulation/simulate.hpp"

namespace gridlock {
namespace {

constexpr double papers_step = 0.1;    // diameters per v_max
constexpr double short_step = 0.0125;  // an eighth of it
constexpr double usual_length = 40.0;  // diameters per v_max

struct Scene {
  double packing_fraction = 0.0;
  Edge edge = Edge::wall;
  StartKind start = StartKind::square;
  double time_step = papers_step;
  double length = usual_length;
};

using Values = std::map<std::string, double>;

Values values_of(std::string const& engine, Scene const& scene, std::uint64_t seed) {
  Configuration configuration;
  configuration.box.edge = scene.edge;
  configuration.disks = {.count = 841, .packing_fraction = scene.packing_fraction, .start = scene.start};
  configuration.engine.kind = engine;
  configuration.engine.time_step = scene.time_step;
  configuration.engine.threads = 1;
  auto const steps_in = [&](double length) {
    return static_cast<std::uint64_t>(std::lround(length / scene.time_step));
  };
  configuration.run = {.steps = steps_in(scene.length), .seed = seed};
  configuration.observe.every = steps_in(1.0);
  configuration.observe.structure_every = 0;
  RunResult const result = simulate(set_up(configuration));
  Values values;
  for (NamedEstimate const& named : result.results) values[named.name] = named.estimate.value;
  double const side = result.world.box.side();
  values["displacement_about_centre"] = std::sqrt(values["mean_squared_displacement"] / (side * side) -
                                                  values["centre_displacement"] * values["centre_displacement"]);
  return values;
}

/// tiled minus stepped from the same start, in parts of stepped: mean over starts with its error from their scatter.
struct Difference {
  double stepped = 0.0;
  double tiled = 0.0;
  double relative = 0.0;
  double error = 0.0;
};

class Orders {
 public:
  Orders(Scene const& scene, int seeds) {
    for (int seed = 1; seed <= seeds; ++seed) {
      stepped_.push_back(values_of("stepped", scene, static_cast<std::uint64_t>(seed)));
      tiled_.push_back(values_of("tiled", scene, static_cast<std::uint64_t>(seed)));
    }
  }

  [[nodiscard]] Difference of(std::string const& observable) const {
    double const n = static_cast<double>(stepped_.size());
    Difference difference;
    for (std::size_t k = 0; k < stepped_.size(); ++k) {
      difference.stepped += stepped_[k].at(observable) / n;
      difference.tiled += tiled_[k].at(observable) / n;
    }
    difference.relative = difference.tiled / difference.stepped - 1.0;
    double squares = 0.0;
    for (std::size_t k = 0; k < stepped_.size(); ++k) {
      double const one = (tiled_[k].at(observable) - stepped_[k].at(observable)) / difference.stepped;
      squares += (one - difference.relative) * (one - difference.relative);
    }
    difference.error = std::sqrt(squares / (n * (n - 1.0)));
    return difference;
  }

 private:
  std::vector<Values> stepped_;
  std::vector<Values> tiled_;
};

/// Four standard errors: two engines that agree fail in one of 16,000 comparisons, or with 16 starts in one of 900.
void expect_agreement(Orders const& orders, std::string const& observable, double largest_error) {
  Difference const difference = orders.of(observable);
  EXPECT_GT(difference.error, 0.0) << observable;
  EXPECT_LT(std::abs(difference.relative), 4.0 * difference.error)
      << observable << ": stepped " << difference.stepped << ", tiled " << difference.tiled << ", "
      << difference.relative << " ± " << difference.error;
  EXPECT_LT(difference.error, largest_error) << observable << " is too uncertain to tell anything";
}

void expect_within(Orders const& orders, std::string const& observable, double bound) {
  Difference const difference = orders.of(observable);
  EXPECT_LT(std::abs(difference.relative) + 2.0 * difference.error, bound)
      << observable << ": stepped " << difference.stepped << ", tiled " << difference.tiled << ", "
      << difference.relative << " ± " << difference.error;
}

TEST(TiledPhysics, AgreesWithSteppedAtAShortStep) {
  constexpr int starts = 16;
  for (double const packing_fraction : {0.3, 0.6}) {
    SCOPED_TRACE(packing_fraction);
    Orders const orders({.packing_fraction = packing_fraction, .time_step = short_step}, starts);
    expect_agreement(orders, "mean_displacement", 0.05);
    for (char const* name : {"wall_pressure", "compressibility_factor", "collision_rate", "halted_fraction"}) {
      expect_agreement(orders, name, 0.005);
    }
  }
  Orders const periodic({.packing_fraction = 0.5, .edge = Edge::periodic, .time_step = short_step}, starts);
  expect_agreement(periodic, "displacement_about_centre", 0.05);
  for (char const* name : {"compressibility_factor", "collision_rate", "halted_fraction"}) {
    expect_agreement(periodic, name, 0.005);
  }
}

/// 64 starts over 128 diameters differ by 1.25 % in collisions at φ = 0.3, 0.70 % at 0.6, and less in pressures.
TEST(TiledPhysics, DiffersByLessThanTwoPercentInTheFluidAtThePapersStep) {
  constexpr int starts = 48;
  for (double const packing_fraction : {0.3, 0.6}) {
    SCOPED_TRACE(packing_fraction);
    Orders const orders({.packing_fraction = packing_fraction}, starts);
    for (char const* name : {"wall_pressure", "compressibility_factor", "collision_rate", "halted_fraction"}) {
      expect_within(orders, name, 0.02);
    }
    expect_within(orders, "mean_displacement", 0.10);
    // There is a difference, or nobody would have to know.
    Difference const collisions = orders.of("collision_rate");
    EXPECT_GT(collisions.relative, 4.0 * collisions.error);
  }
}

/// In the crystal disks of `tiled` creep 0.63(4) times as far as those of `stepped`; hard disks go 0.0029 of the side.
TEST(TiledPhysics, CreepsLessThanSteppedThroughTheCrystalAtThePapersStep) {
  Orders const orders({.packing_fraction = 0.8, .start = StartKind::triangular, .length = 128.0}, 16);
  Difference const creep = orders.of("mean_displacement");
  EXPECT_LT(creep.relative, 0.0) << creep.tiled << " " << creep.stepped;
  EXPECT_GT(creep.relative, -0.6) << creep.tiled << " " << creep.stepped;
  expect_within(orders, "compressibility_factor", 0.02);
  expect_within(orders, "collision_rate", 0.02);
}

/// Halting keeps the momentum but not the motion of the centre: it travels, as fast as the step is long.
TEST(TiledPhysics, LetsTheCentreOfAPeriodicBoxTravelInProportionToTheStep) {
  constexpr int starts = 4;
  Scene scene{.packing_fraction = 0.5, .edge = Edge::periodic};
  Difference const coarse = Orders(scene, starts).of("centre_displacement");
  scene.time_step = 0.25 * papers_step;
  Difference const fine = Orders(scene, starts).of("centre_displacement");
  for (auto const engine : {&Difference::stepped, &Difference::tiled}) {
    EXPECT_GT(fine.*engine, 1e-4);
    EXPECT_GT(coarse.*engine / fine.*engine, 3.0);
    EXPECT_LT(coarse.*engine / fine.*engine, 5.0);
  }
  EXPECT_LT(values_of("exact", scene, 1).at("centre_displacement"), 1e-10);
}

TEST(TiledPhysics, MovesTheDisksOfAPeriodicBoxAboutTheirCentreAsSteppedDoes) {
  Orders const orders({.packing_fraction = 0.7, .edge = Edge::periodic}, 16);
  Difference const whole = orders.of("mean_displacement");
  EXPECT_LT(whole.relative + 4.0 * whole.error, 0.0) << "the centre of stepped goes farther at this density";
  expect_within(orders, "displacement_about_centre", 0.15);
}

}  // namespace
}  // namespace gridlock
