#define NOMINMAX
#define WIN32_LEAN_AND_MEAN
#include <io.h>
#include <windows.h>

#include <algorithm>
#include <cerrno>
#include <limits>

#include "io/posix.hpp"

namespace gridlock {

namespace {

constexpr long page_size = 4096;

DWORD creation_of(int flags) {
  if ((flags & O_CREAT) == 0) return OPEN_EXISTING;
  return (flags & O_EXCL) != 0 ? CREATE_NEW : OPEN_ALWAYS;
}

int error_number(DWORD code) {
  if (code == ERROR_FILE_NOT_FOUND || code == ERROR_PATH_NOT_FOUND) return ENOENT;
  return code == ERROR_FILE_EXISTS ? EEXIST : EACCES;
}

}  // namespace

int open(wchar_t const* path, int flags, int /*mode*/) {
  DWORD access = GENERIC_READ;
  if ((flags & O_WRONLY) != 0) access = GENERIC_WRITE;
  if ((flags & O_RDWR) != 0) access = GENERIC_READ | GENERIC_WRITE;
  HANDLE const handle = CreateFileW(path, access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr,
                                    creation_of(flags), FILE_ATTRIBUTE_NORMAL, nullptr);
  if (handle == INVALID_HANDLE_VALUE) {
    errno = error_number(GetLastError());
    return -1;
  }
  return _open_osfhandle(reinterpret_cast<std::intptr_t>(handle), O_NOINHERIT | O_BINARY);
}

long long pread(int descriptor, void* into, std::size_t size, long long offset) {
  if (_lseeki64(descriptor, offset, SEEK_SET) < 0) return -1;
  return _read(descriptor, into, static_cast<unsigned>(std::min<std::size_t>(size, std::numeric_limits<int>::max())));
}

long sysconf(int name) {
  if (name == _SC_PAGESIZE) return page_size;
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof(status);
  if (GlobalMemoryStatusEx(&status) == 0) return -1;
  return static_cast<long>(std::min<DWORDLONG>(status.ullAvailPhys / page_size, std::numeric_limits<long>::max()));
}

}  // namespace gridlock
