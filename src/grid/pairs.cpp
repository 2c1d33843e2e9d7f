#include "gridlock/grid/pairs.hpp"

namespace gridlock {

LinkedGrid grid_for_reach(State const& state, double reach) {
  return {layout_for_reach(state.box, reach, state.disks.size()), state.disks.column<X>(), state.disks.column<Y>()};
}

}  // namespace gridlock
