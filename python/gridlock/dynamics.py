"""How agents move: displacements, F_s(q, t), overlap, χ₄ and α₂ of a trajectory, also relative to neighbours, and the diffusion
coefficient."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import _core
from .arrays import as_count, as_kinds, as_number, as_numbers, named_in_short
from .box import BoxLike, BoxValues, as_box
from .errors import Error
from .neighbors import Neighbors, as_neighbors
from .settings import as_threads
from .simulation import Result

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Dynamics(NamedTuple):
    """Means over agents and time origins for L lags: arrays of shape (L,), or (kinds, L) where kinds were given.

    An error is one standard error, from origins whose intervals do not overlap; not a number where there is but one.
    """

    lag: NDArray[np.float64]  #: t, ascending, above 0; always shape (L,)
    msd: NDArray[np.float64]  #: ⟨Δr²⟩
    msd_error: NDArray[np.float64]
    non_gaussian: NDArray[np.float64]  #: α₂ = ⟨Δr⁴⟩ / (2 ⟨Δr²⟩²) − 1
    non_gaussian_error: NDArray[np.float64]
    scattering: NDArray[np.float64] | None  #: F_s(q, t), where q was given
    scattering_error: NDArray[np.float64] | None
    overlap: NDArray[np.float64] | None  #: share of agents that moved no further than the overlap length, where it was given
    overlap_error: NDArray[np.float64] | None

    origins: NDArray[np.uint64]  #: pairs of frames with this lag, shape (L,)
    independent_origins: NDArray[np.uint64]  #: those of them whose intervals do not overlap, shape (L,)
    susceptibility: NDArray[np.float64] | None  #: χ₄ = N var(Q) over time origins, Q the overlap and N the agents of the kind
    susceptibility_error: NDArray[np.float64] | None
    total_susceptibility: NDArray[np.float64] | None  #: χ₄ of all kinds together; always shape (L,)
    total_susceptibility_error: NDArray[np.float64] | None

    def __repr__(self) -> str:
        return named_in_short(self)


def as_trajectory(positions: ArrayLike) -> NDArray[np.float64]:
    """Positions of shape (frames, N, 2), in one piece."""
    return as_numbers(positions, "the positions", (None, None, 2), "use an array of shape (frames, N, 2)", finite=False)


def as_times(times: ArrayLike | None, frames: int) -> NDArray[np.float64]:
    """The time of each frame, shape (frames,); the numbers of the frames where times are left out."""
    if times is None:
        return np.arange(frames, dtype=np.float64)
    return as_numbers(times, "the times", (frames,), f"give one time for each of the {frames} frames")


def dynamics(
    positions: ArrayLike,
    times: ArrayLike | None = None,
    *,
    kinds: ArrayLike | None = None,
    q: float | None = None,
    overlap_length: float | None = None,
    lags: int | None = None,
    drift: bool = True,
    neighbors: float | str | Neighbors | Sequence[Neighbors] | None = None,
    box: BoxLike = None,
    threads: int = 1,
) -> Dynamics:
    """Mean squared displacement, α₂, F_s(q, t), overlap and its susceptibility χ₄, by one walk over all pairs of frames.

    Δr = r(t₀ + t) − r(t₀); msd = ⟨Δr²⟩, α₂ = ⟨Δr⁴⟩ / (2 ⟨Δr²⟩²) − 1 (0 for Gaussian displacements in two dimensions),
    F_s(q, t) = ⟨J₀(q |Δr|)⟩ (averaged over all directions of q), overlap = ⟨Q⟩ with Q the share of agents with
    |Δr| ≤ overlap_length, χ₄ = N var(Q) over time origins.

    With ``neighbors``, all of this is measured for displacements relative to the cage: Δr of an agent less the mean Δr of those that
    are its neighbours at the origin t₀. This takes out motion that neighbours share, such as the long waves of two dimensions.

    :param positions: unwrapped, shape (frames, N, 2); ``Trajectory.positions()`` gives them.
    :param times: of the frames, ascending, shape (frames,); the numbers of the frames where left out. They may be even in time,
        in its logarithm, in blocks of it, or anyhow: lags that differ by less than a thousandth of the shortest time between
        frames are one.
    :param kinds: a whole number for each agent, shape (N,); every kind gets its own curves. ``Trajectory.kinds`` gives them.
    :param q: the wave number of F_s, in 1 / length.
    :param overlap_length: in length; 0.3 diameters is usual.
    :param lags: so many lags at most, evenly in their logarithm; all where left out.
    :param drift: False takes out the motion of the mean of all positions, which is that of the centre of mass only where all masses
        are equal.
    :param neighbors: a cutoff, all nearer agents being neighbours; "voronoi"; or one :class:`Neighbors`, for each frame
        or for all. An agent without neighbours keeps its displacement.
    :param box: that of all frames, where neighbours are searched.
    :param threads: 0 for all cores. The result does not depend on it.
    :returns: :class:`Dynamics`.
    :raises Error: for fewer than two frames, times that do not ascend, positions that are not finite, more than 8192 frames
        that are not even in time, and neighbours that cannot be searched.

    Errors know nothing of what changes more slowly than the trajectory: combine runs of several seeds (:func:`combine`). χ₄ is not a
    number where all intervals of a lag overlap. At constant energy or composition it is smaller than where they fluctuate.

    Cost: pairs of frames · N · 0.5 ns with AVX-512, 1.1 ns without; with q 2 ns and 4.3 ns; relative to six neighbours 10 ns more,
    and the search. Source: A. Rahman (1964), doi:10.1103/PhysRev.136.A405; W. Kob, H. C. Andersen (1995),
    doi:10.1103/PhysRevE.52.4134; N. Lačević et al. (2003), doi:10.1063/1.1605094 (overlap, χ₄); L. Berthier et al. (2007),
    doi:10.1063/1.2721554 (χ₄ and what is constant); S. Mazoyer et al. (2009), doi:10.1209/0295-5075/88/66004, and S. Vivek et al.
    (2017), doi:10.1073/pnas.1607226113 (relative to the cage).

    >>> walk = np.random.default_rng(1).normal(size=(200, 100, 2)).cumsum(axis=0)
    >>> found = dynamics(walk, lags=3, q=0.5)
    >>> found.lag
    array([  1.,  14., 199.])
    >>> bool(abs(found.msd[0] - 2) < 5 * found.msd_error[0]), bool(abs(found.scattering[0] - np.exp(-0.125)) < 0.01)
    (True, True)

    A crystal that moves as a whole, seen from its cages:

    >>> crystal = np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0)), axis=-1).reshape(-1, 2)
    >>> moving = crystal + np.array([0.0, 0.3, 1.7])[:, None, None]
    >>> dynamics(moving, neighbors=1.2, box=5.0).msd.round(12)
    array([0., 0.])
    """
    array = as_trajectory(positions)
    frames, count, _ = array.shape
    labels = None if kinds is None else as_kinds(kinds, count)
    found = _core.dynamics(
        array, as_times(times, frames), labels,
        0.0 if q is None else as_number(q, "q"),
        0.0 if overlap_length is None else as_number(overlap_length, "overlap_length"),
        0 if lags is None else as_count(lags, "lags"),
        bool(drift), as_threads(threads), _neighbourhood(neighbors, box, frames, count))
    curves: dict[str, NDArray[np.float64] | None] = {}
    for name in ("msd", "non_gaussian", "scattering", "overlap", "susceptibility", "total_susceptibility"):
        value, error = (None, None) if found[name] is None else found[name]
        is_alone = labels is None or name == "total_susceptibility"
        curves[name] = value[0] if value is not None and is_alone else value
        curves[name + "_error"] = error[0] if error is not None and is_alone else error
    return Dynamics(lag=found["lag"], origins=found["origins"], independent_origins=found["independent_origins"],
                    **curves)  # type: ignore[arg-type]


def _neighbourhood(
    neighbors: float | str | Neighbors | Sequence[Neighbors] | None, box: BoxLike, frames: int, count: int
) -> tuple[float, BoxValues | None, list[Neighbors]] | None:
    """The cutoff, 0 for Voronoi neighbours; the box; and the neighbours of each frame where they are given."""
    hint = 'give a cutoff with the box, "voronoi" with the box, or Neighbors of every frame'
    if neighbors is None:
        if box is not None:
            raise Error(f"there is a box, and no neighbours are searched\n  hint: {hint}")
        return None
    sides = as_box(box)
    if isinstance(neighbors, str):
        if neighbors != "voronoi" or sides is None:
            raise Error(f"the neighbours are {neighbors!r}, the box is {box!r}\n  hint: {hint}")
        return 0.0, sides, []
    if isinstance(neighbors, Neighbors):
        return 0.0, None, [as_neighbors(neighbors, count)] * frames
    if not isinstance(neighbors, Sequence):
        return as_number(neighbors, "the cutoff of the neighbours", hint), sides, []
    if len(neighbors) != frames:
        raise Error(f"there are neighbours of {len(neighbors)} frames, but {frames} frames\n  hint: {hint}")
    return 0.0, None, [as_neighbors(found, count) for found in neighbors]


def diffusion_coefficient(
    lag: ArrayLike, msd: ArrayLike, error: ArrayLike | None = None, *, start: float = 0.0, end: float | None = None
) -> Result:
    """D of the straight line msd = 4 D t + c through the lags from ``start`` to ``end``.

    :param lag: shape (L,).
    :param msd: of one kind, shape (L,).
    :param error: of msd, shape (L,); points count by 1 / error² then, and D has an error.
    :param start: the motion must be diffusive from there on; where it is not, D is too large or too small, whatever its error
        says.
    :param end: the last lag where left out; its error is large where few origins are left.
    :returns: D with one standard error in length² / time. The displacements after different lags are those of the same agents,
        so their errors are not independent; the error of D is the larger one of two: all points off by their errors together,
        or each for itself.
    :raises Error: for fewer than two points in the window, and errors that are not positive there.

    Cost: O(L). Source: A. Einstein (1905), doi:10.1002/andp.19053220806.

    >>> diffusion_coefficient([1.0, 2.0, 3.0], [4.1, 8.1, 12.1], start=1.0).value
    1.0
    """
    hint = "use arrays of one length: lags, and what belongs to each"
    t = as_numbers(lag, "the lags", (None,), hint)
    y = as_numbers(msd, "the displacements", (len(t),), hint)
    first = as_number(start, "start", "use a time, 0 or above", least=-np.inf)
    last = as_number(end, "end", "use a time", least=-np.inf) if end is not None else np.inf
    wanted = (t >= first) & (t <= last)
    if np.unique(t[wanted]).size < 2:
        raise Error(f"there are {int(wanted.sum())} lags from {first:g} to {last:g}\n  hint: a line needs two; widen the window")
    t, y = t[wanted], y[wanted]
    if error is None:
        return Result(float(_line(t, np.ones_like(t)) @ y / 4), None, "length² / time")
    e = as_numbers(error, "the errors", (len(wanted),), hint, finite=False)[wanted]
    if not (np.isfinite(e) & (e > 0)).all():
        raise Error(f"the errors in the window are {e}\n  hint: all must be positive; end the window where origins run out")
    slope = _line(t, 1 / e**2) / 4
    together, apart = abs(slope @ e), np.sqrt((slope**2) @ e**2)
    return Result(float(slope @ y), float(max(together, apart)), "length² / time")


def shear_viscosity(
    times: ArrayLike,
    stress: ArrayLike,
    *,
    area: float,
    temperature: float,
    start: float,
    end: float | None = None,
    lags: int = 100,
) -> Result:
    """The shear viscosity η of a fluid at rest, from the fluctuations of its stress (Helfand's formula).

    η = d⟨ΔG²⟩/dt / (2 A kT) with G(t) = A ∫ σ dt, for one or several stresses σ that are equal by symmetry, σ_xy and (σ_xx − σ_yy) / 2,
    over all time origins; the integral is that of straight lines between the samples.

    :param times: shape (n,), those of the samples: dense enough for the stress to change little from one to the next.
    :param stress: shape (n,), or (k, n) for k stresses; ``run.series["stress_xy"]`` of the engine ``soft``, in equilibrium and without
        flow, or that of ``exact`` with ``observe.viscosity_lag``, which gives the mean since the sample before.
    :param area: that of the box.
    :param temperature: kT.
    :param start, end: the lags between which ⟨ΔG²⟩ is fitted by a straight line: ``start`` beyond the time for which stresses remember
        each other, below which η is too small; ``end`` a tenth of all where left out.
    :param lags: how many lags are used, evenly in their logarithm.
    :returns: η with one standard error, in mass / time. Runs of several seeds tell more: :func:`combine`.
    :raises Error: for times that do not ascend, fewer than two lags between start and end, and a stress whose mean is not 0.

    Cost: n · lags · 1 ns. Source: E. Helfand (1960), doi:10.1103/PhysRev.119.1; for (σ_xx − σ_yy) / 2 P. J. Daivis, D. J. Evans (1994),
    doi:10.1063/1.466970.

    A stress that forgets itself at a rate of 1, with a variance of 2 in an area of 3 at kT = 1: η = 3 · 2.

    >>> random, stress = np.random.default_rng(1), np.zeros((2, 40000))
    >>> for k in range(1, 40000):
    ...     stress[:, k] = np.exp(-0.1) * stress[:, k - 1] + np.sqrt(2 * (1 - np.exp(-0.2))) * random.normal(size=2)
    >>> eta = shear_viscosity(0.1 * np.arange(40000), stress, area=3.0, temperature=1.0, start=5.0, end=40.0)
    >>> bool(abs(eta.value - 6) < 3 * eta.error), eta.unit
    (True, 'mass / time')
    """
    hint = "use arrays of one length: times, and the stress at each"
    t = as_numbers(times, "the times", (None,), hint)
    stresses = as_numbers([stress] if np.ndim(stress) == 1 else stress, "the stresses", (None, len(t)), hint)
    size, kt = as_number(area, "the area"), as_number(temperature, "the temperature")
    if len(stresses) == 0 or len(t) < 2:
        raise Error(f"there are {len(stresses)} stresses at {len(t)} times\n  hint: {hint}")
    _require_no_flow(stresses)
    moments = np.zeros((len(t), len(stresses), 2))  # as agents that move along x alone
    moments[1:, :, 0] = (0.5 * size * np.diff(t) * (stresses[:, 1:] + stresses[:, :-1])).cumsum(axis=1).T
    found = dynamics(moments, t, lags=lags)
    last = end if end is not None else 0.1 * (t[-1] - t[0])
    slope = diffusion_coefficient(found.lag, found.msd, found.msd_error, start=start, end=last)
    scale = 2.0 / (size * kt)
    return Result(scale * slope.value, None if slope.error is None else scale * slope.error, "mass / time")


def _require_no_flow(stresses: NDArray[np.float64]) -> None:
    """Refuses a stress whose mean, over ten blocks, is more than eight standard errors from 0."""
    for stress in stresses:
        if len(stress) < 100:
            return
        means = np.array([block.mean() for block in np.array_split(stress, 10)])
        mean, error = means.mean(), means.std(ddof=1) / np.sqrt(10)
        if abs(mean) > 8.0 * error:
            raise Error(f"the stress has the mean {mean:.3g} ± {error:.2g}, as in a flow or a strained solid\n"
                        "  hint: fluctuations tell a viscosity of a fluid at rest; of a steady flow it is the mean stress over the rate of shear")


def _line(t: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """What each point contributes to the slope of the straight line of least squares."""
    middle = weights @ t / weights.sum()
    slope: NDArray[np.float64] = weights * (t - middle) / (weights @ (t - middle) ** 2)
    return slope
