#pragma once

#include <filesystem>

namespace gridlock {

/// Whether an open file still is the one with that name. One who waited for the lock of a file may find that its last
/// owner has removed it.
bool is_still_named(int descriptor, std::filesystem::path const& path);

}  // namespace gridlock
