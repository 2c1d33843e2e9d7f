#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "device/agents.hpp"
#include "gridlock/model/detail/cells_of_step.hpp"
#include "gridlock/model/detail/on_device.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock {

namespace device {

namespace {

/// Takes steps on the device, and those that the device leaves on the cores.
template <class Model>
class ModelOnDevice final : public EngineFor<Model> {
 public:
  ModelOnDevice(Model const& model, Box const& box, ModelEngineSettings const& settings)
      : model_(model), settings_(settings), cores_(model, box, settings), launcher_(settings.threads) {
    require_device();
  }

  void advance(World<Model>& world, Counters& counters, StopCondition const& stop_condition) override {
    StopCondition one_step;
    std::optional<Agents<Model>> agents;
    auto const bring_back = [&] {
      if (agents) agents->download(world);
      agents.reset();
    };
    while (!stop_condition.is_reached(world.clock, counters.pair_collisions)) {
      if (is_tried_at(world) && is_taken_by_device(world, agents)) {
        ++world.clock.step;
        world.clock.time += model_.time_step();
      } else {
        bring_back();
        one_step.step = world.clock.step + 1;
        cores_.advance(world, counters, one_step);
      }
      if (stop_condition.stops_here()) break;
    }
    bring_back();
  }

  [[nodiscard]] double time_step_of(World<Model> const& world) const override { return cores_.time_step_of(world); }
  void require_valid(World<Model> const& world) const override {
    cores_.require_valid(world);
    require_room(world);
  }
  [[nodiscard]] std::vector<Count> counts(World<Model> const& world, Counters const& counters) const override {
    return cores_.counts(world, counters);
  }

 private:
  /// Returns whether the device tries to take the next step. After each that it has left to the cores in a row, these
  /// take twice as many before it tries again.
  [[nodiscard]] bool is_tried_at(World<Model> const& world) const {
    bool const is_verified = settings_.verify_every > 0 && world.clock.step % settings_.verify_every == 0;
    return !is_verified && !world.agents.empty() && world.clock.step >= next_try_;
  }
  bool is_taken_by_device(World<Model>& world, std::optional<Agents<Model>>& agents) {
    if (!agents) put_onto_device(world, agents);
    bool const is_taken = agents->take_step(world, model_.time_step());
    wait_ = is_taken ? 1 : std::min<std::uint64_t>(2 * wait_, longest_wait);
    if (!is_taken) next_try_ = world.clock.step + wait_;
    return is_taken;
  }

  [[nodiscard]] CellsOfStep cells_of(World<Model> const& world) const {
    return cells_of_step(world.box, model_.cutoff(), world.agents.size());
  }

  void require_room(World<Model> const& world) const {
    std::size_t const bytes = Agents<Model>::bytes(world.agents.size(), cells_of(world).layout);
    require_room_on_device(world.agents.size(), "agents", bytes);
  }

  void put_onto_device(World<Model> const& world, std::optional<Agents<Model>>& agents) {
    // Searches rely on it, and the cores say which agent it is.
    ModelEngine<Model>::require_inside(world);
    require_room(world);
    agents.emplace(launcher_, model_, world, cells_of(world));
  }

  Model model_;
  ModelEngineSettings settings_;
  ModelEngine<Model> cores_;
  Launcher launcher_;
  static constexpr std::uint64_t longest_wait = 256;
  std::uint64_t next_try_ = 0;  ///< step
  std::uint64_t wait_ = 1;      ///< in steps
};

}  // namespace

}  // namespace device

template <class Model>
std::unique_ptr<EngineFor<Model>> model_engine_on_device(Model const& model, Box const& box,
                                                         ModelEngineSettings const& settings) {
  return std::make_unique<device::ModelOnDevice<Model>>(model, box, settings);
}

template std::unique_ptr<EngineFor<Epidemic>> model_engine_on_device(Epidemic const& model, Box const& box,
                                                                     ModelEngineSettings const& settings);
template std::unique_ptr<EngineFor<Flocking>> model_engine_on_device(Flocking const& model, Box const& box,
                                                                     ModelEngineSettings const& settings);

}  // namespace gridlock
