#pragma once

#include <memory>

#include "gridlock/model/model_engine.hpp"

namespace gridlock {

/// Returns whether a model is one of those that the room `device` knows.
template <class Model>
consteval bool runs_on_device() {
  if constexpr (requires { Model::runs_on_device; }) {
    return Model::runs_on_device;
  } else {
    return false;
  }
}

/// Makes an engine that takes the steps of a model on the graphics processor; the room `device` defines it for the
/// models that run there. Errors: Error for the setting "engine.device" without a device.
template <class Model>
std::unique_ptr<EngineFor<Model>> model_engine_on_device(Model const& model, Box const& box,
                                                         ModelEngineSettings const& settings);

}  // namespace gridlock
