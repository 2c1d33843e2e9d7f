#pragma once

// Calls of POSIX for files and memory. On Windows functions of the same names do as much as its calls can: there are no
// locks of files, so that nobody takes a file for left over, and a directory is not brought to the disk.

#include <filesystem>

#ifndef _WIN32

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridlock {

/// Returns whether `path` still leads to this open file. Another process may have removed the file before its lock was
/// obtained.
inline bool is_still_named(int descriptor, std::filesystem::path const& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

}  // namespace gridlock

#else

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridlock {

constexpr int O_CLOEXEC = O_NOINHERIT;
// Flags that open() below takes and does nothing with.
constexpr int O_DIRECTORY = 1 << 27;
constexpr int O_NOFOLLOW = 1 << 28;
constexpr int O_NONBLOCK = 1 << 29;
constexpr int F_DUPFD_CLOEXEC = 0;
constexpr int LOCK_EX = 2;
constexpr int LOCK_NB = 4;
constexpr int RLIMIT_AS = 0;
constexpr int _SC_PHYS_PAGES = 0;
constexpr int _SC_PAGESIZE = 1;
constexpr unsigned long long RLIM_INFINITY = ~0ULL;
struct rlimit {
  unsigned long long rlim_cur;
};

/// Opens a file whose name may be changed or removed meanwhile, as in POSIX; its bytes stay as they are.
int open(wchar_t const* path, int flags, int mode = 0);
long long pread(int descriptor, void* into, std::size_t size, long long offset);
long sysconf(int name);
inline int fcntl(int descriptor, int /*command*/, int /*least*/) { return _dup(descriptor); }
inline int flock(int /*descriptor*/, int /*operation*/) { return -1; }
inline int fsync(int descriptor) { return _commit(descriptor); }
inline int getrlimit(int /*resource*/, rlimit* /*limit*/) { return -1; }
inline int unlink(wchar_t const* path) { return _wunlink(path); }
inline bool is_still_named(int /*descriptor*/, std::filesystem::path const& /*path*/) { return true; }

}  // namespace gridlock

#endif
