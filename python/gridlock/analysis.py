"""Analysis of plain arrays: pair correlation, Voronoi cells, bond orientation order, clusters, density profiles, displacements,
structure factor."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import _core
from .arrays import as_array, as_count, as_kinds, as_number, named_in_short
from .box import Box, BoxLike, BoxValues, as_box
from .dynamics import as_trajectory
from .errors import Error
from .neighbors import Neighbors, as_neighbors, as_points, as_radii, pairs_of_disks
from .neighbors import neighbors as find_neighbors
from .settings import as_threads

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class PairCorrelation(NamedTuple):
    """g(r) in bins."""

    distance: NDArray[np.float64]  #: middle of each bin, shape (bins,)
    g: NDArray[np.float64]  #: shape (bins,), or (kinds, kinds, bins) where kinds were given

    def __repr__(self) -> str:
        return named_in_short(self)


def periodic_box(box: BoxLike, what: str) -> BoxValues:
    sides = as_box(box)
    if sides is None or not (sides[2] and sides[3]):
        raise Error(f"{what} needs a box that is periodic in x and y\n  hint: give box=(width, height)")
    return sides


def separations(points: ArrayLike, i: ArrayLike, j: ArrayLike, box: BoxLike = None) -> NDArray[np.float64]:
    """The vectors from points i to points j, to the nearest image along periodic axes; shape (P, 2).

    In a sheared box it is the nearest one where that is nearer than half the shorter side.

    :param i, j: indices of points, shape (P,) each, such as ``i, j = pairs(...).T``.

    >>> separations([[0.1, 0.5], [0.9, 0.5]], [0], [1], box=1.0)
    array([[-0.2,  0. ]])
    """
    array = as_points(points)
    hint = "use two arrays of whole numbers of one length"
    ends = [as_array(k, "the indices of points are", hint, integers=True) for k in (i, j)]
    if ends[0].ndim != 1 or ends[0].shape != ends[1].shape:
        raise Error(f"the indices of points have the shapes {ends[0].shape} and {ends[1].shape}\n  hint: {hint}")
    for k in ends:
        if len(k) and not 0 <= k.min() <= k.max() < len(array):
            raise Error(f"there is no point {k.max()} among {len(array)}\n  hint: use indices of the points")
    first, second = (k.astype(np.intp) for k in ends)  # an empty list has the type of numbers, not of indices
    difference = array[second] - array[first]
    sides = as_box(box)
    for axis in (1, 0):
        if sides is not None and sides[2 + axis]:
            boxes = np.round(difference[:, axis] / sides[axis])
            difference[:, axis] -= sides[axis] * boxes
            if axis == 1:
                difference[:, 0] -= sides[4] * boxes
    separated: NDArray[np.float64] = difference
    return separated


def pair_correlation(
    points: ArrayLike, box: BoxLike, *, range: float, bins: int = 200, kinds: ArrayLike | None = None, threads: int = 1
) -> PairCorrelation:
    """The pair correlation of points in a periodic box, of every two kinds where they have kinds.

    g(r) = pairs in the bin / (N (N − 1) / 2 · area of the ring / area of the box); 1 for an ideal gas. Of two kinds a and b,
    g_ab(r) = pairs of an a and a b in the bin / (N_a N_b · area of the ring / area of the box).

    :param range: the largest distance, at most half the shorter side.
    :param kinds: a whole number for each point, shape (N,). ``g[a, b]`` belongs to the kinds with the lowest, next … number; it
        is ``g[b, a]``, and not a number where there is no such pair.
    :param threads: 0 for all cores. The result does not depend on it.
    :returns: distances of shape (bins,), and g of shape (bins,) or (kinds, kinds, bins).
    :raises Error: for points, boxes and ranges that cannot be searched, and more than 10⁷ bins of all pairs of kinds together.

    Cost: 10 ns a pair in the range. Source: J.-P. Hansen, I. R. McDonald, Theory of Simple Liquids (2013), chapter 2.

    >>> points = np.random.default_rng(1).random((20000, 2))
    >>> found = pair_correlation(points, box=1.0, range=0.1, bins=5)
    >>> bool(np.all(abs(found.g - 1) < 0.05))
    True
    >>> pair_correlation(points, box=1.0, range=0.1, bins=5, kinds=np.arange(20000) % 2).g.shape
    (2, 2, 5)
    """
    sides = periodic_box(box, "the pair correlation")
    array = as_points(points)
    labels = None if kinds is None else as_kinds(kinds, len(array))
    length, count = as_number(range, "range"), as_count(bins, "bins")
    distance, g = _core.pair_correlation(array, sides, length, count, labels, as_threads(threads))
    return PairCorrelation(distance, g if labels is not None else g[0, 0])


class Voronoi(NamedTuple):
    """The Voronoi cells of N points."""

    neighbors: Neighbors  #: whose cells share an edge, counterclockwise
    areas: NDArray[np.float64]  #: shape (N,); together the area of the box
    edge_lengths: NDArray[np.float64]  #: of the edge with each entry of ``neighbors.indices``

    def __repr__(self) -> str:
        return named_in_short(self)

    @property
    def sides(self) -> NDArray[np.int64]:
        """How many edges each cell has with other cells, shape (N,): 5 and 7 are the defects of a triangular lattice."""
        return self.neighbors.counts


def voronoi_box(box: BoxLike) -> BoxValues:
    sides = as_box(box)
    if sides is None:
        raise Error("Voronoi cells need a box\n  hint: give box=(width, height), or Box(width, height, periodic=False)")
    return sides


def voronoi(points: ArrayLike, box: BoxLike, *, threads: int = 1) -> Voronoi:
    """The Voronoi cell of every point: all places of the box that are nearer to it than to any other point or image of one.

    :param points: shape (N, 2).
    :param box: periodic, or ``Box(width, height, periodic=False)``, whose walls cut the cells: points are neighbours where
        their cells share an edge inside.
    :param threads: 0 for all cores. The result does not depend on it.
    :returns: neighbours in compressed sparse rows, areas, and the lengths of the edges. In a periodic box of few points a point can be a neighbour twice,
        and its own, through the edges.
    :raises Error: without a box, for points at the same place, outside walls or not finite.

    Edges shorter than 10⁻⁹ of the cell do not count: on a square lattice, where four cells meet, every point has four neighbours.

    Cost: 1 µs a point where they are even; up to 40 ns · N a point where nearly all are on a line or in a small part of the box.
    Source: G. Voronoi (1908), doi:10.1515/crll.1908.134.198; C. H. Rycroft (2009), doi:10.1063/1.3215722.

    >>> found = voronoi([[0.2, 0.5], [0.8, 0.5]], Box(1.0, 1.0, periodic=False))
    >>> found.areas
    array([0.5, 0.5])
    >>> found.neighbors.of(0)
    array([1], dtype=uint32)
    """
    sides = voronoi_box(box)
    begin, found, areas, edges = _core.voronoi(as_points(points), sides, as_threads(threads))
    return Voronoi(Neighbors(begin, found), areas, edges)


def bond_orientation(
    points: ArrayLike,
    cutoff: float | None = None,
    box: BoxLike = None,
    *,
    neighbors: Neighbors | None = None,
    weights: ArrayLike | None = None,
    k: int = 6,
    threads: int = 1,
) -> NDArray[np.complex128]:
    """ψ_k of every point: the mean of exp(i k θ) over the directions θ to its neighbours; 0 without neighbours.

    With weights w it is Σ w exp(i k θ) / Σ w. The lengths of Voronoi edges as weights make it a Minkowski structure metric, which
    does not jump where a neighbour comes or goes.

    :param cutoff: all points nearer than this are neighbours.
    :param neighbors: in place of the cutoff: ``voronoi(points, box).neighbors``, or any others.
    :param weights: one number, not negative, for each entry of ``neighbors.indices``, such as ``voronoi(points, box).edge_lengths``.
    :returns: shape (N,), complex. ``abs(psi).mean()`` is the local order, ``abs(psi.mean())`` the global one.
    :raises Error: where cutoff and neighbours are both given or both missing, for weights without neighbours or of another
        number, and for lists in which a point is its own neighbour
        or has one twice.

    In a periodic box the direction to a neighbour is that to its nearest image. Beside voids wider than half the box a Voronoi
    cell can touch another image than that one.

    Source: D. R. Nelson, B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457; on the choice of neighbours W. Mickel et al.
    (2013), doi:10.1063/1.4774084.

    >>> square = [[x, y] for x in range(4) for y in range(4)]
    >>> bool(np.allclose(abs(bond_orientation(square, 1.2, box=4.0, k=4)), 1))
    True
    >>> bool(np.allclose(abs(bond_orientation(square, box=4.0, neighbors=voronoi(square, 4.0).neighbors, k=4)), 1))
    True
    """
    array = as_points(points)
    if (cutoff is None) == (neighbors is None):
        raise Error("neighbours are those within a cutoff, or those of a list\n  hint: give one of cutoff and neighbors")
    if cutoff is not None:
        found = find_neighbors(array, cutoff, box, threads=threads)
    else:
        found = as_neighbors(neighbors, len(array))
    order = as_count(k, "k")
    counts = found.counts
    i = found.owners
    x, y = separations(array, i, found.indices, box).T
    if neighbors is not None:
        _expect_one_image_each(i, found.indices, len(array))
    angles = np.exp(1j * order * np.arctan2(y, x))
    if weights is not None:
        scales = _weights(weights, neighbors, len(i))
        angles *= scales
        counts = np.bincount(i, scales, len(array))
    sums = np.bincount(i, angles.real, len(array)) + 1j * np.bincount(i, angles.imag, len(array))
    return np.where(counts > 0, sums / np.where(counts > 0, counts, 1), 0.0)


def _weights(weights: ArrayLike, neighbors: Neighbors | None, count: int) -> NDArray[np.float64]:
    hint = "give one number, not negative, for each entry of neighbors.indices, such as voronoi(points, box).edge_lengths"
    array = as_array(weights, "the weights are", hint).astype(np.float64)
    if neighbors is None or array.shape != (count,) or not (np.isfinite(array) & (array >= 0)).all():
        raise Error(f"the weights have the shape {array.shape} for {count} neighbours\n  hint: {hint}")
    return array


def _expect_one_image_each(i: NDArray[np.int64], j: NDArray[np.uint32], count: int) -> None:
    """Refuses neighbours whose direction is not one: in a small box the cells of a point meet several images of another."""
    own = int((i == j).sum())
    repeated = int((np.diff(np.sort(i * count + j)) == 0).sum())
    if own > 0 or repeated > 0:
        raise Error(f"{own} neighbours are the points themselves and {repeated} stand in a list twice, so that they have no one direction\n"
                    "  hint: the box is too small for Voronoi neighbours; use a larger one, or a cutoff")


def clusters(centers: ArrayLike, radius: ArrayLike, box: BoxLike, *, cutoff: float = 1.1, threads: int = 1) -> NDArray[np.uint32]:
    """The cluster of every disk. Two disks are in one cluster if their centres are nearer than cutoff · (Rᵢ + Rⱼ), or if a chain of
    such pairs joins them.

    ``np.bincount(clusters(…))`` has the number of disks of each cluster.

    :param centers: shape (N, 2).
    :param radius: shape (N,), or one radius for all.
    :param cutoff: above 0. In a periodic box two of the largest disks must not reach further than half its shorter side.
    :param threads: 0 for all cores. The result does not depend on it.
    :returns: shape (N,): 0 for the disks of the largest cluster, 1 for those of the next … Of two clusters of one size that with the
        first disk comes first.
    :raises Error: as :func:`pairs_of_disks`.

    Cost: that of :func:`pairs_of_disks`, and 10 ns a pair. Source: D. Stauffer, A. Aharony, Introduction to Percolation Theory (1994).

    >>> clusters([[0.5, 0.5], [3.0, 0.5], [4.0, 0.5], [7.8, 0.5]], 0.5, box=(8.0, 3.0))
    array([0, 1, 1, 0], dtype=uint32)
    """
    count = len(as_points(centers))
    i, j = pairs_of_disks(centers, radius, box, factor=as_number(cutoff, "the cutoff"), threads=threads).T
    found: NDArray[np.uint32] = _core.clusters(count, i, j)
    return found


class DensityProfile(NamedTuple):
    """The density in strips of equal width along x or y."""

    position: NDArray[np.float64]  #: middle of each strip, shape (bins,)
    number_density: NDArray[np.float64]  #: centres in the strip over its area, shape (bins,)
    packing_fraction: NDArray[np.float64] | None  #: area of disks inside the strip over its area; None where no radius was given

    def __repr__(self) -> str:
        return named_in_short(self)


def density_profile(
    points: ArrayLike, box: BoxLike, *, axis: str = "y", bins: int = 50, radius: ArrayLike | None = None
) -> DensityProfile:
    """The density of points or disks in strips across the box, one after the other along an axis.

    A disk that crosses the border of two strips covers a part of each, so that its packing fraction is exact for strips of any
    width. For equal disks an equation of state needs ``number_density`` · πR².

    :param points: shape (N, 2), inside the box; in a periodic box any image.
    :param axis: "x" or "y".
    :param radius: shape (N,), or one radius for all; for the packing fraction.
    :raises Error: for points that are not finite or beyond a wall.

    Cost: O(N) without, O(N · bins) with a radius, 50 ns each. Source: J.-P. Hansen, I. R. McDonald, Theory of Simple Liquids (2013), chapter 6.

    >>> density_profile([[1.0, 0.5], [1.0, 2.5], [3.0, 2.7]], (4.0, 3.0), bins=3).number_density
    array([0.25, 0.  , 0.5 ])
    """
    array, sides, count = as_points(points), as_box(box), as_count(bins, "bins")
    if sides is None:
        raise Error("a density profile needs a box\n  hint: give box=(width, height), or Box(width, height, periodic=False)")
    if axis not in ("x", "y"):
        raise Error(f"the axis is {axis!r}\n  hint: use \"x\" or \"y\"")
    if not np.isfinite(array).all():
        raise Error("a point is not finite\n  hint: every coordinate must be finite")
    if axis == "x" and sides[4] != 0:
        raise Error("a sheared box has no density profile along x: its images above are not straight above\n  hint: use axis=\"y\"")
    side = sides[0] if axis == "x" else sides[1]
    place = array[:, 0 if axis == "x" else 1]
    is_periodic = sides[2] if axis == "x" else sides[3]
    if is_periodic:
        place = place - side * np.floor(place / side)
    elif len(place) and not 0 <= place.min() <= place.max() <= side:
        raise Error(f"a point has {axis} = {place.min() if place.min() < 0 else place.max():g} in a box from 0 to {side:g}\n  hint: use points inside")
    edges = side * np.arange(count + 1) / count
    area = sides[0] * sides[1] / count
    strip = np.clip((place / side * count).astype(np.intp), 0, count - 1)
    density = np.bincount(strip, minlength=count) / area
    position = 0.5 * (edges[1:] + edges[:-1])
    if radius is None:
        return DensityProfile(position, density, None)
    radii = as_radii(radius, len(array))
    if len(radii) and radii.max() > side:
        raise Error(f"a radius is {radii.max():g} in a box of side {side:g}\n  hint: use disks that fit into the box")
    covered = np.zeros(count)
    for image in (-side, 0.0, side) if is_periodic else (0.0,):
        below = np.array([_area_below(edge - place - image, radii).sum() for edge in edges])
        covered += np.diff(below)
    return DensityProfile(position, density, covered / area)


def _area_below(height: NDArray[np.float64], radii: NDArray[np.float64]) -> NDArray[np.float64]:
    """The area of each disk below a line at this height above its centre."""
    h = np.clip(height / radii, -1.0, 1.0)
    area: NDArray[np.float64] = radii**2 * (0.5 * np.pi + np.arcsin(h) + h * np.sqrt((1.0 - h) * (1.0 + h)))
    return area


def mean_squared_displacement(positions: ArrayLike, *, drift: bool = True) -> NDArray[np.float64]:
    """⟨|r(t₀ + t) − r(t₀)|²⟩ over all agents and all time origins t₀, for every lag t.

    :param positions: unwrapped, shape (frames, N, 2), at equal times.
    :param drift: False takes out the motion of the mean of all positions, which is that of the centre of mass only where all masses
        are equal.
    :returns: shape (frames,), from lag 0 on.

    For other frames, with errors and of several kinds: :func:`dynamics`.

    Cost: O(frames · log(frames) · N) by Fourier transforms. Source: V. Calandrini et al. (2011), doi:10.1051/sfn/201112010.

    >>> frames = np.cumsum(np.full((5, 3, 2), 1.0), axis=0)  # all move by (1, 1) a frame
    >>> bool(np.allclose(mean_squared_displacement(frames), [0, 2, 8, 18, 32]))
    True
    """
    r = as_trajectory(positions)
    if not np.isfinite(r).all():
        raise Error("a position is not finite\n  hint: every coordinate must be finite")
    frames, count, _ = r.shape
    if frames == 0 or count == 0:
        return np.zeros(frames)
    if not drift:
        r = r - r.mean(axis=1, keepdims=True)
    r = r - r[0]
    # Transforms are linear: one way back serves all agents.
    power = np.zeros(frames + 1)
    for first in np.arange(0, count, 64):  # so many columns stay in the cache
        waves = np.fft.rfft(r[:, first : first + 64].reshape(frames, -1), n=2 * frames, axis=0)
        power += (waves.real**2 + waves.imag**2).sum(axis=1)
    correlation = np.fft.irfft(power)[:frames]
    squares = (r**2).sum(axis=(1, 2))
    sums = np.empty(frames)
    total = 2.0 * squares.sum()
    for lag in np.arange(frames):
        if lag > 0:
            total -= squares[lag - 1] + squares[frames - lag]
        sums[lag] = total
    means: NDArray[np.float64] = np.maximum((sums - 2.0 * correlation) / (count * (frames - np.arange(frames))), 0.0)
    return means


#: What structure_factor() may take, in bytes.
MOST_MEMORY = 8 * 2**30


class StructureFactor(NamedTuple):
    """S(q) in rings of wave vectors of the box."""

    q: NDArray[np.float64]  #: mean length of the wave vectors of a ring, shape (rings,)
    s: NDArray[np.float64]  #: mean of S over them, shape (rings,), or (kinds, kinds, rings) where kinds were given

    def __repr__(self) -> str:
        return named_in_short(self)


def structure_factor(
    points: ArrayLike, box: BoxLike, *, largest_q: float, bins: int = 100, kinds: ArrayLike | None = None
) -> StructureFactor:
    """S(q) = |Σ exp(i q·r)|² / N on the wave vectors of a periodic box, averaged over rings of equal width.

    Of two kinds, S_ab(q) = Re(ρ_a ρ_b*) / √(N_a N_b) with ρ_a = Σ exp(i q·r) over the points of kind a: 1 for a = b and 0 for
    others in an ideal gas.

    :param largest_q: the end of the rings, in 1 / length.
    :param kinds: a whole number for each point, shape (N,).
    :returns: rings that have wave vectors, the lengths ascending.
    :raises Error: for points that are not finite, boxes that are not periodic, and what needs more than 8 GiB of memory.

    Cost: O(N · wave vectors). Source: N. W. Ashcroft, D. C. Langreth (1967), doi:10.1103/PhysRev.156.685, for kinds.

    >>> found = structure_factor(np.random.default_rng(1).random((2000, 2)), box=1.0, largest_q=100.0, bins=4)
    >>> bool(np.all(abs(found.s - 1) < 0.5))
    True
    """
    width, height, _, _, shift = periodic_box(box, "the structure factor")
    array = as_points(points)
    if not np.isfinite(array).all():
        raise Error("a point is not finite\n  hint: every coordinate must be finite")
    largest_q, bins = as_number(largest_q, "largest_q"), as_count(bins, "bins")
    labels = np.zeros(len(array), dtype=np.uint32) if kinds is None else as_kinds(kinds, len(array))
    # One more on every side: rounding must not cost the vectors at the end of the last ring.
    ends = [largest_q / (2 * np.pi) * side + 1 for side in (width, height)]
    size = int(labels.max(initial=0)) + 1
    _expect_room(len(array), ends[0] + 1, 2 * ends[1] + 1, size, bins)
    # In a sheared box the wave vectors of column n are lower by n · shift/width rows.
    most_x, most_y = int(ends[0]), int(ends[1] + ends[0] * abs(shift) / width)
    columns = np.arange(0, most_x + 1)
    rows = np.arange(-most_y, most_y + 1)
    q = 2 * np.pi * np.hypot(columns[:, None] / width, (rows[None, :] - columns[:, None] * shift / width) / height)
    # One of every two opposite vectors, and not 0.
    wanted = (q > 0) & (q <= largest_q * (1 + 1e-12)) & ((columns[:, None] > 0) | (rows[None, :] > 0))
    ring = np.minimum((q[wanted] / largest_q * bins).astype(int), bins - 1)
    counts = np.bincount(ring, minlength=bins)
    along_x = np.exp(2j * np.pi / width * np.outer(columns, array[:, 0] - shift / height * array[:, 1]))
    along_y = np.exp(2j * np.pi / height * np.outer(rows, array[:, 1]))
    waves = []
    for a in range(size):
        of_kind = labels == a
        waves.append((along_x[:, of_kind] @ along_y[:, of_kind].T)[wanted] / np.sqrt(max(of_kind.sum(), 1)))
    means = np.empty((size, size, bins))
    with np.errstate(invalid="ignore"):
        lengths = np.bincount(ring, q[wanted], bins) / counts
        for a in range(size):
            for b in range(size):
                means[a, b] = np.bincount(ring, (waves[a] * waves[b].conj()).real, bins) / counts
    found = means[:, :, counts > 0]
    return StructureFactor(lengths[counts > 0], found[0, 0] if kinds is None else found)


def _expect_room(points: int, columns: float, rows: float, kinds: int, bins: int) -> None:
    """Refuses more wave vectors than fit. Waves of points and of their kinds are complex, and so is a table of each kind."""
    needed = 32 * points * (columns + rows) + columns * rows * (16 * kinds + 64) + 16 * kinds**2 * bins
    if needed > MOST_MEMORY:
        raise Error(f"{columns * rows:.3g} wave vectors, {points} points, {kinds} kinds and {bins} bins need {needed / 2**30:.3g} GiB of memory; "
                    f"the most is {MOST_MEMORY // 2**30}\n  hint: use a smaller largest_q, or fewer points, kinds or bins")
