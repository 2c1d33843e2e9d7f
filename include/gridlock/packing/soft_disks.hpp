#pragma once

/// \file
/// Soft disks, which repel each other if they overlap: packings, their contacts and energy.
///
/// ```cpp
/// Packing const packing{.box = Box(1.0, 1.0, Edge::periodic), .x = {0.3, 0.45}, .y = {0.5, 0.5}, .radius = {0.1, 0.1}};
/// std::vector<Contact> const contacts = find_contacts(packing);
/// double const energy = energy_of(contacts, Potential::harmonic);  // ½ (1 − 0.15/0.2)²
/// ```

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The energy of two disks with the overlap δ = 1 − r/σ, σ the sum of their radii: V = (ε/α) δ^α with α = 2 (harmonic)
/// or 5/2 (Hertzian). All energies are in units of ε.
enum class Potential { harmonic, hertzian };
/// Returns the word of a potential, as in soft.potential.
char const* to_text(Potential potential);

/// Whether the shape of a periodic box is given, or found together with the positions.
enum class BoxShape { fixed, free };

/// Positions and radii of disks at rest.
struct Packing {
  Box box{1.0, 1.0, Edge::periodic};
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> radius;
  /// Number of widths by which the shift of the box has been reduced since the packing was made. A disk that had
  /// crossed m edges of y then has crossed m times as many edges of x more.
  std::int32_t widths_shifted_back = 0;

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Returns the disks of a state in the order of their Ids.
Packing packing_of(State const& state);

/// Returns the smallest diameter, the unit of length of pressures and moduli; 0 for no disks.
double smallest_diameter(Packing const& packing);
/// Returns Σ π R² over the area of the box; overlaps count twice.
double packing_fraction(Packing const& packing);

/// Two disks, or a disk and a wall, that overlap or nearly touch.
struct Contact {
  std::uint32_t first = 0;
  std::uint32_t second = 0;       ///< the other disk, with a larger number; for a wall the number of disks +
                                  ///< Counters::Wall
  Vector normal;                  ///< unit vector from the first to the second
  double distance = 0.0;          ///< r, between the centres, or from the centre to the wall
  double contact_distance = 0.0;  ///< σ, the sum of the radii, or the radius at a wall

  /// Returns δ = 1 − r/σ, below 0 for a gap.
  [[nodiscard]] double overlap() const { return 1.0 - distance / contact_distance; }
};

/// Returns V = δ^α/α of a contact; 0 for a gap.
double energy_of(Contact const& contact, Potential potential);
/// Returns the repulsive force −dV/dr = δ^(α−1)/σ; 0 for a gap.
double force_of(Contact const& contact, Potential potential);
/// Returns d²V/dr² = (α−1) δ^(α−2)/σ²; 0 for a gap.
double stiffness_of(Contact const& contact, Potential potential);

/// Returns all pairs of disks, and of disks and walls, with r < σ (1 + largest_gap), sorted by their numbers.
///
/// A periodic box must be wider than twice the largest of these distances, which are measured to the nearest image.
/// Errors: Error for a packing that require_valid() refuses and for a box that is too small.
/// Cost: that of find_pairs() with the cutoff of the two largest disks, and a sort.
std::vector<Contact> find_contacts(Packing const& packing, double largest_gap = 0.0);

/// Returns the sum of the energies of contacts.
double energy_of(std::span<Contact const> contacts, Potential potential);

/// Returns the net force on every disk.
std::vector<Vector> forces_of(std::span<Contact const> contacts, Potential potential, std::size_t disks);

/// Returns P = Σ f r / (2 A) over all contacts, in ε per area. At walls r is the distance from the centre to the wall.
double pressure_of(std::span<Contact const> contacts, Potential potential, Box const& box);

/// Throws Error for arrays of different length, numbers that are not finite, radii that are not positive, and centres
/// outside walls.
void require_valid(Packing const& packing);
/// Throws Error for a box that is periodic along one axis only: soft disks and contacts know none.
void require_equal_edges(Box const& box);

}  // namespace gridlock
