#pragma once

namespace gridlock {

/// The library's version and the commit that it was built from, as in summary.json and checkpoints: another version may
/// give other bits.
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
