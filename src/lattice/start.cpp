#include "gridlock/lattice/start.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/magnitude.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "lattice/kinds.hpp"
#include "lattice/random_insertion.hpp"

namespace gridlock {

namespace {

constexpr double closest_packing = 0.90689968211710892530;  // π/√12
constexpr double random_insertion_saturation = 0.547069;    // Wang 1994, doi:10.1016/0927-7757(93)02711-Z
constexpr double max_fitted_up = 1.0 + 1e-9;                // factor up to which a size still fits

double radius_for(double packing_fraction, Box const& box, Kinds const& kinds) {
  return std::sqrt(packing_fraction * box.area() / (std::numbers::pi * kinds.sum_of_squared_ratios()));
}

double packing_fraction_for(double radius, Box const& box, Kinds const& kinds) {
  return std::numbers::pi * radius * radius * kinds.sum_of_squared_ratios() / box.area();
}

/// Returns the setting that fixes the size of the disks, for error texts.
char const* size_key(DisksSettings const& settings) {
  return settings.radius ? "disks.radius" : "disks.packing_fraction";
}

double wanted_radius(DisksSettings const& settings, Box const& box, Kinds const& kinds) {
  if (settings.radius && settings.packing_fraction) {
    throw Error({.what = fmt::format("disks.radius = {} and disks.packing_fraction = {} are both given",
                                     *settings.radius, *settings.packing_fraction),
                 .hint = "give one of the two; the other follows from the box and the number of disks",
                 .key = "disks.radius"});
  }
  double const radius = settings.radius.value_or(radius_for(settings.packing_fraction.value_or(0.5), box, kinds));
  double const packing_fraction = packing_fraction_for(radius, box, kinds);
  if (settings.start == StartKind::uniform) return radius;
  if (are_equal(settings) && packing_fraction > closest_packing) {
    throw Error({.what = fmt::format("packing fraction {:.6g} is above the closest packing of equal disks, {:.4f}",
                                     packing_fraction, closest_packing),
                 .hint = fmt::format("use a value below {:.4f}", closest_packing),
                 .key = size_key(settings)});
  }
  if (packing_fraction >= 1.0) {
    throw Error({.what = fmt::format("disks that do not overlap cannot have packing fraction {:.6g}", packing_fraction),
                 .hint = "use a value below 1, or disks.start = \"uniform\" for soft disks, which may overlap",
                 .key = size_key(settings)});
  }
  return radius;
}

/// Returns six digits that are never above `value`, so that the largest value that fits still fits when it is typed in.
std::string rounded_down(double value) {
  double const unit = std::pow(10.0, std::floor(std::log10(value)) - 5.0);
  double rounded = std::floor(value / unit) * unit;
  while (std::stod(fmt::format("{:.6g}", rounded)) > value) rounded -= unit;
  return fmt::format("{:.6g}", rounded);
}

LatticeFit fit_lattice(StartKind kind, Box const& box, std::uint64_t count) {
  return kind == StartKind::square ? fit_square_lattice(box, count) : fit_triangular_lattice(box, count);
}

/// Returns a size in terms of the setting that the user gave: "packing fraction 0.5", or "radius 0.01".
std::string size_in_words(DisksSettings const& settings, Box const& box, Kinds const& kinds, double radius) {
  return settings.radius ? "radius " + rounded_down(radius)
                         : "packing fraction " + rounded_down(packing_fraction_for(radius, box, kinds));
}

/// Returns the largest radius with which all disks fit on a lattice.
double largest_radius_on(StartKind lattice, Box const& box, Kinds const& kinds) {
  return fit_lattice(lattice, box, kinds.count()).radius / kinds.largest_ratio();
}

Error too_large_for_lattice(DisksSettings const& settings, Box const& box, Kinds const& kinds, double radius,
                            double largest) {
  bool const is_square = settings.start == StartKind::square;
  std::uint64_t const count = kinds.count();
  StartKind const other = is_square ? StartKind::triangular : StartKind::square;
  double const largest_on_other = box.is_oblique() ? 0.0 : largest_radius_on(other, box, kinds);
  std::string hint = "use " + size_in_words(settings, box, kinds, largest) + " or less";
  if (largest_on_other > largest) {
    hint += fmt::format(", or disks.start = \"{}\", which reaches {}", is_square ? "triangular" : "square",
                        size_in_words(settings, box, kinds, largest_on_other));
  }
  return Error({.what = fmt::format("{} {} of packing fraction {:.6g} (radius {:.6g}) do not fit on a {} lattice in "
                                    "this box: the largest is {} (radius {})",
                                    count, count == 1 ? "disk" : "disks", packing_fraction_for(radius, box, kinds),
                                    radius, is_square ? "square" : "triangular",
                                    rounded_down(packing_fraction_for(largest, box, kinds)), rounded_down(largest)),
                .hint = hint,
                .key = size_key(settings)});
}

StartOfDisks::SiteOf lattice_sites(Box const& box, DisksSettings const& settings, Kinds const& kinds, double& radius) {
  LatticeFit const fit = fit_lattice(settings.start, box, kinds.count());
  double const largest = fit.radius / kinds.largest_ratio();
  if (radius > largest * max_fitted_up) throw too_large_for_lattice(settings, box, kinds, radius, largest);
  radius = std::min(radius, largest);
  return [fit](std::size_t i) { return fit.site(i); };
}

RandomInsertion insertion_of(Box const& box, Kinds const& kinds, double radius, std::uint64_t seed) {
  std::vector<double> radii(kinds.count());
  for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = radius * kinds.size_ratio(i);
  return {box, std::move(radii), seed};
}

/// A trial that finds the packing fraction which random insertion reaches with disks of these settings. It inserts all
/// disks if they are few, otherwise a sample of the same mixture in a periodic box, which takes about a second.
class InsertionTrial {
 public:
  InsertionTrial(Box const& box, DisksSettings const& settings, std::uint64_t count, std::uint64_t seed)
      : box_(count <= max_disks ? box : Box(1.0, 1.0, Edge::periodic)),
        kinds_(settings, std::min(count, max_disks), seed),
        seed_(seed),
        is_sample_(count > max_disks) {}

  [[nodiscard]] bool is_sample() const { return is_sample_; }
  /// The kinds of the disks in the trial.
  [[nodiscard]] Kinds const& kinds() const { return kinds_; }

  /// Returns whether the sample represents the mixture; it does not if a few disks cover most of the area.
  [[nodiscard]] bool is_representative() const {
    double squares = 0.0;
    for (std::size_t i = 0; i < kinds_.count(); ++i) {
      double const ratio = kinds_.size_ratio(i);
      squares += ratio * ratio * ratio * ratio;
    }
    double const sum = kinds_.sum_of_squared_ratios();
    return !is_sample_ || sum * sum >= 1000.0 * squares;
  }

  /// The result of one insertion at a given packing fraction.
  struct Outcome {
    double share_placed = 0.0;      ///< fraction of the disks, by number, that were inserted
    double packing_fraction = 0.0;  ///< packing fraction of the inserted disks
    double attempts_per_disk = 0.0;
  };
  [[nodiscard]] Outcome insert(double packing_fraction) const {
    RandomInsertion insertion = insertion_of(box_, kinds_, radius_for(packing_fraction, box_, kinds_), seed_);
    auto const disks = static_cast<double>(kinds_.count());
    double const share = static_cast<double>(insertion.place_all()) / disks;
    return {share, insertion.packing_fraction(), static_cast<double>(insertion.attempts()) / disks};
  }
  [[nodiscard]] double share_placed(double packing_fraction) const { return insert(packing_fraction).share_placed; }

  /// Returns a packing fraction somewhat below `reached` at which every disk fits; nothing if three tries fail.
  [[nodiscard]] std::optional<double> find_reachable(double reached) const {
    // The sample is smaller than the system and gets more attempts for each disk, hence the margin.
    double const margin = is_sample_ ? margin_of_sample : 0.0;
    for (int k = 1; k <= 3; ++k) {
      double const candidate = std::floor(100.0 * (reached * (1.0 - margin) - 0.01 * k) + 0.5) / 100.0;
      if (candidate > 0.0 && share_placed(candidate * (1.0 + margin)) >= 1.0) return candidate;
    }
    return std::nullopt;
  }

  static constexpr std::uint64_t max_disks = 5000;

  /// Four times the scatter of the packing fraction that 5000 disks reach, which is 0.35 % for equal disks.
  static constexpr double margin_of_sample = 0.015;

 private:
  Box box_;
  Kinds kinds_;
  std::uint64_t seed_;
  bool is_sample_;
};

/// Returns the hint for a random start that is impossible, with numbers that are possible.
std::string instead_of_random(Box const& box, DisksSettings const& settings, Kinds const& kinds,
                              std::optional<double> reachable) {
  std::string hint;
  double const radius = reachable ? radius_for(*reachable, box, kinds) : 0.0;
  if (reachable) {
    hint = settings.radius ? fmt::format("use radius {} or less", rounded_down(radius))
                           : fmt::format("use packing fraction {:.2f} or less", *reachable);
  }
  double const square = largest_radius_on(StartKind::square, box, kinds);
  double const triangular = box.is_oblique() ? 0.0 : largest_radius_on(StartKind::triangular, box, kinds);
  if (std::max(square, triangular) <= radius) return hint;
  return fmt::format("{}disks.start = \"{}\", which reaches {}", hint.empty() ? "use " : hint + ", or ",
                     square > triangular ? "square" : "triangular",
                     size_in_words(settings, box, kinds, std::max(square, triangular)));
}

// Packing fraction up to which every mixture can be inserted, so that no trial is needed.
constexpr double always_reached = 0.4;

std::vector<Vector> random_sites(Box const& box, DisksSettings const& settings, Kinds const& kinds, double radius,
                                 std::uint64_t seed) {
  std::size_t const count = kinds.count();
  double const packing_fraction = packing_fraction_for(radius, box, kinds);
  InsertionTrial const trial(box, settings, count, seed);
  auto const refuse = [&](std::string const& what, double reached) -> Error {
    return Error({.what = what,
                  .hint = instead_of_random(box, settings, kinds, trial.find_reachable(reached)),
                  .key = size_key(settings)});
  };
  // In a small box a few disks can exceed the saturation of the infinite plane by chance.
  if (are_equal(settings) && count >= 1000 && packing_fraction > random_insertion_saturation * 1.05) {
    throw refuse(fmt::format("random insertion stops at packing fraction {:.6f} for equal disks, below {:.6g}",
                             random_insertion_saturation, packing_fraction),
                 random_insertion_saturation);
  }
  if (trial.is_sample() && trial.is_representative() && packing_fraction > always_reached) {
    InsertionTrial::Outcome const outcome = trial.insert(packing_fraction);
    if (outcome.share_placed < 1.0 - InsertionTrial::margin_of_sample) {
      throw refuse(
          fmt::format("random insertion of these {} disks would stop near packing fraction {:.3f}, below {:.6g}", count,
                      outcome.packing_fraction, packing_fraction),
          outcome.packing_fraction);
    }
  }
  RandomInsertion insertion = insertion_of(box, kinds, radius, seed);
  std::size_t const placed = insertion.place_all();
  if (placed < count) {
    throw refuse(
        fmt::format("random insertion found room for {} of {} disks; it reached packing fraction {:.4f} of {:.6g}",
                    placed, count, insertion.packing_fraction(), packing_fraction),
        insertion.packing_fraction());
  }
  return insertion.take_sites();
}

/// Returns points drawn uniformly, without regard to other disks.
StartOfDisks::SiteOf uniform_sites(Box const& box, DisksSettings const& settings, Kinds const& kinds, double radius,
                                   std::uint64_t seed) {
  double const largest = radius * kinds.largest_ratio();
  if (2.0 * largest > std::min(box.width(), box.height())) {
    throw Error({.what = fmt::format("a disk of diameter {:.6g} does not fit into the box of {} × {}", 2.0 * largest,
                                     box.width(), box.height()),
                 .hint = "use a larger box or smaller disks",
                 .key = size_key(settings)});
  }
  return [&kinds, box, radius, seed](std::size_t i) {
    RandomStream random = places_of(seed, i);
    return AllowedCentres(box, radius * kinds.size_ratio(i)).draw(random);
  };
}

}  // namespace

namespace {

Edge edge_of_axis(AxisEdge axis, Edge edge) {
  if (axis == AxisEdge::same) return edge;
  return axis == AxisEdge::wall ? Edge::wall : Edge::periodic;
}

}  // namespace

Edge edge_x_of(BoxSettings const& settings) { return edge_of_axis(settings.edge_x, settings.edge); }
Edge edge_y_of(BoxSettings const& settings) { return edge_of_axis(settings.edge_y, settings.edge); }
AxisEdge axis_edge_of(Edge edge) { return edge == Edge::wall ? AxisEdge::wall : AxisEdge::periodic; }

Box make_box(BoxSettings const& settings) {
  Box const box(settings.width.value_or(settings.side), settings.height.value_or(settings.side), edge_x_of(settings),
                edge_y_of(settings));
  if (auto problem = find_extreme_sides(box)) throw Error(*std::move(problem));
  return box.tilted(settings.tilt);
}

std::uint64_t count_of(DisksSettings const& settings) { return settings.count.value_or(841); }

namespace {

/// Returns the part of the box that the disks fill, with walls around it. Errors: Error for a region outside the box.
Box box_of_region(Box const& box, std::vector<double> const& region) {
  if (region.empty()) return box;
  bool const is_inside = region.size() == 4 && region[0] >= 0.0 && region[1] >= 0.0 && region[2] <= box.width() &&
                         region[3] <= box.height() && region[0] < region[2] && region[1] < region[3];
  if (!is_inside) {
    throw Error({.what = fmt::format("disks.region = [{:.6g}] is no part of the box of {} × {}",
                                     fmt::join(region, ", "), box.width(), box.height()),
                 .hint = "give left, bottom, right and top of a rectangle inside the box, as in [0, 0, 1, 0.5]",
                 .key = "disks.region"});
  }
  return {region[2] - region[0], region[3] - region[1], Edge::wall};
}

}  // namespace

struct StartOfDisks::Plan {
  Box whole_box;
  Box box;  ///< the part of it that the disks fill
  Vector corner;
  std::uint64_t seed = 0;
  Kinds kinds;
  double radius = 0.0;
  SiteOf site_of = {};
};

StartOfDisks::StartOfDisks(Box const& whole_box, DisksSettings const& settings, std::uint64_t seed) {
  std::uint64_t const count = count_of(settings);
  if (count == 0) throw Error({.what = "there are 0 disks", .hint = "use at least 1", .key = "disks.count"});
  plan_ = std::make_unique<Plan>(Plan{.whole_box = whole_box,
                                      .box = box_of_region(whole_box, settings.region),
                                      .corner = {},
                                      .seed = seed,
                                      .kinds = Kinds(settings, count, seed)});
  if (!settings.region.empty()) plan_->corner = {settings.region[0], settings.region[1]};
  Box const& box = plan_->box;
  Kinds const& kinds = plan_->kinds;
  double& radius = plan_->radius;
  if (settings.start == StartKind::file) {
    throw Error({.what = "disks.start = \"file\" needs a file",
                 .hint = "give disks.file, an extended XYZ file",
                 .key = "disks.start"});
  }
  radius = wanted_radius(settings, box, kinds);
  // The rows of a square lattice stay apart wherever the rows above begin.
  if (settings.start == StartKind::triangular) require_rectangle(box, "disks.start = \"triangular\"");
  if (settings.start == StartKind::random) {
    plan_->site_of = [sites = random_sites(box, settings, kinds, radius, seed)](std::size_t i) { return sites[i]; };
  } else if (settings.start == StartKind::uniform) {
    plan_->site_of = uniform_sites(box, settings, kinds, radius, seed);
  } else {
    plan_->site_of = lattice_sites(box, settings, kinds, radius);
  }
}

StartOfDisks::~StartOfDisks() = default;
StartOfDisks::StartOfDisks(StartOfDisks&&) noexcept = default;

std::uint64_t StartOfDisks::count() const { return plan_->kinds.count(); }

DiskAtStart StartOfDisks::disk(std::uint64_t i) const {
  return {.site = plan_->corner + plan_->site_of(i),
          .radius = plan_->radius * plan_->kinds.size_ratio(i),
          .mass = plan_->kinds.mass(i)};
}

State StartOfDisks::all() const {
  State state{.box = plan_->whole_box, .seed = plan_->seed};
  state.agents.reserve(count());
  for (std::uint64_t i = 0; i < count(); ++i) {
    DiskAtStart const of_row = disk(i);
    state.agents.add(of_row.site.x, of_row.site.y, 0.0, 0.0, of_row.radius, of_row.mass, 0, 0);
  }
  return state;
}

State make_start(Box const& box, DisksSettings const& settings, std::uint64_t seed) {
  return StartOfDisks(box, settings, seed).all();
}

double expected_attempts(Box const& whole_box, DisksSettings const& settings, std::uint64_t seed) {
  Box const box = box_of_region(whole_box, settings.region);
  std::uint64_t const count = count_of(settings);
  if (settings.start != StartKind::random || count == 0) return 0.0;
  InsertionTrial const trial(box, settings, count, seed);
  // A part of the box that has as many disks as the trial.
  double const side = std::sqrt(static_cast<double>(trial.kinds().count()) / static_cast<double>(count));
  Box const part(side * box.width(), side * box.height(), box.edge_x(), box.edge_y());
  double const packing_fraction =
      packing_fraction_for(wanted_radius(settings, part, trial.kinds()), part, trial.kinds());
  if (!trial.is_sample() || !trial.is_representative() || packing_fraction <= always_reached) return 0.0;
  InsertionTrial::Outcome const outcome = trial.insert(packing_fraction);
  // make_start() soon refuses such disks.
  if (outcome.share_placed < 1.0 - InsertionTrial::margin_of_sample) return 0.0;
  return outcome.attempts_per_disk * static_cast<double>(count);
}

namespace {

/// The sums Σ m and Σ m v.
struct DriftSums {
  double mass = 0.0;
  Vector momentum;
};

}  // namespace

void draw_velocities(State& state, VelocitySettings const& settings, AllProcesses processes) {
  if (settings.kind == VelocityKind::file) {
    throw Error({.what = "velocities.kind = \"file\", but there is no file with velocities",
                 .hint = "give disks.file with a velocity column, or draw them: \"uniform\" or \"maxwell\"",
                 .key = "velocities.kind"});
  }
  if (settings.max > 0.0 && settings.max < min_magnitude) {
    throw Error({.what = fmt::format("velocities.max is {}, too small to compute with", settings.max),
                 .hint = magnitude_hint,
                 .key = "velocities.max"});
  }
  auto const vx = state.agents.column<VelocityX>();
  auto const vy = state.agents.column<VelocityY>();
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    RandomStream random(state.seed, 0, state.agents.ids()[i], Purpose::start_velocity);
    Vector v;
    if (is_fixed(state.agents, i)) {
      v = {};
    } else if (settings.kind == VelocityKind::uniform) {
      v = settings.max * random.in_unit_disk();
    } else {
      double const thermal_speed = 0.5 * settings.max / std::sqrt(state.agents.column<Mass>()[i]);
      v.x = thermal_speed * random.normal();
      v.y = thermal_speed * random.normal();
    }
    vx[i] = v.x;
    vy[i] = v.y;
  }
  bool const is_automatic =
      settings.drift == Drift::automatic && state.box.has_images() && processes.sum(state.agents.size()) > 1;
  if (settings.drift != Drift::remove && !is_automatic) return;
  if (processes.sum(count_of_fixed(state.agents)) > 0) return;  // fixed disks stop the drift
  auto const sums = processes.change_in_order(DriftSums{}, [&](DriftSums& so_far) {
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      double const m = state.agents.column<Mass>()[i];
      so_far.mass += m;
      so_far.momentum = so_far.momentum + m * velocity(state.agents, i);
    }
  });
  Vector const drift = (1.0 / sums.mass) * sums.momentum;
  // Walls reflect a drift, so that only one along a periodic axis stays.
  bool const removes_all = settings.drift == Drift::remove;
  if (removes_all || state.box.is_periodic_x()) {
    for (double& v : vx) v -= drift.x;
  }
  if (removes_all || state.box.is_periodic_y()) {
    for (double& v : vy) v -= drift.y;
  }
}

}  // namespace gridlock
