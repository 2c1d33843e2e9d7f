#include "gridlock/model/detail/verify.hpp"

#include <fmt/format.h>

#include "gridlock/core/error.hpp"

namespace gridlock {

void throw_search_difference(SearchDifference const& difference) {
  throw RunFailure(fmt::format(
      "step {}: a search for neighbours within {:.9g} of ({:.9g}, {:.9g}) found {} agents where there are {}; the "
      "first "
      "difference is agent {}\n  hint: this is a mistake of Gridlock, or of a model that searches farther than it says",
      difference.step, difference.cutoff, difference.point.x, difference.point.y, difference.found, difference.expected,
      difference.id));
}

}  // namespace gridlock
