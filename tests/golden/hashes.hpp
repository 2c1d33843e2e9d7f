#pragma once

#include <string>

namespace gridlock {

/// The hashes of a scene before the first and after the last step.
struct Hashes {
  std::string start;
  std::string end;
};

}  // namespace gridlock
