#include "gridlock/core/version.hpp"

#include "version_text.hpp"  // made by cmake/VersionText.cmake

namespace gridlock {

char const* version() { return version_text; }

}  // namespace gridlock
