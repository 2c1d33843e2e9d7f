#include "gridlock/core/archive.hpp"

#include <fmt/format.h>

#include "gridlock/core/error.hpp"

namespace gridlock {

void Archive::require(bool holds, char const* what) const {
  if (holds) return;
  throw Error({.what = fmt::format("what was saved cannot be restored: {}", what),
               .hint = "it was saved by another version, or for another configuration"});
}

}  // namespace gridlock
