#include "terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>

#include "simulation/start_file.hpp"

namespace gridlock::cli {

namespace {

/// Signals that ask to stop; mpirun passes SIGUSR1 on to its ranks without ending them.
constexpr int asking_to_stop[] = {SIGINT, SIGTERM, SIGUSR1};

/// Time of the first request to stop, in milliseconds; 0 if there is none.
std::atomic<std::int64_t> time_of_first = 0;
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a handler of signals may not wait");

/// Signals within this time, in milliseconds, count as one, since schedulers and mpirun may both send one.
constexpr std::int64_t same_request = 500;

std::int64_t milliseconds_now() {
  struct timespec now = {};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

void remember(int signal) {
  std::int64_t const now = milliseconds_now();
  std::int64_t first = 0;
  if (time_of_first.compare_exchange_strong(first, now) || now - first < same_request) return;
  // A later signal ends the program at once, by the default handler.
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

void mask_stop_signals(int how) {
  sigset_t signals;
  sigemptyset(&signals);
  for (int const signal : asking_to_stop) sigaddset(&signals, signal);
  pthread_sigmask(how, &signals, nullptr);
}

}  // namespace

void StopSignals::keep_until_begun() { mask_stop_signals(SIG_BLOCK); }

StopSignals::StopSignals() {
  time_of_first = 0;
  for (int const signal : asking_to_stop) handle(signal, remember);
  mask_stop_signals(SIG_UNBLOCK);
}

StopSignals::~StopSignals() {
  for (int const signal : asking_to_stop) handle(signal, SIG_DFL);
}

bool StopSignals::is_stop_asked() { return time_of_first != 0; }

void StopSignals::ask_to_stop() {
  std::int64_t none = 0;
  time_of_first.compare_exchange_strong(none, milliseconds_now());
}

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) == 1), last_time_(Clock::now()) {}

ProgressLine::~ProgressLine() {
  if (is_line_open_) std::fputc('\n', stderr);
}

void ProgressLine::show(double fraction, double seconds, std::string const& what) {
  double const seconds_left = fraction > 0.0 ? seconds * (1.0 - fraction) / fraction : 0.0;
  show(fraction, fmt::format("{}  {} left", what, duration_text(seconds_left)));
}

void ProgressLine::show(double fraction, std::string const& what) {
  auto const now = Clock::now();
  double const waited = std::chrono::duration<double>(now - last_time_).count();
  bool const is_done = fraction >= 1.0;
  // At the end a line is redrawn only if one is open, since the summary follows.
  bool const is_due = is_terminal_
                          ? waited >= 0.2 || (is_done && is_line_open_)
                          : waited >= 30.0 || (waited >= 1.0 && (is_first_ || fraction - last_fraction_ >= 0.1));
  if (!is_due) return;
  is_first_ = false;
  last_time_ = now;
  last_fraction_ = fraction;
  std::string const text = fmt::format("{:5.1f} %  {}", 100.0 * fraction, what);
  if (is_terminal_) {
    fmt::print(stderr, "\r\033[K{}", text);
    is_line_open_ = true;
  } else {
    fmt::print(stderr, "{}\n", text);
  }
  std::fflush(stderr);
}

std::string text_of(Box const& box, double given_tilt) {
  std::string tilt = box.is_oblique() ? fmt::format(", tilt {:.6g}", box.tilt()) : "";
  if (flipped_tilt(given_tilt, box, "")) tilt += fmt::format(", folded from the tilt {:.6g} of the file", given_tilt);
  return fmt::format("{} box {} × {}{}", edges_in_words(box), box.width(), box.height(), tilt);
}

std::string duration_text(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  auto const whole = static_cast<long long>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string count_text(double count) {
  constexpr struct {
    double size;
    char const* letter;
  } prefixes[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}};
  for (auto const& [size, letter] : prefixes) {
    if (count >= size) return fmt::format("{:.3g} {}", count / size, letter);
  }
  return fmt::format("{:.3g} ", count);
}

}  // namespace gridlock::cli
