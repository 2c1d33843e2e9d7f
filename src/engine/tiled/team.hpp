#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "engine/tiled/kept_order.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/grid/detail/update_order.hpp"

namespace gridlock::tiled {

/// The turns of some tiles of one colour, which touch no common cell, in an order for all of them: class by class, in a class level by
/// level, there tile after tile. Each tile has its own order in it, and groups for the registers are larger.
class Team {
 public:
  void clear() {
    tiles_ = 0;
    turns_ = 0;
  }

  /// Where the order of the next tile may be found.
  [[nodiscard]] UpdateOrder& room() { return room_[tiles_]; }
  /// Adds a tile with the order in room().
  void add_found() {
    turns_ += room().size();
    kept_[tiles_++] = nullptr;
  }
  /// Adds a tile with an order that stays as it is until the turns are taken.
  void add(KeptOrder const& order) {
    turns_ += order.size();
    kept_[tiles_++] = &order;
  }

  [[nodiscard]] std::size_t turns() const { return turns_; }

  /// Calls visit(rows, places) for every class and level; places[k] is the number of the tile of rows[k] in the team.
  template <class Visit>
  void for_each_group(Visit visit) {
    // The groups of a tile that is alone need not be copied.
    auto const visit_alone = [&](std::span<std::uint32_t const> group) {
      if (alone_.size() < group.size()) alone_.resize(group.size());
      visit(group, alone_.data());
    };
    if (tiles_ > 1) {
      visit_groups_of_all(visit);
    } else if (kept_[0] != nullptr) {
      kept_[0]->for_each_group(visit_alone);
    } else {
      room_[0].for_each_group(visit_alone);
    }
  }

 private:
  template <class Visit>
  void visit_groups_of_all(Visit visit) {
    for (std::size_t of_class = 0; of_class < UpdateOrder::classes; ++of_class) {
      for (std::size_t level = 0;; ++level) {
        std::size_t size = 0;
        for (std::size_t tile = 0; tile < tiles_; ++tile) {
          size +=
              copy(kept_[tile] != nullptr ? kept_[tile]->group(of_class, level) : room_[tile].group(of_class, level),
                   tile, size);
        }
        if (size == 0) break;
        visit(std::span<std::uint32_t const>(rows_).first(size), places_.data());
      }
    }
  }

  /// Copies a group of one tile behind those of others. How large it is is as good as random, so it goes in whole chunks.
  std::size_t copy(std::span<std::uint32_t const> group, std::size_t tile, std::size_t behind) {
    constexpr std::size_t chunk = UpdateOrder::beyond_group;
    if (rows_.size() < behind + group.size() + chunk) {
      rows_.resize(2 * (behind + group.size() + chunk));
      places_.resize(rows_.size());
    }
    std::size_t k = 0;
    do {
      std::memcpy(&rows_[behind + k], group.data() + k, chunk * sizeof(std::uint32_t));
      std::memset(&places_[behind + k], static_cast<int>(tile), chunk);
      k += chunk;
    } while (k < group.size());
    return group.size();
  }

  std::size_t tiles_ = 0;
  std::size_t turns_ = 0;
  std::array<UpdateOrder, Tiling::tiles_of_team> room_;
  std::array<KeptOrder const*, Tiling::tiles_of_team> kept_{};  ///< nullptr where the order is in room_
  std::vector<std::uint32_t> rows_;
  std::vector<std::uint8_t> places_;
  std::vector<std::uint8_t> alone_;  ///< places of a tile that is alone: zeros
};

}  // namespace gridlock::tiled
