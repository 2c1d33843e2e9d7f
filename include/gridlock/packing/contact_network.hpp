#pragma once

/// \file
/// The contacts of a packing: which of them carry it, which disks rattle, and what they add up to.
///
/// ```cpp
/// Packing const packing{.box = Box(1.0, 1.0, Edge::periodic), .x = {0.3, 0.45}, .y = {0.5, 0.5}, .radius = {0.1, 0.1}};
/// ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
/// std::size_t const rattlers = packing.size() - network.backbone_disks;  // 2: one contact does not hold a disk
/// std::vector<Contact> const gaps = find_gaps(packing, network, 0.1);
/// ```

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// σ_ab = −Σ f r n_a n_b / A over all contacts, in ε/D²; below 0 for pressure.
struct StressTensor {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
};

/// A minimum has no root mean square of the net forces above this share of the mean contact force.
inline constexpr double usual_largest_residual = 1e-8;
/// Energy of a disk, in ε, below which it does not overlap; there Minimizer ends its search.
inline constexpr double min_energy_of_a_disk = 1e-16;
/// A minimum at that pressure has no mode with an eigenvalue below this, in ε/D². The way down from a saddle curves by
/// some multiple of the pressure, −4p for a square lattice; what is above this bound may be rounding.
constexpr double min_eigenvalue_of_a_minimum(double pressure) { return -(0.1 * pressure + 1e-14); }

/// The contacts of a packing.
///
/// A *rattler* has fewer than three contacts with disks of the backbone or with walls; such disks are taken away again
/// and again until none is left, and the rest is the *backbone*: N₀ disks with N_c contacts among themselves and with
/// walls. Energies are in ε, lengths in those of the box, pressure and stress in ε/D² with the smallest diameter D.
struct ContactNetwork {
  Potential potential = Potential::harmonic;
  bool is_periodic = true;
  double tolerance = 0.0;

  std::vector<Contact> contacts;     ///< all that overlap or are within the tolerance, those of rattlers too, sorted
  std::vector<double> forces;        ///< of each contact, in ε per length; 0 for a gap
  std::vector<bool> is_of_backbone;  ///< of each contact
  std::vector<bool> is_rattler;      ///< of each disk
  std::vector<std::uint32_t> coordination;  ///< of each disk: its contacts in the backbone; 0 for a rattler

  std::size_t backbone_disks = 0;     ///< N₀
  std::size_t backbone_contacts = 0;  ///< N_c

  double energy = 0.0;    ///< of all contacts
  double pressure = 0.0;  ///< p = P D²/ε, P = Σ f r / (2 A)
  StressTensor stress;
  double mean_force = 0.0;          ///< over the contacts that overlap
  double residual_force = 0.0;      ///< the largest net force on a disk over the mean force; 0 without forces
  double rms_residual_force = 0.0;  ///< the same of the root mean square over all disks
  double rounding_residual =
      0.0;  ///< what the rounding of positions alone makes of it: 2⁻⁴⁹ L/(D δ̄), L the longer side, δ̄ the mean overlap; at most 10⁻³
  double smallest_diameter = 0.0;  ///< D

  [[nodiscard]] std::size_t size() const { return is_rattler.size(); }
  /// Z = 2 N_c / N₀; no number without a backbone.
  [[nodiscard]] double contact_number() const;
  /// Contacts of the backbone that a disk has on average over all disks, rattlers too; no number for no disks.
  [[nodiscard]] double mean_coordination() const;
  /// N_c − [2 (N₀ − 1) + 1] in a periodic box, N_c − (2 N₀ + 1) between walls: 0 for one state of self-stress. 0
  /// without a backbone.
  [[nodiscard]] std::int64_t excess_contacts() const;
  /// The contacts of the backbone.
  [[nodiscard]] std::vector<Contact> backbone() const;

  /// Whether all forces balance as far as rounding allows: a minimum of the energy, or a saddle. So it is where the
  /// root mean square of the net forces, which is what most programs bound, is at most this share of the mean contact
  /// force, and no net force is above 100 times it.
  [[nodiscard]] bool is_converged(double largest_residual = usual_largest_residual) const;
  /// Pressure above 0 and forces that balance, on a backbone that has as many contacts as it needs, and no way down.
  ///
  /// The softest mode is the eigenvalue of find_softest_mode(): below min_eigenvalue_of_a_minimum() the packing is a
  /// saddle. Nothing where it is not given and all else holds: then nobody knows. Nothing with a tolerance above 0
  /// either, for such contacts need carry no force.
  [[nodiscard]] std::optional<bool> is_jammed(double largest_residual, std::optional<double> softest_mode) const;
};

/// The contacts of a packing, its backbone, and what they add up to.
///
/// With a tolerance above 0 all pairs with r < σ (1 + tolerance) are contacts, as for hard disks, which have no
/// overlaps: all count for the backbone, and only those that overlap carry a force. Energy, pressure and residual are
/// of these, numbers of contacts of all. The result is the same for disks in another order, but for the rounding of
/// sums.
/// Errors: those of find_contacts(), and Error for a tolerance that is not from 0 to 1 and for overlaps δ above ½.
/// Cost: that of find_contacts().
/// Source: C. S. O'Hern, L. E. Silbert, A. J. Liu, S. R. Nagel (2003), doi:10.1103/PhysRevE.68.011306; the excess:
/// C. P. Goodrich, A. J. Liu, S. R. Nagel (2012), doi:10.1103/PhysRevLett.109.095704.
ContactNetwork find_contact_network(Packing const& packing, Potential potential, double tolerance = 0.0);

/// The pairs that are no contacts of the network and closer than r = σ (1 + largest_gap), the closest first.
///
/// Errors: those of find_contacts(), and Error for a largest gap that is not from 0 to 1.
std::vector<Contact> find_gaps(Packing const& packing, ContactNetwork const& network, double largest_gap);

/// A contact force of the backbone over the mean of the backbone.
struct RelativeForce {
  std::size_t contact = 0;     ///< its number in ContactNetwork::contacts
  double force = 0.0;          ///< f/⟨f⟩
  bool is_of_buckler = false;  ///< one of its disks has exactly three contacts, and buckles where it is pushed
};

/// The forces of the backbone that are above 0, the weakest first.
///
/// Source: P. Charbonneau, E. I. Corwin, G. Parisi, F. Zamponi (2015), doi:10.1103/PhysRevLett.114.125504.
std::vector<RelativeForce> relative_forces_of(ContactNetwork const& network);

}  // namespace gridlock
