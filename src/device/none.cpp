// A program without a graphics processor.

#include <cstddef>
#include <memory>
#include <optional>

#include "engine/tiled/step_taker.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/device/neighbour_lists.hpp"
#include "gridlock/engine/device.hpp"
#include "gridlock/model/detail/on_device.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock {

std::optional<DeviceInfo> find_device() { return std::nullopt; }

void require_device() {
  throw Error({.what = "this program was built without graphics processors",
               .hint = "use engine.device = \"cpu\" or GRIDLOCK_DEVICE=cpu, or build it with -DGRIDLOCK_CUDA=ON",
               .key = "engine.device"});
}

std::size_t tiled::bytes_on_device(std::size_t /*disks*/, CellLayout const& /*layout*/, Tiling const& /*tiling*/) {
  return 0;
}

std::unique_ptr<tiled::StepTaker> tiled::steps_on_device(HotDisks const& /*disks*/, TurnRule const& /*rule*/,
                                                         CellLayout const& /*layout*/, Tiling const& /*tiling*/,
                                                         std::uint64_t /*threads*/) {
  require_device();
  return nullptr;
}

template <class Model>
std::unique_ptr<EngineFor<Model>> model_engine_on_device(Model const& /*model*/, Box const& /*box*/,
                                                         ModelEngineSettings const& /*settings*/) {
  require_device();
  return nullptr;
}

template std::unique_ptr<EngineFor<Epidemic>> model_engine_on_device(Epidemic const&, Box const&,
                                                                     ModelEngineSettings const&);
template std::unique_ptr<EngineFor<Flocking>> model_engine_on_device(Flocking const&, Box const&,
                                                                     ModelEngineSettings const&);

PointPairs find_pairs_on_device(Box const& /*box*/, double /*cutoff*/, PointsInMemory const& /*points*/,
                                std::uint64_t /*threads*/) {
  require_device();
  return {};
}

NeighbourLists find_neighbour_lists_on_device(Box const& /*box*/, double /*cutoff*/, PointsInMemory const& /*points*/,
                                              std::uint64_t /*threads*/) {
  require_device();
  return {};
}

}  // namespace gridlock
