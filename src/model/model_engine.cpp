#include "gridlock/model/model_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "gridlock/core/error.hpp"

namespace gridlock {

void require_cutoff_fits(Box const& box, double cutoff, std::string_view model) {
  if (!(std::isfinite(cutoff) && cutoff > 0.0)) {
    throw Error({.what = fmt::format("the cutoff of the model {} is {}, not a positive number", model, cutoff),
                 .hint = "check the lengths among its settings",
                 .key = std::string(model)});
  }
  double const shorter = std::min(box.width(), box.height());
  if (!box.is_periodic() || 2.0 * cutoff <= shorter) return;
  throw Error({.what = fmt::format("agents that look {:.6g} far could see two images of another in a periodic box with "
                                   "a side of {:.6g}",
                                   cutoff, shorter),
               .hint = "use a box with sides of at least twice the cutoff, or walls",
               .key = std::string(model)});
}

}  // namespace gridlock
