#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <optional>
#include <utility>

namespace gridlock::python {

namespace nb = nanobind;

/// Asks Python now and then whether somebody has pressed Ctrl-C, and tells it how far the work is.
class Listener {
 public:
  explicit Listener(nb::object on_progress)
      : on_progress_(std::move(on_progress)), is_shown_(!on_progress_.is_none()) {}

  /// Whether to go on. Called without the lock of the interpreter.
  bool operator()(std::uint64_t done, double fraction) {
    nb::gil_scoped_acquire const acquired;
    if (PyErr_CheckSignals() != 0) {
      // Takes the exception away from the interpreter: a last sample may still call functions of Python.
      interruption_.emplace();
      return false;
    }
    if (is_shown_) on_progress_(done, fraction);
    return true;
  }
  void raise() const {
    if (interruption_) throw nb::python_error(*interruption_);
  }

 private:
  nb::object on_progress_;
  bool is_shown_;
  std::optional<nb::python_error> interruption_;
};

}  // namespace gridlock::python
