#pragma once

/// \file
/// How stiff a packing is: its elastic moduli and its softest mode.
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

/// The elastic tensor of a minimum in units of ε/D², D the smallest diameter: the energy per area of a box whose sides
/// are strained by a symmetric e is that without strain + σ_ab e_ab + ½ C_abcd e_ab e_cd, after all disks have found
/// their new places.
///
/// Between walls a box has no angle to change: xyxy, xxxy and yyxy are no numbers.
struct ElasticModuli {
  double xxxx = 0.0;
  double yyyy = 0.0;
  double xyxy = 0.0;
  double xxyy = 0.0;
  double xxxy = 0.0;
  double yyxy = 0.0;

  /// K = (C_xxxx + C_yyyy + 2 C_xxyy)/4. As the radii scale, φ dp/dφ = K + p/2.
  [[nodiscard]] double bulk() const { return 0.25 * (xxxx + yyyy + 2.0 * xxyy); }
  /// G_xy = C_xyxy. Under simple shear the energy per area grows by ½ (G − p/2) γ².
  [[nodiscard]] double shear_xy() const { return xyxy; }
  /// G_xx−yy = (C_xxxx + C_yyyy − 2 C_xxyy)/4: the shear that makes the box longer along x and shorter along y.
  [[nodiscard]] double shear_xx_yy() const { return 0.25 * (xxxx + yyyy - 2.0 * xxyy); }
  /// ⟨G⟩, the mean over all directions: (G_xy + G_xx−yy)/2; between walls G_xx−yy.
  [[nodiscard]] double shear() const;
  /// The shear modulus of the softest direction.
  [[nodiscard]] double min_shear() const;
  /// Whether every shear of the box costs energy.
  [[nodiscard]] bool is_shear_stable() const { return min_shear() > 0.0; }
};

/// The elastic moduli of the backbone, with the motions of the disks in a strained box: H u = −Ξ, C = Born − Ξ H⁻¹ Ξ.
///
/// H is the Hessian of the backbone, of which one disk is held in a periodic box, and Ξ the force that a strain puts on
/// the disks. None without a backbone, with a tolerance above 0, and where H has a direction without a cost: no
/// minimum, or one with loose parts.
/// Contract: `network` is that of the packing. The moduli mean something only where is_converged().
/// Cost: one sparse Cholesky factorization, about 5 ms for 1,000 disks. Source: A. Lemaître, C. Maloney (2006),
/// doi:10.1007/s10955-005-9015-5.
std::optional<ElasticModuli> find_elastic_moduli(Packing const& packing, ContactNetwork const& network);

/// How the disks of a minimum move as all radii grow: du/d ln R, a displacement for each disk; 0 for rattlers.
///
/// H u = ∂F/∂ln R, with the Hessian H of the backbone, of which one disk is held in a periodic box, and the force F on
/// the disks. None where find_elastic_moduli() has none. Cost: that of find_elastic_moduli().
std::optional<std::vector<Vector>> find_growth_response(ContactNetwork const& network);

/// A vibration of the backbone.
struct VibrationMode {
  double eigenvalue = 0.0;  ///< of the Hessian, ω² of unit masses, in ε/D²; below 0 where the packing is unstable
  std::vector<Vector> displacement;  ///< of every disk, together of length 1; 0 for rattlers
};

/// The mode of the backbone with the smallest eigenvalue, but for the two that only shift a periodic packing.
///
/// None without a backbone, and with a tolerance above 0. The sign is such that the largest component is positive.
/// Few disks: all eigenvalues of the dense Hessian; many: Lanczos steps with the inverse by its Cholesky factor.
/// Errors: Error where 1,000 Lanczos steps do not find it. Contract: `network` is that of a packing.
/// Cost: about 10 ms for 1,000 disks, 0.5 s for 10,000. Source: C. Lanczos (1950), doi:10.6028/jres.045.026.
std::optional<VibrationMode> find_softest_mode(ContactNetwork const& network);

}  // namespace gridlock
