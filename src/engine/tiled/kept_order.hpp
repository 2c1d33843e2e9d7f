#pragma once

#include <algorithm>
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

  [[nodiscard]] bool is_kept() const { return !ends_.empty(); }
  /// Whether the order of this step will probably be right in the next one. Fast disks change cells all the time, and an order
  /// takes four bytes a disk.
  [[nodiscard]] bool is_worth_keeping() const { return quiet_steps_ > 1; }

  void keep(UpdateOrder const& order) {
    forget();
    rows_.reserve(order.size());
    order.for_each_group([this](std::span<std::uint32_t const> group) {
      rows_.insert(rows_.end(), group.begin(), group.end());
      ends_.push_back(static_cast<std::uint32_t>(rows_.size()));
    });
  }

  [[nodiscard]] std::size_t size() const { return rows_.size(); }

  /// As UpdateOrder does.
  template <class Visit>
  void for_each_group(Visit visit) const {
    std::size_t begin = 0;
    for (std::uint32_t const end : ends_) {
      visit(std::span(rows_).subspan(begin, end - begin));
      begin = end;
    }
  }

 private:
  void forget() {
    rows_.clear();
    ends_.clear();
  }

  static constexpr int most_quiet_steps = 8;

  std::vector<std::uint32_t> rows_;
  std::vector<std::uint32_t> ends_;  ///< of the groups, among the rows
  int quiet_steps_ = 0;
};

}  // namespace gridlock::tiled
