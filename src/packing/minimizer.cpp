#include "gridlock/packing/minimizer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "packing/eigen.hpp"
#include "packing/fire.hpp"
#include "packing/hessian.hpp"
#include "packing/quasi_newton.hpp"
#include "packing/site_forces.hpp"
#include "packing/steepest_descent.hpp"

namespace gridlock {

namespace {

constexpr double min_shift = 1e-9;  // least shift of the Hessian's diagonal, in ε/D²
constexpr double max_shift = 1e3;
constexpr double longest_step = 0.1;  // displacement in a step, in diameters D
constexpr int max_halvings = 6;
constexpr std::uint64_t max_slow_newton_steps = 20;
/// Iterations of other methods before Newton's method is tried again; they take about as long as its steps.
constexpr std::uint64_t iterations_before_newton_again = 2000;
constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

constexpr double first_quasi_newton_scale = 0.2;  // step length over force, in D²/ε
constexpr double min_decrease = 1e-4;             // actual over predicted decrease of the energy, at least

/// Energy for each disk (ε) below which the path no longer matters: disks then move apart or hardly press.
constexpr double min_energy_of_descent = 1e-8;

constexpr double displacement_from_saddle = 1e-4;  // displacement of a disk, in diameters D
constexpr double curvature_of_saddle = -1e-7;      // least eigenvalue of a saddle, in ε/D²
/// Largest residual at which the curvature tells a saddle from a minimum; with larger forces the state is neither.
constexpr double max_residual_of_saddle = 1e-3;

constexpr std::uint64_t iterations_per_look = 8;

MinimizerSettings const& checked(MinimizerSettings const& settings) {
  if (!(settings.residual > 0.0 && settings.residual < 1.0)) {
    throw Error({.what = fmt::format("the residual to reach is {}", settings.residual),
                 .hint = "use a number above 0 and below 1, such as 1e-8",
                 .key = "soft.residual"});
  }
  return settings;
}

}  // namespace

char const* to_text(MinimumStatus status) {
  switch (status) {
    case MinimumStatus::searching:
      return "searching";
    case MinimumStatus::converged:
      return "converged";
    case MinimumStatus::unjammed:
      return "unjammed";
    case MinimumStatus::unconverged:
      break;
  }
  return "unconverged";
}

/// The state of the methods between two iterations.
class Minimizer::Search {
 public:
  Search(MinimizerSettings const& settings, Packing const& packing)
      : settings_(settings),
        forces_(packing, settings),
        diameter_(smallest_diameter(packing)),
        force_(forces_.sites()),
        step_(forces_.sites()),
        descent_(packing.size()),
        fire_(forces_.sites()),
        quasi_newton_(forces_.sites(), first_quasi_newton_scale * diameter_ * diameter_),
        quasi_newton_residual_(settings.quasi_newton_residual),
        newton_residual_(settings.newton_residual) {
    descent_.restart(diameter_);
    fire_.start(diameter_);
  }

  [[nodiscard]] double diameter() const { return diameter_; }

  /// Returns the sums of the forces at these positions, which are computed once.
  ForceSums const& look(Packing const& packing) {
    if (!sums_) sums_ = evaluate(packing);
    return *sums_;
  }
  [[nodiscard]] std::vector<Contact> contacts(Packing const& packing) { return forces_.of_disks().contacts(packing); }

  /// Begins a search at rest, with disks whose sizes may have changed.
  void restart(Packing const& packing) {
    diameter_ = smallest_diameter(packing);
    start_fire();
    descent_.restart(diameter_);
    is_descending_ = true;
    iterations_ = 0;
    saddles_ = 0;
    quasi_newton_residual_ = settings_.quasi_newton_residual;
    newton_residual_ = settings_.newton_residual;
    is_near_minimum_ = false;
    newton_again_at_ = never;
    slow_newton_steps_left_ = 0;
    shift_ = min_shift;
  }

  /// Begins with Newton's method, which finds the minimum also if a few contacts open or close.
  void begin_near_minimum() {
    if (settings_.newton_residual == 0.0) return;
    is_descending_ = false;
    is_near_minimum_ = true;
    newton_residual_ = std::numeric_limits<double>::max();
    newton_again_at_ = never;
    slow_newton_steps_left_ = max_slow_newton_steps;
  }

  /// Returns whether the residual is as small as required, or as the digits of positions allow.
  [[nodiscard]] bool is_converged(ForceSums const& sums, Box const& box) const {
    if (sums.contacts == 0) return false;
    auto const contacts = static_cast<double>(sums.contacts);
    double const overlap = diameter_ * sums.overlaps / contacts;
    double const rounding = 0x1p-50 * std::max(box.width(), box.height()) / overlap;
    return sums.residual() <= std::max(settings_.residual, rounding);
  }
  /// Returns whether the search still follows the steepest descent; once it has left it, it does not return to it.
  [[nodiscard]] bool is_for_descent(ForceSums const& sums) {
    is_descending_ = is_descending_ && sums.residual_of_disks() > settings_.descent_residual &&
                     sums.energy > min_energy_of_descent * static_cast<double>(force_.x.size());
    return is_descending_;
  }
  [[nodiscard]] bool is_for_newton(ForceSums const& sums) const {
    return sums.contacts > 0 && sums.residual() <= newton_residual_;
  }
  [[nodiscard]] bool is_for_quasi_newton(ForceSums const& sums) const {
    return sums.contacts > 0 && sums.residual() <= quasi_newton_residual_;
  }
  [[nodiscard]] bool is_given_up() const { return iterations_ >= settings_.iterations; }

  /// Returns whether the forces balance at a saddle: some displacement lowers the energy more than pressure alone can.
  bool is_at_saddle(Packing const& packing) {
    if (settings_.newton_residual == 0.0 || look(packing).residual() > max_residual_of_saddle) return false;
    return !factorize(analyzed_hessian(packing), -curvature_of_saddle);
  }

  /// Displaces every disk a little in a direction of its own, and lets the next search begin with more steps of FIRE.
  void leave_saddle(Packing& packing) {
    ++iterations_;
    ++saddles_;
    double const length = displacement_from_saddle * diameter_;
    for (std::size_t i = 0; i < packing.size(); ++i) {
      Vector const step = length * direction(2.399963229728653 * static_cast<double>((i + saddles_) % 1009));
      packing.x[i] += step.x;
      packing.y[i] += step.y;
    }
    start_fire();
    quasi_newton_residual_ *= 0.1;
    newton_residual_ *= 0.1;
  }

  void descent_step(Packing& packing) {
    ++iterations_;
    ForceSums const of_disks =
        descent_.step(packing, forces_.of_disks(), settings_.potential, fire_.velocity(), force_);
    sums_ = forces_.with_box(packing, of_disks, fire_.velocity(), force_);
  }

  void fire_step(Packing& packing, ForceSums const& sums) {
    count_iteration();
    sums_.reset();
    fire_.step(packing, forces_, sums, force_, iterations_);
  }

  /// Takes a step of QuasiNewton. If the energy does not fall along it, FIRE continues until the residual is a tenth.
  void quasi_newton_step(Packing& packing, ForceSums const& sums) {
    count_iteration();
    fire_.stop();
    // The residual may rise during these steps.
    quasi_newton_residual_ = std::numeric_limits<double>::max();
    double const slope = quasi_newton_.find_direction(force_, step_, pool());
    auto const scale = descend(packing, sums, slope);
    if (scale) {
      quasi_newton_.remember(step_, *scale, force_before_, force_, pool());
      return;
    }
    quasi_newton_residual_ = 0.1 * std::min(quasi_newton_residual_, sums.residual());
    start_fire();
  }

  /// Takes a step of Newton's method. If no step halves the residual, contacts still open and close and the Hessian
  /// changes too much: the cheaper methods then continue until the residual is a tenth.
  void newton_step(Packing& packing, ForceSums const& sums) {
    ++iterations_;
    fire_.stop();
    SparseMatrix const hessian = analyzed_hessian(packing);
    Eigen::VectorXd right(hessian.rows());
    for (std::size_t i = 0; i < forces_.sites(); ++i) {
      right[static_cast<Eigen::Index>(2 * i)] = force_.x[i];
      right[static_cast<Eigen::Index>(2 * i + 1)] = force_.y[i];
    }
    double const min_gain = 0.5 * sums.residual();
    for (; shift_ <= max_shift; shift_ *= 10.0) {
      if (!factorize(hessian, shift_)) continue;
      Eigen::VectorXd const solution = factors_.solve(right);
      for (std::size_t i = 0; i < forces_.sites(); ++i) {
        step_.x[i] = solution[static_cast<Eigen::Index>(2 * i)];
        step_.y[i] = solution[static_cast<Eigen::Index>(2 * i + 1)];
      }
      // Any decrease of the energy is accepted: it costs a thousandth of a factorization to test one.
      auto const scale = descend(packing, sums, 0.0);
      if (!scale) continue;
      if (*scale == 1.0) shift_ = std::max(0.2 * shift_, min_shift);
      bool const gains_little = look(packing).residual() > min_gain;
      if (gains_little && slow_newton_steps_left_ == 0) leave_newton(look(packing));
      if (gains_little && slow_newton_steps_left_ > 0) --slow_newton_steps_left_;
      return;
    }
    leave_newton(sums);
  }

  void serialize(Archive& archive) {
    serialize_inside(archive, "fire", [&] { fire_.serialize(archive); });
    archive.visit("iterations", iterations_);
    archive.visit("saddles", saddles_);
    archive.visit("quasi_newton_residual", quasi_newton_residual_);
    archive.visit("newton_residual", newton_residual_);
    archive.visit("is_descending", is_descending_);
    archive.visit("is_near_minimum", is_near_minimum_);
    archive.visit("newton_again_at", newton_again_at_);
    archive.visit("slow_newton_steps_left", slow_newton_steps_left_);
    archive.visit("shift", shift_);
    archive.visit("diameter", diameter_);
    serialize_inside(archive, "descent", [&] { descent_.serialize(archive); });
    quasi_newton_.serialize(archive);
    sums_.reset();
  }

 private:
  ThreadPool& pool() { return forces_.of_disks().pool(); }
  ForceSums evaluate(Packing const& packing) { return forces_.evaluate(packing, fire_.velocity(), force_); }

  /// Lets the next search begin with steps of FIRE, or of QuasiNewton without remembered steps.
  void start_fire() {
    sums_.reset();
    quasi_newton_.forget(first_quasi_newton_scale * diameter_ * diameter_);
    fire_.start(diameter_);
  }

  /// Counts an iteration of the methods that continue after Newton's method.
  void count_iteration() {
    if (++iterations_ == newton_again_at_) begin_near_minimum();
  }

  void leave_newton(ForceSums const& sums) {
    shift_ = min_shift;
    newton_residual_ = std::min(settings_.newton_residual, 0.1 * std::min(newton_residual_, sums.residual()));
    if (is_near_minimum_) newton_again_at_ = iterations_ + iterations_before_newton_again;
    slow_newton_steps_left_ = 0;
    start_fire();
  }

  /// Moves along step_, by at most 0.1 D for any disk. Halves the step until the energy falls as the slope predicts or
  /// the residual halves. Returns the factor of step_; nothing, with the disks moved back, if neither happens.
  std::optional<double> descend(Packing& packing, ForceSums const& sums, double slope) {
    before_ = packing;
    force_before_ = force_;
    ForceSums const from = sums;
    double square = 0.0;
    for (std::size_t i = 0; i < forces_.sites(); ++i) {
      square = std::max(square, step_.x[i] * step_.x[i] + step_.y[i] * step_.y[i]);
    }
    double scale = std::min(1.0, longest_step * diameter_ / std::sqrt(square));
    for (int halvings = 0; halvings <= max_halvings; ++halvings, scale *= 0.5) {
      if (halvings > 0) packing = before_;
      forces_.displace(packing, step_, scale);
      sums_ = evaluate(packing);
      double const least = min_decrease * scale * slope;
      if (sums_->energy < from.energy - least || sums_->residual() <= 0.5 * from.residual()) return scale;
    }
    std::swap(packing, before_);
    std::swap(force_, force_before_);
    sums_ = from;
    return {};
  }

  /// Returns the Hessian of all disks, prepared for factorize().
  SparseMatrix analyzed_hessian(Packing const& packing) {
    SparseMatrix hessian = forces_.hessian(packing);
    analyze(hessian);
    return hessian;
  }

  /// Returns whether the Hessian plus shift · ε/D² on its diagonal is positive definite; factors_ then solves with it.
  bool factorize(SparseMatrix const& hessian, double shift) {
    factors_.setShift(shift / (diameter_ * diameter_));
    factors_.factorize(hessian);
    return factors_.info() == Eigen::Success;
  }

  /// Computes the order of elimination if the pattern of the matrix has changed.
  void analyze(SparseMatrix const& hessian) {
    std::span const outer(hessian.outerIndexPtr(), static_cast<std::size_t>(hessian.outerSize() + 1));
    std::span const inner(hessian.innerIndexPtr(), static_cast<std::size_t>(hessian.nonZeros()));
    if (std::ranges::equal(outer, outer_) && std::ranges::equal(inner, inner_)) return;
    outer_.assign(outer.begin(), outer.end());
    inner_.assign(inner.begin(), inner.end());
    factors_.analyzePattern(hessian);
  }

  MinimizerSettings settings_;
  SiteForces forces_;
  double diameter_;
  Columns force_;
  std::optional<ForceSums> sums_;  ///< sums of force_, where they are known
  Columns step_;
  Packing before_;  ///< packing before a step; the next array holds the forces
  Columns force_before_;
  SteepestDescent descent_;
  Fire fire_;
  QuasiNewton quasi_newton_;
  Eigen::SimplicialLLT<SparseMatrix> factors_;
  std::vector<int> outer_;  ///< pattern of the matrix for which factors_ has been analyzed; the next array too
  std::vector<int> inner_;
  double quasi_newton_residual_;
  double newton_residual_;
  double shift_ = min_shift;
  bool is_descending_ = true;
  bool is_near_minimum_ = false;              ///< whether the search began near a minimum
  std::uint64_t newton_again_at_ = never;     ///< value of iterations_ at which Newton's method begins again
  std::uint64_t slow_newton_steps_left_ = 0;  ///< steps of Newton's method with little gain still allowed
  std::uint64_t iterations_ = 0;              ///< iterations of this search
  std::uint64_t saddles_ = 0;
};

Minimizer::Minimizer(MinimizerSettings const& settings, Packing packing)
    : settings_(checked(settings)), packing_(std::move(packing)) {
  require_valid(packing_);
  if (settings_.box_shape == BoxShape::free && !packing_.box.is_periodic()) {
    throw Error({.what = fmt::format("the shape of a box that is {} cannot be free", edges_in_words(packing_.box)),
                 .hint = "use a box that is periodic along x and y: box.edge = \"periodic\"",
                 .key = "box.edge"});
  }
  search_ = std::make_unique<Search>(settings_, packing_);
}

Minimizer::~Minimizer() = default;

bool Minimizer::advance(std::function<bool()> const& should_continue) {
  while (status_ == MinimumStatus::searching) {
    for (std::uint64_t k = 0; k < iterations_per_look && status_ == MinimumStatus::searching; ++k) {
      ForceSums const sums = search_->look(packing_);
      energy_ = sums.energy;
      residual_ = sums.residual();
      if (energy_ < min_energy_of_a_disk * static_cast<double>(packing_.size())) {
        status_ = MinimumStatus::unjammed;
      } else if (search_->is_given_up()) {
        status_ = MinimumStatus::unconverged;
      } else if (search_->is_converged(sums, packing_.box)) {
        if (search_->is_at_saddle(packing_)) {
          search_->leave_saddle(packing_);
          ++fire_iterations_;
        } else {
          status_ = MinimumStatus::converged;
        }
      } else if (search_->is_for_descent(sums)) {
        search_->descent_step(packing_);
        ++descent_iterations_;
        k = iterations_per_look;  // a step takes as long as up to 200 others, so the callback is asked after it
      } else if (search_->is_for_newton(sums)) {
        search_->newton_step(packing_, sums);
        ++newton_iterations_;
        k = iterations_per_look;  // a step takes as long as a hundred others
      } else if (search_->is_for_quasi_newton(sums)) {
        search_->quasi_newton_step(packing_, sums);
        ++quasi_newton_iterations_;
      } else {
        search_->fire_step(packing_, sums);
        ++fire_iterations_;
      }
    }
    if (status_ == MinimumStatus::searching && should_continue && !should_continue()) return false;
  }
  return true;
}

void Minimizer::restart(Packing packing) {
  packing_ = std::move(packing);
  status_ = MinimumStatus::searching;
  search_->restart(packing_);
}

void Minimizer::restart_near_minimum(Packing packing) {
  restart(std::move(packing));
  search_->begin_near_minimum();
}

double Minimizer::pressure() const {
  double const diameter = search_->diameter();
  return pressure_of(contacts(), settings_.potential, packing_.box) * diameter * diameter;
}

std::vector<Contact> Minimizer::contacts() const { return search_->contacts(packing_); }

void Minimizer::serialize(Archive& archive) {
  auto place = static_cast<std::uint64_t>(status_);
  archive.visit("status", place);
  archive.require(place <= static_cast<std::uint64_t>(MinimumStatus::unconverged), "a minimization has no such status");
  status_ = static_cast<MinimumStatus>(place);
  std::size_t const disks = packing_.size();
  serialize_places(archive, packing_, settings_.box_shape);
  archive.visit("radius", packing_.radius);
  archive.require(packing_.x.size() == disks && packing_.y.size() == disks && packing_.radius.size() == disks,
                  "a minimization has another number of positions than of disks");
  if (archive.is_restoring()) require_valid(packing_);
  archive.visit("energy", energy_);
  archive.visit("residual", residual_);
  archive.visit("descent_iterations", descent_iterations_);
  archive.visit("fire_iterations", fire_iterations_);
  archive.visit("quasi_newton_iterations", quasi_newton_iterations_);
  archive.visit("newton_iterations", newton_iterations_);
  search_->serialize(archive);
}

}  // namespace gridlock
