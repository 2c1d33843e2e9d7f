"""Who is nearer than a cutoff to whom, among any points of the plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _core
from .arrays import as_array, as_number, as_numbers, named_in_short
from .box import BoxLike, as_box
from .errors import Error
from .settings import as_threads

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Neighbors(NamedTuple):
    """The neighbours of N points, in one array (compressed sparse rows).

    Those of point i are ``indices[indptr[i]:indptr[i + 1]]``, which is ``of(i)``.
    """

    indptr: NDArray[np.uint64]  #: shape (N + 1,)
    indices: NDArray[np.uint32]  #: shape (indptr[N],)

    def __repr__(self) -> str:
        return named_in_short(self)

    def of(self, i: int | NDArray[Any]) -> NDArray[np.uint32]:
        """The neighbours of point i, or of several points, one after the other.

        >>> neighbors([[0.1, 0.5], [0.3, 0.5], [0.5, 0.5]], 0.25, box=1.0).of(np.array([0, 2]))
        array([1, 1], dtype=uint32)
        """
        if isinstance(i, np.ndarray):
            first, counts = self.indptr[i].astype(np.int64), (self.indptr[i + 1] - self.indptr[i]).astype(np.int64)
            ends = np.cumsum(counts)
            places = np.arange(ends[-1] if len(ends) else 0) + np.repeat(first - ends + counts, counts)
            joined: NDArray[np.uint32] = self.indices[places]
            return joined
        if not 0 <= i < len(self.indptr) - 1:
            raise IndexError(f"there is no point {i} among {len(self.indptr) - 1}")
        return self.indices[self.indptr[i] : self.indptr[i + 1]]

    @property
    def counts(self) -> NDArray[np.int64]:
        """How many neighbours each point has, shape (N,)."""
        ends = self.indptr.astype(np.int64)
        return ends[1:] - ends[:-1]

    @property
    def owners(self) -> NDArray[np.int64]:
        """Whose neighbour each entry of ``indices`` is, shape (indptr[N],)."""
        return np.repeat(np.arange(len(self.indptr) - 1), self.counts)

    def sum(self, values: ArrayLike) -> NDArray[np.float64]:
        """Σ of the values of each point's neighbours, in the order of the lists: shape (N,), or (N, k) for values of shape (N, k).
        A mask counts those neighbours where it is True.

        Cost: about 1 ns a neighbour and number.

        >>> neighbors([[0.1, 0.5], [0.3, 0.5], [0.5, 0.5]], 0.25, box=1.0).sum([1, 10, 100])
        array([ 10., 101.,  10.])
        """
        is_mask = isinstance(values, np.ndarray) and values.dtype == np.bool_ and not np.ma.isMaskedArray(values)
        hint = f"use one row for each of the {self._points} points"
        array = np.ascontiguousarray(values if is_mask else as_array(values, "the values are", hint), dtype=np.float64)
        if array.ndim not in (1, 2) or len(array) != self._points:
            raise Error(f"the values have shape {array.shape}\n  hint: {hint}")
        sums: NDArray[np.float64] = _core.neighbor_sums(self.indptr, self.indices, array.reshape(len(array), int(np.prod(array.shape[1:]))))
        return sums.reshape(-1, *array.shape[1:]) if array.ndim > 1 else sums[:, 0]

    def mean(self, values: ArrayLike) -> NDArray[np.float64]:
        """The mean over each point's neighbours; not a number where there are none. Shapes are those of :meth:`sum`."""
        sums = self.sum(values)
        counts = self.counts.reshape((-1,) + (1,) * (sums.ndim - 1))
        means: NDArray[np.float64] = np.divide(sums, counts, out=np.full(sums.shape, np.nan), where=counts > 0)
        return means

    @property
    def _points(self) -> int:
        """How many points a neighbour can be."""
        return len(self.indptr) - 1

    def pick(self, random: ArrayLike) -> NDArray[np.int64]:
        """One neighbour of each point, chosen by a number in [0, 1) for each, shape (N,); −1 for points without neighbours.

        >>> neighbors([[0.1, 0.5], [0.3, 0.5], [0.5, 0.5]], 0.25, box=1.0).pick([0.5, 0.7, 0.0])
        array([1, 2, 1])
        """
        count = len(self.indptr) - 1
        numbers = as_numbers(random, "the random numbers", (count,), f"use one for each of the {count} points: world.uniform()")
        if numbers.size and not 0 <= numbers.min() <= numbers.max() < 1:
            raise Error("the random numbers are not all in [0, 1)\n  hint: world.uniform()")
        counts = self.counts
        picked = np.full(count, -1)
        has_some = counts > 0
        places = self.indptr[:-1].astype(np.int64) + (numbers * counts).astype(np.int64)
        picked[has_some] = self.indices[places[has_some]]
        return picked

    def __or__(self, others: Neighbors) -> Neighbors:
        """The neighbours in either of two lists of the same points, each once, in the order of their indices.

        >>> near = neighbors([[0.1, 0.5], [0.3, 0.5], [0.7, 0.5]], 0.25, box=1.0)
        >>> (near | neighbors([[0.1, 0.5], [0.3, 0.5], [0.7, 0.5]], 0.45, box=1.0)).of(0)
        array([1, 2], dtype=uint32)
        """
        count = len(self.indptr) - 1
        if len(others.indptr) - 1 != count:
            raise Error(f"neighbours of {count} and of {len(others.indptr) - 1} points cannot be joined\n  hint: use lists of the same points")
        # Sorting is far faster than np.unique.
        both = np.sort(np.concatenate([self.owners * count + self.indices, others.owners * count + others.indices]))
        both = both[np.diff(both, prepend=-1) != 0]
        owners, indices = np.divmod(both, max(count, 1))
        return Neighbors(np.searchsorted(owners, np.arange(count + 1)).astype(np.uint64), indices.astype(np.uint32))


class NeighborsAmong(Neighbors):
    """The neighbours of N points among others, by the rows of the others: those of wolves among the sheep."""

    _others: int

    @property
    def _points(self) -> int:
        return self._others


class WeightedNeighbors(Neighbors):
    """The neighbours of N agents on a network, with the weights of the edges to them."""

    weights: NDArray[np.float64]  #: of the edge to each entry of ``indices``, shape (indptr[N],)

    def __new__(cls, indptr: NDArray[np.uint64], indices: NDArray[np.uint32], weights: NDArray[np.float64]) -> WeightedNeighbors:
        lists = super().__new__(cls, indptr, indices)
        lists.weights = weights
        return lists

    def __getnewargs__(self) -> Any:
        return (*self, self.weights)

    def weighted_sum(self, values: ArrayLike) -> NDArray[np.float64]:
        """Σ of weight times value over each agent's neighbours, in the order of the lists, shape (N,)."""
        count = len(self.indptr) - 1
        hint = f"use one number for each of the {count} agents"
        is_mask = isinstance(values, np.ndarray) and values.dtype == np.bool_
        numbers = as_numbers(np.asarray(values, dtype=np.float64) if is_mask else values, "the values", (count,), hint, finite=False)
        sums = np.bincount(self.owners, self.weights * numbers[self.indices], minlength=count)
        return sums.astype(np.float64)  # NumPy gives whole numbers where there are no edges


def as_points(points: ArrayLike) -> NDArray[np.float64]:
    """Points as an array of shape (N, 2) of float64 in one piece; not copied where they are one.

    The library refuses what is not finite.
    """
    hint = "use an array of shape (N, 2): x and y of each point"
    array = as_array(points, "the points are", hint)
    return as_numbers(array.reshape(-1, 2) if array.shape == (0,) else array, "the points", (None, 2), hint, finite=False)


def as_radii(radius: ArrayLike, count: int) -> NDArray[np.float64]:
    """The radius of each of ``count`` disks, from an array or from one radius for all."""
    if np.ndim(radius) == 0:
        return np.full(count, as_number(radius, "the radius"))
    return as_numbers(radius, "the radii", (count,), "use an array of shape (N,): the radius of each disk")


def as_neighbors(found: Any, count: int) -> Neighbors:
    """Neighbours of ``count`` points, whoever has found them."""
    hint = "use what neighbors() or voronoi() gives for the same points"
    if not isinstance(found, tuple) or len(found) != 2:
        raise Error(f"the neighbours are {type(found).__name__}\n  hint: {hint}")
    begin = as_array(found[0], "the neighbours begin at", hint, integers=True)
    indices = as_array(found[1], "the neighbours are", hint, integers=True)
    is_whole = begin.shape == (count + 1,) and indices.ndim == 1 and begin[0] == 0 and begin[-1] == len(indices)
    if not is_whole or (np.diff(begin.astype(np.int64)) < 0).any():
        raise Error(f"the neighbours are not those of {count} points\n  hint: {hint}")
    if len(indices) > 0 and not 0 <= indices.min() <= indices.max() < count:
        raise Error(f"there is a neighbour {indices.max()} among {count} points\n  hint: {hint}")
    return Neighbors(begin.astype(np.uint64), indices.astype(np.uint32))


def as_cutoff(cutoff: Any) -> float:
    """How far a search looks."""
    return as_number(cutoff, "the cutoff", "use a positive length")


def as_device(device: Any, box: BoxLike) -> bool | None:
    """Whether the graphics processor searches; ``None`` where the environment says it."""
    if device is None:
        return None
    if device not in ("cpu", "gpu"):
        raise Error(f'the device is {device!r}\n  hint: use "cpu" for the cores, or "gpu" for a graphics processor')
    if device == "gpu" and box is None:
        raise Error("the graphics processor searches points in a box, and there is none\n"
                    "  hint: give a box, such as Box(width, height, periodic=False)")
    return bool(device == "gpu")


def pairs(
    points: ArrayLike, cutoff: float, box: BoxLike = None, *, threads: int = 1, device: str | None = None
) -> NDArray[np.uint32]:
    """All pairs of points nearer than the cutoff, each once.

    :param points: shape (N, 2); float64 in one piece is read where it is, anything else is copied.
    :param cutoff: a length; pairs at exactly this distance are left out. In a periodic box at most half its shorter side.
    :param box: a :class:`Box`, ``(width, height)`` or a side of a periodic box; ``None`` for points in the open plane.
    :param threads: 0 for all cores. The result does not depend on it.
    :param device: ``"gpu"`` for a graphics processor, in a package built for one; it needs a box, and the result is the same.
        By default what the environment variable ``GRIDLOCK_DEVICE`` says, or the cores.
    :returns: shape (P, 2), the indices of the two points of each pair. ``i, j = pairs(...).T`` are arrays in one piece.
    :raises Error: for points that are not finite and cutoffs and boxes that cannot be searched.

    >>> pairs([[0.1, 0.5], [0.9, 0.5], [0.5, 0.5]], 0.3, box=1.0)
    array([[0, 1]], dtype=uint32)
    """
    return _core.pairs(as_points(points), as_cutoff(cutoff), as_box(box), as_threads(threads), as_device(device, box)).T


def pairs_of_disks(
    centers: ArrayLike, radius: ArrayLike, box: BoxLike, *, factor: float = 1.0, gap: float = 0.0, threads: int = 1
) -> NDArray[np.uint32]:
    """All pairs of disks nearer than factor · (Rᵢ + Rⱼ) + gap, each once: by default those that overlap.

    Disks of like size share a grid of cells, so that few large disks among many small ones cost no more than as many small ones.

    :param centers: shape (N, 2).
    :param radius: shape (N,), or one radius for all.
    :param box: a :class:`Box`, ``(width, height)`` or a side of a periodic box.
    :param factor: above 0. In a periodic box two of the largest disks must not reach further than half its shorter side.
    :param gap: a length of at least 0 between the rims.
    :param threads: 0 for all cores. The result does not depend on it.
    :returns: shape (P, 2), the indices of the two disks of each pair.
    :raises Error: for centres that are not finite, radii that are not positive, and a reach or a box that cannot be searched.

    >>> pairs_of_disks([[0.0, 0.0], [5.5, 0.0], [6.3, 0.0]], [5.0, 0.4, 0.4], box=30.0, gap=0.2)
    array([[0, 1],
           [1, 2]], dtype=uint32)
    """
    points = as_points(centers)
    radii = as_radii(radius, len(points))
    values = as_box(box)
    if values is None:
        raise Error("there is no box\n  hint: use Box(width, height, periodic=False) for disks in the open plane")
    reach = as_number(factor, "the factor")
    between_rims = as_number(gap, "the gap", "use a length of at least 0", least=-np.finfo(float).tiny)
    return _core.pairs_of_disks(points, radii, reach, between_rims, values, as_threads(threads)).T


def neighbors(
    points: ArrayLike, cutoff: float, box: BoxLike = None, *, threads: int = 1, device: str | None = None
) -> Neighbors:
    """The neighbours of every point: all others nearer than the cutoff.

    Parameters and errors are those of :func:`pairs`.

    >>> found = neighbors([[0.1, 0.5], [0.9, 0.5], [0.5, 0.5]], 0.3, box=1.0)
    >>> found.counts
    array([1, 1, 0])
    >>> found.of(0)
    array([1], dtype=uint32)
    """
    found = _core.neighbor_lists(as_points(points), as_cutoff(cutoff), as_box(box), as_threads(threads), as_device(device, box))
    return Neighbors(*found)
