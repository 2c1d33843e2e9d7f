#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/grid/detail/update_order.hpp"

namespace gridlock::tiled {

/// The order of the turns of a tile, kept for steps before which no disk came into one of its cells or left one. On a cache line
/// of its own, since threads write to it side by side.
class alignas(64) KeptOrder {
 public:
  /// To be told of every step before the order is looked at.
  void begin_step(bool has_changed) {
    if (has_changed) forget();
    quiet_steps_ = has_changed ? quiet_steps_ / 2 : std::min(quiet_steps_ + 1, most_quiet_steps);
  }

  [[nodiscard]] bool is_kept() const { return !begins_.empty(); }
  /// Whether the order of this step will probably be right in the next one. Fast disks change cells all the time, and an order
  /// takes four bytes a disk.
  [[nodiscard]] bool is_worth_keeping() const { return quiet_steps_ > 1; }

  void keep(UpdateOrder const& order) {
    forget();
    rows_.resize(order.size() + UpdateOrder::beyond_group);
    std::size_t count = 0;
    for (std::size_t of_class = 0; of_class < UpdateOrder::classes; ++of_class) {
      first_group_[of_class] = static_cast<std::uint32_t>(begins_.size());
      for (std::size_t level = 0;; ++level) {
        std::span<std::uint32_t const> const group = order.group(of_class, level);
        if (group.empty()) break;
        begins_.push_back(static_cast<std::uint32_t>(count));
        std::ranges::copy(group, rows_.begin() + static_cast<std::ptrdiff_t>(count));
        count += group.size();
      }
    }
    first_group_[UpdateOrder::classes] = static_cast<std::uint32_t>(begins_.size());
    begins_.push_back(static_cast<std::uint32_t>(count));
  }

  [[nodiscard]] std::size_t size() const { return begins_.empty() ? 0 : begins_.back(); }

  /// As that of UpdateOrder. How many levels a class has is as good as random: no branch depends on it.
  [[nodiscard]] std::span<std::uint32_t const> group(std::size_t of_class, std::size_t level) const {
    std::size_t const end = first_group_[of_class + 1];
    std::size_t const k = std::min(first_group_[of_class] + level, end);
    return std::span(rows_).subspan(begins_[k], begins_[std::min(k + 1, end)] - begins_[k]);
  }

  /// As that of UpdateOrder.
  template <class Visit>
  void for_each_group(Visit visit) const {
    for (std::size_t k = 0; k + 1 < begins_.size(); ++k) {
      visit(std::span(rows_).subspan(begins_[k], begins_[k + 1] - begins_[k]));
    }
  }

 private:
  void forget() { begins_.clear(); }

  static constexpr int most_quiet_steps = 8;

  std::vector<std::uint32_t> rows_;
  std::vector<std::uint32_t> begins_;  ///< of the groups among the rows, and the end of the last one
  std::array<std::uint32_t, UpdateOrder::classes + 1> first_group_{};
  int quiet_steps_ = 0;
};

}  // namespace gridlock::tiled
