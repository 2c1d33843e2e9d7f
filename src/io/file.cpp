#include "io/file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/descriptor.hpp"
#include "io/posix.hpp"
#include "io/text.hpp"

namespace gridlock {

namespace {

constexpr std::size_t buffer_size = std::size_t{256} * 1024;
constexpr std::size_t max_bytes_at_once = std::size_t{1} << 30;  ///< no system takes more than 2 GB in one call

std::string reason(int error_number) { return std::generic_category().message(error_number); }

/// Returns the target of a chain of symbolic links; the path itself if it is no link, or if the link is broken.
std::filesystem::path follow_links(std::filesystem::path const& path) {
  std::error_code ignored;
  if (!std::filesystem::is_symlink(path, ignored)) return path;
  std::filesystem::path followed = std::filesystem::canonical(path, ignored);
  return followed.empty() ? path : followed;
}

bool is_written_directly(std::filesystem::path const& path) {
  std::error_code ignored;
  auto const type = std::filesystem::status(path, ignored).type();
  using enum std::filesystem::file_type;
  return type == character || type == block || type == fifo || type == socket;
}

/// Creates and locks a temporary file beside `target`. Its name contains the target's, for users to recognize.
int open_temporary(std::filesystem::path const& target, std::filesystem::path& temporary) {
  for (int attempt = 0;; ++attempt) {
    temporary = target.parent_path() / fmt::format(".{}.{}-{}.part", target.filename().string(), getpid(), attempt);
    int const descriptor = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && (errno != EEXIST || attempt > 1000)) return descriptor;
    if (descriptor < 0) continue;
    // Some file systems have no locks; temporary files left there by killed processes are not removed.
    while (flock(descriptor, LOCK_EX) != 0 && errno == EINTR) {
    }
    // Between open() and flock() another process may have removed the file as a leftover.
    if (is_still_named(descriptor, temporary)) return descriptor;
    close(descriptor);
  }
}

/// Returns whether open_temporary() gives names of this form.
bool is_name_of_temporary(std::string_view name) {
  constexpr std::string_view end = ".part";
  if (!name.starts_with('.') || !name.ends_with(end)) return false;
  name.remove_suffix(end.size());
  std::string_view const numbers = name.substr(name.rfind('.') + 1);
  std::size_t const dash = numbers.find('-');
  auto const is_number = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  return numbers.size() + 2 < name.size() && dash != std::string_view::npos && is_number(numbers.substr(0, dash)) &&
         is_number(numbers.substr(dash + 1));
}

/// Syncs a directory, so that a rename in it survives a power cut. Errors are ignored, as some file systems cannot do
/// this; the file is complete under its old or new name anyway.
void bring_names_to_disk(std::filesystem::path const& directory) {
  std::filesystem::path const place = directory.empty() ? "." : directory;
  Descriptor const opened(open(place.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.is_open()) fsync(opened.number());
}

/// Removes a temporary file unless a living process has locked it.
void remove_if_abandoned(std::filesystem::path const& path) {
  Descriptor const file(open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  bool const is_file = file.is_open() && fstat(file.number(), &status) == 0 && S_ISREG(status.st_mode);
  if (!is_file || flock(file.number(), LOCK_EX | LOCK_NB) != 0) return;
  if (is_still_named(file.number(), path)) unlink(path.c_str());
}

[[noreturn]] void refuse_reading(std::filesystem::path const& path, std::string const& why, std::string hint) {
  throw Error(Problem{
      .what = fmt::format("cannot read {}: {}", path.string(), why), .hint = std::move(hint), .file = path.string()});
}

[[noreturn]] void refuse_too_large(std::filesystem::path const& path, std::uint64_t largest) {
  refuse_reading(path, fmt::format("it is larger than {} bytes", largest), "is it the right file?");
}

/// Returns whether reading would never end, as for /dev/zero or a whole disk. /dev/null counts as an empty file.
bool has_no_end(struct stat const& status) {
  struct stat null_device {};
  bool const is_null_device = stat("/dev/null", &null_device) == 0 && status.st_rdev == null_device.st_rdev;
  return S_ISBLK(status.st_mode) || (S_ISCHR(status.st_mode) && !is_null_device);
}

}  // namespace

std::optional<int> descriptor_named(std::filesystem::path const& path) {
  constexpr int max_links = 8;
  std::string const own_process = fmt::format("/proc/{}/fd", getpid());
  std::filesystem::path place = path.lexically_normal();
  for (int link = 0; link < max_links; ++link) {
    std::filesystem::path const parent = place.parent_path();
    if (parent == "/dev/fd" || parent == "/proc/self/fd" || parent == own_process) {
      return parse_number<int>(place.filename().string());
    }
    std::error_code error;
    std::filesystem::path const next = std::filesystem::read_symlink(place, error);
    if (error) return std::nullopt;
    place = (parent / next).lexically_normal();
  }
  return std::nullopt;
}

AtomicFile::AtomicFile(std::filesystem::path path, AtName at_name)
    : path_(std::move(path)), target_(at_name == AtName::replaced ? path_ : follow_links(path_)) {
  if (auto const named = at_name == AtName::written_through ? descriptor_named(path_) : std::nullopt) {
    // A duplicate of the descriptor continues after earlier output; opening the path would write from the beginning.
    descriptor_ = fcntl(*named, F_DUPFD_CLOEXEC, 0);
  } else if (at_name == AtName::written_through && is_written_directly(target_)) {
    descriptor_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    std::error_code ignored;
    if (std::filesystem::is_directory(std::filesystem::symlink_status(target_, ignored))) fail(EISDIR);
    descriptor_ = open_temporary(target_, temporary_);
  }
  if (descriptor_ < 0) {
    int const error_number = errno;
    temporary_.clear();
    fail(error_number);
  }
  buffer_.reserve(buffer_size);
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::append(std::string_view text) {
  if (buffer_.size() + text.size() > buffer_size) {
    write_out(buffer_);
    buffer_.clear();
    if (text.size() > buffer_size) return write_out(text);
  }
  buffer_ += text;
}

void AtomicFile::commit(std::filesystem::path const& previous) {
  write_out(buffer_);
  buffer_.clear();
  if (temporary_.empty()) {
    if (close(std::exchange(descriptor_, -1)) != 0) fail(errno);
    return;
  }
  if (fsync(descriptor_) != 0) fail(errno);
  // The file is closed after the rename, since closing releases the lock that keeps other processes from removing it.
  std::error_code error;
  if (!previous.empty()) std::filesystem::rename(target_, previous, error);
  if (error && error != std::errc::no_such_file_or_directory) fail(error.value());
  std::filesystem::rename(temporary_, target_, error);
  if (error) fail(error.value());
  temporary_.clear();
  close(std::exchange(descriptor_, -1));
  bring_names_to_disk(target_.parent_path());
}

void AtomicFile::write_out(std::string_view text) {
  while (!text.empty()) {
    ssize_t const written =
        write(descriptor_, text.data(), static_cast<unsigned>(std::min(text.size(), max_bytes_at_once)));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::discard() noexcept {
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  if (!temporary_.empty()) unlink(temporary_.c_str());
  temporary_.clear();
}

void AtomicFile::fail(int error_number) {
  discard();
  throw RunFailure(fmt::format("cannot write {}: {}", path_.string(), reason(error_number)));
}

void write_file(std::filesystem::path const& path, std::string_view content) {
  AtomicFile file(path);
  file.append(content);
  file.commit();
}

void remove_leftovers(std::filesystem::path const& directory) {
  std::error_code error;
  std::filesystem::directory_iterator entry(directory, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (is_name_of_temporary(entry->path().filename().string())) remove_if_abandoned(entry->path());
  }
}

void require_regular_file(std::filesystem::path const& path) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) return;
  refuse_reading(path, "it is not a regular file", "remove it");
}

std::uint64_t size_of_file(std::filesystem::path const& path, std::uint64_t largest) {
  std::error_code error;
  std::uint64_t const size = std::filesystem::file_size(path, error);
  if (error) refuse_reading(path, error.message(), "");
  if (size > largest) refuse_too_large(path, largest);
  return size;
}

void read_piece(std::filesystem::path const& path, std::uint64_t offset, std::span<char> into) {
  Descriptor const file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) refuse_reading(path, reason(errno), "");
  while (!into.empty()) {
    ssize_t const got = pread(file.number(), into.data(), into.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse_reading(path, reason(errno), "");
    if (got == 0) refuse_reading(path, "it has become shorter", "is another program writing to it?");
    into = into.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

FileReader::FileReader(std::filesystem::path path)
    : path_(std::move(path)), file_(open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (!file_.is_open()) {
    refuse_reading(path_, reason(errno), errno == ENOENT ? "check the name and the directory it is looked for in" : "");
  }
  struct stat status {};
  if (fstat(file_.number(), &status) != 0) refuse_reading(path_, reason(errno), "");
  if (S_ISDIR(status.st_mode)) refuse_reading(path_, "it is a directory", "name a file inside it");
  if (has_no_end(status) && isatty(file_.number()) == 0) {
    refuse_reading(path_, "it is a device, and has no end", "name a file");
  }
  is_regular_ = S_ISREG(status.st_mode);
  size_ = static_cast<std::uint64_t>(status.st_size);
}

std::size_t FileReader::read(std::span<char> into) {
  while (true) {
    ssize_t const got =
        ::read(file_.number(), into.data(), static_cast<unsigned>(std::min(into.size(), max_bytes_at_once)));
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR) refuse_reading(path_, reason(errno), "");
  }
}

std::string read_file(std::filesystem::path const& path, std::uint64_t largest) {
  FileReader file(path);
  if (file.size() > largest) refuse_too_large(path, largest);
  // The size is only a first guess, since a pipe has none and a file may grow while it is read.
  std::string content(static_cast<std::size_t>(file.size()) + 1, '\0');
  std::size_t filled = 0;
  while (true) {
    if (filled == content.size()) content.resize(2 * content.size() + 4096);
    std::size_t const got = file.read(std::span(content).subspan(filled));
    if (got == 0) break;
    filled += got;
    if (filled > largest) refuse_too_large(path, largest);
  }
  content.resize(filled);
  return content;
}

void make_output_directory(std::filesystem::path const& path) {
  auto const refuse = [&](std::string const& why) {
    throw Error(Problem{.what = fmt::format("cannot write into the directory {}: {}", path.string(), why),
                        .hint = "name another directory",
                        .key = "-o"});
  };
  if (path.empty()) refuse("its name is empty");
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) refuse(error.message());
  // A probe file is created, since permission bits do not show read-only file systems, quotas or the rights of root.
  std::filesystem::path probe;
  int const descriptor = open_temporary(path / "probe", probe);
  if (descriptor < 0) refuse(reason(errno));
  unlink(probe.c_str());
  close(descriptor);
  remove_leftovers(path);
}

}  // namespace gridlock
