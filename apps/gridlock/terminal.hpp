#pragma once

#include <chrono>
#include <string>

#include "gridlock/core/box.hpp"

namespace gridlock::cli {

/// Handles requests to stop. Ctrl-C, SIGTERM and SIGUSR1 are recorded, and the work checks for them after each chunk. A
/// second signal at least half a second later ends the program at once.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(StopSignals const&) = delete;
  StopSignals& operator=(StopSignals const&) = delete;

  /// Keeps requests to stop until the first StopSignals exists, which then receives them.
  static void keep_until_begun();

  [[nodiscard]] static bool is_stop_asked();
  /// Requests a stop, as a signal does.
  static void ask_to_stop();
};

/// Shows progress on standard error. A terminal gets a line that is redrawn a few times a second; a file or pipe gets a
/// new line after a second, and then for every ten percent or half a minute.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(ProgressLine const&) = delete;
  ProgressLine& operator=(ProgressLine const&) = delete;

  /// Shows the fraction in percent, then `what`, such as the rate, then the remaining time.
  void show(double fraction, double seconds, std::string const& what);
  /// Shows the fraction in percent and `what`, without the remaining time.
  void show(double fraction, std::string const& what);

 private:
  using Clock = std::chrono::steady_clock;

  bool is_terminal_;
  bool is_line_open_ = false;
  bool is_first_ = true;  ///< whether no line has been shown yet
  double last_fraction_ = 0.0;
  Clock::time_point last_time_;
};

/// Returns a box as text: "periodic box 1 × 1, tilt 0.3"; and the tilt of a file that leans farther.
std::string text_of(Box const& box, double given_tilt = 0.0);

/// Returns a duration as text: 93 s → "1 min 33 s".
std::string duration_text(double seconds);

/// Returns a count with a prefix: 12'345'678.0 → "12.3 M".
std::string count_text(double count);

}  // namespace gridlock::cli
