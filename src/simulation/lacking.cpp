#include "simulation/lacking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace gridlock {

namespace {

struct Lacking {
  std::string_view word;
  std::string_view instead;  ///< reason or substitute
};

constexpr std::string_view constant_area =
    "the area of a run is constant; a stage of a [[protocol]] may end at a pressure";
constexpr std::string_view no_forces = "disks feel gravity and the potential of pairs alone";

/// Words for missing features; docs/explanation/limits.md explains each of them.
constexpr std::array<Lacking, 6> all_lacking{{
    {"barostat", constant_area},
    {"pressure", constant_area},
    {"npt", constant_area},
    {"forces", no_forces},
    {"field", no_forces},
    {"gpu", "it computes on the cores of a processor"},
}};

/// Models of earlier versions, and the engine of disks that gives the same bits.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> former_models{
    {{"colloid", "stepped"}, {"colloid_tiled", "tiled"}}};

}  // namespace

std::optional<std::string> instead_of_model(std::string_view name) {
  for (auto const& [model, engine] : former_models) {
    if (name != model) continue;
    return fmt::format(
        "use model.kind = \"disks\" with engine.kind = \"{}\", which gives the same bits; the rule as a model is an "
        "example now, examples/colloid.hpp",
        engine);
  }
  return std::nullopt;
}

std::optional<std::string> sentence_on_lacking(std::string_view word) {
  std::string lower(word);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  auto const found = std::ranges::find(all_lacking, lower, &Lacking::word);
  if (found == all_lacking.end()) return std::nullopt;
  return fmt::format("Gridlock has no {}: {} (see limits in the documentation)", found->word, found->instead);
}

}  // namespace gridlock
