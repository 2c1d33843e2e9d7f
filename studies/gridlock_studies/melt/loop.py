"""The loop of the pressure in a finite box, and Maxwell's construction."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..statistics import Estimate

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray


class Loop(NamedTuple):
    """Where a line of constant pressure cuts two equal areas from P*(a), a = A/(N(2R)²) the area of a disk."""

    pressure: Estimate
    liquid: Estimate  #: the packing fractions at both ends of the line
    solid: Estimate
    barrier: Estimate  #: the area between line and curve, βΔf of a disk, of either half


def area_per_disk(packing_fraction: float) -> float:
    """In (2R)²."""
    return math.pi / (4.0 * packing_fraction)


def curve_through(points: Sequence[tuple[float, float]]) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """P* against the area of a disk, by cubic pieces that rise and fall only where the points do."""
    from scipy.interpolate import PchipInterpolator  # type: ignore[import-untyped]

    ordered = sorted((area_per_disk(density), pressure) for density, pressure in points)
    curve: Callable[[NDArray[np.float64]], NDArray[np.float64]] = PchipInterpolator(*zip(*ordered))
    return curve


def _cut(area: NDArray[np.float64], pressure: NDArray[np.float64], level: float) -> tuple[float, float, float, float] | None:
    """Both ends of the line at a level, the area between, and that of its half below."""
    above = pressure > level
    if not above[0] or above[-1]:
        return None
    changes = np.flatnonzero(above[1:] != above[:-1])
    first, last = changes[0] + 1, changes[-1] + 1
    step = area[1] - area[0]
    excess = pressure[first:last] - level
    return float(area[first]), float(area[last]), float(excess.sum() * step), float(-excess[excess < 0.0].sum() * step)


def _construct(points: Sequence[tuple[float, float]]) -> tuple[float, float, float, float] | None:
    """Pressure, both packing fractions and barrier; None without a loop."""
    ends = [area_per_disk(density) for density, _ in points]
    area = np.linspace(min(ends), max(ends), 4001)
    pressure = curve_through(points)(area)
    rises = np.flatnonzero(np.diff(pressure) > 0.0)
    if not len(rises):
        return None
    low, high = float(pressure[rises].min()), float(pressure[rises + 1].max())
    for _ in range(60):
        level = 0.5 * (low + high)
        cut = _cut(area, pressure, level)
        if cut is None:  # the curve has no end on one side at this level
            low, high = (level, high) if pressure[-1] > level else (low, level)
        elif cut[2] > 0.0:
            low = level
        else:
            high = level
    cut = _cut(area, pressure, 0.5 * (low + high))
    if cut is None or abs(cut[2]) > 1e-3 * max(cut[3], 1e-9) + 1e-6 or cut[3] <= 0.0:
        return None
    return 0.5 * (low + high), math.pi / (4.0 * cut[1]), math.pi / (4.0 * cut[0]), cut[3]


def find_loop(points: Sequence[tuple[float, Estimate]], draws: int = 200) -> Loop | None:
    """Maxwell's construction, J. E. Mayer, W. W. Wood (1965), doi:10.1063/1.1695931.

    Errors are those of repetitions with pressures drawn within their errors. None where the points have no whole loop, or more than
    one in twenty repetitions has none.
    """
    if len(points) < 4:
        return None
    found = _construct([(density, pressure.value) for density, pressure in points])
    if found is None:
        return None
    random = np.random.default_rng(1)
    drawn = (_construct([(density, random.normal(pressure.value, pressure.known_error)) for density, pressure in points])
             for _ in range(draws))
    repeated = [one for one in drawn if one is not None]
    if len(repeated) < 0.95 * draws:
        return None
    return Loop(*(Estimate(value, float(error)) for value, error in zip(found, np.std(repeated, axis=0))))


def interface_free_energy(loop: Loop, disks: int) -> Estimate:
    """βγ(2R): two interfaces cross a square box where liquid and solid coexist, so N βΔf = 2 βγ L."""
    side = math.sqrt(disks * area_per_disk(0.5 * (loop.liquid.value + loop.solid.value)))
    factor = disks / (2.0 * side)
    return Estimate(factor * loop.barrier.value, factor * loop.barrier.known_error)


def density_at_pressure(points: Sequence[tuple[float, Estimate]], pressure: float, disks: int, draws: int = 200) -> Estimate | None:
    """⟨φ⟩ of so many disks at constant pressure, from their own P* at constant area:

        p(a) ∝ exp(N ∫ (P*(a′) − P*) da′)

    None where the points do not reach as far as the density fluctuates.
    """
    ends = [area_per_disk(density) for density, _ in points]
    area = np.linspace(min(ends), max(ends), 4001)

    def mean(values: Sequence[float]) -> float:
        excess = curve_through([(density, value) for (density, _), value in zip(points, values)])(area) - pressure
        exponent = disks * np.cumsum(excess) * (area[1] - area[0])
        weight = np.exp(exponent - exponent.max())
        reaches = max(weight[0], weight[-1]) < 1e-3
        return float(np.sum(weight * math.pi / (4.0 * area)) / weight.sum()) if reaches else math.nan

    found = mean([one.value for _, one in points])
    random = np.random.default_rng(1)
    repeated = [mean([random.normal(one.value, one.known_error) for _, one in points]) for _ in range(draws)]
    return None if math.isnan(found) or any(map(math.isnan, repeated)) else Estimate(found, float(np.std(repeated)))
