#include <array>

#include "core/magnitude.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {

namespace {

// Bounds within which squares of size ratios keep all their digits.
constexpr double min_size_ratio = 1e-30;
constexpr double max_size_ratio = 1e30;

}  // namespace

void describe(BoxSettings& settings, SettingVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> edges{"wall", "periodic"};
  visit_enum(visitor,
             {.key = "edge", .documentation = "What a disk meets at the border: a hard wall, or the other side."},
             edges, settings.edge);
  static constexpr std::array<std::string_view, 3> edges_of_axis{"same", "wall", "periodic"};
  visit_enum(visitor,
             {.key = "edge_x",
              .documentation = "Left and right border: same as box.edge, or other: periodic with walls for y is a "
                               "channel."},
             edges_of_axis, settings.edge_x);
  visit_enum(visitor, {.key = "edge_y", .documentation = "Lower and upper border: same as box.edge, or other."},
             edges_of_axis, settings.edge_y);
  visitor.visit({.key = "side",
                 .unit = "length",
                 .documentation = "Side of a square box.",
                 .min = min_magnitude,
                 .max = max_magnitude},
                settings.side);
  visitor.visit({.key = "width",
                 .unit = "length",
                 .documentation = "Width of a rectangular box.",
                 .min = min_magnitude,
                 .max = max_magnitude,
                 .default_note = "box.side"},
                settings.width);
  visitor.visit({.key = "height",
                 .unit = "length",
                 .documentation = "Height of a rectangular box.",
                 .min = min_magnitude,
                 .max = max_magnitude,
                 .default_note = "box.side"},
                settings.height);
  visitor.visit(
      {.key = "tilt",
       .documentation = "xy/L_y of an oblique periodic box: its images above are tilt · height farther to the "
                        "right. A tilt beyond ½ L_x/L_y counts as the same box with a smaller one.",
       .min = -1e6,
       .max = 1e6},
      settings.tilt);
}

void describe(SpeciesSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "fraction",
                 .documentation = "Share of the disks that are of this kind; all shares add up to 1.",
                 .min = 0.0,
                 .max = 1.0},
                settings.fraction);
  visitor.visit({.key = "size_ratio",
                 .unit = "disks.radius",
                 .documentation = "Radius of this kind.",
                 .min = min_size_ratio,
                 .max = max_size_ratio},
                settings.size_ratio);
  visitor.visit(
      {.key = "mass",
       .unit = "mass",
       .documentation =
           "Mass of a disk of this kind; with equal speeds the engine exact takes masses up to about 10⁶ apart.",
       .min = min_magnitude,
       .max = max_magnitude},
      settings.mass);
  visitor.visit(
      {.key = "fixed", .documentation = "Whether disks of this kind never move, as obstacles for the others."},
      settings.fixed);
}

void describe(DisksSettings& settings, SettingVisitor& visitor) {
  static constexpr std::string_view region =
      "Left, bottom, right and top of the part of the box that the disks of the start fill, as if walls were around "
      "it; "
      "packing_fraction is that of this part. Not for a file.";
  static constexpr std::array<std::string_view, 5> starts{"square", "triangular", "random", "uniform", "file"};
  static constexpr std::array<std::string_view, 4> distributions{"equal", "inverse_cube", "uniform", "normal"};
  visitor.visit({.key = "count",
                 .documentation = "N, the number of disks.",
                 .min = 1,
                 .max = 2e9,
                 .default_note = "841, or as many as the file holds"},
                settings.count);
  visitor.visit(
      {.key = "packing_fraction",
       .documentation = "φ = Σ π R² / (width · height), below 1 unless disks overlap at the start; give this or "
                        "disks.radius.",
       .min = 0.0,
       .max = 2.0,
       .min_is_allowed = false,
       .default_note = "from disks.radius, or 0.5 where neither is given"},
      settings.packing_fraction);
  visitor.visit(
      {.key = "radius",
       .unit = "length",
       .documentation = "R, the radius of a disk with size_ratio 1, and with disks.sizes the mean radius; give this "
                        "or disks.packing_fraction.",
       .min = min_magnitude,
       .max = max_magnitude,
       .default_note = "from disks.packing_fraction"},
      settings.radius);
  visit_enum(visitor,
             {.key = "sizes",
              .documentation =
                  "How diameters σ are distributed, without species: all equal, P(σ) ∝ σ⁻³ between a smallest and "
                  "a largest one, uniform between them, or normal, cut off at three standard deviations. Every "
                  "seed has the same sizes, dealt out at random."},
             distributions, settings.sizes);
  visitor.visit(
      {.key = "size_spread",
       .documentation = "Standard deviation of the diameters over their mean, s; σ⁻³: s² = artanh(z)/z − 1 with z = "
                        "(σ_max − σ_min)/(σ_max + σ_min), so that 0.23 is σ_max/σ_min = 2.23.",
       .min = 0.0,
       .max = 1.0,
       .min_is_allowed = false,
       .max_is_allowed = false,
       .default_note = "0.23, where disks.sizes is given"},
      settings.size_spread);
  visit_enum(
      visitor,
      {.key = "start",
       .documentation = "Where the disks start: on a square or triangular lattice fitted to the box, at "
                        "random without overlap, at points uniformly at random, where soft disks may overlap, or "
                        "as a file says."},
      starts, settings.start);
  visitor.visit({.key = "file",
                 .documentation = "Extended XYZ file to start from, relative to the configuration; implies start = "
                                  "\"file\", and box, radii and velocities come from it.",
                 .default_note = "no file"},
                settings.file);
  visitor.visit({.key = "frame",
                 .documentation = "The frame of disks.file to start from, counted from 0, where it has several.",
                 .default_note = "the only one"},
                settings.frame);
  visitor.visit({.key = "region", .unit = "length", .documentation = region, .default_note = "the whole box"},
                settings.region);
  visitor.visit_tables(
      {.key = "species",
       .documentation = "The kinds of disks in a mixture, assigned at random.",
       .default_note = "equal disks of mass 1"},
      settings.species.size(), [&](std::size_t count) { settings.species.resize(count); },
      [&](std::size_t k, SettingVisitor& inner) { describe(settings.species[k], inner); });
}

void describe(VelocitySettings& settings, SettingVisitor& visitor) {
  static constexpr std::array<std::string_view, 3> kinds{"uniform", "maxwell", "file"};
  static constexpr std::array<std::string_view, 3> drifts{"automatic", "keep", "remove"};
  visit_enum(visitor,
             {.key = "kind",
              .documentation = "How velocities are drawn: uniform in a disk of radius max (the paper's), Maxwell's "
                               "distribution, or as the file says."},
             kinds, settings.kind);
  visitor.visit(
      {.key = "max",
       .unit = "length / time",
       .documentation = "v_max; \"maxwell\" has the temperature the uniform start relaxes to, kT = v_max²/4 for "
                        "mass 1.",
       .min = 0.0,
       .max = max_magnitude},
      settings.max);
  visit_enum(
      visitor,
      {.key = "drift",
       .documentation = "Whether the mean motion is taken out of drawn velocities; automatic: in a periodic box."},
      drifts, settings.drift);
  visitor.visit({.key = "redraw", .documentation = "Draw new velocities although the start file has some."},
                settings.redraw);
}

}  // namespace gridlock
