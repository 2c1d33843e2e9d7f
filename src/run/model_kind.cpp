#include "gridlock/run/model_kind.hpp"

#include <fmt/format.h>

namespace gridlock {

namespace {

ModelKinds& all_known() {
  static ModelKinds kinds = shipped_models();
  return kinds;
}

}  // namespace

ModelKinds known_models() { return all_known(); }

void make_known(std::unique_ptr<ModelKind> kind) {
  if (all_known().find(kind->name()) != nullptr) {
    throw Error({.what = fmt::format("there is a model {} already", kind->name()),
                 .hint = "give this one another name, and call make_known() for it once",
                 .key = "model.kind"});
  }
  all_known().add(std::move(kind));
}

}  // namespace gridlock
