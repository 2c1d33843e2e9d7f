#pragma once

#include <cstdint>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// The samples at which expensive observables of structure are measured: the first, the first that counts for averages
/// (so that the shortest run has one that counts), and then every `every`-th; none for every = 0.
class StructureSchedule {
 public:
  explicit StructureSchedule(std::uint64_t every) : every_(every) {}

  /// Returns whether to measure the present sample. Contract: it is called once for each sample.
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

  /// Begins anew.
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
