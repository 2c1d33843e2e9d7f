#pragma once

/// \file
/// The contacts of a packing: its backbone, its rattlers, and its energy, pressure and forces.
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

/// The stress tensor σ_ab = −Σ f r n_a n_b / A over all contacts, in ε/D²; σ_xx and σ_yy are below 0 under pressure.
struct StressTensor {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;

  /// Adds a contact; `force` is its force over the area, in ε/D² per length.
  void add(Contact const& contact, double force) {
    double const virial = force * contact.distance;
    xx -= virial * contact.normal.x * contact.normal.x;
    yy -= virial * contact.normal.y * contact.normal.y;
    xy -= virial * contact.normal.x * contact.normal.y;
  }
};

/// The default bound on the root mean square of the net forces in a minimum, over the mean contact force.
inline constexpr double usual_largest_residual = 1e-8;
/// Energy of a disk, in ε, below which disks count as not overlapping; Minimizer then ends its search.
inline constexpr double min_energy_of_a_disk = 1e-16;
/// Returns a lower bound on the eigenvalues of a minimum at a pressure, in ε/D². A saddle has an eigenvalue of the
/// order of −p (−4p for a square lattice); rounding can give eigenvalues between this bound and 0.
constexpr double min_eigenvalue_of_a_minimum(double pressure) { return -(0.1 * pressure + 1e-14); }

/// The contacts of a packing and their sums.
///
/// A *rattler* has fewer than three contacts with disks of the backbone or with walls. Rattlers are removed until none
/// is left; the rest is the *backbone*: N₀ disks with N_c contacts among themselves and with walls. Energies are in ε,
/// lengths in the unit of the box, pressure and stress in ε/D² with the smallest diameter D.
struct ContactNetwork {
  Potential potential = Potential::harmonic;
  bool is_periodic = true;
  double tolerance = 0.0;

  std::vector<Contact> contacts;            ///< all contacts within the tolerance, also of rattlers, sorted
  std::vector<double> forces;               ///< one for each contact, in ε per length; 0 for a gap
  std::vector<bool> is_of_backbone;         ///< one for each contact
  std::vector<bool> is_rattler;             ///< one for each disk
  std::vector<std::uint32_t> coordination;  ///< number of contacts of each disk in the backbone; 0 for a rattler

  std::size_t backbone_disks = 0;     ///< N₀
  std::size_t backbone_contacts = 0;  ///< N_c

  double energy = 0.0;    ///< energy of all contacts
  double pressure = 0.0;  ///< p = P D²/ε, P = Σ f r / (2 A)
  StressTensor stress;
  double mean_force = 0.0;          ///< mean over the contacts that overlap
  double residual_force = 0.0;      ///< the largest net force on a disk over the mean force; 0 without forces
  double rms_residual_force = 0.0;  ///< root mean square of the net forces over the mean force
  double rounding_residual =
      0.0;  ///< part of residual_force from rounding of positions: 2⁻⁴⁹ L/(D δ̄), L the longer side, δ̄ the mean
            ///< overlap; at most 10⁻³
  double smallest_diameter = 0.0;  ///< the smallest diameter D

  [[nodiscard]] std::size_t size() const { return is_rattler.size(); }
  /// Returns Z = 2 N_c / N₀; NaN without a backbone.
  [[nodiscard]] double contact_number() const;
  /// Returns the mean of `coordination` over all disks, also rattlers; NaN for no disks.
  [[nodiscard]] double mean_coordination() const;
  /// Returns N_c − [2 (N₀ − 1) + 1] in a periodic box, N_c − (2 N₀ + 1) in a box with walls: 0 for one state of
  /// self-stress. 0 without a backbone.
  [[nodiscard]] std::int64_t excess_contacts() const;
  /// Returns the contacts of the backbone.
  [[nodiscard]] std::vector<Contact> backbone() const;

  /// Returns whether all forces balance as far as rounding allows, as in a minimum of the energy or a saddle: the root
  /// mean square of the net forces over the mean contact force is at most `largest_residual`, and no net force is above
  /// 100 times that.
  [[nodiscard]] bool is_converged(double largest_residual = usual_largest_residual) const;
  /// Returns whether the packing is jammed: its pressure is above 0, forces balance, the backbone has enough contacts,
  /// and no motion lowers the energy.
  ///
  /// `softest_mode` is the eigenvalue of find_softest_mode(): below min_eigenvalue_of_a_minimum() the packing is a
  /// saddle. Returns nothing if it is not known: if all other conditions hold and `softest_mode` is empty, or with a
  /// tolerance above 0, since such contacts may bear no force.
  [[nodiscard]] std::optional<bool> is_jammed(double largest_residual, std::optional<double> softest_mode) const;
};

/// Finds the contacts of a packing, its backbone, and its energy, pressure and forces.
///
/// With a tolerance above 0, for hard disks, which do not overlap, all pairs with r < σ (1 + tolerance) are contacts
/// and count for the backbone. Only contacts that overlap have a force and enter energy, pressure and residual. The
/// order of the disks changes the result only by the rounding of sums.
/// Errors: those of find_contacts(), and Error for a tolerance that is not from 0 to 1 and for overlaps δ above ½.
/// Cost: that of find_contacts().
/// Source: C. S. O'Hern, L. E. Silbert, A. J. Liu, S. R. Nagel (2003), doi:10.1103/PhysRevE.68.011306; the excess:
/// C. P. Goodrich, A. J. Liu, S. R. Nagel (2012), doi:10.1103/PhysRevLett.109.095704.
ContactNetwork find_contact_network(Packing const& packing, Potential potential, double tolerance = 0.0);

/// Returns the pairs with r < σ (1 + largest_gap) that are no contacts of the network, the smallest gap first.
///
/// Errors: those of find_contacts(), and Error for a largest gap that is not from 0 to 1.
std::vector<Contact> find_gaps(Packing const& packing, ContactNetwork const& network, double largest_gap);

/// A contact force of the backbone over the mean contact force of the backbone.
struct RelativeForce {
  std::size_t contact = 0;     ///< index in ContactNetwork::contacts
  double force = 0.0;          ///< contact force over its mean, f/⟨f⟩
  bool is_of_buckler = false;  ///< whether one of its disks is a buckler: it has exactly three contacts
};

/// Returns the forces of the backbone that are above 0, the weakest first.
///
/// Source: P. Charbonneau, E. I. Corwin, G. Parisi, F. Zamponi (2015), doi:10.1103/PhysRevLett.114.125504.
std::vector<RelativeForce> relative_forces_of(ContactNetwork const& network);

}  // namespace gridlock
