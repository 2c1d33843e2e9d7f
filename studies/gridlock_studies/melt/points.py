"""A number of disks at a packing fraction: the runs from both starts, and whether they agree."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import combine

from ..statistics import Estimate, three_sigma
from .runs import CRYSTAL, LIQUID, Outcome

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Each run is cut into so many blocks, to see whether two runs have been to the same places.
_BLOCKS = 8


def are_apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether every block of one series is above every block of the other.

    Blocks that forget each other are so by chance in one of 6,435 cases, whatever their distribution.

    >>> are_apart(np.arange(16.0), np.arange(16.0) + 20.0), are_apart(np.arange(16.0), np.arange(16.0) + 5.0)
    (True, False)
    """
    first, second = (np.array([block.mean() for block in np.array_split(series, _BLOCKS)]) for series in (one, other))
    return bool(first.min() > second.max() or second.min() > first.max())


@dataclasses.dataclass(frozen=True)
class Point:
    """Runs that differ in start and seed alone."""

    disks: int
    packing_fraction: float
    runs: dict[str, list[Outcome]]  #: by the kind of start

    def pressures(self, kind: str | None = None) -> Estimate:
        """P* = βP(2R)² of the runs from one kind of start; of all by default.

        The error is the larger one of that from the scatter of the runs and that from their blocks.
        """
        factor = 4.0 * self.packing_fraction / math.pi
        outcomes = [outcome for name, some in self.runs.items() if kind in (None, name) for outcome in some]
        if not outcomes:
            return Estimate(math.nan)
        found = combine([outcome.result("compressibility_factor") for outcome in outcomes])
        return Estimate(factor * found.value, None if math.isnan(found.error) else factor * found.error)

    def mean(self, samples: Callable[[Outcome], NDArray[Any]], statistic: Callable[[NDArray[Any]], float]) -> Estimate:
        """Of a number that each run has by its samples, one for each entry of an array.

        The error is the larger one of that from the scatter of the runs and that from leaving out one block of a run at a time.
        """
        found = combine([_jackknife(samples(outcome), statistic) for outcome in self.trusted])
        return Estimate(float(found.value), None if math.isnan(found.error) else float(found.error))

    @property
    def trusted(self) -> list[Outcome]:
        """All runs where the starts agree, those from the crystal where they do not."""
        kinds = (CRYSTAL, LIQUID) if self.is_equilibrated else (CRYSTAL,)
        return [outcome for kind in kinds for outcome in self.runs.get(kind, [])]

    @property
    def difference(self) -> str:
        """Why the starts do not agree; empty where they do."""
        crystal, liquid = self.runs.get(CRYSTAL, []), self.runs.get(LIQUID, [])
        if not crystal or not liquid:
            return "a start is missing"
        names = {"compressibility_factor": "P*", "global_bond_orientation_order": "|Ψ6|"}
        for name, text in names.items():
            if any(are_apart(one.series(name), other.series(name)) for one in crystal for other in liquid):
                return f"blocks of {text} do not overlap"
        first, second = self.pressures(CRYSTAL), self.pressures(LIQUID)
        if first.error is None or second.error is None:
            return "an error is not known"
        knows_all = all(not math.isnan(outcome.result("compressibility_factor")[1]) for outcome in (*crystal, *liquid))
        allowed = 3.0 if knows_all else three_sigma(len(crystal) + len(liquid) - 2)
        distance = abs(first.value - second.value) / math.hypot(first.error, second.error)
        return f"P* is {distance:.1f} standard errors apart" if distance > allowed else ""

    @property
    def is_equilibrated(self) -> bool:
        return not self.difference

    @property
    def note(self) -> str:
        """For captions and texts."""
        return "" if self.is_equilibrated else " (crystal alone)"


def _jackknife(samples: NDArray[Any], statistic: Callable[[NDArray[Any]], float]) -> tuple[float, float]:
    """A number of all samples, and its error from blocks, B. Efron (1982), doi:10.1137/1.9781611970319.

    >>> value, error = _jackknife(np.random.default_rng(1).normal(0.0, 1.0, 10_000), lambda x: float(np.mean(x)))
    >>> bool(abs(error - 0.01) < 0.005)
    True
    """
    blocks = np.array_split(samples, _BLOCKS)
    without = [statistic(np.concatenate([*blocks[:k], *blocks[k + 1:]])) for k in range(_BLOCKS)]
    return statistic(samples), math.sqrt((_BLOCKS - 1) * float(np.var(without)))


def errors_text(distance: float) -> str:
    """
    >>> errors_text(-3.21), errors_text(1234.0)
    ('3.2 standard errors', 'more than 100 standard errors')
    """
    return f"{abs(distance):.1f} standard errors" if abs(distance) < 100.0 else "more than 100 standard errors"


def decay_exponent(outcome: Outcome, number: int) -> float:
    """η of r^(−η), fitted from three diameters to a quarter of the box; below noise the curve ends.

    g₆(r) is number 0, c_G(r) number 1.
    """
    distance, curve = outcome.curve(number)
    # Half the box is the whole reach; its second half feels the images of the disks.
    use = (distance > 3.0) & (distance < 0.55 * distance[-1])
    low = np.flatnonzero(use & (curve < 0.01))
    use[low[0] if len(low) else len(use):] = False
    if np.count_nonzero(use) < 3:
        return math.nan
    return -float(np.polyfit(np.log(distance[use]), np.log(curve[use]), 1)[0])
