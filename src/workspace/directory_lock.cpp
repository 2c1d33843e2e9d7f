#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file_lock.hpp"

namespace gridlock {

namespace {

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
             "name another directory with -o");
    }
    if (flock(descriptor_, (sharing == Sharing::alone ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0) {
      close(descriptor_);
      refuse(fmt::format("another process is working in {}", directory.string()),
             "wait until it has ended, or name another directory with -o");
    }
    if (is_still_named(descriptor_, path_)) return;
    close(descriptor_);
  }
}

DirectoryLock::~DirectoryLock() {
  // The last one of those who share it tidies up.
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) unlink(path_.c_str());
  close(descriptor_);
}

}  // namespace gridlock
