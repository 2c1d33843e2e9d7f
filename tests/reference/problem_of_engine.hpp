#pragma once

#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::reference {

/// Returns the setting and the text of the error with which an engine refuses a state; empty where it takes it.
inline std::string problem_of(EngineSettings const& settings, State const& state) {
  try {
    make_engine(settings, state);
  } catch (Error const& error) {
    return error.problems().front().key + ": " + error.problems().front().what;
  }
  return "";
}

}  // namespace gridlock::reference
