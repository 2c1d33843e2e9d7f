#include "io/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <thread>

#include "gridlock/core/error.hpp"

extern char** environ;  // NOLINT: POSIX gives it no header

namespace gridlock {

namespace {

using Instant = std::chrono::steady_clock::time_point;

constexpr std::size_t most_errors = std::size_t{64} * 1024;

/// Throws unless a POSIX call that returns its error number succeeded.
void require(int error_number, std::string const& program) {
  if (error_number == 0) return;
  throw RunFailure(fmt::format("{} could not be started: {}", program, std::generic_category().message(error_number)));
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor const&) = delete;
  Descriptor& operator=(Descriptor const&) = delete;
  ~Descriptor() { close(); }

  [[nodiscard]] int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

/// What the child does between being born and becoming the program.
class SpawnPlan {
 public:
  SpawnPlan(std::filesystem::path const& directory, int errors, std::string const& program) {
    require(posix_spawn_file_actions_init(&actions_), program);
    require(posix_spawnattr_init(&attributes_), program);
    require(posix_spawn_file_actions_addchdir_np(&actions_, directory.c_str()), program);
    require(posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0), program);
    require(posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0), program);
    require(posix_spawn_file_actions_adddup2(&actions_, errors, STDERR_FILENO), program);
    // Signals ignored or blocked here, as a program waiting for Ctrl-C may have them, are not for the child.
    sigset_t none;
    sigemptyset(&none);
    sigset_t all;
    sigfillset(&all);
    require(posix_spawnattr_setsigmask(&attributes_, &none), program);
    require(posix_spawnattr_setsigdefault(&attributes_, &all), program);
    require(posix_spawnattr_setpgroup(&attributes_, 0), program);
    require(
        posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF),
        program);
  }
  SpawnPlan(SpawnPlan const&) = delete;
  SpawnPlan& operator=(SpawnPlan const&) = delete;
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }

  [[nodiscard]] posix_spawn_file_actions_t const* actions() const { return &actions_; }
  [[nodiscard]] posix_spawnattr_t const* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

/// Reads until the other end is closed; false when the deadline passed first.
bool read_all(int descriptor, Instant deadline, std::string& text) {
  std::array<char, 4096> buffer;
  while (true) {
    auto const left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
    int const ready = poll(&waiting, 1, static_cast<int>(std::min<std::chrono::milliseconds::rep>(left.count(), 1000)));
    if (ready <= 0) continue;  // nothing yet, or a signal came between
    ssize_t const length = read(descriptor, buffer.data(), buffer.size());
    if (length == 0) return true;
    if (length < 0 && errno != EINTR && errno != EAGAIN) return true;
    if (length > 0 && text.size() < most_errors) text.append(buffer.data(), static_cast<std::size_t>(length));
  }
}

/// Waits for the end of the child; false when the deadline passed first.
bool wait_for(pid_t child, Instant deadline, bool& succeeded) {
  while (true) {
    int status = 0;
    pid_t const ended = waitpid(child, &status, WNOHANG);
    if (ended == child) {
      succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
      return true;
    }
    if (ended < 0 && errno != EINTR) return true;  // somebody else collected it: its status is lost, not good
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

ProcessResult run_process(std::vector<std::string> const& arguments, std::filesystem::path const& directory,
                          std::chrono::milliseconds time_limit) {
  Instant const deadline = std::chrono::steady_clock::now() + time_limit;
  std::string const& program = arguments.front();
  // Said here, since below a missing directory and a missing program are the same error.
  if (!std::filesystem::is_directory(directory)) {
    throw RunFailure(fmt::format("{} could not be started: there is no directory {}", program, directory.string()));
  }
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) require(errno, program);
  Descriptor const reading(ends[0]);
  Descriptor writing(ends[1]);
  std::vector<char*> words;
  for (std::string const& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);

  SpawnPlan const plan(directory, writing.number(), program);
  pid_t child = -1;
  int const failure = posix_spawnp(&child, words.front(), plan.actions(), plan.attributes(), words.data(), environ);
  ProcessResult result;
  // An unreadable directory in PATH makes a missing program look like a forbidden one.
  result.was_found = failure != ENOENT && failure != EACCES;
  if (!result.was_found) return result;
  require(failure, program);
  writing.close();
  bool const has_ended =
      read_all(reading.number(), deadline, result.errors) && wait_for(child, deadline, result.succeeded);
  if (!has_ended) {
    result.timed_out = true;
    kill(-child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  return result;
}

}  // namespace gridlock
