// A world of events against a plain map: births, deaths and moves one at a time and many at once, and who is nearest.

#include "gridlock/model/mutable_world.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "gridlock/core/disks.hpp"

namespace gridlock {
namespace {

struct Marked {
  [[maybe_unused]] static constexpr Schedule schedule = Schedule::events;
  using Agents = Population<Mass, Y, X>;  // in an order of its own
};

struct Agent {
  double mass;
  Vector place;
};

class Town {
 public:
  Town(Box const& box, double cutoff) : grid_(layout_for_cutoff(box, cutoff, 20)), cutoff_(cutoff) { world_.box = box; }

  void add(double mass, Vector p) { alive_[open_.add(mass, p.y, p.x)] = {mass, p}; }
  void remove(std::size_t number) {
    Id const id = id_of(number);
    open_.remove(id);
    alive_.erase(id);
  }
  /// By row, as a model of events draws whom something happens to.
  void remove_row(std::size_t number) {
    Id const id = open_.agent_in_row(number % open_.size());
    open_.remove(id);
    RC_ASSERT(alive_.erase(id) == 1U);
  }
  void move(std::size_t number, Vector p) {
    Id const id = id_of(number);
    open_.move_to(id, p);
    alive_[id].place = p;
  }
  void remove_every(std::size_t nth) {
    std::vector<Id> dying;
    for (std::size_t row = 0; row < open_.size(); row += nth) dying.push_back(open_.agent_in_row(row));
    open_.remove_all(dying);
    for (Id const id : dying) alive_.erase(id);
  }
  void add_all(std::vector<Agent> const& newborn) {
    std::set<Id> before;
    for (auto const& [id, agent] : alive_) before.insert(id);
    std::vector<Marked::Agents::Values> values;
    for (Agent const& agent : newborn) values.emplace_back(agent.mass, agent.place.y, agent.place.x);
    open_.add_all(values);
    std::size_t const first = open_.size() - newborn.size();
    for (std::size_t k = 0; k < newborn.size(); ++k) {
      Id const id = open_.agent_in_row(first + k);
      RC_ASSERT(!before.contains(id));
      alive_[id] = newborn[k];
    }
  }

  [[nodiscard]] std::size_t size() const { return alive_.size(); }

  void check(Vector p) const {
    RC_ASSERT(open_.size() == alive_.size());
    RC_ASSERT(grid_.size() == alive_.size());
    RC_ASSERT(grid_.is_consistent());
    std::optional<Id> nearest;
    for (auto const& [id, agent] : alive_) {
      RC_ASSERT(open_.contains(id));
      RC_ASSERT(open_.position(id) == agent.place);
      RC_ASSERT(open_.get<Mass>(id) == agent.mass);
      double const distance = squared_length(world_.box.displacement(p, agent.place));
      if (!(distance < cutoff_ * cutoff_)) continue;
      if (!nearest || distance < squared_length(world_.box.displacement(p, alive_.at(*nearest).place))) nearest = id;
    }
    RC_ASSERT(open_.nearest(p, cutoff_) == nearest);
  }

 private:
  [[nodiscard]] Id id_of(std::size_t number) const {
    return std::next(alive_.begin(), static_cast<std::ptrdiff_t>(number % alive_.size()))->first;
  }

  World<Marked> world_;
  PackedGrid grid_;
  double cutoff_;
  MutableWorld<Marked> open_{world_, grid_, cutoff_, true};
  std::map<Id, Agent> alive_;
};

RC_GTEST_PROP(MutableWorldProperty, BehavesLikeAMapUnderAnySequenceOfBirthsDeathsAndMoves, ()) {
  Box const box(1.0, 1.5, *rc::gen::element(Edge::wall, Edge::periodic));
  // Few cells, so that many agents share one, or many, so that most are empty.
  Town town(box, *rc::gen::element(0.05, 0.2, 0.49));
  RandomStream random(*rc::gen::arbitrary<std::uint64_t>(), 0, 0, Purpose::start_position);
  auto const anywhere = [&]() -> Vector {
    // Half of them in a small corner, some at the very same point.
    double const part = random.below(2) == 0 ? 0.1 * static_cast<double>(random.below(3)) / 3.0 : random.uniform();
    double const x = part * box.width();
    return {x, random.below(3) == 0 ? 0.0 : random.uniform() * box.height()};
  };
  for (int n = *rc::gen::inRange(0, 120); n > 0; --n) {
    std::uint64_t const operation = random.below(9);
    if (operation < 4 || town.size() == 0) {
      town.add(random.uniform(), anywhere());
    } else if (operation == 4) {
      town.remove(random.below(1000));
    } else if (operation == 5) {
      town.remove_row(random.below(1000));
    } else if (operation == 6) {
      town.move(random.below(1000), anywhere());
    } else if (operation == 7) {
      town.remove_every(1 + random.below(6));
    } else {
      std::vector<Agent> newborn(random.below(40));
      for (Agent& agent : newborn) agent = {random.uniform(), anywhere()};
      town.add_all(newborn);
    }
    town.check(anywhere());
  }
}

}  // namespace
}  // namespace gridlock
