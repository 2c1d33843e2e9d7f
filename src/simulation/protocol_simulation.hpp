#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/protocol/protocol.hpp"
#include "gridlock/simulation/world_simulation.hpp"

namespace gridlock {

/// Returns the results that a protocol adds to summary.json; the next function its tables, without rows, for the help.
std::vector<ColumnInfo> protocol_results();
std::vector<Distribution> protocol_tables();

/// A simulation of disks that begins after a protocol has prepared them.
///
/// During the protocol, `simulation_` holds the start and provides only the columns of the series. The clock does not
/// advance during the protocol.
class ProtocolSimulation final : public Simulation {
 public:
  /// Makes the simulation of a state. It is called for the start, whose disks may overlap, and again for the state at
  /// the end of the protocol.
  using MakeSimulation = std::function<std::unique_ptr<DiskSimulation>(State state, bool is_prepared)>;

  ProtocolSimulation(ProtocolSettings const& settings, State start, MakeSimulation make);

  [[nodiscard]] bool is_prepared() const override { return is_prepared_; }
  bool prepare(std::function<bool()> const& should_continue) override;
  [[nodiscard]] Preparation preparation() const override;
  [[nodiscard]] std::vector<Event> notes() const override;

  [[nodiscard]] Clock clock() const override { return is_prepared_ ? simulation_->clock() : start_clock_; }
  [[nodiscard]] double time_step() const override { return simulation_->time_step(); }
  [[nodiscard]] Box const& box() const override { return state_.box; }
  [[nodiscard]] AgentsView view() const override;
  [[nodiscard]] std::uint64_t state_hash() const override;
  /// Returns the counts of the run after the protocol; none before its first step.
  [[nodiscard]] std::vector<Count> counts() const override {
    return has_run() ? simulation_->counts() : std::vector<Count>();
  }
  [[nodiscard]] std::vector<Count> audits() const override { return simulation_->audits(); }
  [[nodiscard]] std::uint64_t pair_collisions() const override { return simulation_->pair_collisions(); }
  [[nodiscard]] std::vector<NamedColumn> columns_of_agents() override;
  [[nodiscard]] std::shared_ptr<void> release_columns() override;
  void require_valid() const override;
  void advance(StopCondition const& stop_condition) override { simulation_->advance(stop_condition); }
  void observe(std::unique_ptr<Observable> observable) override;
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return simulation_->columns(); }
  void sample(std::span<double> row, bool counts_for_average) override { simulation_->sample(row, counts_for_average); }
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void give_frame(UseFrame const& use) const override;
  [[nodiscard]] std::optional<FrameContacts> contacts() const override;
  void serialize(Archive& archive) override;

 private:
  void begin_simulation();
  [[nodiscard]] bool has_run() const;
  [[nodiscard]] bool ends_at_minimum() const;

  MakeSimulation make_;
  SoftSettings soft_;
  Clock start_clock_;
  State state_;  ///< state of the protocol; after it the simulation owns the state
  Protocol protocol_;
  bool is_prepared_ = false;
  std::unique_ptr<DiskSimulation> simulation_;
};

}  // namespace gridlock
