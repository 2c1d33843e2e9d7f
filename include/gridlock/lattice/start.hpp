#pragma once

/// \file
/// Starts of hard disks: positions on a square or triangular lattice or at random, and first velocities.
///
/// ```cpp
/// DisksSettings const disks{.count = 100, .packing_fraction = 0.5, .start = StartKind::triangular};
/// State state = make_start(Box(1.0, 1.0, Edge::periodic), disks, 1);
/// draw_velocities(state, {.max = 1.0});
/// ```

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// The edges along one axis: those of `box.edge`, or others.
enum class AxisEdge { same, wall, periodic };

/// The settings `[box]`.
struct BoxSettings {
  Edge edge = Edge::wall;
  AxisEdge edge_x = AxisEdge::same;
  AxisEdge edge_y = AxisEdge::same;
  double side = 1.0;
  std::optional<double> width;   ///< left out: side
  std::optional<double> height;  ///< left out: side
  double tilt = 0.0;             ///< xy/L_y of an oblique periodic box
};
void describe(BoxSettings& settings, SettingVisitor& visitor);
Box make_box(BoxSettings const& settings);
/// Return the edges that the settings give to an axis.
Edge edge_x_of(BoxSettings const& settings);
Edge edge_y_of(BoxSettings const& settings);
AxisEdge axis_edge_of(Edge edge);

/// One kind of disk in a mixture: `[[disks.species]]`.
struct SpeciesSettings {
  double fraction = 1.0;    ///< share of the disks; the shares of all species add up to 1
  double size_ratio = 1.0;  ///< radius in units of disks.radius
  double mass = 1.0;
  bool fixed = false;  ///< these disks never move: their mass is infinite
};
void describe(SpeciesSettings& settings, SettingVisitor& visitor);

/// The distribution P(σ) of diameters: all equal; ∝ σ⁻³ or uniform between a smallest and a largest diameter; or
/// normal, cut off at three standard deviations.
///
/// σ⁻³: Ninarello, Berthier, Coslovich 2017, doi:10.1103/PhysRevX.7.021039. With an area ∝ σ² P(σ) dσ = dσ/σ at every
/// size, disks of similar size can be exchanged at any density, and nothing crystallizes.
enum class SizeDistribution { equal, inverse_cube, uniform, normal };

/// The positions of the disks at the start. `uniform`: uniform random points, whose disks overlap.
enum class StartKind { square, triangular, random, uniform, file };

/// The settings `[disks]`.
struct DisksSettings {
  std::optional<std::uint64_t> count;      ///< default: 841, or the number of disks of the file
  std::optional<double> packing_fraction;  ///< exactly one of packing_fraction and radius is given, neither for a file
  std::optional<double> radius;            ///< for size_ratio 1; the mean of a distribution of sizes
  SizeDistribution sizes = SizeDistribution::equal;  ///< only without species
  /// s = √(⟨σ²⟩ − ⟨σ⟩²)/⟨σ⟩ of the distribution; default: 0.23. With z = (σ_max − σ_min)/(σ_max + σ_min):
  /// inverse_cube s² = artanh(z)/z − 1, uniform s = z/√3, normal s = 0.3289 z.
  std::optional<double> size_spread;
  StartKind start = StartKind::square;
  std::vector<double> region;  ///< left, bottom, right, top: the disks fill this part of the box; empty: all of it
  std::string file;            ///< extended XYZ; giving it implies start = "file"
  std::optional<std::uint64_t> frame;    ///< frame of the file, from 0; default: its only frame
  std::vector<SpeciesSettings> species;  ///< empty: equal disks of mass 1
};
void describe(DisksSettings& settings, SettingVisitor& visitor);

/// The distribution of the first velocities.
enum class VelocityKind { uniform, maxwell, file };
/// Whether the mean velocity of the start is subtracted; automatic: only in a periodic box.
enum class Drift { automatic, keep, remove };

/// The settings `[velocities]`. A start from a file keeps the velocities of the file for any `kind`, unless `redraw` is
/// true.
struct VelocitySettings {
  VelocityKind kind = VelocityKind::uniform;
  double max = 1.0;  ///< v_max; maxwell: kT = m v_max²/4, the temperature to which the uniform start relaxes
  Drift drift = Drift::automatic;
  bool redraw = false;  ///< draw new velocities even if the file has velocities
};
void describe(VelocitySettings& settings, SettingVisitor& visitor);

/// Makes the disks of the settings at rest, with Ids 0 … count − 1 in the order of their sites, row after row from the
/// lower left. Species are assigned at random, with exactly round(fraction · count) disks of each; so are the sizes of
/// a distribution, its quantiles (k + ½)/count for every seed. Disks of a `uniform` start overlap, for soft disks.
///
/// Errors: Error if settings contradict each other or the disks do not fit, with the largest packing fraction that
/// fits.
State make_start(Box const& box, DisksSettings const& settings, std::uint64_t seed);

/// Returns the number of disks of the settings.
std::uint64_t count_of(DisksSettings const& settings);

/// A disk of a start, at rest.
struct DiskAtStart {
  Vector site;
  double radius = 0.0;
  double mass = 1.0;
};

/// Makes the disks of make_start() one by one, for callers that do not need all disks in one process. Memory: none for
/// a lattice of equal disks, 16 bytes a disk for other sizes, 16 more for random sites, and 50 while they are found.
class StartOfDisks {
 public:
  /// Returns the site of disk number i.
  using SiteOf = std::function<Vector(std::size_t i)>;

  /// Errors: those of make_start().
  StartOfDisks(Box const& box, DisksSettings const& settings, std::uint64_t seed);
  ~StartOfDisks();
  StartOfDisks(StartOfDisks&&) noexcept;

  [[nodiscard]] std::uint64_t count() const;
  /// Returns disk number i, whose Id will be i.
  [[nodiscard]] DiskAtStart disk(std::uint64_t i) const;
  /// Returns all disks.
  [[nodiscard]] State all() const;

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

/// Returns the number of positions that a random start will try, each about 0.15 µs. Cost: at most about a second, for
/// a sample of 5000 of its disks. Returns 0 for fast starts: other kinds, few disks, packing fractions up to 0.4; and
/// for starts that make_start() refuses after such a sample. Errors: Error for settings that contradict each other.
double expected_attempts(Box const& box, DisksSettings const& settings, std::uint64_t seed);

/// Draws a velocity for every disk, which depends on (seed, Id) alone before the drift is removed.
///
/// uniform: v = v_max u, u uniform in the unit disk, so ⟨v²⟩ = v_max²/2 and the mean speed is 2 v_max/3;
/// maxwell: each component normal with variance kT/m, kT = v_max²/4 in units of mass 1.
/// Removing the drift subtracts Σ m v / Σ m from every velocity; automatic does so for two disks or more in a periodic
/// box without fixed disks, where nothing else stops the drift. Fixed disks get no velocity.
/// All processes that share the disks call it; `state` has the disks of this process, in the order of the Ids.
/// Errors: Error for kind = file, since no file is given, and for a largest speed below 10⁻⁶⁰ that is not 0.
void draw_velocities(State& state, VelocitySettings const& settings, AllProcesses processes = {});

/// The lattice of at least `count` sites on which equal disks are largest: their radius, packing fraction and sites.
///
/// square: columns × rows sites (c + ½, r + ½) in units of the spacings, columns and rows chosen for the largest
/// radius. triangular: rows of p and p or p and p − 1 sites, every second one shifted by half a spacing, stretched to
/// fill the box; number of rows, p and orientation chosen for the largest radius, min(a_x, √(a_x²/4 + a_y²), 2 a_y)/2.
/// 841 disks in a hard square box reach π/4 and 0.8654. Unused sites are spread evenly.
/// Cost: O(√count); a site O(1).
struct LatticeFit {
  /// Rows of sites along x, or along y if is_turned.
  struct Rows {
    std::uint64_t even_length = 1;  ///< sites in rows 0, 2, 4 …
    std::uint64_t odd_length = 1;   ///< sites in rows 1, 3, 5 …
    Vector spacing;
    Vector corner;              ///< corner of the box at which the rows begin
    Vector offset;              ///< position of the first site from the corner, in spacings
    double shift_of_odd = 0.0;  ///< shift of rows 1, 3, 5 …, in spacings
    bool is_turned = false;
  };

  double radius = 0.0;
  double packing_fraction = 0.0;
  std::uint64_t count = 0;
  std::uint64_t available = 0;  ///< number of sites of the lattice
  Rows rows;

  /// Returns site n < count, row after row from the lower left. Sites do not depend on the radius of the disks.
  [[nodiscard]] Vector site(std::uint64_t n) const;
};
LatticeFit fit_square_lattice(Box const& box, std::uint64_t count);
LatticeFit fit_triangular_lattice(Box const& box, std::uint64_t count);

}  // namespace gridlock
