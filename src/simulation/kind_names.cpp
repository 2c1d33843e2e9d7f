#include "simulation/kind_names.hpp"

#include "gridlock/core/error.hpp"
#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

std::vector<std::string> kind_names(SettingsFile const& file, std::string_view column) {
  try {
    return read_configuration(file).kind().value_names(column);
  } catch (Error const&) {
    return {};  // settings of another program
  }
}

}  // namespace gridlock
