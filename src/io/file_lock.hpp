#pragma once

#include <filesystem>

namespace gridlock {

/// Returns whether `path` still leads to this open file. Another process may have removed the file before its lock was
/// obtained.
bool is_still_named(int descriptor, std::filesystem::path const& path);

}  // namespace gridlock
