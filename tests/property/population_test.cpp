#include "gridlock/core/population.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gridlock {
namespace {

struct Weight {
  using type = double;
};
struct Colour {
  using type = int;
};
using Marbles = Population<Weight, Colour>;

Id id_of(std::uint64_t slot, std::uint64_t generation) { return (generation << 32) | slot; }

/// What a population must be: a map from names to values, and the names of the dead.
struct Model {
  std::map<Id, std::pair<double, int>> alive;
  std::set<Id> dead;

  [[nodiscard]] bool takes(Id id) const {
    std::uint64_t const slot = id & 0xFFFFFFFFU;
    for (auto const& [other, values] : alive) {
      if ((other & 0xFFFFFFFFU) == slot) return false;
    }
    for (Id const other : dead) {
      if ((other & 0xFFFFFFFFU) == slot && other >= id) return false;
    }
    return true;
  }
};

void check_same(Marbles const& marbles, Model const& model) {
  RC_ASSERT(marbles.size() == model.alive.size());
  RC_ASSERT(marbles.empty() == model.alive.empty());
  RC_ASSERT(marbles.ids().size() == model.alive.size());
  for (auto const& [id, values] : model.alive) {
    std::size_t const row = marbles.index_of(id);
    RC_ASSERT(row < marbles.size());
    RC_ASSERT(marbles.ids()[row] == id);
    RC_ASSERT(marbles.column<Weight>()[row] == values.first);
    RC_ASSERT(marbles.column<Colour>()[row] == values.second);
  }
  for (Id const id : model.dead) RC_ASSERT(!marbles.contains(id));
}

RC_GTEST_PROP(PopulationProperty, BehavesLikeAMapFromNamesToValuesUnderAnySequence, ()) {
  Marbles marbles;
  Model model;
  auto const operations = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 1000));
  for (int const operation : operations) {
    double const weight = 0.5 * operation;
    switch (operation % 4) {
      case 0:
      case 1: {
        Id const id = marbles.add(weight, operation);
        RC_ASSERT(model.takes(id));
        model.alive[id] = {weight, operation};
        break;
      }
      case 2: {
        if (model.alive.empty()) break;
        auto const victim = std::next(model.alive.begin(), operation % static_cast<int>(model.alive.size()));
        marbles.remove(victim->first);
        model.dead.insert(victim->first);
        model.alive.erase(victim);
        break;
      }
      default: {
        // Few slots and generations, so that names of the living, of the dead and of nobody all come up.
        Id const id =
            id_of(static_cast<std::uint64_t>(operation / 4 % 12), static_cast<std::uint64_t>(operation / 48 % 4));
        bool const is_taken = !model.takes(id);
        RC_ASSERT(marbles.add_as(id, weight, operation) == !is_taken);
        if (!is_taken) model.alive[id] = {weight, operation};
      }
    }
    check_same(marbles, model);
  }
}

RC_GTEST_PROP(PopulationProperty, BirthsAndDeathsUseNoMoreSlotsThanWereEverAliveAtOnce, ()) {
  Marbles marbles;
  std::vector<Id> alive;
  std::size_t max_alive = 0;
  Id largest_slot = 0;
  for (int const operation : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 1000))) {
    if (operation % 2 == 0 || alive.empty()) {
      alive.push_back(marbles.add(0.0, 0));
      largest_slot = std::max(largest_slot, alive.back() & 0xFFFFFFFFU);
      max_alive = std::max(max_alive, alive.size());
    } else {
      std::size_t const victim = static_cast<std::size_t>(operation) % alive.size();
      marbles.remove(alive[victim]);
      alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(victim));
    }
  }
  RC_ASSERT(max_alive == 0 || largest_slot < max_alive);
}

}  // namespace
}  // namespace gridlock
