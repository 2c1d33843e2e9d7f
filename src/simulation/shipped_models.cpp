#include "gridlock/simulation/register_model.hpp"
#include "models/catalyst.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"
#include "models/predation.hpp"
#include "models/segregation.hpp"
#include "simulation/disks_kind.hpp"

namespace gridlock {

namespace {

template <class Model>
void add(ModelKinds& kinds) {
  kinds.add(std::make_unique<detail::ModelKindOf<Model>>());
}

}  // namespace

/// Lists all models of Gridlock. A new model needs an entry here and a file in models/.
ModelKinds shipped_models() {
  ModelKinds kinds;
  kinds.add(disks_kind());
  add<Flocking>(kinds);
  add<Epidemic>(kinds);
  add<Catalyst>(kinds);
  add<Predation>(kinds);
  add<Segregation>(kinds);
  return kinds;
}

}  // namespace gridlock
