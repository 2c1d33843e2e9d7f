// A quantity of your own, measured along a run like those that Gridlock has: the speed of the fastest disk.
#include <cmath>
#include <cstdio>
#include <memory>

#include "gridlock/observe/observable.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"

class LargestSpeed final : public gridlock::AveragingObservable {
 public:
  gridlock::Requirements requirements(gridlock::Box const&) const override {
    return {.columns = {"velocity_x", "velocity_y"}};
  }
  void begin(gridlock::Snapshot const&) override {
    reset({{"largest_speed", "length / time", "Speed of the fastest disk."}});
  }
  void sample(gridlock::Snapshot const& now, std::span<double> row, bool counts_for_average) override {
    auto const x = now.agents.column<gridlock::VelocityX>();
    auto const y = now.agents.column<gridlock::VelocityY>();
    row[0] = now.max([&](std::size_t i) { return std::hypot(x[i], y[i]); });
    if (counts_for_average) average(0, row[0]);
  }
};

int main() {
  gridlock::Configuration configuration;
  configuration.disks = {.count = 400, .packing_fraction = 0.5, .start = gridlock::StartKind::triangular};
  configuration.engine.kind = "exact";
  configuration.run.steps = 2000;
  gridlock::Setup const setup = gridlock::set_up(configuration);
  setup.simulation->observe(std::make_unique<LargestSpeed>());
  gridlock::Run run(*setup.simulation, gridlock::plan_of(setup));
  run.advance();
  for (auto const& [name, estimate, unit] : run.record().results) {
    if (name == "mean_speed" || name == "largest_speed") {
      std::printf("%s %.3f ± %.3f %s\n", name.c_str(), estimate.value, estimate.error.value_or(0.0), unit.c_str());
    }
  }
}
