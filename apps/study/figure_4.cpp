#include <fmt/format.h>

#include <cmath>

#include "grid/linked_grid.hpp"
#include "gridlock/grid/validate.hpp"
#include "study/figures.hpp"

namespace gridlock {

namespace {

constexpr std::uint64_t k = 10;
constexpr std::uint64_t steps = 100;
constexpr double packing_fraction = 0.7;

/// Where every disk is, which neighbourhood that makes it, and at which step.
void add_disks(Table& table, State const& state) {
  CellLayout const layout(state.box, k, k);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    Vector const p = position(state.agents, i);
    table.add_row(std::vector<Cell>{state.clock.step, state.agents.ids()[i], p.x, p.y, state.agents.column<Radius>()[i],
                                    static_cast<std::uint64_t>(layout.column_of(p.x)),
                                    static_cast<std::uint64_t>(layout.row_of(p.y))});
  }
}

PictureSettings picture(std::string title) {
  return {.colouring = Colouring::neighbourhood, .columns = k, .rows = k, .title = std::move(title)};
}

}  // namespace

Chapter figure_4(Study& study) {
  Configuration configuration;
  configuration.disks = {.count = study.extent().disks, .packing_fraction = packing_fraction};
  configuration.engine.cells = k;
  configuration.run = {.steps = steps, .seed = study.seed(0)};
  Setup const setup = set_up(configuration);
  State state = disks_of(setup);
  Counters counters;
  make_engine(setup.configuration.engine, state)->advance(state, counters, stop_condition_of(setup));

  study.draw(disks_of(setup),
             picture(fmt::format("start: N = {}, φ = {}, k = {}", state.agents.size(), packing_fraction, k)),
             "figure_4_start");
  study.draw(state, picture(fmt::format("after {} steps", steps)), "figure_4_after");
  Table table;
  for (char const* name : {"step", "id"}) table.add_column(name, std::vector<std::uint64_t>{});
  for (char const* name : {"x", "y", "radius"}) table.add_column(name, std::vector<double>{});
  for (char const* name : {"column", "row"}) table.add_column(name, std::vector<std::uint64_t>{});
  add_disks(table, disks_of(setup));
  add_disks(table, state);
  study.write(table, "figure_4.csv");

  LinkedGrid const grid(CellLayout(state.box, k, k), state.agents.column<X>(), state.agents.column<Y>());
  double const overlap = largest_overlap(state);
  double const energy_change = kinetic_energy(state.agents) / kinetic_energy(disks_of(setup).agents) - 1.0;
  bool const is_sound = grid.is_consistent() && overlap == 0.0 && std::abs(energy_change) < 1e-12;

  Chapter chapter{.title = "Figure 4: the disks and their neighbourhoods"};
  chapter.introduction.push_back(
      fmt::format("{} disks on the square lattice at φ = {}, and the same disks after {} steps of the paper's rule, on "
                  "{} × {} neighbourhoods. Disks of adjacent neighbourhoods have different colours.",
                  state.agents.size(), packing_fraction, steps, k, k));
  chapter.drawings.push_back(
      {{"figure_4_start.svg", "figure_4_after.svg"}, fmt::format("The start, and after {} steps.", steps)});
  chapter.claims.push_back(
      {.where = "Figure 4",
       .statement = "Every disk belongs to exactly one of the k × k neighbourhoods, and the rule keeps the disks from "
                    "overlapping.",
       .measured =
           fmt::format("After {} steps every disk is in the list of its neighbourhood and of no other; the largest "
                       "overlap of two disks is {}; kinetic energy has changed by {:.1e} of itself; {:.0f} % of the "
                       "moves were halted.",
                       steps, overlap, energy_change,
                       100.0 * static_cast<double>(counters.halted_moves) / static_cast<double>(counters.moves)),
       .verdict = is_sound ? Verdict::agrees : Verdict::differs});
  return chapter;
}

}  // namespace gridlock
