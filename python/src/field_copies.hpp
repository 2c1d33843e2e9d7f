#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/copy_if_finite.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/field.hpp"
#include "gridlock/model/detail/field_requests.hpp"

namespace gridlock::python {

/// Copies of the fields of a world from before a step, to restore those that a failed step has changed.
///
/// Only fields that a step is about to change are copied. One pass at its end checks their values and makes the copies
/// for the next step.
class FieldCopies {
 public:
  /// Forgets all copies, since the world may have changed.
  void forget(std::size_t fields) {
    now_.resize(fields);
    next_.resize(fields);
    is_up_to_date_.assign(fields, false);
    is_changed_.assign(fields, false);
  }
  /// Is called before a step changes field k.
  void keep(std::span<Field const> fields, std::size_t k) {
    is_changed_[k] = true;
    if (is_up_to_date_[k]) return;
    now_[k].assign(fields[k].values().begin(), fields[k].values().end());
    is_up_to_date_[k] = true;
  }
  /// Puts back the fields that this step has changed.
  void restore(std::span<Field> fields) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (is_changed_[k]) std::ranges::copy(now_[k], fields[k].values().begin());
      is_changed_[k] = false;
    }
  }
  /// Checks the fields that this step has changed. Errors: RunFailure for a value that is infinite or no number.
  void check(std::span<Field const> fields, std::uint64_t step) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (!is_changed_[k]) continue;
      next_[k].resize(fields[k].size());
      if (!copy_if_finite(fields[k].values(), next_[k])) require_finite(fields[k], step);
    }
  }
  /// Is called when the step that was checked holds.
  void accept() {
    for (std::size_t k = 0; k < is_changed_.size(); ++k) {
      if (is_changed_[k]) std::swap(now_[k], next_[k]);
      is_changed_[k] = false;
    }
  }

 private:
  std::vector<UninitializedArray<double>> now_;
  std::vector<UninitializedArray<double>> next_;
  std::vector<bool> is_up_to_date_;
  std::vector<bool> is_changed_;
};

}  // namespace gridlock::python
