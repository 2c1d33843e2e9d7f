#pragma once

/// \file
/// Starts: disks on a square or triangular lattice or at random, and their first velocities.
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

/// The settings `[box]`.
struct BoxSettings {
  Edge edge = Edge::wall;
  double side = 1.0;
  std::optional<double> width;   ///< left out: side
  std::optional<double> height;  ///< left out: side
};
void describe(BoxSettings& settings, SettingVisitor& visitor);
Box make_box(BoxSettings const& settings);

/// One kind of disk in a mixture: `[[disks.species]]`.
struct SpeciesSettings {
  double fraction = 1.0;    ///< share of the disks; the shares of all species add up to 1
  double size_ratio = 1.0;  ///< radius in units of disks.radius
  double mass = 1.0;
};
void describe(SpeciesSettings& settings, SettingVisitor& visitor);

/// How the sizes of the disks are distributed: all equal, or P(σ) ∝ σ⁻³ between a smallest and a largest diameter, the
/// same share of disks at every σ between them, or a normal distribution cut off at three standard deviations.
///
/// σ⁻³: Ninarello, Berthier, Coslovich 2017, doi:10.1103/PhysRevX.7.021039. A share of area ∝ σ² P(σ) dσ = dσ/σ at
/// every size leaves no size alone, so that neighbouring sizes can change places at any density and nothing
/// crystallizes.
enum class SizeDistribution { equal, inverse_cube, uniform, normal };

/// Where the disks stand at the start. `uniform`: points uniformly at random, whose disks overlap.
enum class StartKind { square, triangular, random, uniform, file };

/// The settings `[disks]`.
struct DisksSettings {
  std::optional<std::uint64_t> count;      ///< left out: 841, or as many as the file holds
  std::optional<double> packing_fraction;  ///< exactly one of packing_fraction and radius, none for a file
  std::optional<double> radius;            ///< of a disk with size_ratio 1; with a distribution of sizes the mean
  SizeDistribution sizes = SizeDistribution::equal;  ///< without species only
  /// s = √(⟨σ²⟩ − ⟨σ⟩²)/⟨σ⟩ of the distribution; left out: 0.23. With z = (σ_max − σ_min)/(σ_max + σ_min):
  /// inverse_cube s² = artanh(z)/z − 1, uniform s = z/√3, normal s = 0.3289 z.
  std::optional<double> size_spread;
  StartKind start = StartKind::square;
  std::string file;                      ///< extended XYZ; giving it implies start = "file"
  std::optional<std::uint64_t> frame;    ///< of the file, from 0; left out: its only one
  std::vector<SpeciesSettings> species;  ///< empty: equal disks of mass 1
};
void describe(DisksSettings& settings, SettingVisitor& visitor);

/// How the first velocities are drawn.
enum class VelocityKind { uniform, maxwell, file };
/// Whether the mean velocity of the start is taken out; automatic: in a periodic box only.
enum class Drift { automatic, keep, remove };

/// The settings `[velocities]`. A start from a file keeps the velocities of the file, whatever `kind` says, unless
/// `redraw` asks for new ones.
struct VelocitySettings {
  VelocityKind kind = VelocityKind::uniform;
  double max = 1.0;  ///< v_max; maxwell: kT = m v_max²/4, the temperature the uniform start relaxes to
  Drift drift = Drift::automatic;
  bool redraw = false;  ///< with a file that holds velocities: draw new ones all the same
};
void describe(VelocitySettings& settings, SettingVisitor& visitor);

/// Disks of the settings, on their sites, at rest; Ids 0 … count − 1 in the order of the sites, row after row from the
/// lower left. Species are dealt out at random, exactly round(fraction · count) of each; so are the sizes of a
/// distribution, its quantiles (k + ½)/count, which are the same for every seed. Disks of a `uniform` start overlap:
/// soft disks may.
///
/// Errors: Error where the settings contradict each other or the disks cannot fit, naming the largest packing fraction
/// that does.
State make_start(Box const& box, DisksSettings const& settings, std::uint64_t seed);

/// How many disks the settings ask for.
std::uint64_t count_of(DisksSettings const& settings);

/// A disk of a start, at rest.
struct DiskAtStart {
  Vector site;
  double radius = 0.0;
  double mass = 1.0;
};

/// The disks of make_start() one by one, for those who do not keep them all in one place.
/// Memory: of a lattice of equal disks none, of other kinds 16 bytes a disk, of random sites 16 more, and 50 while they
/// are found.
class StartOfDisks {
 public:
  /// The site of disk number i.
  using SiteOf = std::function<Vector(std::size_t i)>;

  /// Errors: those of make_start().
  StartOfDisks(Box const& box, DisksSettings const& settings, std::uint64_t seed);
  ~StartOfDisks();
  StartOfDisks(StartOfDisks&&) noexcept;

  [[nodiscard]] std::uint64_t count() const;
  /// Number i, whose Id will be i.
  [[nodiscard]] DiskAtStart disk(std::uint64_t i) const;
  /// All of them.
  [[nodiscard]] State all() const;

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

/// How many places a random start will try in all, each about 0.15 µs; from a sample of 5000 of its disks, about a
/// second at most. 0 for starts that take no such time: other kinds, few disks, packing fractions up to 0.4, and those
/// that make_start() refuses after such a sample. Errors: Error for settings that contradict each other.
double expected_attempts(Box const& box, DisksSettings const& settings, std::uint64_t seed);

/// Draws a velocity for every disk: a function of (seed, Id) alone, but for the drift.
///
/// uniform: v = v_max u, u uniform in the unit disk, so ⟨v²⟩ = v_max²/2 and the mean speed is 2 v_max/3;
/// maxwell: each component normal with variance kT/m, kT = v_max²/4 in units of mass 1.
/// Removing the drift subtracts Σ m v / Σ m from every velocity; automatic does so for two disks or more in a periodic
/// box, where nothing else would ever stop it.
/// All processes that share the disks call it; `state` has those of this one, in the order of the Ids.
/// Errors: Error for kind = file, since there is no file here, and for a largest speed below 10⁻⁶⁰ that is not 0.
void draw_velocities(State& state, VelocitySettings const& settings, AllProcesses processes = {});

/// The largest radius of equal disks on the best lattice of at least `count` sites, its packing fraction, and `count`
/// of its sites.
///
/// square: columns × rows sites (c + ½, r + ½) in units of the spacings, columns and rows chosen for the largest
/// radius. triangular: rows of p and p or p and p − 1 sites, every second one shifted by half a spacing, stretched to
/// fill the box; number of rows, p and orientation chosen for the largest radius, min(a_x, √(a_x²/4 + a_y²), 2 a_y)/2.
/// 841 disks in a hard square box reach π/4 and 0.8654. Sites left over are spread evenly.
/// Cost: O(√count); a site O(1).
struct LatticeFit {
  /// Rows of sites along x, or along y where they are turned.
  struct Rows {
    std::uint64_t even_length = 1;  ///< sites in rows 0, 2, 4 …
    std::uint64_t odd_length = 1;   ///< sites in rows 1, 3, 5 …
    Vector spacing;
    Vector corner;              ///< where the rows begin
    Vector offset;              ///< of the first site from there, in spacings
    double shift_of_odd = 0.0;  ///< of rows 1, 3, 5 …, in spacings
    bool is_turned = false;
  };

  double radius = 0.0;
  double packing_fraction = 0.0;
  std::uint64_t count = 0;
  std::uint64_t available = 0;  ///< sites of the lattice
  Rows rows;

  /// Site n < count, row after row from the lower left; sites do not depend on the radius that is used.
  [[nodiscard]] Vector site(std::uint64_t n) const;
};
LatticeFit fit_square_lattice(Box const& box, std::uint64_t count);
LatticeFit fit_triangular_lattice(Box const& box, std::uint64_t count);

}  // namespace gridlock
