#pragma once

#include <chrono>
#include <string>

namespace gridlock::cli {

/// Stops work politely: Ctrl-C, SIGTERM and SIGUSR1 are remembered, and the work asks at every chunk. A signal
/// half a second later or more ends the program at once.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(StopSignals const&) = delete;
  StopSignals& operator=(StopSignals const&) = delete;

  /// Keeps requests to stop that come before there is one of these, for it.
  static void keep_until_begun();

  [[nodiscard]] static bool is_stop_asked();
  /// As a signal does.
  static void ask_to_stop();
};

/// Shows how far the work has come, on standard error: one line redrawn a few times a second on a terminal, a plain
/// line after a second, and then every ten percent or half minute, where the output goes to a file or pipe.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(ProgressLine const&) = delete;
  ProgressLine& operator=(ProgressLine const&) = delete;

  /// `what` is the part between the percentage and the time left, such as the rate.
  void show(double fraction, double seconds, std::string const& what);
  /// Without the time left.
  void show(double fraction, std::string const& what);

 private:
  using Clock = std::chrono::steady_clock;

  bool is_terminal_;
  bool is_line_open_ = false;
  bool is_first_ = true;  ///< nothing has been shown yet
  double last_fraction_ = 0.0;
  Clock::time_point last_time_;
};

/// 93 s → "1 min 33 s".
std::string duration_text(double seconds);

/// 12'345'678.0 → "12.3 M".
std::string count_text(double count);

}  // namespace gridlock::cli
