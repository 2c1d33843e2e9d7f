#include "drawing/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <thread>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

using Instant = std::chrono::steady_clock::time_point;

constexpr std::size_t max_errors = std::size_t{64} * 1024;

/// Throws RunFailure if a POSIX error number is not 0.
void require(int error_number, std::string const& program) {
  if (error_number == 0) return;
  throw RunFailure(fmt::format("{} could not be started: {}", program, std::generic_category().message(error_number)));
}

struct Ends {
  Descriptor ours;
  Descriptor theirs;
};

/// Returns a socket for the input of a program, since writing to a closed socket can avoid the signal SIGPIPE.
Ends input_of(std::string const& program) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) require(errno, program);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

Ends pipe_of(std::string const& program) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) require(errno, program);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// The data by which a child process becomes the program.
struct ProgramStart {
  char const* directory;
  int input;  ///< negative: no input
  int errors;
  char* const* words;
  pid_t parent;
};

bool move_to(int descriptor, int place) {
  return descriptor == place ? fcntl(place, F_SETFD, 0) == 0 : dup2(descriptor, place) == place;
}

bool open_nothing(int flags, int place) {
  int const nothing = open("/dev/null", flags | O_CLOEXEC);
  return nothing >= 0 && move_to(nothing, place);
}

/// Resets signals that this process ignores or blocks, such as Ctrl-C, since the child would inherit that.
void reset_signals() {
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (int number = 1; number < NSIG; ++number) sigaction(number, &usual, nullptr);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Runs in the child between fork and exec; returns only if exec fails. Other threads may have held locks at the fork,
/// also that of malloc, so no function is called that takes a lock.
void become_program(ProgramStart const& start) {
  // The program must end with a killed parent; otherwise it would complete its file from half of the input.
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return;
  if (getppid() != start.parent) _exit(1);  // the parent was killed before prctl()
  bool const is_ready = setpgid(0, 0) == 0 && chdir(start.directory) == 0 &&
                        (start.input < 0 ? open_nothing(O_RDONLY, STDIN_FILENO) : move_to(start.input, STDIN_FILENO)) &&
                        open_nothing(O_WRONLY, STDOUT_FILENO) && move_to(start.errors, STDERR_FILENO);
  if (!is_ready) return;
  reset_signals();
  execvp(start.words[0], start.words);
}

/// Starts the program; returns 0 or the error number.
int begin(ProgramStart const& start, pid_t& child, std::string const& program) {
  // exec closes the child's end of this pipe, so reading nothing means that exec succeeded.
  Ends failures = pipe_of(program);
  child = fork();
  if (child < 0) return errno;
  if (child == 0) {
    become_program(start);
    int const failure = errno;
    _exit(write(failures.theirs.number(), &failure, sizeof failure) == sizeof failure ? 1 : 2);
  }
  failures.theirs.close();
  int failure = 0;
  ssize_t length = 0;
  while ((length = read(failures.ours.number(), &failure, sizeof failure)) < 0 && errno == EINTR) {
  }
  if (length != sizeof failure) return 0;
  while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  return failure;
}

/// Returns the milliseconds for poll() to wait, at most 1000 so that the deadline is checked again; 0 at the deadline.
int milliseconds_until(Instant deadline) {
  auto const left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
  return static_cast<int>(std::clamp<decltype(left)>(left, 0, 1000));
}

/// Waits for the end of the child; returns false if the deadline passes first.
bool wait_for(pid_t child, Instant deadline, bool& succeeded) {
  while (true) {
    int status = 0;
    pid_t const ended = waitpid(child, &status, WNOHANG);
    if (ended == child) {
      succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
      return true;
    }
    if (ended < 0 && errno != EINTR) return true;  // other code collected the status, so success is unknown
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> const& arguments, std::filesystem::path const& directory,
                           ProcessInput input) {
  std::string const& program = arguments.front();
  // A missing directory is reported here, since exec gives the same error for it as for a missing program.
  if (!std::filesystem::is_directory(directory)) {
    throw RunFailure(fmt::format("{} could not be started: there is no directory {}", program, directory.string()));
  }
  Ends in;
  if (input == ProcessInput::pipe) in = input_of(program);
  Ends errors = pipe_of(program);
  std::vector<char*> words;
  for (std::string const& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);

  ProgramStart const start{.directory = directory.c_str(),
                           .input = in.theirs.number(),
                           .errors = errors.theirs.number(),
                           .words = words.data(),
                           .parent = getpid()};
  int const failure = begin(start, id_, program);
  // exec reports EACCES for a missing program if PATH has an unreadable directory.
  result_.was_found = failure != ENOENT && failure != EACCES;
  if (failure != 0) id_ = -1;
  if (result_.was_found) require(failure, program);
  input_ = std::move(in.ours);
  errors_ = std::move(errors.ours);
}

ChildProcess::~ChildProcess() { kill_group(); }

void ChildProcess::kill_group() {
  if (id_ < 0) return;
  kill(-id_, SIGKILL);
  int status = 0;
  while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
}

/// Reads available bytes of standard error, and closes it at its end.
void ChildProcess::read_errors() {
  std::array<char, 4096> buffer;
  ssize_t const length = read(errors_.number(), buffer.data(), buffer.size());
  if (length == 0 || (length < 0 && errno != EINTR && errno != EAGAIN)) errors_.close();
  if (length > 0 && result_.errors.size() < max_errors) {
    result_.errors.append(buffer.data(), static_cast<std::size_t>(length));
  }
}

bool ChildProcess::write(std::string_view bytes, std::chrono::milliseconds time_limit) {
  Instant const deadline = std::chrono::steady_clock::now() + time_limit;
  while (!bytes.empty() && id_ >= 0) {
    ssize_t const sent = send(input_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) bytes.remove_prefix(static_cast<std::size_t>(sent));
    if (sent >= 0 || errno == EINTR) continue;
    if (errno != EAGAIN || std::chrono::steady_clock::now() >= deadline) return false;
    // The program may wait until its standard error is read.
    std::array<pollfd, 2> waiting{pollfd{.fd = input_.number(), .events = POLLOUT, .revents = 0},
                                  pollfd{.fd = errors_.number(), .events = POLLIN, .revents = 0}};
    poll(waiting.data(), waiting.size(), milliseconds_until(deadline));
    if (waiting[1].revents != 0) read_errors();
  }
  return bytes.empty();
}

ProcessResult ChildProcess::wait(std::chrono::milliseconds time_limit) {
  Instant const deadline = std::chrono::steady_clock::now() + time_limit;
  input_.close();
  while (id_ >= 0 && errors_.is_open() && std::chrono::steady_clock::now() < deadline) {
    pollfd waiting{.fd = errors_.number(), .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, milliseconds_until(deadline)) > 0) read_errors();
  }
  if (id_ >= 0 && !errors_.is_open() && wait_for(id_, deadline, result_.succeeded)) id_ = -1;
  result_.timed_out = id_ >= 0;
  kill_group();
  return result_;
}

ProcessResult run_process(std::vector<std::string> const& arguments, std::filesystem::path const& directory,
                          std::chrono::milliseconds time_limit) {
  return ChildProcess(arguments, directory, ProcessInput::nothing).wait(time_limit);
}

}  // namespace gridlock
