#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/posix.hpp"

namespace gridlock {

namespace {

/// Attempts to get a lock, since is_held() in another process may hold it for a moment.
constexpr int attempts = 5;
constexpr std::chrono::milliseconds between_attempts{10};

bool lock_file(int descriptor, int operation) {
  for (int attempt = 1;; ++attempt) {
    if (flock(descriptor, operation | LOCK_NB) == 0) return true;
    if (attempt == attempts) return false;
    std::this_thread::sleep_for(between_attempts);
  }
}

[[noreturn]] void refuse(std::string const& what, std::string hint) {
  throw Error({.what = what, .hint = std::move(hint), .key = "-o"});
}

}  // namespace

DirectoryLock::DirectoryLock(std::filesystem::path const& directory, Sharing sharing) : path_(directory / file_name) {
  for (;;) {
    descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      refuse(fmt::format("cannot write into the directory {}: {}", directory.string(),
                         std::generic_category().message(errno)),
             "name another directory");
    }
    if (!lock_file(descriptor_, sharing == Sharing::alone ? LOCK_EX : LOCK_SH)) {
      close(descriptor_);
      refuse(fmt::format("another process is working in {}", directory.string()),
             "wait until it has ended, or name another directory");
    }
    if (is_still_named(descriptor_, path_)) return;
    close(descriptor_);
  }
}

DirectoryLock::~DirectoryLock() {
  // The last of several processes with a shared lock removes the file.
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) unlink(path_.c_str());
  close(descriptor_);
}

bool DirectoryLock::is_held(std::filesystem::path const& directory) {
  int const descriptor = open((directory / file_name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  // A process that ends removes the file of its lock.
  if (descriptor < 0) return errno != ENOENT;
  bool const is_held = flock(descriptor, LOCK_SH | LOCK_NB) != 0;
  close(descriptor);
  return is_held;
}

}  // namespace gridlock
