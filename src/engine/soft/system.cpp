#include "engine/soft/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/pair_law.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock::soft {

namespace {

/// The longest path of a step, in smallest diameters.
constexpr double max_path = 0.5;

/// The largest of the numbers of all bands.
struct Largest {
  double value = 0.0;
  void add(Largest const& other) { value = std::max(value, other.value); }
};

/// Calls visit(row, other, squared distance, contact distance) for each entry of the lists that is a disk.
template <class Visit>
void for_each_entry(std::vector<Band> const& bands, Box const& box, Disks const& disks, Visit visit) {
  for (Band const& band : bands) {
    for (std::size_t k = 0; k < band.is_at_edge.size(); ++k) {
      std::size_t const row = band.first + k;
      for_each_neighbour(band, k, box, disks, [&](std::uint32_t other, Vector d) {
        visit(row, other, squared_length(d), disks.identities[row].radius + disks.identities[other].radius);
      });
    }
  }
}

}  // namespace

ListReach list_reach(PotentialSettings const& potential, Box const& box, RadiusRange const& radii) {
  constexpr double usual_skin = 0.3;
  double const cutoff = cutoff_of(potential);
  double const sigma = 2.0 * radii.largest;
  double const room = 0.499 * box.shortest_period() - cutoff * sigma;
  double const needed = 2.0 * (1.01 * cutoff * sigma);
  if (!(needed <= box.shortest_period())) {
    throw Error(
        {.what = fmt::format("in a periodic box of {} × {} a disk could feel two images of another; the potential "
                             "\"{}\" of these disks needs sides of at least {:.6g}",
                             box.width(), box.height(), to_text(potential.kind), needed),
         .hint = "use more disks, a lower packing fraction, or a shorter potential.cutoff",
         .key = "box"});
  }
  return {.cutoff = cutoff,
          .largest_sigma = sigma,
          .skin = std::min(usual_skin * 2.0 * radii.smallest, room),
          .are_equal = radii.smallest == radii.largest,
          .flows = false};
}

System::System(EngineSettings const& settings, State const& state, ThreadPool& pool, double skin)
    : settings_(settings),
      box_(state.box),
      pool_(pool),
      smallest_diameter_(2.0 * radius_range(state.agents).smallest),
      forces_(force_rule(settings.potential, state.box, radius_range(state.agents), settings.pair_drag.exists())),
      moves_(move_rule(settings, state)),
      reach_(list_reach(settings.potential, state.box, radius_range(state.agents))),
      kernel_(forces_for(target(), forces_)),
      disks_(state) {
  if (skin > 0.0) reach_.skin = std::min(skin * smallest_diameter_, reach_.skin);
  reach_.flows = settings.flow.exists();
  prepare(moves_, disks_);
  if (settings.pair_drag.exists()) {
    drag_ = drag_rule(settings, forces_, radius_range(state.agents));
    disks_.velocities_in_drag.resize(disks_.size());
  }
  list_again();
  compute_forces(state.clock.step);
}

template <class Result, class DoPart>
Result System::for_bands(DoPart do_part) {
  std::vector<Result> results(bands_.size());
  pool_.for_each(bands_.size(), [&](std::size_t b) { do_part(bands_[b], results[b]); });
  for (std::size_t b = 1; b < results.size(); ++b) results[0].add(results[b]);
  return results[0];
}

template <class DoPart>
void System::for_each_band(DoPart do_part) {
  pool_.for_each(bands_.size(), [&](std::size_t b) { do_part(bands_[b]); });
}

void System::list_again() {
  bands_ = make_lists(box_, reach_, disks_, pool_);
  moves_.strain = 0.0;
}

void System::move_images() {
  double const strain = moves_.shear_rate * moves_.duration;
  double const shift = box_.shift() + strain * box_.height();
  if (auto const widths = static_cast<std::int32_t>(box_.widths_in(shift)); widths != 0) {
    // Images above begin again a width before, so that each disk keeps its displacement since the start.
    for (std::size_t row = 0; row < disks_.size(); ++row) {
      disks_.identities[row].image_x += widths * disks_.identities[row].image_y;
    }
  }
  box_ = box_.shifted(shift);
  moves_.box = box_;
  moves_.strain += strain;
  forces_.shift = box_.shift();
}

bool System::are_lists_old(double squared_drift) const {
  // A shear by γ brings two disks nearer by at most γ/2 of their distance.
  double const range = reach_.cutoff * reach_.largest_sigma + reach_.skin;
  double const nearer = 0.5 * std::abs(moves_.strain) * range;
  double const left = reach_.skin - nearer;
  return !(left > 0.0) || 4.0 * squared_drift >= left * left;
}

void System::compute_forces(std::uint64_t step) {
  Largest const largest =
      for_bands<Largest>([&](Band const& band, Largest& push) { push.value = kernel_(forces_, band, disks_); });
  if (!(largest.value <= forces_.max_push)) throw_near_pair(step);
}

void System::use_drags(std::uint64_t step, UseDrags use) {
  Largest const largest =
      for_bands<Largest>([&](Band const& band, Largest& drag) { drag.value = use(*drag_, box_, band, disks_); });
  if (!(largest.value <= drag_->largest_drag)) throw_strong_drag(step, largest.value);
}

void System::take_step(std::uint64_t step) {
  if (drag_) {
    for_each_band([&](Band const& band) { take_velocities(band, disks_); });
    use_drags(step, add_drags);
  }
  if (moves_.shear_rate != 0.0) move_images();
  LongestWays const ways = for_bands<LongestWays>(
      [&](Band const& band, LongestWays& of_band) { of_band = move(moves_, step, band, disks_); });
  if (!(ways.squared_step <= (max_path * smallest_diameter_) * (max_path * smallest_diameter_))) {
    throw_long_step(step, ways);
  }
  if (are_lists_old(ways.squared_drift)) list_again();
  if (drag_) for_each_band([&](Band const& band) { predict_velocities(band, disks_); });
  compute_forces(step);
  if (drag_) return use_drags(step, kick_with_drags);
  for_each_band([&](Band const& band) { end_step(moves_, band, disks_); });
}

void System::throw_long_step(std::uint64_t step, LongestWays const& ways) const {
  // A tenth of a diameter is a usual longest path.
  constexpr double usual_path = 0.1;
  double const path = std::sqrt(ways.squared_step) / smallest_diameter_;
  double const advised = std::max(settings_.time_step * usual_path / path, 1e-3 * settings_.time_step);
  throw RunFailure(
      fmt::format("step {}: disk {} would move {:.3g} diameters of the smallest disk in one time step, more than {}\n"
                  "  hint: use a shorter engine.time_step, such as {:.1g}",
                  step, disks_.identities[ways.row].id, path, max_path, advised));
}

void System::throw_near_pair(std::uint64_t step) const {
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t one = 0;
  std::size_t other = 0;
  for_each_entry(bands_, box_, disks_, [&](std::size_t row, std::uint32_t to, double square, double sigma) {
    if (!(square / (sigma * sigma) < nearest)) return;
    nearest = square / (sigma * sigma);
    one = row;
    other = to;
  });
  bool const is_of_table = settings_.potential.kind == PairPotential::table;
  if (is_of_table && std::sqrt(nearest) < forces_.law.table().first_distance()) {
    throw RunFailure(fmt::format(
        "step {}: disks {} and {} are {:.3g} of the sum of their radii apart, nearer than the first distance "
        "{:.6g} of the table of the potential\n"
        "  hint: use a table that begins nearer, or a shorter engine.time_step, such as {:.1g}",
        step, disks_.identities[one].id, disks_.identities[other].id, std::sqrt(nearest),
        forces_.law.table().first_distance(), 0.5 * settings_.time_step));
  }
  throw RunFailure(fmt::format(
      "step {}: disks {} and {} are {:.3g} of the sum of their radii apart, where the potential \"{}\" is too steep\n"
      "  hint: use a shorter engine.time_step, such as {:.1g}",
      step, disks_.identities[one].id, disks_.identities[other].id, std::sqrt(nearest),
      to_text(settings_.potential.kind), 0.5 * settings_.time_step));
}

void System::throw_strong_drag(std::uint64_t step, double drag) const {
  throw RunFailure(
      fmt::format("step {}: the drag between two disks that touch is {:.3g}, more than {:.3g}, the largest that can be "
                  "added up\n"
                  "  hint: use a lower pair_drag.coefficient, or a higher potential.energy",
                  step, drag, drag_->largest_drag));
}

double System::potential_energy() const {
  double energy = 0.0;
  for_each_entry(bands_, box_, disks_, [&](std::size_t /*row*/, std::uint32_t /*other*/, double square, double sigma) {
    energy += forces_.law.energy(square, sigma);
  });
  return 0.5 * energy;
}

double System::kinetic_energy() const {
  double energy = 0.0;
  for (std::size_t row = 0; row < disks_.size(); ++row) {
    if (is_fixed(disks_.identities[row].mass)) continue;
    energy += 0.5 * disks_.identities[row].mass * squared_length(disks_.motions[row].velocity);
  }
  return energy;
}

}  // namespace gridlock::soft
