#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <optional>
#include <utility>

namespace gridlock::python {

namespace nb = nanobind;

/// Checks for Ctrl-C in Python and reports progress to a function of Python.
class Listener {
 public:
  explicit Listener(nb::object on_progress)
      : on_progress_(std::move(on_progress)), is_shown_(!on_progress_.is_none()) {}

  /// Returns whether to continue. The caller must not hold the GIL.
  bool operator()(std::uint64_t done, double fraction) {
    nb::gil_scoped_acquire const acquired;
    if (PyErr_CheckSignals() != 0) {
      // The exception is stored, since Python functions of a last sample may be called before it is thrown.
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
