#include "observe/energy.hpp"

#include "observe/motion.hpp"

namespace gridlock {

namespace {

constexpr std::size_t energy_column = 0;
constexpr std::size_t drift_column = 1;

}  // namespace

void Energy::begin(Snapshot const& start) {
  reset({{"kinetic_energy", "mass · length² / time²", "Total kinetic energy ½ Σ m v²."},
         {"kinetic_energy_drift", "", "Relative change of the kinetic energy since the start."}});
  start_ = measured_kinetic_energy(start);
  last_ = start_;
}

void Energy::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  last_ = measured_kinetic_energy(now);
  row[energy_column] = last_;
  row[drift_column] = has_drift() ? drift() : no_value;
  if (counts_for_average) average(energy_column, last_);
}

std::vector<NamedEstimate> Energy::results() const {
  std::vector<NamedEstimate> results = AveragingObservable::results();
  if (has_drift())
    results.push_back({columns()[drift_column].name, {drift(), std::nullopt}, columns()[drift_column].unit});
  return results;
}

void Energy::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  archive.visit("last", last_);
}

}  // namespace gridlock
