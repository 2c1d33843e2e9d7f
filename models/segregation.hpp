#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/model/model.hpp"

namespace gridlock {

struct Group {
  using type = std::uint32_t;
  static constexpr char const* name = "group";
  static constexpr std::array<std::string_view, 2> value_names{"one", "two"};
};
/// 0 where a cell is empty, else 1 and the group of the agent that lives there.
struct Homes {
  static constexpr std::string_view name = "homes";
};

/// Agents of two groups that move away where too few of their own group are near: Schelling's model of segregation, by
/// the rules of the public comparison of agent frameworks (doi:10.5281/zenodo.8016506).
///
/// Each agent has a cell of its own. In a step all take their turn one after the other, in a random order: an agent
/// with fewer than `wanted` of its own group in the (2 radius + 1)² − 1 cells around its own moves to an empty cell,
/// any of them alike. Source: T. C. Schelling (1971), doi:10.1080/0022250X.1971.9989794.
struct Segregation {
  static constexpr std::string_view name = "segregation";
  static constexpr std::string_view documentation = "Agents that move away where too few of their own group are near.";
  static constexpr Schedule schedule = Schedule::events;
  static constexpr std::array<std::string_view, 1> events{"moves"};
  using Agents = Population<X, Y, Group>;
  using Fields = FieldSet<Homes>;

  std::uint64_t side = 40;
  std::uint64_t count = 1000;
  std::uint64_t radius = 1;
  std::uint64_t wanted = 3;

  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "side", .documentation = "Cells along x.", .min = 2, .max = 5000}, side);
    visitor.visit({.key = "count", .documentation = "Agents, half of each group.", .min = 1, .max = 2e9}, count);
    visitor.visit({.key = "radius", .unit = "cells", .documentation = "How far an agent looks.", .min = 1, .max = 50},
                  radius);
    visitor.visit(
        {.key = "wanted", .documentation = "Neighbours of its own group with whom an agent stays.", .max = 10000},
        wanted);
  }
  /// Throws Error for a box without edges, and for more agents than cells.
  void check(Box const& box) const {
    if (box.has_images()) {
      throw Error(
          {.what = "the city of the model segregation has edges, and the box is " + std::string(edges_in_words(box)),
           .hint = "use box.edge = \"wall\"",
           .key = "count"});
    }
    std::size_t const cells = side * rows_of_squares(box, side);
    if (count <= cells) return;
    throw Error({.what = std::to_string(count) + " agents have " + std::to_string(cells) + " cells",
                 .hint = "use a smaller count or a larger side",
                 .key = "count"});
  }
  [[nodiscard]] std::uint64_t agents_at_start() const { return count; }

  /// No agent searches for others: it looks at the cells around its own, so that a coarse grid is
  /// enough.
  [[nodiscard]] double cutoff(AgentSums<Segregation> const& all) const {
    return 0.5 * std::min(all.box().width(), all.box().height());
  }
  [[nodiscard]] double time_step() const { return 1.0; }
  [[nodiscard]] std::size_t columns(Homes) const { return side; }

  void start(World<Segregation>& world) const {
    Field& homes = field_of<Homes>(world);
    std::vector<std::size_t> cells(homes.size());
    std::iota(cells.begin(), cells.end(), 0);
    RandomStream random = world.start_random(0);
    for (std::uint64_t number = 0; number < count; ++number) {
      std::swap(cells[number], cells[number + random.below(cells.size() - number)]);
      Vector const p = centre_of_cell(homes, world.box, cells[number]);
      std::uint32_t const group = 2 * number < count ? 0 : 1;
      homes.values()[cells[number]] = 1.0 + group;
      world.agents.add(p.x, p.y, group);
    }
  }

  void step(MutableWorld<Segregation>& city) const {
    RandomStream random = city.random();
    Field const& homes = city.field<Homes>();
    Map map(homes, radius);
    std::vector<std::size_t> vacant;
    for (std::size_t cell = 0; cell < homes.size(); ++cell) {
      if (homes.values()[cell] == 0.0) vacant.push_back(cell);
    }
    if (vacant.empty()) return;
    for (Id const id : city.agents_in_random_order(random)) {
      std::size_t const here = homes.cell_of(city.box(), city.position(id));
      std::uint32_t const group = city.get<Group>(id);
      if (map.near(here, group) >= wanted) continue;
      std::size_t& chosen = vacant[random.below(vacant.size())];
      Vector const there = centre_of_cell(homes, city.box(), chosen);
      city.deposit<Homes>(city.position(id), -1.0 - group);
      city.deposit<Homes>(there, 1.0 + group);
      city.move_to(id, there);
      city.count(0);
      map.move(here, chosen);
      chosen = here;
    }
  }

  void observe(World<Segregation> const& world, Observations& seen) const {
    Field const& homes = field_of<Homes>(world);
    Map const map(homes, radius);
    AgentSums<Segregation> const agents(world);
    auto const sum = [&](auto term) {
      return agents.sum([&](auto const& agent) {
        std::size_t const cell = homes.cell_of(world.box, {agent.template get<X>(), agent.template get<Y>()});
        std::uint32_t const group = agent.template get<Group>();
        std::uint64_t const like = map.near(cell, group);
        return term(static_cast<double>(like), static_cast<double>(like + map.near(cell, 1 - group)));
      });
    };
    double const shares = sum([](double like, double all) { return all > 0.0 ? like / all : 0.0; });
    double const sociable = sum([](double, double all) { return all > 0.0 ? 1.0 : 0.0; });
    double const happy = sum([&](double like, double) { return like >= static_cast<double>(wanted) ? 1.0 : 0.0; });
    seen.add("like_share", sociable > 0.0 ? shares / sociable : 0.0,
             "Share of an agent's neighbours who are of its group; mean over agents with neighbours.");
    seen.add("happy", happy / static_cast<double>(agents.size()),
             "Share of agents with as many of their group near as they want.");
  }

 private:
  /// The homes with an empty rim as wide as the radius, so that no agent looks beyond the city.
  class Map {
   public:
    Map(Field const& homes, std::size_t radius)
        : radius_(radius), columns_(static_cast<std::uint32_t>(homes.columns())), width_(columns_ + 2 * radius) {
      homes_.resize(width_ * (homes.rows() + 2 * radius));
      auto value = homes.values().begin();
      for (std::size_t row = 0; row < homes.rows(); ++row) {
        std::size_t const first = (row + radius) * width_ + radius;
        for (std::size_t k = 0; k < columns_; ++k) homes_[first + k] = static_cast<std::uint8_t>(*value++);
      }
    }
    /// Returns how many agents of a group are near that of a cell.
    [[nodiscard]] std::uint64_t near(std::size_t cell, std::uint32_t group) const {
      std::size_t const here = place_of(cell);
      std::size_t const first = here - radius_ * (width_ + 1);
      auto const like = static_cast<std::uint8_t>(group + 1);
      std::uint32_t near = 0;
      for (std::size_t row = 0; row <= 2 * radius_; ++row) {
        std::uint8_t const* const homes = &homes_[first + row * width_];
        for (std::size_t k = 0; k <= 2 * radius_; ++k) near += homes[k] == like ? 1 : 0;
      }
      return homes_[here] == like ? near - 1 : near;
    }
    void move(std::size_t from, std::size_t to) { std::swap(homes_[place_of(from)], homes_[place_of(to)]); }

   private:
    [[nodiscard]] std::size_t place_of(std::size_t cell) const {
      auto const short_cell = static_cast<std::uint32_t>(cell);  // divided in half the time
      return (short_cell / columns_ + radius_) * width_ + short_cell % columns_ + radius_;
    }

    std::size_t radius_;
    std::uint32_t columns_;
    std::size_t width_;
    std::vector<std::uint8_t> homes_;
  };
};

}  // namespace gridlock
