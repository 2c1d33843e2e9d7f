// The paper's rule as a model is an example that Gridlock does not ship. Tests run it from settings, beside the
// engines.

#include <gtest/gtest.h>

#include "gridlock/simulation/register_model.hpp"
#include "tiled_colloid.hpp"

namespace gridlock {
namespace {

class KnowColloids final : public testing::Environment {
 public:
  void SetUp() override {
    register_model<Colloid>();
    register_model<TiledColloid>();
  }
};

[[maybe_unused]] testing::Environment* const environment = testing::AddGlobalTestEnvironment(new KnowColloids);

}  // namespace
}  // namespace gridlock
