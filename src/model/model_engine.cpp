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
  require_rectangle(box, fmt::format("the model {}", model));
  double const shorter = box.shortest_period();
  if (2.0 * cutoff <= shorter) return;
  throw Error({.what = fmt::format("the cutoff of the model {}, {:.6g}, is more than half a side of the periodic box, "
                                   "{:.6g}: an agent could meet two images of another",
                                   model, cutoff, shorter),
               .hint = fmt::format("use a box with sides of at least {:.6g}, a smaller cutoff, or walls", 2.0 * cutoff),
               .key = std::string(model)});
}

}  // namespace gridlock
