#pragma once

/// \file
/// The elastic moduli of a packing and its softest mode.
///
/// ```cpp
/// Packing const packing{.box = Box(1.0, 1.0, Edge::periodic), .x = {0.3, 0.45}, .y = {0.5, 0.5}, .radius = {0.1, 0.1}};
/// ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
/// std::optional<ElasticModuli> const moduli = find_elastic_moduli(packing, network);  // none: nothing carries
/// ```

#include <optional>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// The elastic tensor of a minimum in units of ε/D², D the smallest diameter: the energy per area of a box strained by
/// a symmetric e is the energy without strain + σ_ab e_ab + ½ C_abcd e_ab e_cd, after all disks have moved to the new
/// minimum.
///
/// A box with walls cannot be sheared along its sides: there xyxy, xxxy and yyxy are NaN.
struct ElasticModuli {
  double xxxx = 0.0;
  double yyyy = 0.0;
  double xyxy = 0.0;
  double xxyy = 0.0;
  double xxxy = 0.0;
  double yyxy = 0.0;

  /// Returns K = (C_xxxx + C_yyyy + 2 C_xxyy)/4. If all radii grow, φ dp/dφ = K + p/2.
  [[nodiscard]] double bulk() const { return 0.25 * (xxxx + yyyy + 2.0 * xxyy); }
  /// Returns G_xy = C_xyxy. Under simple shear the energy per area grows by ½ (G − p/2) γ².
  [[nodiscard]] double shear_xy() const { return xyxy; }
  /// Returns G_xx−yy = (C_xxxx + C_yyyy − 2 C_xxyy)/4, for a shear that makes the box longer along x and shorter along
  /// y.
  [[nodiscard]] double shear_xx_yy() const { return 0.25 * (xxxx + yyyy - 2.0 * xxyy); }
  /// Returns ⟨G⟩, the mean over all directions: (G_xy + G_xx−yy)/2; in a box with walls G_xx−yy.
  [[nodiscard]] double shear() const;
  /// Returns the shear modulus of the softest direction.
  [[nodiscard]] double min_shear() const;
  /// Returns whether every shear of the box costs energy.
  [[nodiscard]] bool is_shear_stable() const { return min_shear() > 0.0; }
};

/// Returns the elastic moduli of the backbone, with the motion u of disks in a strained box: H u = −Ξ, C = Born − Ξ H⁻¹
/// Ξ.
///
/// H is the Hessian of the backbone (in a periodic box one disk is fixed), and Ξ the force on the disks per strain.
/// Returns nothing without a backbone, with a tolerance above 0, and if H is not positive definite: no minimum, or
/// loose parts. Contract: `network` belongs to the packing. The moduli are valid only if is_converged(). Cost: one
/// sparse Cholesky factorization, about 5 ms for 1,000 disks. Source: A. Lemaître, C. Maloney (2006),
/// doi:10.1007/s10955-005-9015-5.
std::optional<ElasticModuli> find_elastic_moduli(Packing const& packing, ContactNetwork const& network);

/// Returns the modulus dσ/dγ that a finite simple shear x ← x + γ y sees: C_xyxy − p/2 + (σ_yy − σ_xx)/2.
///
/// The tensor C is that of symmetric strains; a simple shear also turns the packing, and prestress resists that. NaN in
/// a box with walls. Contract: the moduli are those of the network.
double simple_shear_modulus(ElasticModuli const& moduli, ContactNetwork const& network);
/// Returns the modulus that a finite pure shear x ← x e^(γ/2), y ← y e^(−γ/2) sees: G_xx−yy − p/2.
double pure_shear_modulus(ElasticModuli const& moduli, ContactNetwork const& network);

/// The motion of a packing as all radii grow, per d ln R.
struct GrowthResponse {
  std::vector<Vector> displacement;  ///< of each disk, in addition to the deformation of the box; 0 for rattlers
  double pure_shear = 0.0;           ///< strains of a box whose shape is free, as the next
  double simple_shear = 0.0;
};

/// Returns the motion of a minimum as all radii grow.
///
/// H u = ∂F/∂ln R, with the Hessian H of the backbone (in a periodic box one disk is fixed) and the force F on the
/// disks; where the shape of the box is free, also with the strains that keep the shear stress at 0. Returns nothing
/// where find_elastic_moduli() returns nothing, and for a free box that is not stable against shear. Cost: that of
/// find_elastic_moduli().
std::optional<GrowthResponse> find_growth_response(ContactNetwork const& network, BoxShape shape = BoxShape::fixed);

/// A vibration of the backbone.
struct VibrationMode {
  double eigenvalue = 0.0;  ///< of the Hessian: ω² for unit masses, in ε/D²; below 0 for an unstable packing
  std::vector<Vector> displacement;  ///< of every disk, with Σ u² = 1; 0 for rattlers
};

/// Returns the mode of the backbone with the smallest eigenvalue, without the two translations of a periodic packing.
///
/// Returns nothing without a backbone, and with a tolerance above 0. The sign is such that the largest component is
/// positive. Method: the dense Hessian for few disks; for many, Lanczos steps with the inverse of the sparse Hessian.
/// Errors: Error if 1,000 Lanczos steps do not find it. Contract: `network` belongs to a packing. Cost: about 10 ms for
/// 1,000 disks, 0.5 s for 10,000. Source: C. Lanczos (1950), doi:10.6028/jres.045.026.
std::optional<VibrationMode> find_softest_mode(ContactNetwork const& network);

}  // namespace gridlock
