#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "engine/turn.hpp"
#include "gridlock/core/state.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

/// The disks as the threads want them: columns in the order of the turns.
class HotDisks {
 public:
  /// `order[k]` is the row of the state that comes to row k.
  HotDisks(State const& state, std::vector<std::uint32_t> order) : order_(std::move(order)) {
    Disks const& disks = state.disks;
    gather(disks.ids(), id_);
    id_.push_back(std::numeric_limits<Id>::max());
    gather(disks.column<X>(), x_);
    gather(disks.column<Y>(), y_);
    gather(disks.column<VelocityX>(), velocity_x_);
    gather(disks.column<VelocityY>(), velocity_y_);
    gather(disks.column<Radius>(), radius_);
    gather(disks.column<Mass>(), mass_);
    gather(disks.column<ImageX>(), image_x_);
    gather(disks.column<ImageY>(), image_y_);
  }

  /// The Ids of all rows and, behind them, of nobody.
  [[nodiscard]] std::vector<Id> const& ids() const { return id_; }
  [[nodiscard]] std::uint32_t nobody() const { return static_cast<std::uint32_t>(order_.size()); }
  [[nodiscard]] std::size_t row_in_state(std::size_t k) const { return order_[k]; }

  TurnView view(Box const& box, EngineSettings const& settings, double duration) {
    return {.box = box,
            .id = id_,
            .x = x_,
            .y = y_,
            .velocity_x = velocity_x_,
            .velocity_y = velocity_y_,
            .radius = radius_,
            .mass = mass_,
            .image_x = image_x_,
            .image_y = image_y_,
            .substep = duration / static_cast<double>(settings.substeps),
            .substeps = settings.substeps,
            .contact = settings.contact};
  }

  void write_back(State& state) const {
    Disks& disks = state.disks;
    scatter_into(x_, disks.column<X>());
    scatter_into(y_, disks.column<Y>());
    scatter_into(velocity_x_, disks.column<VelocityX>());
    scatter_into(velocity_y_, disks.column<VelocityY>());
    scatter_into(image_x_, disks.column<ImageX>());
    scatter_into(image_y_, disks.column<ImageY>());
  }

 private:
  template <class T>
  void gather(std::span<T const> from, std::vector<T>& to) const {
    to.resize(order_.size());
    for (std::size_t k = 0; k < order_.size(); ++k) to[k] = from[order_[k]];
  }
  template <class T>
  void scatter_into(std::vector<T> const& from, std::span<T> to) const {
    for (std::size_t k = 0; k < order_.size(); ++k) to[order_[k]] = from[k];
  }

  std::vector<std::uint32_t> order_;
  std::vector<Id> id_;
  std::vector<double> x_, y_, velocity_x_, velocity_y_, radius_, mass_;
  std::vector<std::int32_t> image_x_, image_y_;
};

}  // namespace gridlock
