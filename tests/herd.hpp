#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gridlock/model/model.hpp"

namespace gridlock::test {

struct Stomach {
  using type = double;
  static constexpr char const* name = "stomach";
};
struct Scent {
  static constexpr std::string_view name = "scent";
};
struct Grass {
  static constexpr std::string_view name = "grass";
};

/// Agents that eat, leave a scent, follow it, multiply and starve; grass grows where a number drawn for the cell says.
template <Schedule order>
struct Herd {
  static constexpr std::string_view name = "test_herd";
  static constexpr std::string_view documentation = "Grazers.";
  static constexpr Schedule schedule = order;
  using Agents = Population<X, Y, Stomach>;
  using Fields = FieldSet<Grass, Scent>;
  std::uint64_t cells = 20;

  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "cells", .documentation = "Columns of grass.", .min = 1, .max = 1e9}, cells);
  }
  [[nodiscard]] std::size_t columns(Grass) const { return cells; }
  [[nodiscard]] std::size_t columns(Scent) const { return 9; }
  [[nodiscard]] std::size_t rows(Scent) const { return 13; }
  [[nodiscard]] double cutoff() const { return 0.3; }
  [[nodiscard]] double time_step() const { return 0.5; }
  void start(World<Herd>& world) const {
    auto const grass = field_of<Grass>(world).values();
    for (std::size_t cell = 0; cell < grass.size(); ++cell) grass[cell] = start_random_of_cell(world, cell).uniform();
    for (std::uint64_t n = 0; n < 300; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y, random.uniform());
    }
  }
  void turn(Turn<Herd>& self) const {
    RandomStream random = self.random();
    double const stomach = self.template get<Stomach>() - 0.1;
    self.template set<Stomach>(stomach);
    if constexpr (order == Schedule::sequential) {
      self.template set<Stomach>(stomach + self.template take<Grass>(0.3));
    } else {
      self.template take<Grass, Stomach>(0.3);
    }
    self.template deposit<Scent>(random.uniform());
    if (stomach < 0.0) self.die();
    if (stomach > 1.0) self.give_birth(self.position().x, self.position().y, 0.5);
    Vector const step = 0.05 * random.in_unit_disk();
    if (self.template at<Scent>() > 1.0) self.move_by(step);
  }
  void step_fields(FieldsOfStep<Herd>& fields) const {
    auto const grass = fields.template get<Grass>().values();
    for (std::size_t cell = 0; cell < grass.size(); ++cell) {
      if (fields.random(cell).uniform() < 0.1) grass[cell] = std::min(grass[cell] + fields.time_step(), 1.0);
    }
    fields.template spread<Scent>({.diffusion = 0.002, .decay = 0.2});
  }
  void observe(AgentSums<Herd> const& agents, Observations& seen) const {
    seen.add("stomachs", agents.sum([](auto const& agent) { return agent.template get<Stomach>(); }));
  }
};

}  // namespace gridlock::test
