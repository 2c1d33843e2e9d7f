"""Contacts, backbone, elastic moduli and softest mode of packings, from plain arrays."""

from __future__ import annotations

import math
import numbers
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _core
from .arrays import as_count, as_number, as_numbers, named_in_short
from .box import Box, BoxLike, as_box, box_of
from .errors import Error
from .neighbors import as_points
from .settings import as_threads

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Contacts:
    """The contacts of a packing of N disks: C contacts, G gaps, F forces of the backbone.

    Energies are in ε, lengths in those of the box; pressure, stress, moduli and the softest mode are in ε/D² with D the smallest
    diameter. In ``pairs`` a wall is a disk of its own: N the left one, N + 1 right, N + 2 bottom, N + 3 top.
    """

    points: NDArray[np.float64] = field(repr=False)  #: as given, in float64; shape (N, 2)
    radii: NDArray[np.float64] = field(repr=False)  #: shape (N,)
    box: Box
    potential: str  #: ``"harmonic"`` or ``"hertzian"``
    tolerance: float

    pairs: NDArray[np.uint32] = field(repr=False)  #: the two disks of each contact, the smaller number first, sorted; shape (C, 2)
    normals: NDArray[np.float64] = field(repr=False)  #: of length 1, from the first to the second, to the nearest image; shape (C, 2)
    distances: NDArray[np.float64] = field(repr=False)  #: r, from centre to centre, or to the wall; shape (C,)
    overlaps: NDArray[np.float64] = field(repr=False)  #: δ = 1 − r/σ, below 0 for a gap; shape (C,)
    forces: NDArray[np.float64] = field(repr=False)  #: in ε per length, 0 for a gap; shape (C,)
    is_of_backbone: NDArray[np.bool_] = field(repr=False)  #: shape (C,)
    is_rattler: NDArray[np.bool_] = field(repr=False)  #: shape (N,)
    coordination: NDArray[np.uint32] = field(repr=False)  #: contacts of each disk in the backbone, shape (N,)
    gap_pairs: NDArray[np.uint32] = field(repr=False)  #: pairs that do not touch, the closest first; shape (G, 2)
    gaps: NDArray[np.float64] = field(repr=False)  #: their gaps r/σ − 1, ascending; shape (G,)
    relative_forces: NDArray[np.float64] = field(repr=False)  #: f/⟨f⟩ of the backbone, ascending; shape (F,)
    is_of_buckler: NDArray[np.bool_] = field(repr=False)  #: whether one of the two disks has exactly three contacts; shape (F,)

    packing_fraction: float  #: φ; overlaps count twice
    smallest_diameter: float  #: D
    backbone_disks: int  #: N₀
    backbone_contacts: int  #: N_c
    contact_number: float  #: Z = 2 N_c / N₀; not a number without a backbone
    mean_coordination: float  #: contacts of the backbone a disk, rattlers too
    excess_contacts: int  #: N_c − [2 (N₀ − 1) + 1], between walls N_c − (2 N₀ + 1)
    energy: float  #: of all contacts
    pressure: float  #: p = P D²/ε with P = Σ f r / (2 A)
    stress: NDArray[np.float64]  #: σ_ab = −Σ f r n_a n_b D² / (ε A), shape (2, 2)
    residual_force: float  #: the largest net force on a disk over the mean contact force
    rms_residual_force: float  #: the root mean square of the net forces over the mean contact force
    is_converged: bool  #: the root mean square is below the bound, or as small as the rounding of positions allows
    #: converged, with pressure, no fewer contacts than a rigid backbone needs, and no way down; None where that is not known: of hard disks,
    #: and without the stiffness
    is_jammed: bool | None

    bulk_modulus: float  #: K; not a number where ``is_converged`` is false, and where no strain has a cost
    shear_modulus: float  #: ⟨G⟩ over all directions: (G_xy + G_xx−yy)/2, between walls G_xx−yy
    simple_shear_modulus: float  #: dσ/dγ of x ← x + γ y: G_xy − p/2 + (σ_yy − σ_xx)/2; nan between walls
    pure_shear_modulus: float  #: dσ/dγ of x ← x e^(γ/2), y ← y e^(−γ/2): G_xx−yy − p/2
    least_shear_modulus: float  #: G of the softest direction
    elastic_constants: NDArray[np.float64]  #: C_xxxx, C_yyyy, C_xyxy, C_xxyy, C_xxxy, C_yyxy; between walls no numbers for those with xy
    softest_mode: float  #: the smallest eigenvalue of the Hessian of the backbone but for shifts; below 0 where the packing is unstable
    softest_displacements: NDArray[np.float64] = field(repr=False)  #: of this mode, together of length 1; shape (N, 2)

    @property
    def rattler_share(self) -> float:
        """Rattlers over all disks."""
        return float(self.is_rattler.mean()) if len(self.is_rattler) > 0 else math.nan

    @property
    def shear_moduli(self) -> tuple[float, float]:
        """G_xy = C_xyxy and G_xx−yy = (C_xxxx + C_yyyy − 2 C_xxyy)/4."""
        xxxx, yyyy, xyxy, xxyy, _, _ = self.elastic_constants.tolist()
        return xyxy, (xxxx + yyyy - 2.0 * xxyy) / 4.0

    @property
    def is_shear_stable(self) -> bool:
        """Whether every shear of the box costs energy."""
        return self.least_shear_modulus > 0.0


def contacts(
    points: ArrayLike,
    radii: ArrayLike,
    box: BoxLike,
    *,
    potential: str = "harmonic",
    tolerance: float = 0.0,
    largest_gap: float = 0.1,
    residual: float = 1e-8,
    stiffness: bool = True,
) -> Contacts:
    """The contacts of a packing, which disks rattle, and how stiff the rest is.

    Disks repel each other where they overlap, V = (ε/α) δ^α with δ = 1 − r/σ, σ the sum of the radii. A rattler has fewer than three
    contacts with the backbone or with walls. The elastic constants are those of a minimum, with the motions of the disks in a strained
    box: its energy per area grows by σ_ab e_ab + ½ C_abcd e_ab e_cd. So φ dp/dφ = K + p/2 as the radii scale.

    :param points: shape (N, 2); float64 in one piece is read where it is, anything else is copied. Coordinates outside a periodic box
        are those of the image inside. In single precision, disks that touch overlap or miss each other by some 10⁻⁷ of their distance.
    :param radii: shape (N,), or one number for all; copied as the points are.
    :param box: periodic, or ``Box(width, height, periodic=False)``.
    :param potential: ``"harmonic"``, α = 2, or ``"hertzian"``, α = 5/2.
    :param tolerance: pairs with a gap r/σ − 1 below it are contacts too. Hard disks, which do not overlap, have contacts only so; they
        get a backbone, but no forces and moduli.
    :param largest_gap: of ``gaps``, from 0 to 1.
    :param residual: the largest share of the mean contact force that the root mean square of the net forces of a minimum may have; a
        single net force may have 100 times it.
    :param stiffness: False leaves out the elastic constants and the softest mode, which take most of the time. Then nobody knows whether
        forces that balance do so at a saddle: ``is_jammed`` is None in place of True.
    :raises Error: without a box, for points outside walls, radii that are not positive, overlaps δ above ½, which no packing has, and
        periodic boxes in which a disk could touch two images of another.

    Cost: 1 µs a contact; the stiffness about 20 ms for 1,000 disks, 0.6 s for 10,000. Source: C. S. O'Hern et al. (2003), doi:10.1103/PhysRevE.68.011306;
    A. Lemaître, C. Maloney (2006), doi:10.1007/s10955-005-9015-5.

    >>> x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    >>> rows = np.column_stack([(x + y % 2 / 2).ravel(), np.sqrt(0.75) * y.ravel()])  # a triangular lattice
    >>> found = contacts(rows, 0.501, (4.0, 4.0 * np.sqrt(0.75)))
    >>> found.contact_number, found.excess_contacts, found.is_jammed
    (6.0, 17, True)
    >>> [round(value, 3) for value in (found.pressure, found.bulk_modulus, found.shear_modulus)]
    [0.003, 0.866, 0.432]
    """
    array = as_numbers(as_points(points), "the points", (None, 2), "use an array of shape (N, 2): x and y of each point")
    sides = as_box(box)
    if sides is None:
        raise Error("the contacts of a packing need a box\n  hint: give box=(width, height), or Box(width, height, periodic=False)")
    if potential not in ("harmonic", "hertzian"):
        raise Error(f"the potential is {potential!r}\n  hint: use \"harmonic\" or \"hertzian\"")
    if not isinstance(stiffness, (bool, np.bool_)):
        raise Error(f"stiffness is {stiffness!r}\n  hint: use True or False")
    sizes = _as_radii(radii, len(array))
    found: dict[str, Any] = _core.contacts(
        array, sizes, sides, potential == "harmonic", _as_share(tolerance, "the tolerance"), _as_share(largest_gap, "the largest gap"),
        as_number(residual, "the residual"), bool(stiffness))
    return _contacts_of(array, sizes, box_of(sides), potential, float(tolerance), found)


def _contacts_of(points: Any, radii: Any, box: Box, potential: str, tolerance: float, found: dict[str, Any]) -> Contacts:
    for name in ("is_of_backbone", "is_rattler", "is_of_buckler"):
        found[name] = found[name].view(np.bool_)
    xx, yy, xy = found["stress"]
    found["stress"] = np.array([[xx, xy], [xy, yy]])
    found["gaps"] = -found.pop("gap_overlaps")
    for name in ("gap_normals", "gap_distances"):
        del found[name]
    for name in ("bulk_modulus", "shear_modulus", "simple_shear_modulus", "pure_shear_modulus", "least_shear_modulus", "softest_mode"):
        found.setdefault(name, math.nan)
    found["elastic_constants"] = np.array(found.get("elastic_constants", (math.nan,) * 6))
    found.setdefault("softest_displacements", np.full((len(points), 2), math.nan))
    return Contacts(points=points, radii=radii, box=box, potential=potential, tolerance=tolerance, **found)


def _as_share(value: Any, what: str) -> float:
    """A gap over a contact distance."""
    hint = "it is a gap over the contact distance: use a number from 0 to 1"
    share = as_number(value, what, hint, least=-1e-300)
    if share > 1.0:
        raise Error(f"{what} is {value!r}\n  hint: {hint}")
    return share


def _as_radii(radii: Any, count: int) -> NDArray[np.float64]:
    hint = f"give one number above 0 for each of the {count} disks, or one for all"
    if isinstance(radii, numbers.Real) or (isinstance(radii, np.ndarray) and radii.ndim == 0):
        return np.full(count, as_number(radii, "the radius", hint))
    sizes = as_numbers(radii, "the radii", (count,), hint)
    if (sizes <= 0.0).any():
        disk = int(np.flatnonzero(sizes <= 0.0)[0])
        raise Error(f"the radius of disk {disk} is {sizes[disk]}\n  hint: {hint}")
    return sizes


class SpectralDensity(NamedTuple):
    """χ_V(q) in rings of wave vectors of the box."""

    q: NDArray[np.float64]  #: mean length of the wave vectors of a ring, shape (rings,)
    density: NDArray[np.float64]  #: mean of χ_V over them, in length²; shape (rings,)
    vectors: NDArray[np.uint64]  #: how many there are, one of every two opposite ones; shape (rings,)

    def __repr__(self) -> str:
        return named_in_short(self)


def spectral_density(
    points: ArrayLike, radii: ArrayLike, box: BoxLike, *, largest_q: float, bins: int = 100, threads: int = 1
) -> SpectralDensity:
    """χ_V(q) = |Σ exp(i q·r) 2π R J₁(q R)/q|² / A of the disks in a periodic box, averaged over rings of equal width.

    It vanishes for q → 0 where the disks are hyperuniform, for disks of several sizes too, whose structure factor does not.

    :param radii: shape (N,), or one number for all.
    :param largest_q: the end of the rings, in 1 / length.
    :param threads: 0 for all cores. The result does not depend on it.
    :returns: rings that have wave vectors, the lengths ascending.
    :raises Error: for boxes that are not periodic, radii that are not positive, and more than 10⁸ wave vectors.

    Cost: 2 ns a disk and wave vector. Source: C. E. Zachary, Y. Jiao, S. Torquato (2011), doi:10.1103/PhysRevE.83.051308.

    >>> found = spectral_density([[0.2, 0.3]], 0.1, box=1.0, largest_q=10.0, bins=1)
    >>> found.vectors  # (1, 0), (0, 1), (1, 1) and (1, −1) times 2π
    array([4], dtype=uint64)
    >>> round(float(found.density[0] / (0.01 * np.pi) ** 2), 3)  # near 1: the square of the area of the disk
    0.862
    """
    array = as_numbers(as_points(points), "the points", (None, 2), "use an array of shape (N, 2): x and y of each point")
    sides = as_box(box)
    if sides is None or not (sides[2] and sides[3]):
        raise Error("the spectral density needs a box that is periodic in x and y\n  hint: give box=(width, height)")
    return SpectralDensity(*_core.spectral_density(array, _as_radii(radii, len(array)), sides, as_number(largest_q, "largest_q"),
                                                   as_count(bins, "bins"), as_threads(threads)))
