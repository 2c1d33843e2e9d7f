// What a settings file may hold, from reading to the configuration it means. A text that is accepted says the same
// again when it is written out.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "gridlock/core/error.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/workspace/sweep.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace gridlock;
  std::string_view const text(reinterpret_cast<char const*>(data), size);
  try {
    SettingsFile const file = SettingsFile::from_text(text, "fuzz.toml");
    Configuration configuration;
    file.read_into(describing(configuration));
    std::string const written = to_toml(describing(configuration));
    Configuration again;
    SettingsFile::from_text(written, "written.toml").read_into(describing(again));
    if (to_toml(describing(again)) != written) std::abort();
  } catch (Error const&) {
  }
  try {
    static_cast<void>(plan_sweep(SettingsFile::from_text(text, "fuzz.toml")));
  } catch (Error const&) {
  }
  return 0;
}
