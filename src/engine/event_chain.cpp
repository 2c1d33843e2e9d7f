#include "event_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/disks_overview.hpp"
#include "core/temperature.hpp"
#include "engine/chain/chains.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {

namespace {

void require_periodic_sides(State const& state) {
  if (!state.box.is_periodic()) {
    throw Error({.what = fmt::format("event chains know no walls, and the box is {}", edges_in_words(state.box)),
                 .hint = "use box.edge = \"periodic\", or engine.kind = \"exact\"",
                 .key = "box.edge"});
  }
  double const needed = chain::min_side * largest_contact_distance(state.agents.column<Radius>());
  if (state.agents.size() < 2 || state.box.shortest_period() >= needed) return;
  throw Error({.what = fmt::format("the box of {} × {} is too small for event chains: these disks need sides of at "
                                   "least {:.6g}",
                                   state.box.width(), state.box.height(), needed),
               .hint = "use more disks, or engine.kind = \"exact\", in a protocol a stage \"run\"",
               .key = "engine.kind"});
}

void require_mobile_disks(Disks const& disks) {
  std::size_t const fixed = count_of_fixed(disks);
  if (fixed == 0) return;
  throw Error({.what = fmt::format("{} disks are fixed, and event chains move all disks", fixed),
               .hint = "let all species move, or use engine.kind = \"exact\"",
               .key = "disks.species"});
}

/// Errors: Error for disks whose velocities would not stay a sample of Maxwell's distribution, or that never move.
void require_newtonian(Disks const& disks) {
  auto const masses = disks.column<Mass>();
  auto const refuse = [](std::string what) {
    throw Error({.what = std::move(what), .hint = "use chains = \"straight\"", .key = "engine.chains"});
  };
  if (std::ranges::any_of(masses, [&](double mass) { return mass != masses[0]; })) {
    refuse("Newtonian chains need disks of one mass");
  }
  if (kinetic_energy(disks) == 0.0) refuse("Newtonian chains need velocities, and all disks are at rest");
}

/// Contacts of a chain, so that a straight one goes around a small box once at most.
double contacts_of_chain(EngineSettings const& settings, double disks) {
  if (settings.chain_length) return static_cast<double>(*settings.chain_length);
  return std::min(1000.0, 8.0 * std::sqrt(disks));
}

std::string_view unused_in_event_chain(EngineSettings const& /*settings*/, std::string_view setting) {
  bool const is_used = setting == "kind" || setting == "chains" || setting == "chain_length";
  return is_used ? "" : "kind";
}

}  // namespace

EngineRecord event_chain_record() {
  return {.name = "event_chain",
          .documentation = "has no dynamics: Monte Carlo by chains of moves, in periodic boxes",
          .has_time_step = false,
          .is_monte_carlo = true,
          .bytes_per_disk = 240.0,
          .bytes_per_disk_of_checkpoint = 19.0,
          .unused_because_of = unused_in_event_chain,
          .cost_of_move = [](EngineSettings const& /*settings*/, State const& /*state*/) { return 1.0; },
          .make = [](EngineSettings const& settings, State const& state) -> std::unique_ptr<Engine> {
            return std::make_unique<EventChainEngine>(settings, state);
          }};
}

void describe_chains(ChainKind& chains, std::optional<std::uint64_t>& chain_length, SettingVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> names{"straight", "newtonian"};
  visit_enum(visitor,
             {.key = "chains",
              .documentation = "How the disks of event_chain move one after the other: \"straight\" up and to the "
                               "right, or \"newtonian\", each by its velocity, which contacts change."},
             names, chains);
  visitor.visit({.key = "chain_length",
                 .unit = "contacts",
                 .documentation = "About how many disks of event_chain move in one chain. A step, or a sweep of a "
                                  "stage, has chains with about as many contacts as there are disks.",
                 .min = 1,
                 .max = 1e9,
                 .default_note = "8 √N, and 1,000 at most"},
                chain_length);
}

std::vector<Count> EventChainEngine::counts(State const& /*state*/, Counters const& counters) const {
  return {{"moves", counters.moves}, {"pair_collisions", counters.pair_collisions}};
}

EventChainEngine::EventChainEngine(EngineSettings const& settings, State const& state) : kind_(settings.chains) {
  EventChainEngine::require_valid(state);
  Disks const& disks = state.agents;
  if (disks.empty()) return;
  auto const count = static_cast<double>(disks.size());
  chains_ = static_cast<std::uint64_t>(std::max(1.0, std::floor(count / contacts_of_chain(settings, count) + 0.5)));
  // From scaled particle theory, and beyond freezing from the pressure there: Z − 1 is the mean distance of two centres
  // along a chain, about π/4 diameters, over the way between two contacts.
  double const packing_fraction = packing_fraction_of(state);
  double const excess = std::min(2.0 * packing_fraction / ((1.0 - packing_fraction) * (1.0 - packing_fraction)), 9.2);
  double const diameter = mean_diameter(disks);
  double const kt = temperature(state).value_or(0.0);
  double const squared_speed = 2.0 * kinetic_energy(disks) / (count * mean_mass(disks));
  if (kt > 0.0) speed_ = std::sqrt(2.0 * kt / mean_mass(disks));
  double const all_ways = count * std::min(0.785 / excess, 10.0) * diameter;
  if (kind_ == ChainKind::straight) {
    length_ = all_ways / static_cast<double>(chains_);
    duration_ = all_ways / (count * speed_);
    return;
  }
  // Newtonian: (Z − 1) ⟨v²⟩ is the mean of σ v_n, 1.25 σ √(kT/m), over the time between two contacts.
  double const all_times = count * std::min(1.25 / excess, 20.0) * diameter / std::sqrt(2.0 * squared_speed);
  length_ = all_times / static_cast<double>(chains_);
  duration_ = all_times / count;
  virial_factor_ = 2.0 * kt / squared_speed;
}

void EventChainEngine::require_valid(State const& state) const {
  double const rounding = rounding_of_contact(state);
  validate(state, {.overlap = rounding});
  require_periodic_sides(state);
  require_mobile_disks(state.agents);
  if (kind_ == ChainKind::newtonian && !state.agents.empty()) require_newtonian(state.agents);
}

void EventChainEngine::serialize(Archive& archive, State const& /*state*/) {
  archive.visit("length", length_);
  archive.visit("speed", speed_);
  archive.visit("duration", duration_);
  archive.visit("virial_factor", virial_factor_);
  archive.require(std::isfinite(length_) && length_ >= 0.0 && speed_ > 0.0 && duration_ > 0.0,
                  "the length of chains is no number above 0");
}

void EventChainEngine::advance(State& state, Counters& counters, StopCondition const& stop_condition) {
  if (state.agents.empty() || stop_condition.is_reached(state.clock, counters.pair_collisions)) return;
  std::unique_ptr<chain::ChainDisks> const disks = chain::chain_disks(state, target());
  bool const by_velocity = kind_ == ChainKind::newtonian;
  double const factor = by_velocity ? virial_factor_ : 2.0 * temperature(state).value_or(0.0) / speed_;
  // Some seconds, and far more than a chain needs in a crystal whose rows hardly fit.
  std::uint64_t const most_contacts = 100'000'000 + 1'000 * (state.agents.size() / chains_);
  while (!stop_condition.is_reached(state.clock, counters.pair_collisions)) {
    chain::ChainSums const sums = disks->take({.seed = state.seed,
                                               .step = state.clock.step,
                                               .count = chains_,
                                               .length = length_,
                                               .by_velocity = by_velocity,
                                               .most_contacts = most_contacts});
    ++state.clock.step;
    state.clock.time += duration_;
    counters.moves += sums.flights;
    counters.pair_collisions += sums.contacts;
    counters.pair_virial += factor * sums.virial;
    if (stop_condition.stops_here()) break;
  }
  disks->write_back(state);
}

}  // namespace gridlock
