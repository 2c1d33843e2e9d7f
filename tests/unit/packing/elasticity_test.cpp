#include "gridlock/packing/elasticity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gridlock/packing/minimizer.hpp"
#include "reference/soft_minimum.hpp"
#include "unit/packing/packings.hpp"

namespace gridlock {
namespace {

struct Known {
  char const* name;
  double bulk;
  double shear;
  bool is_stable;
};

TEST(ElasticModuli, OfKnownPackings) {
  for (Known const& known : {Known{"over", 27.948968, 4.5018203, true},
                             {"mid", 18.622292, 0.47092151, false},
                             {"marginal", 19.30870, 0.590710, false}}) {
    Packing const packing = harmonic64(known.name);
    ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
    std::optional<ElasticModuli> const moduli = find_elastic_moduli(packing, network);
    ASSERT_TRUE(moduli.has_value()) << known.name;
    double const unit = network.smallest_diameter * network.smallest_diameter;
    EXPECT_NEAR(moduli->bulk(), known.bulk * unit, 1e-6 * known.bulk * unit) << known.name;
    EXPECT_NEAR(moduli->shear(), known.shear * unit, 1e-6 * known.shear * unit) << known.name;
    EXPECT_LT(moduli->min_shear(), moduli->shear());
    EXPECT_LE(moduli->min_shear(), std::min(moduli->shear_xy(), moduli->shear_xx_yy()));
    // A direction between xy and xx−yy gives way: the box was not free to shear when these were made.
    EXPECT_EQ(moduli->is_shear_stable(), known.is_stable) << moduli->min_shear() / unit;
  }
}

TEST(ElasticModuli, OfATriangularLatticeAreThoseOfItsSprings) {
  // Springs of stiffness k = 1/σ² of length a: K = √3 k/2 and G = √3 k/4 without stress, in a unit of D² = σ².
  for (std::size_t const side : {4UL, 12UL}) {
    Packing const packing = triangular_lattice(side, side, 1e-9);
    std::optional<ElasticModuli> const moduli =
        find_elastic_moduli(packing, find_contact_network(packing, Potential::harmonic));
    ASSERT_TRUE(moduli.has_value());
    EXPECT_NEAR(moduli->bulk(), std::sqrt(3.0) / 2.0, 1e-8);
    EXPECT_NEAR(moduli->shear_xy(), std::sqrt(3.0) / 4.0, 1e-8);
    EXPECT_NEAR(moduli->shear_xx_yy(), std::sqrt(3.0) / 4.0, 1e-8);
    EXPECT_NEAR(moduli->xxxy, 0.0, 1e-12);
  }
}

/// φ dp/dφ of the minima at packing fractions that differ a little.
double bulk_modulus_by_differences(Packing const& packing, Potential potential) {
  double const step = 1e-6;
  std::vector<double> pressures;
  for (double const sign : {-1.0, 1.0}) {
    Packing scaled = packing;
    reference::scale_radii(scaled, 1.0 + sign * step);
    scaled = reference::minimum_near(scaled, potential);
    pressures.push_back(find_contact_network(scaled, potential).pressure);
  }
  return (pressures[1] - pressures[0]) / (4.0 * step);  // φ grows by twice the share of the radii
}

TEST(ElasticModuli, GiveTheChangeOfThePressureAsRadiiScale) {
  for (Potential const potential : {Potential::harmonic, Potential::hertzian}) {
    for (Edge const edge : {Edge::periodic, Edge::wall}) {
      Packing const packing =
          reference::minimum_near(reference::random_packing(24, 0.98, Box(1.0, 1.2, edge), 5), potential);
      ContactNetwork const network = find_contact_network(packing, potential);
      ASSERT_EQ(network.is_jammed(usual_largest_residual, find_softest_mode(network)->eigenvalue), true)
          << network.residual_force;
      std::optional<ElasticModuli> const moduli = find_elastic_moduli(packing, network);
      ASSERT_TRUE(moduli.has_value());
      double const expected = bulk_modulus_by_differences(packing, potential);
      EXPECT_NEAR(moduli->bulk() + 0.5 * network.pressure, expected, 1e-5 * expected);
      EXPECT_EQ(std::isnan(moduli->xyxy), edge == Edge::wall) << "a box between walls keeps its angles";
      EXPECT_FALSE(std::isnan(moduli->shear()));
    }
  }
}

TEST(GrowthResponse, IsTheMotionOfTheDisksAsRadiiScale) {
  double const step = 1e-7;
  for (Potential const potential : {Potential::harmonic, Potential::hertzian}) {
    for (Edge const edge : {Edge::periodic, Edge::wall}) {
      Packing const packing =
          reference::minimum_near(reference::random_packing(24, 0.98, Box(1.0, 1.2, edge), 5), potential);
      ContactNetwork const network = find_contact_network(packing, potential);
      std::optional<GrowthResponse> const response = find_growth_response(network);
      ASSERT_TRUE(response.has_value());
      Packing grown = packing;
      reference::scale_radii(grown, 1.0 + step);
      grown = reference::minimum_near(grown, potential);
      // A periodic packing may be shifted as a whole.
      std::optional<Vector> shift;
      for (std::size_t i = 0; i < packing.size(); ++i) {
        if (network.is_rattler[i]) {
          EXPECT_EQ(squared_length(response->displacement[i]), 0.0);
          continue;
        }
        Vector const moved{(grown.x[i] - packing.x[i]) / step, (grown.y[i] - packing.y[i]) / step};
        if (!shift) shift = edge == Edge::periodic ? moved - response->displacement[i] : Vector{};
        EXPECT_NEAR(response->displacement[i].x + shift->x, moved.x, 1e-4) << i;
        EXPECT_NEAR(response->displacement[i].y + shift->y, moved.y, 1e-4) << i;
      }
    }
  }
}

TEST(GrowthResponse, NothingThatCarriesHasNone) {
  Packing const apart{.box = Box(1.0, 1.0, Edge::periodic), .x = {0.2, 0.7}, .y = {0.5, 0.5}, .radius = {0.1, 0.1}};
  EXPECT_FALSE(find_growth_response(find_contact_network(apart, Potential::harmonic)).has_value());
}

/// The contacts of a packing in a strained box, from whose affine places the disks move by `displacement`.
std::vector<Contact> strained(std::vector<Contact> contacts, double xx, double yy, double xy,
                              Eigen::VectorXd const& displacement) {
  for (Contact& contact : contacts) {
    Vector const r = contact.distance * contact.normal;
    auto const a = static_cast<Eigen::Index>(2 * contact.first);
    auto const b = static_cast<Eigen::Index>(2 * contact.second);
    Vector const d{(1.0 + xx) * r.x + xy * r.y + displacement(b) - displacement(a),
                   xy * r.x + (1.0 + yy) * r.y + displacement(b + 1) - displacement(a + 1)};
    contact.distance = std::sqrt(squared_length(d));
    contact.normal = {d.x / contact.distance, d.y / contact.distance};
  }
  return contacts;
}

/// The least energy of the contacts in a box strained by a finite amount; the disk 0 stays.
double min_energy(std::vector<Contact> const& contacts, std::size_t disks, Potential potential, double xx, double yy,
                  double xy) {
  std::vector<bool> moves(disks, true);
  moves[0] = false;
  Unknowns const unknowns(moves);
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(2 * disks));
  for (int step = 0; step < 6; ++step) {
    std::vector<Contact> const now = strained(contacts, xx, yy, xy, displacement);
    std::vector<Vector> const forces = forces_of(now, potential, disks);
    Eigen::VectorXd force(static_cast<Eigen::Index>(2 * disks - 2));
    for (std::size_t i = 1; i < disks; ++i) {
      force(static_cast<Eigen::Index>(2 * i - 2)) = forces[i].x;
      force(static_cast<Eigen::Index>(2 * i - 1)) = forces[i].y;
    }
    displacement.tail(force.size()) +=
        Eigen::SimplicialLLT<SparseMatrix>(hessian_of(now, potential, unknowns)).solve(force);
  }
  return energy_of(strained(contacts, xx, yy, xy, displacement), potential);
}

TEST(ElasticModuli, AreTheCurvatureOfTheEnergyUnderFiniteStrains) {
  Packing const packing = harmonic64("over");
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
  ElasticModuli const moduli = find_elastic_moduli(packing, network).value();
  double const unit = network.smallest_diameter * network.smallest_diameter;
  double const step = 1e-5;
  auto const energy = [&](double xx, double yy, double xy) {
    return min_energy(network.contacts, packing.size(), Potential::harmonic, xx * step, yy * step, xy * step);
  };
  // e_xy = ½: the shear strain γ is 1.
  auto const curvature = [&](double xx, double yy, double xy) {
    return unit * (energy(xx, yy, xy) + energy(-xx, -yy, -xy) - 2.0 * energy(0, 0, 0)) / (step * step);
  };
  double const bound = 3e-6 * moduli.xxxx;
  EXPECT_NEAR(moduli.xxxx, curvature(1, 0, 0), bound);
  EXPECT_NEAR(moduli.yyyy, curvature(0, 1, 0), bound);
  EXPECT_NEAR(moduli.xyxy, curvature(0, 0, 0.5), bound);
  EXPECT_NEAR(moduli.xxyy, 0.25 * (curvature(1, 1, 0) - curvature(1, -1, 0)), bound);
  EXPECT_NEAR(moduli.xxxy, 0.25 * (curvature(1, 0, 0.5) - curvature(1, 0, -0.5)), bound);
  EXPECT_NEAR(moduli.yyxy, 0.25 * (curvature(0, 1, 0.5) - curvature(0, 1, -0.5)), bound);
}

TEST(ElasticModuli, HaveTheLeastShearOfAllDirections) {
  for (std::uint64_t const seed : {1U, 2U, 5U}) {
    Packing const packing = reference::minimum_near(
        reference::random_packing(24, 0.98, Box(1.0, 1.2, Edge::periodic), seed), Potential::harmonic);
    std::optional<ElasticModuli> const moduli =
        find_elastic_moduli(packing, find_contact_network(packing, Potential::harmonic));
    ASSERT_TRUE(moduli.has_value());
    double least = moduli->shear_xy();
    for (int step = 0; step < 3600; ++step) {
      // The box becomes longer by c along x and shorter along y, and is sheared by s.
      double const angle = step * 3.141592653589793 / 1800.0;
      double const c = 0.5 * std::cos(angle);
      double const s = std::sin(angle);
      least = std::min(least, c * c * (moduli->xxxx + moduli->yyyy - 2.0 * moduli->xxyy) + s * s * moduli->xyxy +
                                  2.0 * c * s * (moduli->xxxy - moduli->yyxy));
    }
    EXPECT_NEAR(moduli->min_shear(), least, 1e-5 * moduli->shear()) << seed;
  }
}

TEST(ElasticModuli, AreThereOnlyWhereSomethingCarries) {
  Packing const hard = triangular_lattice(4, 4, -1e-6);
  EXPECT_FALSE(find_elastic_moduli(hard, find_contact_network(hard, Potential::harmonic)).has_value());
  EXPECT_FALSE(find_elastic_moduli(hard, find_contact_network(hard, Potential::harmonic, 1e-5)).has_value());
  EXPECT_FALSE(find_softest_mode(find_contact_network(hard, Potential::harmonic, 1e-5)).has_value());
  // A square lattice has directions that cost nothing, and less than nothing under pressure.
  Packing square{.box = Box(4.0, 4.0, Edge::periodic), .x = {}, .y = {}, .radius = std::vector<double>(16, 0.51)};
  for (int k = 0; k < 16; ++k) {
    square.x.push_back(k % 4);
    square.y.push_back(k / 4);
  }
  ContactNetwork const network = find_contact_network(square, Potential::harmonic);
  EXPECT_TRUE(network.is_converged());
  EXPECT_FALSE(find_elastic_moduli(square, network).has_value());
  EXPECT_LT(find_softest_mode(network).value().eigenvalue, -1e-3);
  // Without pressure they cost nothing, whatever the last bits of the contacts say.
  for (int columns = 3; columns <= 9; ++columns) {
    for (int ulps = 1; ulps <= 4; ++ulps) {
      Packing rows{.box = Box(columns, 4.0, Edge::periodic), .x = {}, .y = {}, .radius = {}};
      for (int k = 0; k < 4 * columns; ++k) {
        rows.x.push_back(k % columns);
        rows.y.push_back(k / columns);
        rows.radius.push_back(0.5 * (1.0 + 0x1p-52 * ulps));
      }
      ContactNetwork const slack = find_contact_network(rows, Potential::harmonic);
      EXPECT_FALSE(find_elastic_moduli(rows, slack).has_value()) << columns << " columns, " << ulps << " last bits";
      EXPECT_FALSE(find_growth_response(slack).has_value());
    }
  }
  square.radius.assign(16, 0.5 * (1.0 + 1e-13));
  EXPECT_FALSE(find_elastic_moduli(square, find_contact_network(square, Potential::harmonic)).has_value());
}

TEST(SoftestMode, IsTheLowestEigenvalueOfTheHessianButForShifts) {
  // By another program; the eigenvalues of a box of side 1.
  for (Known const& known :
       {Known{"over", 0.548557239, 0, true}, {"mid", 0.0311508128, 0, true}, {"marginal", 0.0511176185, 0, true}}) {
    ContactNetwork const network = find_contact_network(harmonic64(known.name), Potential::harmonic);
    VibrationMode const mode = find_softest_mode(network).value();
    double const unit = network.smallest_diameter * network.smallest_diameter;
    EXPECT_NEAR(mode.eigenvalue, unit * known.bulk, 1e-8 * unit * known.bulk) << known.name;
    double squares = 0.0;
    Vector sum{};
    for (std::size_t i = 0; i < network.size(); ++i) {
      squares += squared_length(mode.displacement[i]);
      sum = sum + mode.displacement[i];
      EXPECT_TRUE(!network.is_rattler[i] || mode.displacement[i] == Vector{});
    }
    EXPECT_NEAR(squares, 1.0, 1e-12);
    EXPECT_NEAR(squared_length(sum), 0.0, 1e-20);
  }
}

TEST(SoftestMode, HasALargestComponentAboveZero) {
  std::vector<Packing> packings{harmonic64("over"), harmonic64("mid"), harmonic64("marginal"),
                                triangular_lattice(16, 14, 1e-6)};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Minimizer minimizer({}, reference::random_packing(40, 0.95, Box(1.0, 1.3, Edge::periodic), seed));
    minimizer.advance();
    packings.push_back(minimizer.packing());
  }
  for (Packing const& packing : packings) {
    VibrationMode const mode = find_softest_mode(find_contact_network(packing, Potential::harmonic)).value();
    double largest = 0.0;
    for (Vector const u : mode.displacement) {
      for (double const component : {u.x, u.y}) {
        if (std::abs(component) > std::abs(largest)) largest = component;
      }
    }
    EXPECT_GT(largest, 0.0);
  }
}

TEST(SoftestMode, OfATriangularLatticeIsItsLongestTransverseWave) {
  // ω² = k [3 − 2 cos(q/2) … ] of waves along a row: transverse 3 k (1 − cos(q/2)) with q = 2π/16, k = 1/σ²; a Lanczos
  // of 256 disks.
  Packing const packing = triangular_lattice(16, 16, 1e-10);
  VibrationMode const mode = find_softest_mode(find_contact_network(packing, Potential::harmonic)).value();
  double const half = 3.141592653589793 / 16.0;
  EXPECT_NEAR(mode.eigenvalue, 3.0 * (1.0 - std::cos(half)), 1e-7);
}

TEST(SoftestMode, OfADisksBetweenFourWallsIsItsRattling) {
  Packing const packing{.box = Box(0.98, 0.96, Edge::wall), .x = {0.49}, .y = {0.48}, .radius = {0.5}};
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
  // Two walls of stiffness 1/R² along each axis, in a unit of D² = 4 R².
  EXPECT_NEAR(find_softest_mode(network).value().eigenvalue, 8.0, 1e-12);
}

}  // namespace
}  // namespace gridlock
