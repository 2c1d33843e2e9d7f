#include "observe/speed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>

#include "gridlock/parallel/detail/collectives.hpp"
#include "observe/mobile.hpp"
#include "observe/motion.hpp"

namespace gridlock {

namespace {

constexpr std::size_t speed_column = 0;
constexpr std::size_t ratio_column = 1;

/// A mass and the number of agents that have it.
struct CountedMass {
  double mass = 0.0;
  std::uint64_t agents = 0;
};

/// Adds agents of a mass that is not below the last one.
void add_counted(std::vector<CountedMass>& masses, CountedMass const& next) {
  if (!masses.empty() && masses.back().mass == next.mass) {
    masses.back().agents += next.agents;
  } else {
    masses.push_back(next);
  }
}

/// Returns the masses of all processes in ascending order, each once. Contract: `masses` ascend.
std::vector<CountedMass> merged(Communicator& processes, std::vector<CountedMass> const& masses) {
  Message const all =
      all_reduce(processes, message_of_all(std::span(masses)), [](Message const& left, Message const& right) {
        auto const first = MessageReader(left).rest<CountedMass>();
        auto const second = MessageReader(right).rest<CountedMass>();
        std::vector<CountedMass> sorted;
        std::merge(first.begin(), first.end(), second.begin(), second.end(), std::back_inserter(sorted),
                   [](CountedMass const& a, CountedMass const& b) { return a.mass < b.mass; });
        std::vector<CountedMass> merged;
        for (CountedMass const& next : sorted) add_counted(merged, next);
        return message_of_all(std::span<CountedMass const>(merged));
      });
  return MessageReader(all).rest<CountedMass>();
}

/// Returns the different masses in ascending order. Many different masses are rounded to sixteen binary digits, which
/// changes Maxwell's curve by less than 1e-5 of itself and keeps the list shorter than the number of agents.
std::vector<CountedMass> masses_of(Snapshot const& now) {
  constexpr std::size_t many = std::size_t{1} << 16U;
  auto const column = now.agents.column<Mass>();
  std::vector<double> masses(column.begin(), column.end());
  std::erase_if(masses, [](double mass) { return is_fixed(mass); });
  std::ranges::sort(masses);
  std::vector<CountedMass> counted;
  for (double const mass : masses) add_counted(counted, {mass, 1});
  auto const round = [&] {
    std::vector<CountedMass> rounded;
    for (auto const& [mass, agents] : counted) {
      int exponent = 0;
      double const fraction = std::frexp(mass, &exponent);
      add_counted(rounded, {std::ldexp(std::round(fraction * 0x1p16), exponent - 16), agents});
    }
    counted = std::move(rounded);
  };
  std::array<std::uint64_t, 1> processes_with_many{counted.size() > many ? 1U : 0U};
  now.counts(processes_with_many);
  if (processes_with_many[0] > 0) round();
  counted = merged(now.processes.communicator(), counted);
  if (processes_with_many[0] == 0 && counted.size() > many) round();
  return counted;
}

}  // namespace

void Speed::begin(Snapshot const& start) {
  reset({{"mean_speed", "length / time", "Mean speed of the agents."},
         {"speed_moment_ratio", "", "⟨v⁴⟩/⟨v²⟩², with energies for unequal masses; 2 in thermal equilibrium."}});
  auto const n = static_cast<double>(count_of_moving(start));
  std::vector<CountedMass> const masses = masses_of(start);
  masses_.clear();
  for (auto const& [mass, agents] : masses) masses_.push_back({mass, static_cast<double>(agents) / n});
  double const energy = measured_kinetic_energy(start);
  bin_width_ =
      energy > 0.0 ? range_ * std::sqrt(2.0 * energy / (n * masses_.front().mass)) / static_cast<double>(bins_) : 0.0;
  counts_.assign(bin_width_ > 0.0 ? bins_ : 0, 0);
  shares_.assign(counts_.size(), {});
  temperature_ = {};
}

void Speed::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  AgentsView const& agents = now.agents;
  auto const n = static_cast<double>(count_of_moving(now));
  MobileAgents const mobile(agents);
  auto const mass = agents.column<Mass>();
  auto const velocity_x = agents.column<VelocityX>();
  auto const velocity_y = agents.column<VelocityY>();
  std::ranges::fill(counts_, 0);
  double const bins_per_speed = bin_width_ > 0.0 ? 1.0 / bin_width_ : 0.0;
  auto const bins = static_cast<double>(counts_.size());
  auto const [speeds, energies, squared_energies] = now.sum([&](std::size_t i) {  // twice the kinetic energies
    if (!mobile.has(i)) return std::array{0.0, 0.0, 0.0};
    double const squared_speed = velocity_x[i] * velocity_x[i] + velocity_y[i] * velocity_y[i];
    double const speed = std::sqrt(squared_speed);
    double const energy = mass[i] * squared_speed;
    double const bin = speed * bins_per_speed;
    if (bin < bins) ++counts_[static_cast<std::size_t>(bin)];
    return std::array{speed, energy, energy * energy};
  });
  now.counts(counts_);
  bool const is_moving = energies > 0.0;
  row[speed_column] = n > 0.0 ? speeds / n : no_value;
  row[ratio_column] = is_moving ? n * squared_energies / (energies * energies) : no_value;
  if (!counts_for_average || !(n > 0.0)) return;
  average(speed_column, row[speed_column]);
  if (is_moving) average(ratio_column, row[ratio_column]);
  for (std::size_t b = 0; b < counts_.size(); ++b) shares_[b].add(static_cast<double>(counts_[b]) / n);
  if (auto const kt = measured_temperature(now)) temperature_.add(*kt);
}

double Speed::maxwell_below(double v, double temperature) const {
  double below = 0.0;
  for (auto const& [mass, share] : masses_) below -= share * std::expm1(-0.5 * mass * v * v / temperature);
  return below;
}

std::vector<Distribution> Speed::distributions() const {
  auto const kt = temperature_.estimate();
  if (counts_.empty() || !kt || !(kt->value > 0.0)) return {};
  std::vector<double> speed, density, error, maxwell;
  for (std::size_t b = 0; b < shares_.size(); ++b) {
    double const lower = static_cast<double>(b) * bin_width_;
    double const upper = static_cast<double>(b + 1) * bin_width_;
    Estimate const share = *shares_[b].estimate();
    speed.push_back(0.5 * (lower + upper));
    density.push_back(share.value / bin_width_);
    error.push_back(share.error ? *share.error / bin_width_ : no_value);
    maxwell.push_back((maxwell_below(upper, kt->value) - maxwell_below(lower, kt->value)) / bin_width_);
  }
  return {{.name = "speed_distribution",
           .columns = {{"speed", "length / time", "Middle of the bin."},
                       {"density", "time / length", "Share of the disks in the bin per unit of speed."},
                       {"error", "time / length", "One standard error of the density, from blocks of samples."},
                       {"maxwell", "time / length", "Maxwell's density at the measured temperature."}},
           .columns_of_values = {std::move(speed), std::move(density), std::move(error), std::move(maxwell)}}};
}

void Speed::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  gridlock::serialize(archive, "shares", shares_);
  gridlock::serialize(archive, "temperature", std::span(&temperature_, 1));
}

}  // namespace gridlock
