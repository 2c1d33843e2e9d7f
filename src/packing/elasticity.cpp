#include "gridlock/packing/elasticity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "packing/eigen.hpp"
#include "packing/hessian.hpp"

namespace gridlock {

namespace {

using Cholesky = Eigen::SimplicialLLT<SparseMatrix>;

/// The images of a vector under unit strains xx, yy and xy; the last has γ = 2 e_xy = 1, so sums run over xy and yx.
constexpr std::size_t strains = 3;
std::array<Vector, strains> strained(Vector r) { return {{{r.x, 0.0}, {0.0, r.y}, {0.5 * r.y, 0.5 * r.x}}}; }

struct StrainedBackbone {
  Eigen::MatrixXd force;  ///< Ξ, the forces on the disks; a column for each strain
  Eigen::Matrix3d born;   ///< second derivatives of the energy by two strains at fixed disks
};

StrainedBackbone strain(ContactNetwork const& network, std::span<Contact const> contacts, Unknowns const& unknowns) {
  StrainedBackbone result{.force = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(2 * unknowns.disks), strains),
                          .born = Eigen::Matrix3d::Zero()};
  auto const add = [&](std::uint32_t disk, Eigen::Index column, Vector change) {
    std::uint32_t const place = unknowns.place[disk];
    if (place == Unknowns::none) return;
    auto const row = 2 * static_cast<Eigen::Index>(place);
    result.force(row, column) += change.x;
    result.force(row + 1, column) += change.y;
  };
  for (Contact const& contact : contacts) {
    bool const is_at_wall = contact.second >= network.size();
    HessianBlock const block = block_of(contact, network.potential, is_at_wall);
    auto const stretches = strained(contact.distance * contact.normal);
    for (std::size_t a = 0; a < strains; ++a) {
      Vector const change = block * stretches[a];
      auto const column = static_cast<Eigen::Index>(a);
      add(contact.first, column, -1.0 * change);
      if (!is_at_wall) add(contact.second, column, change);
      for (std::size_t b = 0; b < strains; ++b) {
        result.born(static_cast<Eigen::Index>(b), column) += dot(stretches[b], change);
      }
    }
  }
  return result;
}

/// Returns whether some motion costs no energy, up to rounding.
bool is_loose(Cholesky const& cholesky) {
  SparseMatrix const factor = cholesky.matrixL();
  Eigen::VectorXd const diagonal = factor.diagonal();
  return diagonal.size() > 0 && diagonal.minCoeff() < 3e-7 * diagonal.maxCoeff();
}

/// Returns the unknowns: the disks of the backbone, without the first in a periodic packing, which could be shifted.
Unknowns held(ContactNetwork const& network) {
  std::vector<bool> moves(network.size());
  bool holds_next = network.is_periodic;
  for (std::size_t i = 0; i < network.size(); ++i) {
    moves[i] = !network.is_rattler[i] && !holds_next;
    if (!network.is_rattler[i]) holds_next = false;
  }
  return Unknowns(moves);
}

}  // namespace

double ElasticModuli::shear() const { return std::isnan(xyxy) ? shear_xx_yy() : 0.5 * (xyxy + shear_xx_yy()); }

double ElasticModuli::min_shear() const {
  if (std::isnan(xyxy)) return shear_xx_yy();
  // The softest shear is the smaller eigenvalue of the two shears, which a turn by 45° exchanges.
  double const half_difference = 0.5 * (shear_xx_yy() - xyxy);
  double const between = 0.5 * (xxxy - yyxy);
  return shear() - std::sqrt(half_difference * half_difference + between * between);
}

double simple_shear_modulus(ElasticModuli const& moduli, ContactNetwork const& network) {
  StressTensor const& stress = network.stress;
  return moduli.shear_xy() - 0.5 * network.pressure + 0.5 * (stress.yy - stress.xx);
}

double pure_shear_modulus(ElasticModuli const& moduli, ContactNetwork const& network) {
  return moduli.shear_xx_yy() - 0.5 * network.pressure;
}

std::optional<GrowthResponse> find_growth_response(ContactNetwork const& network, BoxShape shape) {
  if (network.backbone_disks == 0 || network.tolerance > 0.0) return std::nullopt;
  Unknowns const unknowns = held(network);
  std::vector<Contact> const contacts = network.backbone();
  Cholesky const cholesky(hessian_of(contacts, network.potential, unknowns));
  if (cholesky.info() != Eigen::Success || is_loose(cholesky)) return std::nullopt;
  // Growing disks and a shrinking box exert the same forces on the disks.
  StrainedBackbone const backbone = strain(network, contacts, unknowns);
  // The columns are growth, a pure shear and a simple shear.
  Eigen::Matrix3d const combine{{1.0, 0.5, 0.0}, {1.0, -0.5, 0.0}, {0.0, 0.0, 1.0}};
  Eigen::MatrixXd const force = backbone.force * combine;
  Eigen::Index const columns = shape == BoxShape::free ? 3 : 1;
  Eigen::MatrixXd const motions = cholesky.solve(force.leftCols(columns));
  Eigen::VectorXd motion = motions.col(0);
  GrowthResponse response{.displacement = std::vector<Vector>(network.size())};
  if (shape == BoxShape::free) {
    Eigen::Matrix3d const relaxed = combine.transpose() * backbone.born * combine - force.transpose() * motions;
    Eigen::Matrix2d stiffness = relaxed.bottomRightCorner<2, 2>();
    // Prestress lowers the moduli of finite shears at constant area by p/2.
    for (Contact const& contact : contacts)
      stiffness.diagonal().array() -= 0.25 * force_of(contact, network.potential) * contact.distance;
    if (!(stiffness.determinant() > 0.0 && stiffness(0, 0) > 0.0)) return std::nullopt;
    Eigen::Vector2d const strains = stiffness.inverse() * relaxed.bottomLeftCorner<2, 1>();
    motion -= motions.rightCols<2>() * strains;
    response.pure_shear = strains[0];
    response.simple_shear = strains[1];
  }
  for (std::size_t i = 0; i < network.size(); ++i) {
    if (unknowns.place[i] == Unknowns::none) continue;
    auto const row = 2 * static_cast<Eigen::Index>(unknowns.place[i]);
    response.displacement[i] = {motion[row], motion[row + 1]};
  }
  return response;
}

std::optional<ElasticModuli> find_elastic_moduli(Packing const& packing, ContactNetwork const& network) {
  if (network.backbone_disks == 0 || network.tolerance > 0.0) return std::nullopt;
  Unknowns const unknowns = held(network);
  std::vector<Contact> const contacts = network.backbone();
  Cholesky const cholesky(hessian_of(contacts, network.potential, unknowns));
  if (cholesky.info() != Eigen::Success || is_loose(cholesky)) return std::nullopt;
  StrainedBackbone const backbone = strain(network, contacts, unknowns);
  Eigen::MatrixXd const motion = cholesky.solve(backbone.force);
  double const unit = network.smallest_diameter * network.smallest_diameter / packing.box.area();
  Eigen::Matrix3d const c = unit * (backbone.born - backbone.force.transpose() * motion);
  ElasticModuli moduli{
      .xxxx = c(0, 0), .yyyy = c(1, 1), .xyxy = c(2, 2), .xxyy = c(0, 1), .xxxy = c(0, 2), .yyxy = c(1, 2)};
  if (!network.is_periodic) moduli.xyxy = moduli.xxxy = moduli.yyxy = std::numeric_limits<double>::quiet_NaN();
  return moduli;
}

}  // namespace gridlock
