"""Analysis of plain arrays: pair correlation, sixfold order, mean squared displacement, structure factor."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .box import BoxLike, as_box
from .errors import Error
from .neighbors import as_points, neighbors, pairs

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class PairCorrelation(NamedTuple):
    """g(r) in bins."""

    distance: NDArray[np.float64]  #: middle of each bin, shape (bins,)
    g: NDArray[np.float64]  #: shape (bins,)


def _periodic(box: BoxLike, what: str) -> tuple[float, float]:
    sides = as_box(box)
    if sides is None or not sides[2]:
        raise Error(f"{what} needs a periodic box\n  hint: give box=(width, height)")
    return sides[0], sides[1]


def separations(points: ArrayLike, i: NDArray[np.integer], j: NDArray[np.integer], box: BoxLike = None) -> NDArray[np.float64]:
    """The vectors from points i to points j, to the nearest image in a periodic box; shape (P, 2)."""
    array = as_points(points)
    difference = array[j] - array[i]
    sides = as_box(box)
    if sides is not None and sides[2]:
        lengths = np.array(sides[:2])
        difference -= lengths * np.round(difference / lengths)
    separated: NDArray[np.float64] = difference
    return separated


def pair_correlation(points: ArrayLike, box: BoxLike, *, range: float, bins: int = 200, threads: int = 1) -> PairCorrelation:
    """The pair correlation of points in a periodic box.

    g(r) = pairs in the bin / (N (N − 1) / 2 · area of the ring / area of the box); 1 for an ideal gas.

    :param range: the largest distance, at most half the shorter side.
    :returns: distances and g, shapes (bins,).

    Cost: a search for all pairs in the range.

    >>> found = pair_correlation(np.random.default_rng(1).random((20000, 2)), box=1.0, range=0.1, bins=5)
    >>> bool(np.all(abs(found.g - 1) < 0.05))
    True
    """
    width, height = _periodic(box, "the pair correlation")
    array = as_points(points)
    i, j = pairs(array, range, box, threads=threads).T
    lengths = np.hypot(*separations(array, i, j, box).T)
    counts, edges = np.histogram(lengths, bins=bins, range=(0.0, range))
    rings = np.pi * (edges[1:] ** 2 - edges[:-1] ** 2)
    expected = 0.5 * len(array) * (len(array) - 1) * rings / (width * height)
    with np.errstate(invalid="ignore", divide="ignore"):
        g = counts / expected
    return PairCorrelation(0.5 * (edges[1:] + edges[:-1]), g)


def bond_orientation(points: ArrayLike, cutoff: float, box: BoxLike = None, *, k: int = 6, threads: int = 1) -> NDArray[np.complex128]:
    """ψ_k of every point: the mean of exp(i k θ) over the directions θ to its neighbours within the cutoff; 0 without neighbours.

    :returns: shape (N,), complex. ``abs(psi).mean()`` is the local order, ``abs(psi.mean())`` the global one.

    Source: D. R. Nelson, B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457.

    >>> square = [[x, y] for x in range(4) for y in range(4)]
    >>> bool(np.allclose(abs(bond_orientation(square, 1.2, box=4.0, k=4)), 1))
    True
    """
    array = as_points(points)
    found = neighbors(array, cutoff, box, threads=threads)
    counts = found.counts
    i = np.repeat(np.arange(len(array)), counts)
    x, y = separations(array, i, found.indices, box).T
    angles = np.exp(1j * k * np.arctan2(y, x))
    sums = np.bincount(i, angles.real, len(array)) + 1j * np.bincount(i, angles.imag, len(array))
    return np.where(counts > 0, sums / np.maximum(counts, 1), 0.0)


def mean_squared_displacement(positions: ArrayLike, *, drift: bool = True) -> NDArray[np.float64]:
    """⟨|r(t₀ + t) − r(t₀)|²⟩ over all agents and all time origins t₀, for every lag t.

    :param positions: unwrapped, shape (frames, N, 2), at equal times.
    :param drift: False takes the motion of the mean of all agents out.
    :returns: shape (frames,), from lag 0 on.

    Cost: O(frames · log(frames) · N) by Fourier transforms. Source: V. Calandrini et al. (2011), doi:10.1051/sfn/201112010.

    >>> frames = np.cumsum(np.full((5, 3, 2), 1.0), axis=0)  # all move by (1, 1) a frame
    >>> bool(np.allclose(mean_squared_displacement(frames), [0, 2, 8, 18, 32]))
    True
    """
    r = np.asarray(positions, dtype=np.float64)
    if r.ndim != 3 or r.shape[2] != 2:
        raise Error(f"the positions have shape {r.shape}\n  hint: use an array of shape (frames, N, 2)")
    if not np.isfinite(r).all():
        raise Error("a position is not finite\n  hint: every coordinate must be finite")
    frames, count, _ = r.shape
    if frames == 0 or count == 0:
        return np.zeros(frames)
    if not drift:
        r = r - r.mean(axis=1, keepdims=True)
    r = r - r[0]
    transformed = np.fft.rfft(r, n=2 * frames, axis=0)
    correlation = np.fft.irfft((np.abs(transformed) ** 2).sum(axis=2), axis=0)[:frames].sum(axis=1)
    squares = (r**2).sum(axis=(1, 2))
    sums = np.empty(frames)
    total = 2.0 * squares.sum()
    for lag in np.arange(frames):
        if lag > 0:
            total -= squares[lag - 1] + squares[frames - lag]
        sums[lag] = total
    means: NDArray[np.float64] = np.maximum((sums - 2.0 * correlation) / (count * (frames - np.arange(frames))), 0.0)
    return means


class StructureFactor(NamedTuple):
    """S(q) in rings of wave vectors of the box."""

    q: NDArray[np.float64]  #: mean length of the wave vectors of a ring
    s: NDArray[np.float64]  #: mean of S over them


def structure_factor(points: ArrayLike, box: BoxLike, *, largest_q: float, bins: int = 100) -> StructureFactor:
    """S(q) = |Σ exp(i q·r)|² / N on the wave vectors of a periodic box, averaged over rings of equal width.

    :param largest_q: the end of the rings, in 1 / length.
    :returns: rings that have wave vectors, the lengths ascending.

    Cost: O(N · wave vectors).

    >>> found = structure_factor(np.random.default_rng(1).random((2000, 2)), box=1.0, largest_q=100.0, bins=4)
    >>> bool(np.all(abs(found.s - 1) < 0.5))
    True
    """
    width, height = _periodic(box, "the structure factor")
    array = as_points(points)
    if not np.isfinite(array).all():
        raise Error("a point is not finite\n  hint: every coordinate must be finite")
    if not 0 < largest_q < np.inf or bins < 1:
        raise Error(f"largest_q={largest_q!r}, bins={bins!r}\n  hint: use a positive number and at least one bin")
    # One more on every side: rounding must not cost the vectors at the end of the last ring.
    most_x, most_y = (int(largest_q * side / (2 * np.pi)) + 1 for side in (width, height))
    columns = np.arange(0, most_x + 1)
    rows = np.arange(-most_y, most_y + 1)
    along_x = np.exp(2j * np.pi / width * np.outer(columns, array[:, 0]))
    along_y = np.exp(2j * np.pi / height * np.outer(rows, array[:, 1]))
    power = np.abs(along_x @ along_y.T) ** 2 / max(len(array), 1)
    q = 2 * np.pi * np.hypot(columns[:, None] / width, rows[None, :] / height)
    # One of every two opposite vectors, and not 0.
    wanted = (q > 0) & (q <= largest_q * (1 + 1e-12)) & ((columns[:, None] > 0) | (rows[None, :] > 0))
    ring = np.minimum((q[wanted] / largest_q * bins).astype(int), bins - 1)
    counts = np.bincount(ring, minlength=bins)
    with np.errstate(invalid="ignore"):
        lengths = np.bincount(ring, q[wanted], bins) / counts
        values = np.bincount(ring, power[wanted], bins) / counts
    return StructureFactor(lengths[counts > 0], values[counts > 0])
