#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "packing/eigen.hpp"
#include "packing/hessian.hpp"

namespace gridlock {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Number of unknowns up to which all eigenvalues of the dense Hessian are computed, which then is fast enough.
constexpr Index max_unknowns_of_dense = 200;
constexpr Index max_steps = 1000;
/// Accepted residual of a mode over its eigenvalue of the inverse.
constexpr double precision = 1e-12;

/// Subtracts the common shift of all disks.
void remove_shift(VectorXd& mode) {
  for (Index const axis : {0, 1}) {
    auto components = mode(Eigen::seq(axis, mode.size() - 1, 2));
    components.array() -= components.mean();
  }
}

/// Factorizes H + s 1 by Cholesky's method, where s makes it positive definite; the factor is the same for every order
/// of disks.
class ShiftedInverse {
 public:
  explicit ShiftedInverse(SparseMatrix const& hessian) {
    double const scale = hessian.diagonal().cwiseAbs().mean();
    for (double share = 1e-10; share <= 1e6; share *= 10.0) {
      cholesky_.setShift(share * scale);
      cholesky_.compute(hessian);
      if (cholesky_.info() == Eigen::Success) return;
    }
  }
  [[nodiscard]] VectorXd operator()(VectorXd const& v) const { return cholesky_.solve(v); }

 private:
  Eigen::SimplicialLLT<SparseMatrix> cholesky_;
};

/// Returns numbers between −½ and ½ that resemble no mode.
VectorXd first_guess(Index size) {
  VectorXd guess(size);
  double value = 0.0;
  for (Index k = 0; k < size; ++k) {
    value += 0.6180339887498949;
    value -= std::floor(value);
    guess(k) = value - 0.5;
  }
  return guess;
}

/// Finds the eigenvector of the shifted inverse's largest eigenvalue by Lanczos steps, each orthogonal to all before.
class Lanczos {
 public:
  Lanczos(SparseMatrix const& hessian, bool is_periodic)
      : inverse_(hessian), is_periodic_(is_periodic), basis_(hessian.rows(), 0) {}

  [[nodiscard]] VectorXd find() {
    VectorXd next = first_guess(basis_.rows());
    if (is_periodic_) remove_shift(next);
    Index const most = std::min(max_steps, basis_.rows() - (is_periodic_ ? 2 : 0));
    double rest = next.norm();
    for (Index step = 0; step < most; ++step) {
      add_to_basis(next / rest);
      next = rest_of_step(step);
      rest = next.norm();
      if (step % 5 == 4 || step + 1 == most || rest == 0.0) {
        if (is_found(rest) || step + 1 == basis_.rows()) return mode_;
      }
    }
    throw Error({.what = fmt::format("the softest mode of {} disks is not found in {} steps", basis_.rows() / 2, most),
                 .hint = "the packing has many modes of nearly the same stiffness; leave the softest mode out",
                 .key = "disks"});
  }

 private:
  void add_to_basis(VectorXd const& v) {
    if (used_ == basis_.cols()) basis_.conservativeResize(Eigen::NoChange, std::max<Index>(32, 2 * used_));
    basis_.col(used_++) = v;
  }

  /// Returns the inverse times the last vector, without its components along the basis.
  VectorXd rest_of_step(Index step) {
    VectorXd next = inverse_(basis_.col(step));
    if (is_periodic_) remove_shift(next);
    along_.push_back(next.dot(basis_.col(step)));
    auto const known = basis_.leftCols(used_);
    // Orthogonalized twice, which is enough against rounding.
    for (int time = 0; time < 2; ++time) next -= known * (known.transpose() * next);
    between_.push_back(next.norm());
    return next;
  }

  /// Finds the best mode in the basis; returns whether it is accurate enough.
  bool is_found(double rest) {
    Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
    Eigen::Map<VectorXd const> const diagonal(along_.data(), used_);
    Eigen::Map<VectorXd const> const beside(between_.data(), used_ - 1);
    solver.computeFromTridiagonal(diagonal, beside);
    VectorXd const weights = solver.eigenvectors().col(used_ - 1);
    mode_ = basis_.leftCols(used_) * weights;
    return rest * std::abs(weights(used_ - 1)) <= precision * solver.eigenvalues()(used_ - 1);
  }

  ShiftedInverse inverse_;
  bool is_periodic_;
  MatrixXd basis_;
  Index used_ = 0;
  std::vector<double> along_;
  std::vector<double> between_;
  VectorXd mode_;
};

/// Returns the eigenvector of the smallest eigenvalue. In a periodic packing a large stiffness excludes the two shifts.
VectorXd mode_of_dense(SparseMatrix const& hessian, bool is_periodic) {
  MatrixXd full = MatrixXd(hessian).selfadjointView<Eigen::Lower>();
  if (is_periodic) {
    double const stiff = full.cwiseAbs().maxCoeff();
    for (Index i = 0; i < full.rows(); ++i) {
      for (Index j = i % 2; j < full.cols(); j += 2) full(i, j) += stiff;
    }
  }
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(full).eigenvectors().col(0);
}

/// Makes the largest component positive, the first of equal ones.
void fix_sign(VectorXd& mode) {
  Index largest = 0;
  mode.cwiseAbs().maxCoeff(&largest);
  if (mode(largest) < 0.0) mode = -mode;
}

}  // namespace

std::optional<VibrationMode> find_softest_mode(ContactNetwork const& network) {
  if (network.backbone_disks == 0 || network.tolerance > 0.0) return std::nullopt;
  std::vector<bool> takes_part = network.is_rattler;
  takes_part.flip();
  Unknowns const unknowns(takes_part);
  SparseMatrix const hessian = hessian_of(network.backbone(), network.potential, unknowns);
  bool const is_small = hessian.rows() <= max_unknowns_of_dense;
  VectorXd mode = is_small ? mode_of_dense(hessian, network.is_periodic) : Lanczos(hessian, network.is_periodic).find();
  if (network.is_periodic) remove_shift(mode);
  mode.normalize();
  fix_sign(mode);
  double const unit = network.smallest_diameter * network.smallest_diameter;
  VibrationMode found{.eigenvalue = unit * mode.dot(hessian.selfadjointView<Eigen::Lower>() * mode),
                      .displacement = std::vector<Vector>(network.size())};
  for (std::size_t i = 0; i < network.size(); ++i) {
    if (!takes_part[i]) continue;
    auto const row = 2 * static_cast<Index>(unknowns.place[i]);
    found.displacement[i] = {mode(row), mode(row + 1)};
  }
  return found;
}

}  // namespace gridlock
