#pragma once

#include <cstdint>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// When the expensive observables of structure measure: at the first sample, at the first that counts for averages, and
/// then at every `every`-th, so that the shortest run has one measurement that counts. Never for every = 0.
class StructureSchedule {
 public:
  explicit StructureSchedule(std::uint64_t every) : every_(every) {}

  /// Whether the sample taken now is one to measure; call once per sample.
  [[nodiscard]] bool is_due(bool counts_for_average) {
    if (every_ == 0) return false;
    bool const is_first_that_counts = counts_for_average && !has_counted_;
    has_counted_ = has_counted_ || counts_for_average;
    if (!is_first_that_counts && wait_ > 0) {
      --wait_;
      return false;
    }
    wait_ = every_ - 1;
    return true;
  }

  /// Starts over.
  void reset() { *this = StructureSchedule(every_); }

  void serialize(Archive& archive) {
    archive.visit("wait", wait_);
    archive.visit("has_counted", has_counted_);
  }

 private:
  std::uint64_t every_;
  std::uint64_t wait_ = 0;
  bool has_counted_ = false;
};

}  // namespace gridlock
