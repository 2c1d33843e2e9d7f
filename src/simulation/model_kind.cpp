#include "gridlock/simulation/model_kind.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace gridlock {

namespace {

ModelKinds& all_known() {
  static ModelKinds kinds = shipped_models();
  return kinds;
}

}  // namespace

void blame_table(std::string_view model, std::function<void()> const& act) {
  try {
    act();
  } catch (RunFailure const& failure) {
    throw Error({.what = failure.what(), .key = std::string(model)});
  } catch (Error const& error) {
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      problem.key = problem.key.empty() ? std::string(model) : fmt::format("{}.{}", model, problem.key);
    }
    throw Error(std::move(problems));
  }
}

ModelKinds known_models() { return all_known(); }

void register_model(std::unique_ptr<ModelKind> kind) {
  if (all_known().find(kind->name()) != nullptr) {
    throw Error({.what = fmt::format("there is a model {} already", kind->name()),
                 .hint = "give this one another name, and call register_model() for it once",
                 .key = "model.kind"});
  }
  all_known().add(std::move(kind));
}

}  // namespace gridlock
