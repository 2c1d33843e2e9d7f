#include "gridlock/simulation/model_kind.hpp"
#include "models/catalyst.hpp"
#include "models/colloid.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock {

ModelKinds shipped_models() {
  ModelKinds kinds;
  kinds.add<Flocking>();
  kinds.add<Epidemic>();
  kinds.add<Catalyst>();
  kinds.add<Colloid>();
  kinds.add<TiledColloid>();
  return kinds;
}

}  // namespace gridlock
