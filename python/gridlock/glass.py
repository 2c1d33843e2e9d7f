"""How liquids become glass: collective F(q, t), van Hove functions, and strings of mobile agents."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import _core
from .arrays import as_count, as_kinds, as_number, as_numbers, named_in_short
from .box import BoxLike, as_box
from .dynamics import as_times, as_trajectory
from .errors import Error
from .settings import as_threads

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class CollectiveScattering(NamedTuple):
    """F(q, t) of L lags, shape (L,), or F_ab(q, t), shape (kinds, kinds, L), where kinds were given.

    An error is one standard error, from origins whose intervals do not overlap; not a number where there is but one.
    """

    q: float  #: the mean length of the wave vectors, in 1 / length
    vectors: int  #: how many there are, counting q and −q once
    lag: NDArray[np.float64]  #: t, ascending, from 0 on, shape (L,)
    scattering: NDArray[np.float64]
    scattering_error: NDArray[np.float64]
    origins: NDArray[np.uint64]  #: pairs of frames with this lag, shape (L,)
    independent_origins: NDArray[np.uint64]  #: those of them whose intervals do not overlap, shape (L,)

    def __repr__(self) -> str:
        return named_in_short(self)


def collective_scattering(
    positions: ArrayLike,
    times: ArrayLike | None = None,
    *,
    box: BoxLike,
    q: float,
    width: float | None = None,
    kinds: ArrayLike | None = None,
    lags: int | None = None,
    threads: int = 1,
) -> CollectiveScattering:
    """The collective intermediate scattering function F(q, t): how long density waves last.

    F_ab(q, t) = Re ⟨ρ_a(t₀ + t) ρ_b*(t₀)⟩ / √(N_a N_b) with ρ_a = Σ exp(i q·r) over the agents of kind a, as a mean over time
    origins and the wave vectors of the box with | |q| − q | ≤ width / 2. F(q, 0) = S(q).

    :param positions, times, kinds, threads: as in :func:`dynamics`.
    :param box: periodic, that of all frames.
    :param q: the middle of the ring of wave vectors, in 1 / length.
    :param width: that of the ring; 2π over the shorter side where left out.
    :param lags: so many lags besides 0 at most, evenly in their logarithm; all where left out.
    :raises Error: as :func:`dynamics`; for boxes that are not periodic, rings without wave vectors, and more than 10⁸ waves of all
        frames and kinds.

    Cost: 2 ns a frame, agent, and wave vector or row or column of wave vectors; 1 ns a pair of frames, wave vector and pair of
    kinds. Source: J.-P. Hansen, I. R. McDonald, Theory of Simple Liquids (2013), chapter 7.

    >>> random = np.random.default_rng(1)
    >>> walk = random.uniform(0, 20, (60, 2)) + random.normal(size=(400, 60, 2)).cumsum(axis=0)
    >>> found = collective_scattering(walk, box=20.0, q=1.0, lags=3)
    >>> bool(np.all(abs(found.scattering - np.exp(-0.5 * found.q**2 * found.lag))[:3] < 0.1))
    True
    """
    array = as_trajectory(positions)
    frames, count, _ = array.shape
    sides = as_box(box)
    if sides is None:
        raise Error("collective scattering needs a box that is periodic in x and y\n  hint: give box=(width, height)")
    labels = None if kinds is None else as_kinds(kinds, count)
    length, vectors, lag, origins, independent, value, error = _core.collective_scattering(
        array, as_times(times, frames), labels, sides, as_number(q, "q"),
        2 * np.pi / min(sides[:2]) if width is None else as_number(width, "the width of the ring"),
        0 if lags is None else as_count(lags, "lags"), as_threads(threads))
    if labels is None:
        value, error = value[0, 0], error[0, 0]
    return CollectiveScattering(length, vectors, lag, value, error, origins, independent)


class VanHove(NamedTuple):
    """The van Hove functions after T lags, in bins of distance.

    An error is one standard error, from origins whose intervals do not overlap; not a number where there is but one.
    """

    distance: NDArray[np.float64]  #: middle of each bin, shape (bins,)
    lag: NDArray[np.float64]  #: those of the trajectory nearest to what was asked for, shape (T,)
    self_part: NDArray[np.float64]  #: G_s in 1 / length², shape (T, bins), or (T, kinds, bins) where kinds were given
    self_error: NDArray[np.float64]
    distinct_part: NDArray[np.float64] | None  #: G_d, shape (T, bins) or (T, kinds, kinds, bins), where a box was given
    distinct_error: NDArray[np.float64] | None
    origins: NDArray[np.uint64]  #: pairs of frames that were used, shape (T,)
    independent_origins: NDArray[np.uint64]  #: those of them whose intervals do not overlap, shape (T,)

    def __repr__(self) -> str:
        return named_in_short(self)


def van_hove(
    positions: ArrayLike,
    times: ArrayLike | None = None,
    *,
    lags: ArrayLike,
    range: float,
    bins: int = 200,
    box: BoxLike = None,
    kinds: ArrayLike | None = None,
    origins: int | None = None,
    threads: int = 1,
) -> VanHove:
    """The van Hove functions: how far agents have moved after some times, and where the others are then.

    G_s(r, t) = agents with |r_i(t₀ + t) − r_i(t₀)| in the bin / (N · area of the ring): ∫ G_s 2πr dr = 1.
    G_d(r, t) = pairs i ≠ j with |r_j(t₀ + t) − r_i(t₀)| in the bin / (all such pairs · area of the ring / area of the box): g(r) at
    t = 0, and 1 where agents no longer know of each other. Of kinds, i is of the first and j of the second.

    :param positions, times, kinds, threads: as in :func:`dynamics`.
    :param lags: times, shape (T,), or one; 0 for each frame with itself.
    :param range: the largest distance; with a box at most half the shorter side.
    :param box: periodic, that of all frames, for the distinct part; where it is left out there is none.
    :param origins: so many for each lag at most, evenly spread; all where left out.
    :raises Error: as :func:`dynamics` and :func:`pair_correlation`; for lags below 0 and beyond the last frame.

    Cost: the self part 9 ns an origin and agent, the distinct part twice that of :func:`pair_correlation` an origin. Source: L. van
    Hove (1954), doi:10.1103/PhysRev.95.249.

    >>> walk = np.random.default_rng(1).normal(size=(200, 100, 2)).cumsum(axis=0)
    >>> found = van_hove(walk, lags=4.0, range=6.0, bins=12)
    >>> gauss = np.exp(-found.distance**2 / 8) / (8 * np.pi)
    >>> bool(np.all(abs(found.self_part[0] - gauss) < 0.002))
    True
    """
    array = as_trajectory(positions)
    frames, count, _ = array.shape
    labels = None if kinds is None else as_kinds(kinds, count)
    distance, lag, own, own_error, others, others_error, used, independent = _core.van_hove(
        array, as_times(times, frames), labels, as_box(box), _as_lags(lags), as_number(range, "range"), as_count(bins, "bins"),
        0 if origins is None else as_count(origins, "origins"), as_threads(threads))
    if labels is None:
        own, own_error = own[:, 0], own_error[:, 0]
        if others is not None and others_error is not None:
            others, others_error = others[:, 0, 0], others_error[:, 0, 0]
    return VanHove(distance, lag, own, own_error, others, others_error, used, independent)


def _as_lags(lags: ArrayLike) -> NDArray[np.float64]:
    """Times, from one or several."""
    return as_numbers([lags] if np.ndim(lags) == 0 else lags, "the lags", (None,), "use an array of times")


class StringLengths(NamedTuple):
    """The lengths of strings of mobile agents after T lags, as means over time origins.

    An error is one standard error, from origins whose intervals do not overlap; not a number where there is but one.
    """

    lag: NDArray[np.float64]  #: those of the trajectory nearest to what was asked for, shape (T,)
    mean_length: NDArray[np.float64]  #: ⟨n⟩, mobile agents a string, shape (T,); 1 where none follows another
    mean_length_error: NDArray[np.float64]
    weighted_length: NDArray[np.float64]  #: ⟨n²⟩/⟨n⟩, the length of the string of a mobile agent, shape (T,)
    weighted_length_error: NDArray[np.float64]
    strings: NDArray[np.float64]  #: strings of 1, 2 … agents in an origin, shape (T, longest string)
    mobile_agents: int  #: how many agents are mobile in each origin
    origins: NDArray[np.uint64]  #: pairs of frames that were used, shape (T,)
    independent_origins: NDArray[np.uint64]  #: those of them whose intervals do not overlap, shape (T,)

    def __repr__(self) -> str:
        return named_in_short(self)


def string_lengths(
    positions: ArrayLike,
    times: ArrayLike | None = None,
    *,
    lags: ArrayLike,
    distance: float,
    mobile: float = 0.05,
    box: BoxLike = None,
    origins: int | None = None,
) -> StringLengths:
    """How long the strings are in which mobile agents follow one another, each into the place of the next.

    Mobile agents i and j are in one string if min(|r_i(t₀ + t) − r_j(t₀)|, |r_j(t₀ + t) − r_i(t₀)|) < distance, or if a chain of
    such pairs joins them.

    :param positions, times: as in :func:`dynamics`.
    :param lags: times, shape (T,), or one.
    :param distance: in length; 0.6 mean diameters in the source.
    :param mobile: the share of agents that are mobile: those that have moved farthest.
    :param box: that of all frames; left out: the open plane.
    :param origins: so many for each lag at most, evenly spread; all where left out.
    :raises Error: as :func:`dynamics`; for a share outside 0 … 1, distances that the box cannot have, and lags below 0 or
        beyond the last frame.

    Cost: 30 ns an origin and agent. Source: C. Donati et al. (1998), doi:10.1103/PhysRevLett.80.2338.

    >>> frames = [[[1.0, 1.0], [2.0, 1.0], [5.0, 5.0]], [[2.0, 1.0], [3.0, 1.0], [5.0, 5.0]]]
    >>> string_lengths(frames, lags=1.0, distance=0.3, mobile=0.6).mean_length
    array([2.])
    """
    array = as_trajectory(positions)
    lag, mean, mean_error, weighted, weighted_error, lengths, mobile_agents, used, independent = _core.string_lengths(
        array, as_times(times, len(array)), as_box(box), _as_lags(lags), as_number(distance, "the distance"),
        as_number(mobile, "mobile", "use a share of the agents, above 0 and at most 1"),
        0 if origins is None else as_count(origins, "origins"))
    longest = max(map(len, lengths), default=0)
    strings = np.array([np.pad(counts, (0, longest - len(counts))) for counts in lengths]).reshape(len(lengths), longest)
    return StringLengths(lag, mean, mean_error, weighted, weighted_error, strings, mobile_agents, used, independent)
