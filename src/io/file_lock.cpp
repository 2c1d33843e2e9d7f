#include "io/file_lock.hpp"

#include <sys/stat.h>

namespace gridlock {

bool is_still_named(int descriptor, std::filesystem::path const& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

}  // namespace gridlock
