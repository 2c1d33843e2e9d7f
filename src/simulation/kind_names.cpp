#include "simulation/kind_names.hpp"

#include "gridlock/core/error.hpp"
#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

std::vector<std::string> kind_names(SettingsFile const& file, std::string_view column) {
  try {
    Configuration const configuration = read_configuration(file);
    ModelKind const* const kind = configuration.models.find(configuration.model.kind);
    return kind == nullptr ? std::vector<std::string>() : kind->value_names(column);
  } catch (Error const&) {
    return {};  // settings of another program
  }
}

}  // namespace gridlock
