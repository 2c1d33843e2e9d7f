#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/world.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/observe/detail/observable_set.hpp"
#include "gridlock/parallel/detail/frame_of_all.hpp"
#include "gridlock/simulation/simulation.hpp"

namespace gridlock {

/// A world of any model, the engine that advances it, and its observables.
///
/// ```cpp
/// auto const fastest = [](DiskSimulation& simulation) {
///   simulation.advance({.step = 100});
///   return largest_speed(simulation.world().agents);
/// };
/// ```
template <class Model>
class WorldSimulation : public Simulation {
 public:
  /// `world` has the agents of this process; `engine` is made for all processes that share the world.
  WorldSimulation(std::unique_ptr<EngineFor<Model>> engine, World<Model>&& world, AllProcesses processes = {})
      : world_(std::move(world)), engine_(std::move(engine)), processes_(processes) {
    count_agents();
  }

  [[nodiscard]] World<Model> const& world() const { return world_; }
  [[nodiscard]] Counters const& counters() const { return counters_; }

  /// Adds the observables of the settings whose required columns this world has.
  void observe(ObserveSettings const& settings, DynamicsTraits const& dynamics) {
    for (auto& observable : make_observables(settings, snapshot(), dynamics)) add(std::move(observable));
  }
  void observe(std::unique_ptr<Observable> observable) override {
    require_columns(*observable, snapshot());
    observable->begin(snapshot());
    add(std::move(observable));
  }

  [[nodiscard]] Box const& box() const override { return world_.box; }
  [[nodiscard]] Clock clock() const override { return world_.clock; }
  [[nodiscard]] double time_step() const override { return engine_->time_step_of(world_); }
  [[nodiscard]] AgentsView view() const override { return world_.agents; }
  [[nodiscard]] std::size_t agents() const override { return agents_; }
  [[nodiscard]] AllProcesses processes() const override { return processes_; }
  [[nodiscard]] std::uint64_t state_hash() const override {
    std::uint64_t const sum = processes_.sum(sum_of_hashes(world_.agents));
    std::uint64_t const of_agents = hash_of_world(world_.box, world_.clock, world_.seed, agents_, sum);
    return hash_with_networks(hash_with_fields(of_agents, world_.fields), world_.networks);
  }
  [[nodiscard]] std::vector<Count> counts() const override { return engine_->counts(world_, counters_); }
  [[nodiscard]] std::vector<Count> audits() const override { return engine_->audits(); }
  [[nodiscard]] std::uint64_t pair_collisions() const override { return counters_.pair_collisions; }
  [[nodiscard]] std::vector<NamedColumn> columns_of_agents() override { return columns_of(world_.agents); }
  [[nodiscard]] std::shared_ptr<void> release_columns() override { return world_.agents.release(); }
  void require_valid() const override { engine_->require_valid(world_); }
  void advance(StopCondition const& stop_condition) override {
    try {
      engine_->advance(world_, counters_, stop_condition);
    } catch (...) {
      find_agents_again();
      throw;
    }
    find_agents_again();
  }

  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return observables_.columns(); }
  void sample(std::span<double> row, bool counts_for_average) override {
    observables_.sample(snapshot(), row, counts_for_average);
  }
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return observables_.results(); }
  [[nodiscard]] std::vector<Distribution> distributions() const override { return observables_.distributions(); }

  void give_frame(UseFrame const& use) const override {
    gridlock::give_frame(processes_, world_, [&](FrameSource const& frame) { engine_->give_frame(frame, use); });
  }

  void serialize(Archive& archive) override {
    serialize_inside(archive, "world", [&] { gridlock::serialize(archive, world_); });
    // A file can hold any values.
    if (archive.is_restoring()) engine_->require_valid(world_);
    // take_restored() adds the agents of other processes.
    agents_ = archive.is_restoring() ? world_.agents.size() : agents_;
    serialize_inside(archive, "counters", [&] { gridlock::serialize(archive, counters_); });
    serialize_inside(archive, "engine", [&] { engine_->serialize(archive, world_); });
    observables_.serialize(archive);
  }
  void take_restored() override {
    engine_->take_restored(world_);
    find_agents_again();
  }

 private:
  void add(std::unique_ptr<Observable> observable) {
    if (observable->requirements(world_.box).reports) {
      engine_->report_collisions([this](PairCollision const& collision) { observables_.collided(collision); });
    }
    observables_.add(std::move(observable));
  }
  [[nodiscard]] Snapshot snapshot() const { return {world_, counters_, processes_, agents_, attached_}; }
  /// Updates the count of agents and the attached columns after births, deaths and moves to other processes.
  void find_agents_again() {
    count_agents();
    attached_.migrate(processes_, world_.agents.ids());
  }
  void count_agents() { agents_ = processes_.sum(world_.agents.size()); }

  World<Model> world_;
  Counters counters_;
  std::unique_ptr<EngineFor<Model>> engine_;
  AllProcesses processes_;
  std::size_t agents_ = 0;    ///< number of agents of all processes
  AttachedColumns attached_;  ///< values that observables keep for each agent
  ObservableSet observables_;
};

using DiskSimulation = WorldSimulation<HardDisks>;

}  // namespace gridlock
