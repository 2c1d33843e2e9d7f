#pragma once

#include <Random123/philox.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "device/backend.hpp"
#include "device/neighbour_kernels.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/model/detail/checks.hpp"
#include "gridlock/model/detail/motion.hpp"

/// \file
/// A turn of a synchronous model on the device: Turn and Neighbour again, over columns in its memory. Births, deaths
/// and errors make the cores take the whole step once more.

namespace gridlock::device {

/// RandomStream on the device, as far as models there use it: the same numbers.
class RandomNumbers {
 public:
  constexpr RandomNumbers(std::uint64_t seed, std::uint64_t step, Id id, Purpose purpose)
      : seed_(seed), step_(step), id_(id), purpose_(static_cast<std::uint64_t>(purpose)) {}

  GRIDLOCK_ON_DEVICE std::uint64_t bits() {
    if (used_ == 4) {
      auto const drawn = r123::Philox4x64()({{block_++, step_, id_, purpose_}}, {{seed_, 0}});
      for (unsigned n = 0; n < 4; ++n) numbers_[n] = drawn[n];
      used_ = 0;
    }
    return numbers_[used_++];
  }
  GRIDLOCK_ON_DEVICE double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

 private:
  std::uint64_t seed_, step_, id_, purpose_;
  std::uint64_t block_ = 0;
  std::uint64_t numbers_[4]{};
  unsigned used_ = 4;
};

/// Pointers to the columns of a population in the memory of the device.
template <class Agents>
struct Columns;
template <class... Column>
struct Columns<Population<Column...>> {
  std::tuple<typename Column::type*...> values;

  template <class Wanted>
  [[nodiscard]] constexpr typename Wanted::type& at(std::size_t agent) const {
    return std::get<Population<Column...>::template place_of<Wanted>>(values)[agent];
  }
  /// Gives an agent the values that it has in other columns.
  constexpr void copy(Columns const& from, std::size_t agent) const {
    ((at<Column>(agent) = from.at<Column>(agent)), ...);
  }
};

/// The events of a step, and whether the cores must take it once more.
template <class Model>
struct StepResult {
  std::array<std::uint64_t, event_names<Model>().size()> events;
  std::uint32_t left_to_cores;
};

template <class Model>
struct ModelMemory {
  Model model;
  PointsMemory points;
  std::size_t population;
  std::uint64_t seed;
  std::uint64_t step;
  double cutoff;
  double time_step;
  Id const* ids;
  Columns<typename Model::Agents> present;
  Columns<typename Model::Agents> next;
  StepResult<Model>* result;
};

/// As Neighbour.
template <class Model>
struct NeighbourOnDevice {
  ModelMemory<Model> const& memory;
  std::size_t agent;
  Vector seen_from;

  [[nodiscard]] constexpr Id id() const { return memory.ids[agent]; }
  template <class Column>
  [[nodiscard]] constexpr typename Column::type get() const {
    return memory.present.template at<Column>(agent);
  }
  [[nodiscard]] constexpr Vector position() const { return {get<X>(), get<Y>()}; }
  [[nodiscard]] constexpr Vector separation() const {
    return memory.points.box.displacement_inside(seen_from, position());
  }
};

/// As Turn, of the agent in a row of the sorted points.
template <class Model>
class TurnOnDevice {
 public:
  constexpr TurnOnDevice(ModelMemory<Model> const& memory, std::size_t row)
      : memory_(memory), row_(row), agent_(memory.points.index[row]) {
    memory_.next.copy(memory_.present, agent_);
  }

  [[nodiscard]] constexpr Id id() const { return memory_.ids[agent_]; }
  [[nodiscard]] constexpr Box const& box() const { return memory_.points.box; }
  [[nodiscard]] constexpr double cutoff() const { return memory_.cutoff; }
  [[nodiscard]] constexpr double time_step() const { return memory_.time_step; }
  [[nodiscard]] constexpr std::size_t population() const { return memory_.population; }
  [[nodiscard]] constexpr Vector position() const { return {get<X>(), get<Y>()}; }
  template <class Column>
  [[nodiscard]] constexpr typename Column::type get() const {
    return memory_.present.template at<Column>(agent_);
  }
  template <class Column>
  constexpr void set(typename Column::type value) {
    memory_.next.template at<Column>(agent_) = value;
  }
  [[nodiscard]] GRIDLOCK_ON_DEVICE RandomNumbers random(std::uint64_t purpose = 0) const {
    return {memory_.seed, memory_.step, id(), purpose_of_turn(purpose)};
  }

  GRIDLOCK_ON_DEVICE Bounce move_by(Vector displacement) {
    if (!is_shorter_than_box(box(), displacement)) {
      leave_to_cores();
      return {};
    }
    Motion const to = motion(box(), position(), displacement);
    set<X>(to.end.x);
    set<Y>(to.end.y);
    return to.bounce;
  }

  template <class Visit>
  GRIDLOCK_ON_DEVICE void for_each_neighbour(double cutoff, Visit visit) const {
    if (!(cutoff >= 0.0 && cutoff <= memory_.cutoff)) {
      leave_to_cores();
      return;
    }
    Vector const p = position();
    for_each_partner<Partners::all>(memory_.points, cutoff * cutoff, row_, [&](std::size_t other) {
      visit(NeighbourOnDevice<Model>{memory_, memory_.points.index[other], p});
    });
  }

  GRIDLOCK_ON_DEVICE void count(std::size_t event) const { add(memory_.result->events[event], 1); }
  template <class... Values>
  GRIDLOCK_ON_DEVICE void give_birth(Values... /*values*/) const {
    leave_to_cores();
  }
  GRIDLOCK_ON_DEVICE void die() const { leave_to_cores(); }

 private:
  GRIDLOCK_ON_DEVICE void leave_to_cores() const { store(memory_.result->left_to_cores, 1); }

  ModelMemory<Model> const& memory_;
  std::size_t row_;
  std::size_t agent_;
};

template <class Model>
struct TakeTurns {
  ModelMemory<Model> memory;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t row) const {
    TurnOnDevice<Model> turn(memory, row);
    memory.model.turn(turn);
  }
};

}  // namespace gridlock::device
