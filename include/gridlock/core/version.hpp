#pragma once

namespace gridlock {

/// Returns the version of the library and the commit from which it was built. Summary.json and checkpoints record it,
/// since another version may give other bits.
///
///     0.2.0-dev+0123456789ab            of that commit
///     0.2.0-dev+0123456789ab.modified   with changes to what is compiled
///     0.2.0-dev+unknown                 of sources without git
///
/// ```cpp
/// #include <string>
///
/// std::string const program = std::string("gridlock ") + gridlock::version();
/// ```
char const* version();

}  // namespace gridlock
