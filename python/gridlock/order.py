"""Order of crystals and its loss: correlations of order parameters, maps of pairs, Bragg peaks, defects."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import _core
from .analysis import bond_orientation, periodic_box, voronoi, voronoi_box
from .arrays import as_array, as_count, as_number, named_in_short
from .box import BoxLike
from .errors import Error
from .neighbors import as_points
from .settings import as_threads

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class OrderCorrelation(NamedTuple):
    """⟨ψ*(0) ψ(r)⟩ in bins, and g(r)."""

    distance: NDArray[np.float64]  #: middle of each bin, shape (bins,)
    correlation: NDArray[np.float64]  #: shape (bins,); not a number where the bin has no pairs
    g: NDArray[np.float64]  #: g(r), shape (bins,): the pairs of a bin are in proportion to g(r) r

    def __repr__(self) -> str:
        return named_in_short(self)


def _as_orders(order: ArrayLike, count: int) -> NDArray[np.complex128]:
    array = np.ascontiguousarray(order, dtype=np.complex128)
    if array.shape != (count,):
        raise Error(f"the orders have the shape {array.shape} for {count} points\n  hint: give one complex number for each point")
    return array


def order_correlation(
    points: ArrayLike, order: ArrayLike, box: BoxLike, *, range: float, bins: int = 200, threads: int = 1
) -> OrderCorrelation:
    """The correlation of an order parameter: the mean of Re ψᵢ* ψⱼ over the pairs at a distance.

    With ``bond_orientation(...)`` it is g₆(r), the hexatic correlation: a constant at large r in a crystal, a power of r in a
    hexatic, exponential in a liquid. With ``np.exp(1j * points @ G)``, G from :func:`structure_peak`, it is the positional
    correlation c_G(r).

    :param order: a complex number ψ for each point, shape (N,).
    :param range: the largest distance, at most half the shorter side of the periodic box.
    :param threads: 0 for all cores. The result does not depend on it.
    :raises Error: as :func:`pair_correlation`; for orders of another shape or not finite.

    Cost: up to twice that of :func:`pair_correlation`. Products are rounded to N² 2⁻⁵⁹ of the largest |ψ|².
    Source: D. R. Nelson, B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457.

    >>> points = [[x + 0.5 * (y % 2), y * 0.75**0.5] for y in np.arange(10) for x in np.arange(10)]
    >>> box = (10.0, 10 * 0.75**0.5)
    >>> found = order_correlation(points, bond_orientation(points, 1.2, box), box, range=4.0, bins=4)
    >>> bool(np.allclose(found.correlation[1:], 1))
    True
    """
    sides = periodic_box(box, "a correlation")
    array = as_points(points)
    length, count = as_number(range, "range"), as_count(bins, "bins")
    distance, g, correlation = _core.order_correlation(
        array, _as_orders(order, len(array)), sides, length, count, as_threads(threads))
    return OrderCorrelation(distance, correlation, g)


class PairCorrelationMap(NamedTuple):
    """g(x, y) around a point, in a turned frame."""

    x: NDArray[np.float64]  #: middles of the columns, shape (columns,)
    y: NDArray[np.float64]  #: middles of the rows, shape (rows,)
    g: NDArray[np.float64]  #: shape (rows, columns)
    order_correlation: NDArray[np.float64] | None  #: mean of Re ψᵢ* ψⱼ over the pairs, shape (rows, columns); None without orders

    def __repr__(self) -> str:
        return named_in_short(self)


def pair_correlation_map(
    points: ArrayLike,
    box: BoxLike,
    *,
    half: tuple[float, float],
    bins: tuple[int, int],
    angle: float = 0.0,
    order: ArrayLike | None = None,
    threads: int = 1,
) -> PairCorrelationMap:
    """The pair correlation of the plane: g(x, y) = pairs with that separation, divided by those of an ideal gas.

    One row of rectangles is g(x, 0), along a line.

    :param half: the map reaches from −half[0] to half[0] along x and from −half[1] to half[1] along y; its corners are at most
        half the shorter side of the periodic box away.
    :param bins: (columns, rows).
    :param angle: the direction of x in radians: ``np.angle(psi.mean()) / 6``, with psi of :func:`bond_orientation`, is along the
        rows of a crystal.
    :param order: a complex number for each point, shape (N,), for ``order_correlation``.
    :raises Error: as :func:`pair_correlation`, and for maps without area.

    Cost: 10 ns a pair nearer than the corners. Source: E. P. Bernard, W. Krauth (2011), doi:10.1103/PhysRevLett.107.155704.

    >>> points = [[x, y] for y in np.arange(8.0) for x in np.arange(8.0)]
    >>> pair_correlation_map(points, 8.0, half=(2.5, 0.25), bins=(5, 1)).g > 0
    array([[ True,  True, False,  True,  True]])
    """
    sides = periodic_box(box, "a map of pairs")
    array = as_points(points)
    extent = as_number(half[0], "half[0]"), as_number(half[1], "half[1]")
    counts = as_count(bins[0], "bins[0]"), as_count(bins[1], "bins[1]")
    orders = None if order is None else _as_orders(order, len(array))
    turned = as_number(angle, "the angle", "use a finite number", least=-np.inf)
    along = float(np.cos(turned)), float(np.sin(turned))
    return PairCorrelationMap(*_core.pair_correlation_map(array, sides, extent, counts, along, orders, as_threads(threads)))


class StructurePeak(NamedTuple):
    """S(q) on the wave vectors of a box in a square, and its peak."""

    at: NDArray[np.float64]  #: G, the wave vector of the largest S, shape (2,), in 1 / length
    height: float  #: S(G) / N, from 0 to 1
    wave_vectors: NDArray[np.float64]  #: all in the square, shape (M, 2)
    s: NDArray[np.float64]  #: S of each, shape (M,)

    def __repr__(self) -> str:
        return named_in_short(self)


#: |G| √(area of a point) / 2π of the first peaks of a triangular lattice; of a square one it is 1.
_TRIANGULAR = float(np.sqrt(2 / np.sqrt(3)))


def _usual_peak(points: NDArray[np.float64], box: BoxLike, area: float, threads: int) -> NDArray[np.float64]:
    """A first peak of S(q) of a triangular or a square lattice with the density and the orientation of the points."""
    cells = voronoi(points, box, threads=threads)
    six, four = (bond_orientation(points, box=box, neighbors=cells.neighbors, weights=cells.edge_lengths, k=k, threads=threads).mean()
                 for k in (6, 4))
    root = np.sqrt(len(points) / area)
    if abs(four) > abs(six):
        theta, length = np.angle(four) / 4, 2 * np.pi * root
    else:
        theta, length = np.angle(six) / 6 + np.pi / 6, 2 * np.pi * _TRIANGULAR * root
    centre: NDArray[np.float64] = length * np.array([np.cos(theta), np.sin(theta)])
    return centre


def structure_peak(
    points: ArrayLike, box: BoxLike, *, near: ArrayLike | None = None, half_width: float | None = None, threads: int = 1
) -> StructurePeak:
    """The peak of S(q) = |Σ exp(i q·r)|² / N in a square of wave vectors, and S(q) around it.

    Its height S(G)/N tends to a constant, or a power of N, in a crystal, and to 1/N without positional order.

    :param near: the middle of the square; by default where a triangular lattice of this density and orientation has a peak,
        (4π/√3 a)(cos θ, sin θ), with bonds of length a at θ + 30°; or a square lattice, (2π/a)(cos θ, sin θ) with bonds at θ, where
        the mean of ψ₄ over the Voronoi neighbours, weighted by their edges, is larger than that of ψ₆. Give it for other lattices.
    :param half_width: by default a fifth of 4π/(√3 a).
    :raises Error: for boxes that are not periodic, points that are not finite, and a square with no wave vector or more than 10⁸.

    Cost: 3 ns a point and wave vector. Source: D. R. Nelson, B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457.

    >>> points = [[x + 0.5 * (y % 2), y * 0.75**0.5] for y in np.arange(10) for x in np.arange(10)]
    >>> found = structure_peak(points, (10.0, 10 * 0.75**0.5))
    >>> round(found.height, 6), bool(np.isclose(np.hypot(*found.at), 4 * np.pi / 3**0.5))
    (1.0, True)
    """
    sides = periodic_box(box, "the structure factor")
    array = as_points(points)
    area = sides[0] * sides[1]
    if near is None:
        centre = _usual_peak(array, box, area, threads)
    else:
        centre = as_array(near, "the middle of the square is", "give (q_x, q_y)").astype(np.float64)
        if centre.shape != (2,):
            raise Error(f"the middle of the square has the shape {centre.shape}\n  hint: give (q_x, q_y)")
    half = 0.2 * 2 * np.pi * _TRIANGULAR * np.sqrt(len(array) / area) if half_width is None else as_number(half_width, "half_width")
    at, height, vectors, s = _core.structure_peak(array, sides, (float(centre[0]), float(centre[1])), float(half), as_threads(threads))
    return StructurePeak(np.array(at), height, vectors, s)


#: The kinds of clusters of defects, by their numbers.
DEFECT_KINDS = ("disclination", "dislocation", "dislocation_pair", "other")


class Defects(NamedTuple):
    """The defects of a triangular crystal: points whose Voronoi cell has not six sides, and the C clusters of them."""

    sides: NDArray[np.uint32]  #: of the cell of each point, shape (N,)
    cluster: NDArray[np.int64]  #: the cluster of each point, shape (N,); −1 for a point with six neighbours
    kind: NDArray[np.str_]  #: of each cluster, shape (C,): one of the words of :func:`defects`
    size: NDArray[np.uint32]  #: number of points of each cluster, shape (C,); the largest first
    charge: NDArray[np.int32]  #: Σ (6 − sides) of each cluster, shape (C,)
    moment: NDArray[np.float64]  #: Σ (6 − sides) r of each cluster, shape (C, 2)

    def __repr__(self) -> str:
        return named_in_short(self)

    def share(self, kind: str | None = None) -> float:
        """The share of the points that are in clusters of a kind; of all defects by default."""
        if kind is not None and kind not in DEFECT_KINDS:
            raise Error(f"the kind is {kind!r}\n  hint: use one of {', '.join(DEFECT_KINDS)}")
        return float(self.size[self.kind == kind if kind else slice(None)].sum() / max(len(self.sides), 1))


def defects(points: ArrayLike, box: BoxLike, *, threads: int = 1) -> Defects:
    """The defects of a triangular crystal, and the clusters of those whose Voronoi cells share edges.

    A point with n neighbours has the charge 6 − n. The kinds of clusters:

    - "disclination": one 5 or 7 alone;
    - "dislocation": a 5 and a 7 side by side; its moment is the vector from the 7 to the 5, perpendicular to the Burgers vector;
    - "dislocation_pair": charges +2 and −2 in all, as 5-7-5-7 or 5-8-5: two bound dislocations, a vacancy, an interstitial;
    - "other": all others.

    All charges of a periodic box together are 0. Between walls the cells at the walls have fewer sides, and count as defects.

    :raises Error: as :func:`voronoi`.

    Cost: 1 µs a point. Source: D. R. Nelson, B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457; Y. Lansac, M. A. Glaser,
    N. A. Clark (2006), doi:10.1103/PhysRevE.73.041501.

    >>> lattice = np.array([[x + 0.5 * (y % 2), y * 0.75**0.5] for y in range(10) for x in range(10)])
    >>> points = lattice + np.random.default_rng(1).normal(0.0, 0.02, lattice.shape)
    >>> found = defects(points[1:], (10.0, 10 * 0.75**0.5))
    >>> found.kind, found.charge
    (array(['dislocation_pair'], dtype='<U16'), array([0], dtype=int32))
    """
    sides = voronoi_box(box)
    found = _core.defects(as_points(points), sides, as_threads(threads))
    edges, cluster, kind, size, charge, moment = found
    numbers = cluster.astype(np.int64)
    numbers[cluster == np.iinfo(np.uint32).max] = -1
    return Defects(edges, numbers, np.array(DEFECT_KINDS)[kind], size, charge, moment)
