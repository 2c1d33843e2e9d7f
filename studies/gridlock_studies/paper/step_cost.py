"""What a step of N disks on k × k neighbourhoods costs: distances checked, counted, and time, measured."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import json
import math
import statistics
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import Error, Simulation

from ..statistics import total
from .context import Context
from .extent import Extent
from .figure_4 import neighbourhoods_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The sizes of neighbourhoods.
KS = (10, 15, 20)
STEPS = 100
SUBSTEPS = 5
#: Looks at all neighbours in a whole run: every disk, every sub-step of every step.
LOOKS = float(STEPS * SUBSTEPS)
#: With the most disks the square lattice is nearly close packed, so that the sizes run from a gas to a standstill.
LARGEST_PACKING_FRACTION = 0.78
#: Sizes up to this packing fraction count as dilute: hardly a disk halts.
DILUTE = 0.32
#: Above it the start is so nearly close packed that it stays a lattice in which nothing moves, a case of its own.
LIQUID = 0.72


def settings_of(context: Context, disks: int, k: int) -> dict[str, Any]:
    """With the paper's own lists: the figure is about what they cost."""
    return {
        "disks": {"count": disks, "radius": _radius(context.extent)},
        "engine": {"cells": k, "grid": "linked", "substeps": SUBSTEPS},
        "run": {"seed": context.seed},
    }


def paper_checks(disks: int, k: int) -> float:
    """The paper's estimate of what one look at all neighbours costs, 9N²/k²: N disks, nine neighbourhoods each, N/k² disks in a
    neighbourhood."""
    return 9.0 * (disks / k) ** 2


def mean_block_size(k: int) -> float:
    """How many neighbourhoods a 3×3 block holds on average, (3k − 2)²/k², since a block at a wall is cut.

    >>> mean_block_size(1), mean_block_size(2), mean_block_size(4)
    (1.0, 4.0, 6.25)
    """
    return ((3.0 * k - 2.0) / k) ** 2


def uniform_checks(disks: int, k: int) -> float:
    """The same cost exactly, for disks that stand anywhere with equal chance: N(N − 1)(3k − 2)²/k⁴.

    A disk is in each neighbourhood with chance 1/k², each of the other N − 1 is in its block with chance (cells)/k², and no disk
    checks itself.
    """
    return disks * (disks - 1.0) * mean_block_size(k) / float(k) ** 2


def checks_of_one_look(positions: NDArray[Any], k: int) -> int:
    """The same cost for disks where they stand, in the unit box, counted.

    >>> checks_of_one_look(np.array([[0.1, 0.1], [0.2, 0.1], [0.9, 0.9]]), 10)
    2
    """
    column, row = neighbourhoods_of(positions, k).T
    disks_in = np.zeros((k + 2, k + 2), dtype=np.int64)  # with a rim of empty ones
    disks_in[1:-1, 1:-1] = np.bincount(row * k + column, minlength=k * k).reshape(k, k)
    rows = disks_in[:-2] + disks_in[1:-1] + disks_in[2:]
    blocks = rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:]
    return int((disks_in[1:-1, 1:-1] * (blocks - 1)).sum())


@dataclasses.dataclass
class StepCost:
    """What 100 steps of N disks on k × k neighbourhoods cost."""

    disks: int
    k: int
    packing_fraction: float = 0.0
    checks: float = 0.0  #: distances checked, exactly; 0 as long as they are not counted
    free_checks: float = 0.0  #: what they would be if no disk halted, with the disks where they are
    halted_fraction: float = 0.0
    times: list[float] = dataclasses.field(default_factory=list)  #: CPU seconds of each repeat

    @property
    def seconds(self) -> float:
        return statistics.median(self.times)

    @property
    def spread(self) -> float:
        return max(self.times) - min(self.times)

    @property
    def is_dilute(self) -> bool:
        return self.packing_fraction <= DILUTE

    @property
    def is_liquid(self) -> bool:
        return self.packing_fraction <= LIQUID


def _radius(extent: Extent) -> float:
    return math.sqrt(LARGEST_PACKING_FRACTION / (max(extent.timing_counts) * math.pi))


def require_possible(extent: Extent) -> None:
    """:raises Error: where blocks of 3 × 3 neighbourhoods do not hold all that a disk can meet."""
    # A step of 0.1 diameters per v_max, and no disk is likely to become three times as fast as v_max.
    if 2.0 * _radius(extent) * 1.3 * max(KS) > 1.0:
        raise Error("the disks of Figure 5 are too large for its finest neighbourhoods, so blocks would be wider than 3×3\n"
                    "  hint: let timing_counts go up to 700 disks or more")


def expected_seconds(extent: Extent) -> float:
    """What the measurement takes, roughly; for the progress."""
    runs = (LOOKS * (2e-9 * uniform_checks(disks, k) + 4e-8 * disks) for disks in extent.timing_counts for k in KS)
    return (extent.timing_repeats + 1) * sum(runs)


class Measurement:
    """All sizes of Figure 5, measured in rounds; what is measured is kept."""

    def __init__(self, context: Context) -> None:
        self._context = context
        extent = context.extent
        self._repeats = extent.timing_repeats
        self.costs = [StepCost(disks, k) for disks in extent.timing_counts for k in KS]
        self._key = json.dumps(["Figure 5", extent.timing_counts, context.seed])
        kept = context.partial_results.restore(self._key)
        if kept is not None:
            self.costs = [StepCost(**cost) for cost in json.loads(str(kept["costs"]))]

    def _keep(self) -> None:
        self._context.partial_results.keep(self._key, {"costs": json.dumps([dataclasses.asdict(cost) for cost in self.costs])})

    def _simulation(self, cost: StepCost) -> Simulation:
        simulation = Simulation(settings_of(self._context, cost.disks, cost.k), observe={"every": 2 * STEPS, "structure_every": 0})
        simulation.run(steps=0)  # takes the sample of the start, which is no part of what is timed
        return simulation

    def measure(self, jobs: int, on_progress: Callable[[float], None]) -> list[StepCost]:
        """Counts the distances of every size on some cores, then times one size after the other on this thread: anything else
        running in the process would be in the CPU time."""
        def report() -> None:
            done = sum((cost.checks > 0.0) + min(len(cost.times), self._repeats) for cost in self.costs)
            on_progress(done / (len(self.costs) * (self._repeats + 1)))

        counting = concurrent.futures.ThreadPoolExecutor(jobs)
        try:
            for _ in counting.map(self._count, [cost for cost in self.costs if cost.checks == 0.0]):
                report()
            # All sizes once, then all again: a machine that slows down for a while then spoils one repeat, not one size.
            for repeat in range(self._repeats):
                self._keep()
                for cost in self.costs:
                    if len(cost.times) <= repeat:
                        cost.times.append(self._seconds(cost))
                        report()
        finally:
            counting.shutdown(cancel_futures=True)
            self._keep()
        return self.costs

    def _count(self, cost: StepCost) -> None:
        """The distances that a run checks, and what they would be without halting, step by step."""
        simulation = self._simulation(cost)
        radius = simulation.agents.radius.copy()
        free = 0
        for _ in range(STEPS):
            free += SUBSTEPS * checks_of_one_look(simulation.agents.positions, cost.k)
            simulation.step()
        counts = simulation.counts
        cost.packing_fraction = math.pi * total(radius * radius)
        cost.free_checks = float(free)
        cost.halted_fraction = counts["halted_moves"] / counts["moves"]
        cost.checks = float(counts["distance_checks"])

    def _seconds(self, cost: StepCost) -> float:
        """CPU time of one call that advances a fresh simulation by all steps: the engine's, since Python waits meanwhile."""
        simulation = self._simulation(cost)
        start = time.process_time()
        simulation.run(steps=STEPS)
        return time.process_time() - start
