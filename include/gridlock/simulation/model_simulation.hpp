#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/model/model.hpp"
#include "gridlock/observe/block_average.hpp"
#include "gridlock/simulation/simulation.hpp"

namespace gridlock {

/// A model's world, the engine that steps it and what is observed of it: a simulation like any other.
///
/// Columns of the series: the number of agents, how often each event has happened since the start, and what
/// Model::observe() says; averages of all but the events.
template <class Model>
class ModelSimulation final : public Simulation {
 public:
  /// Errors: those of ModelEngine and of Model::start().
  ModelSimulation(Model model, Box const& box, std::uint64_t seed, ModelEngineSettings const& settings = {})
      : engine_(std::move(model), box, settings), world_{.box = box, .seed = seed} {
    engine_.model().start(world_);
    averages_.resize(1 + observe().size());
  }

  [[nodiscard]] World<Model> const& world() const { return world_; }

  [[nodiscard]] Clock clock() const override { return world_.clock; }
  [[nodiscard]] double time_step() const override { return time_step_of(engine_.model(), world_); }
  [[nodiscard]] std::size_t agents() const override { return world_.agents.size(); }
  [[nodiscard]] std::uint64_t state_hash() const override { return hash(world_); }
  [[nodiscard]] std::vector<Count> counts() const override {
    std::vector<Count> counts;
    for (std::size_t k = 0; k < world_.events.size(); ++k) {
      counts.push_back({std::string(event_names<Model>()[k]), world_.events[k]});
    }
    return counts;
  }

  void advance(StopCondition const& stop_condition) override { engine_.advance(world_, stop_condition); }

  [[nodiscard]] std::vector<ColumnInfo> columns() const override {
    std::vector<ColumnInfo> columns{{"agents", "", "Agents alive."}};
    for (auto const name : event_names<Model>()) columns.push_back({std::string(name), "", "Times since the start."});
    for (auto const& [name, value, documentation] : observe()) columns.push_back({name, "", documentation});
    return columns;
  }
  void sample(std::span<double> row, bool counts_for_average) override {
    std::vector<Observations::Entry> const seen = observe();
    row[0] = static_cast<double>(agents());
    for (std::size_t k = 0; k < world_.events.size(); ++k) row[1 + k] = static_cast<double>(world_.events[k]);
    std::size_t const first = 1 + world_.events.size();
    for (std::size_t k = 0; k < seen.size(); ++k)
      row[first + k] = std::isfinite(seen[k].value) ? seen[k].value : no_value;
    if (!counts_for_average) return;
    averages_[0].add(row[0]);
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (std::isfinite(seen[k].value)) averages_[1 + k].add(seen[k].value);
    }
  }
  [[nodiscard]] std::vector<NamedEstimate> results() const override {
    std::vector<NamedEstimate> results;
    auto const add = [&](std::string const& name, BlockAverage const& average) {
      if (auto const estimate = average.estimate()) results.push_back({name, *estimate, ""});
    };
    add("agents", averages_[0]);
    std::vector<Observations::Entry> const seen = observe();
    for (std::size_t k = 0; k < seen.size(); ++k) add(seen[k].name, averages_[1 + k]);
    return results;
  }
  [[nodiscard]] std::vector<Distribution> distributions() const override { return {}; }

  [[nodiscard]] Frame frame() const override { return frame_of(world_.box, world_.clock, world_.seed, world_.agents); }

  void serialize(Archive& archive) override {
    serialize_inside(archive, "world", [&] { gridlock::serialize(archive, world_); });
    gridlock::serialize(archive, "averages", averages_);
  }

 private:
  [[nodiscard]] std::vector<Observations::Entry> observe() const {
    Observations seen;
    if constexpr (requires { engine_.model().observe(world_, seen); }) engine_.model().observe(world_, seen);
    return seen.entries();
  }

  ModelEngine<Model> engine_;
  World<Model> world_;
  std::vector<BlockAverage> averages_;  ///< of the number of agents, then of what the model observes
};

}  // namespace gridlock
