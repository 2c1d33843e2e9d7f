#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/model/model.hpp"

namespace gridlock {

struct Animal {
  using type = std::uint32_t;
  static constexpr char const* name = "kind";
  static constexpr std::array<std::string_view, 2> value_names{"sheep", "wolf"};
};
struct Energy {
  using type = double;
  static constexpr char const* name = "energy";
};
/// Steps until the grass of a cell is grown; 0 where it is.
struct Bare {
  static constexpr std::string_view name = "bare";
};

/// Sheep that eat grass and wolves that eat sheep, on the cells of a meadow, by the rules of the public comparison of
/// agent frameworks (doi:10.5281/zenodo.8016506).
///
/// In a step all sheep take their turn, in a random order; then all wolves; then the grass. An animal goes to one of
/// the 8 cells around its own, where walls keep it in its row or column, and loses 1 of its energy. A sheep eats grown
/// grass in its cell, for `sheep_gain`; a wolf eats one of the sheep in its cell, for `wolf_gain`. With less than 0 the
/// animal dies; otherwise it bears young with a probability, and they share its energy. Lambs may be eaten in the step
/// of their birth. Eaten grass is grown again after `regrowth` steps. Source: U. Wilensky (1997),
/// ccl.northwestern.edu/netlogo/models/WolfSheepPredation.
struct Predation {
  static constexpr std::string_view name = "predation";
  static constexpr std::string_view documentation = "Wolves that eat sheep, which eat grass, which grows again.";
  static constexpr Schedule schedule = Schedule::events;
  enum Kind : std::uint32_t { a_sheep, a_wolf };
  static constexpr std::array<std::string_view, 6> events{"meals_of_sheep", "meals_of_wolves", "lambs",
                                                          "pups",           "starved_sheep",   "starved_wolves"};
  using Agents = Population<X, Y, Animal, Energy>;
  using Fields = FieldSet<Bare>;

  std::uint64_t side = 25;
  std::uint64_t sheep = 60;
  std::uint64_t wolves = 40;
  std::uint64_t regrowth = 20;
  double sheep_gain = 5.0;
  double wolf_gain = 13.0;
  double sheep_birth = 0.2;
  double wolf_birth = 0.1;

  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "side", .documentation = "Cells along x.", .min = 2, .max = 5000}, side);
    visitor.visit({.key = "sheep", .documentation = "At the start.", .max = 1e9}, sheep);
    visitor.visit({.key = "wolves", .documentation = "At the start.", .max = 1e9}, wolves);
    visitor.visit(
        {.key = "regrowth", .unit = "steps", .documentation = "Until eaten grass is grown.", .min = 1, .max = 1e9},
        regrowth);
    auto const number = [&](std::string_view key, std::string_view text, double max, double& value) {
      visitor.visit({.key = key, .documentation = text, .min = 0.0, .max = max}, value);
    };
    number("sheep_gain", "Energy in the grass of a cell.", 1000.0, sheep_gain);
    number("wolf_gain", "Energy in a sheep.", 1000.0, wolf_gain);
    number("sheep_birth", "Probability that a sheep bears a lamb in a step.", 1.0, sheep_birth);
    number("wolf_birth", "Probability that a wolf bears a pup in a step.", 1.0, wolf_birth);
  }
  void check(Box const& box) const { require_rectangle(box, "the model predation"); }
  [[nodiscard]] std::uint64_t agents_at_start() const { return sheep + wolves; }

  /// No animal searches for others: those in its cell are listed, so that a coarse grid is enough.
  [[nodiscard]] double cutoff(AgentSums<Predation> const& all) const {
    return 0.5 * std::min(all.box().width(), all.box().height());
  }
  [[nodiscard]] double time_step() const { return 1.0; }
  [[nodiscard]] std::size_t columns(Bare) const { return side; }

  void start_fields(World<Predation>& world) const {
    auto const bare = field_of<Bare>(world).values();
    for (std::size_t cell = 0; cell < bare.size(); ++cell) {
      RandomStream random = start_random_of_cell(world, cell);
      bool const is_grown = random.uniform() < 0.5;
      bare[cell] = is_grown ? 0.0 : 1.0 + static_cast<double>(random.below(regrowth));
    }
  }
  [[nodiscard]] Agents::Values first_agent(World<Predation> const& world, std::uint64_t number) const {
    RandomStream random = world.start_random(number);
    Field const& bare = field_of<Bare>(world);
    std::uint64_t const column = random.below(bare.columns());
    Vector const p = centre_of_cell(bare, world.box, random.below(bare.rows()) * bare.columns() + column);
    Kind const kind = number < sheep ? a_sheep : a_wolf;
    double const energy = std::floor(random.uniform() * 2.0 * (kind == a_sheep ? sheep_gain : wolf_gain));
    return {p.x, p.y, kind, energy};
  }

  void step(MutableWorld<Predation>& meadow) const {
    RandomStream random = meadow.random();
    std::array<std::vector<Id>, 2> herds;
    for (std::vector<Id>& herd : herds) herd.reserve(meadow.size());
    for (Id const id : meadow.agents_in_random_order(random)) {
      herds[meadow.get<Animal>(id) == a_sheep ? a_sheep : a_wolf].push_back(id);
    }
    std::vector<Place> const flock = graze(meadow, random, herds[a_sheep]);
    hunt(meadow, random, herds[a_wolf], Prey(meadow.field<Bare>().size(), flock));
  }
  void step_fields(FieldsOfStep<Predation>& fields) const {
    for (double& bare : fields.get<Bare>().values()) bare = std::max(bare - 1.0, 0.0);
  }

  void observe(World<Predation> const& world, Observations& seen) const {
    seen.add_counts<Animal>(world.agents, {"sheep", "wolves"});
    auto const bare = field_of<Bare>(world).values();
    double const grown = static_cast<double>(std::ranges::count(bare, 0.0));
    seen.add("grass", grown / static_cast<double>(bare.size()), "Share of cells with grown grass.");
    auto const energy = [](auto const& animal) {
      return animal.template get<Animal>() == a_sheep ? animal.template get<Energy>() : 0.0;
    };
    seen.add("energy_of_sheep", AgentSums<Predation>(world).sum(energy), "Energy of all sheep.");
  }

 private:
  /// An animal, and the cell where it is.
  struct Place {
    Id id;
    std::size_t cell;
  };

  /// The sheep in each cell after they have grazed.
  class Prey {
   public:
    Prey(std::size_t cells, std::vector<Place> const& flock) : first_(cells + 1), left_(cells), sheep_(flock.size()) {
      for (Place const& place : flock) ++first_[place.cell + 1];
      for (std::size_t cell = 0; cell < cells; ++cell) first_[cell + 1] += first_[cell];
      for (auto const& [id, cell] : flock) sheep_[first_[cell] + left_[cell]++] = id;
    }
    /// Takes one of the sheep in a cell, if there is one.
    std::optional<Id> take(std::size_t cell, RandomStream& random) {
      if (left_[cell] == 0) return {};
      std::swap(sheep_[first_[cell] + random.below(left_[cell])], sheep_[first_[cell] + left_[cell] - 1]);
      return sheep_[first_[cell] + --left_[cell]];
    }

   private:
    std::vector<std::uint32_t> first_;
    std::vector<std::uint32_t> left_;
    std::vector<Id> sheep_;
  };

  /// The 8 hops of an animal.
  class Hops {
   public:
    explicit Hops(MutableWorld<Predation>& meadow) : meadow_(meadow), bare_(meadow.field<Bare>()) {
      Vector const cell = size_of_cell(meadow.box(), bare_);
      for (std::size_t k = 0; k < ways_.size(); ++k) {
        std::size_t const place = k < 4 ? k : k + 1;  // of 3 × 3 cells; 4 is the one in the middle
        ways_[k] = {(static_cast<double>(place % 3) - 1.0) * cell.x, (static_cast<double>(place / 3) - 1.0) * cell.y};
      }
    }
    /// Moves an animal to one of the 8 cells around its own; returns its cell.
    std::size_t take(Id id, RandomStream& random) const {
      Vector const p = motion(meadow_.box(), meadow_.position(id), ways_[random.bits() >> 61]).end;
      meadow_.move_to(id, p);
      return bare_.cell_of(meadow_.box(), p);
    }

   private:
    MutableWorld<Predation>& meadow_;
    Field const& bare_;
    std::array<Vector, 8> ways_;
  };

  static Vector size_of_cell(Box const& box, Field const& field) {
    return {box.width() / static_cast<double>(field.columns()), box.height() / static_cast<double>(field.rows())};
  }
  /// Returns the sheep that live on, with their lambs.
  std::vector<Place> graze(MutableWorld<Predation>& meadow, RandomStream& random, std::vector<Id> const& flock) const {
    std::vector<Place> alive;
    alive.reserve(2 * flock.size());
    Hops const hops(meadow);
    for (Id const id : flock) {
      std::size_t const cell = hops.take(id, random);
      double energy = meadow.get<Energy>(id) - 1.0;
      if (meadow.field<Bare>().values()[cell] == 0.0) {
        energy += sheep_gain;
        meadow.deposit<Bare>(meadow.position(id), static_cast<double>(regrowth));
        meadow.count(0);
      }
      Fate const fate = live_on<a_sheep>(meadow, random, id, energy);
      if (fate.lives) alive.push_back({id, cell});
      if (fate.young) alive.push_back({*fate.young, cell});
    }
    return alive;
  }

  void hunt(MutableWorld<Predation>& meadow, RandomStream& random, std::vector<Id> const& pack, Prey prey) const {
    Hops const hops(meadow);
    for (Id const id : pack) {
      std::size_t const cell = hops.take(id, random);
      double energy = meadow.get<Energy>(id) - 1.0;
      if (std::optional<Id> const eaten = prey.take(cell, random)) {
        energy += wolf_gain;
        meadow.remove(*eaten);
        meadow.count(1);
      }
      live_on<a_wolf>(meadow, random, id, energy);
    }
  }

  struct Fate {
    bool lives = false;
    std::optional<Id> young;
  };
  /// Lets an animal starve, or live on and perhaps bear young.
  template <Kind kind>
  Fate live_on(MutableWorld<Predation>& meadow, RandomStream& random, Id id, double energy) const {
    if (energy < 0.0) {
      meadow.remove(id);
      meadow.count(4 + kind);
      return {};
    }
    bool const bears = random.uniform() < (kind == a_sheep ? sheep_birth : wolf_birth);
    meadow.set<Energy>(id, bears ? 0.5 * energy : energy);
    if (!bears) return {.lives = true};
    meadow.count(2 + kind);
    Vector const p = meadow.position(id);
    return {.lives = true, .young = meadow.add(p.x, p.y, static_cast<std::uint32_t>(kind), 0.5 * energy)};
  }
};

}  // namespace gridlock
