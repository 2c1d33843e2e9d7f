"""Figure 5: what the grid saves, in distances checked and in time."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import json
import math
import statistics
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Error
from ..simulation import Simulation
from ..study import style
from ..study.chapter import Chapter, Claim, Drawing, SetUp, Table
from .extent import Extent
from .figure_4 import neighbourhoods_of
from ..study.statistics import PowerLaw, Verdict, fit_power_law, plain, total
from .context import Context

if TYPE_CHECKING:
    from matplotlib.figure import Figure
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


def _settings(context: Context, disks: int, k: int) -> dict[str, Any]:
    """With the paper's own lists: the figure is about what they cost."""
    return {
        "disks": {"count": disks, "radius": _radius(context.extent)},
        "engine": {"cells": k, "grid": "linked", "substeps": SUBSTEPS},
        "run": {"seed": context.seed},
    }


def _set_ups(context: Context) -> list[SetUp]:
    """A few of the sizes, from a gas to a lattice that hardly moves, on each grid."""
    counts = sorted(context.extent.timing_counts)
    few = sorted({counts[0], counts[len(counts) // 2], counts[-1]})
    return [SetUp(f"N = {count}", _settings(context, count, k), f"k = {k}", colour="neighbourhood", has_grid=True)
            for k in KS for count in few]


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
        simulation = Simulation(_settings(self._context, cost.disks, cost.k), observe={"every": 2 * STEPS, "structure_every": 0})
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


def _law(costs: Sequence[StepCost], measure: Callable[[StepCost], float]) -> PowerLaw | None:
    """measure(cost) ∝ N^a k^b."""
    costs = [cost for cost in costs if measure(cost) > 0.0]
    return fit_power_law([(cost.disks, cost.k) for cost in costs], [measure(cost) for cost in costs])


class Laws:
    """The power laws of one measure over all sizes, the dilute and the dense ones."""

    def __init__(self, costs: Sequence[StepCost], measure: Callable[[StepCost], float]) -> None:
        liquid = [cost for cost in costs if cost.is_liquid]
        self.all = _law(liquid, measure)
        self.dilute = _law([cost for cost in liquid if cost.is_dilute], measure)
        self.dense = _law([cost for cost in liquid if not cost.is_dilute], measure)


def _text(law: PowerLaw | None, which: int) -> str:
    return "–" if law is None else str(law.exponents[which])


def _law_table(free: Laws, made: Laws, seconds: Laws) -> Table:
    table = Table(["", "a", "a, dilute", "a, dense", "b"], (
        f"Exponents of cost ∝ N^a k^b by least squares in the logarithms up to φ = {LIQUID}; dilute: φ ≤ {DILUTE}, dense: "
        "above. The errors measure how far the points are from a power law."))
    for name, laws in (("distance checks if no disk halted", free), ("distance checks made", made), ("CPU time", seconds)):
        table.rows.append([name, _text(laws.all, 0), _text(laws.dilute, 0), _text(laws.dense, 0), _text(laws.all, 1)])
    table.rows.append(["9N²/k²", "2", "2", "2", "−2"])
    return table


def _cost_claim(costs: Sequence[StepCost], free: Laws) -> Claim:
    ratios = [cost.free_checks / (LOOKS * paper_checks(cost.disks, cost.k)) for cost in costs]
    misfits = [abs(cost.free_checks / (LOOKS * uniform_checks(cost.disks, cost.k)) - 1.0) for cost in costs]
    verdict = Verdict.UNDECIDED
    if free.all is not None:
        a, b = free.all.exponents
        verdict = Verdict.AGREES if abs(a.value - 2.0) < 0.1 and abs(b.value + 2.0) < 0.1 else Verdict.DIFFERS
    return Claim(
        "Figure 5",
        "The cost of a step is proportional to 9N²/k²: N disks, nine neighbourhoods each, N/k² disks in a neighbourhood.",
        f"The distances that would be checked if no disk halted are {min(ratios):.2f} to {max(ratios):.2f} of 9N²/k² and grow as "
        f"N^({_text(free.all, 0)}) k^({_text(free.all, 1)}). The shortfall is the walls': a 3×3 block there is cut, which leaves "
        f"(3k−2)²/k² cells on average, {mean_block_size(10):.2f} for k = 10 and {mean_block_size(20):.2f} for k = 20. For disks "
        "anywhere with equal chance that makes N(N−1)(3k−2)²/k⁴, exactly; the counts differ from it by "
        f"{100.0 * statistics.median(misfits):.1f} % (median) to {100.0 * max(misfits):.1f} % (few disks, which the start keeps "
        "apart). What is actually checked is less, see the next claim. Agreement means exponents within 0.1 of 2 and of −2.",
        verdict,
    )


def _growth_claim(costs: Sequence[StepCost], free: Laws, made: Laws, seconds: Laws) -> Claim:
    first = min(costs, key=lambda cost: cost.packing_fraction)
    last = [cost for cost in costs if cost.packing_fraction == max(cost.packing_fraction for cost in costs)][-1]
    verdict = Verdict.UNDECIDED
    if made.dense is not None and free.dense is not None and seconds.dense is not None:
        is_slower = made.dense.exponents[0].value < free.dense.exponents[0].value - 0.1 and seconds.dense.exponents[0].value < 2.0
        verdict = Verdict.AGREES if is_slower else Verdict.DIFFERS
    return Claim(
        "Figure 5",
        "With disks of constant size the time grows more slowly than N², because disks in dense systems halt early.",
        f"Above φ = {DILUTE} the CPU time grows as N^({_text(seconds.dense, 0)}) and the distances checked as "
        f"N^({_text(made.dense, 0)}); without halting they would grow as N^({_text(free.dense, 0)}). Below, where few halt, the "
        f"distances grow as N^({_text(made.dilute, 0)}); the time as N^({_text(seconds.dilute, 0)}), since handling a disk "
        f"costs too, however few neighbours it has. From φ = {first.packing_fraction:.2f} to {last.packing_fraction:.2f} the "
        f"share of the checks that is made falls from {first.checks / first.free_checks:.3f} to "
        f"{last.checks / last.free_checks:.3f}, while the share of halted moves rises from {first.halted_fraction:.3f} to "
        f"{last.halted_fraction:.3f}.",
        verdict,
    )


def _equal_cost_claims(costs: Sequence[StepCost]) -> list[Claim]:
    """The claims about 1000 and 2000 disks, where both were measured."""
    by_size = {(cost.disks, cost.k): cost for cost in costs}
    small, large = by_size.get((1000, 10)), by_size.get((2000, 20))
    if small is None or large is None:
        return []
    checks, free = large.checks / small.checks, large.free_checks / small.free_checks
    seconds = large.seconds / small.seconds

    def verdict_on(ratio: float) -> Verdict:
        return Verdict.AGREES if abs(ratio - 1.0) < 0.1 else Verdict.DIFFERS

    return [
        Claim(
            "Figure 5", "1000 disks on 10×10 neighbourhoods need as many distance checks as 2000 disks on 20×20.",
            f"Distance checks in 100 steps: {small.checks:.0f} and {large.checks:.0f}, a ratio of {checks:.3f}. Without halting "
            f"it would be {free:.3f}, since the finer grid loses less at the walls "
            f"({uniform_checks(2000, 20) / uniform_checks(1000, 10):.3f} for disks anywhere with equal chance); halting takes "
            f"away {100.0 * (1.0 - checks / free):.0f} % of it, since the 2000 disks fill φ = {large.packing_fraction:.2f} "
            f"instead of {small.packing_fraction:.2f}. Agreement means within 10 %.",
            verdict_on(checks),
        ),
        Claim(
            "Figure 5", "1000 disks on 10×10 neighbourhoods cost the same time as 2000 disks on 20×20.",
            f"CPU time of 100 steps: {1e3 * small.seconds:.1f} ms and {1e3 * large.seconds:.1f} ms, a ratio of {seconds:.2f}. "
            "The ratio depends on the machine: each disk costs something besides its distances, and there are twice as many, but a "
            "distance in the shorter lists of the finer grid may cost less. Agreement means within 10 %.",
            verdict_on(seconds),
        ),
    ]


def fit_look_cost(costs: Sequence[StepCost]) -> tuple[float, float]:
    """Seconds for each disk and for each of 9N²/k² distances in a look without halting, from the dilute sizes, where hardly a
    disk halts; least squares of the relative misfit."""
    dilute = [cost for cost in costs if cost.is_dilute and cost.seconds > 0.0]
    design = [(LOOKS * cost.disks / cost.seconds, LOOKS * paper_checks(cost.disks, cost.k) / cost.seconds) for cost in dilute]
    if len(design) < 2:
        return 0.0, 0.0
    per_disk, per_check = np.linalg.lstsq(np.array(design), np.ones(len(design)), rcond=None)[0]
    return float(per_disk), float(per_check)


def _draw_times(costs: Sequence[StepCost]) -> Figure:
    figure, axes = style.new_axes("Figure 5: 100 steps of N disks on k × k neighbourhoods", "number of disks N",
                                  "CPU time of 100 steps / ms")
    per_disk, per_check = fit_look_cost(costs)
    n = np.linspace(0.0, 1.04 * max(cost.disks for cost in costs), 200)
    for k, colour, marker in zip(KS, style.COLOURS, style.MARKERS):
        mine = [cost for cost in costs if cost.k == k]
        axes.plot([cost.disks for cost in mine], [1e3 * cost.seconds for cost in mine], color=colour, marker=marker, label="k "
                                                                                                                           "= "
                                                                                                                           f"{k}")
        axes.plot(n, 1e3 * LOOKS * (per_disk * n + per_check * 9.0 * n**2 / k**2), color=colour, linestyle="--", linewidth=0.8)
    axes.plot([], [], color=style.GREY, linestyle="--", linewidth=0.8, label="if no disk halted")
    # The paper's circles.
    marked = [cost for cost in costs if (cost.disks, cost.k) in ((1000, 10), (2000, 20))]
    if marked:
        axes.plot([cost.disks for cost in marked], [1e3 * cost.seconds for cost in marked], "o", markersize=13,
                  markerfacecolor="none", markeredgecolor=style.COLOURS[1], label="of equal cost, says the paper")
    axes.set(xlim=(0.0, None), ylim=(0.0, 1.25e3 * max(cost.seconds for cost in costs)))
    axes.legend(loc="upper left")
    return figure


def _draw_checks(costs: Sequence[StepCost]) -> Figure:
    figure, axes = style.new_axes("Distance checks in units of the paper's 9N²/k²", "number of disks N", "distance checks / "
                                                                                                         "(9N²/k²)")
    style.reference(axes, 1.0, "9N²/k²")
    for k, colour, marker in zip(KS, style.COLOURS, style.MARKERS):
        mine = [cost for cost in costs if cost.k == k]
        disks = [cost.disks for cost in mine]
        paper = [LOOKS * paper_checks(cost.disks, k) for cost in mine]
        axes.plot(disks, [cost.free_checks / checks for cost, checks in zip(mine, paper)], color=colour, linestyle="--",
                  label=f"k = {k}, if no disk halted")
        axes.plot(disks, [cost.checks / checks for cost, checks in zip(mine, paper)], color=colour, marker=marker,
                  label=f"k = {k}, made")
    axes.set(xlim=(0.0, None), ylim=(0.0, 1.15))
    axes.legend(loc="lower left")
    return figure


def measure(context: Context, jobs: int, on_progress: Callable[[float], None]) -> None:
    """Counts and times; make() tells of it."""
    context.costs = Measurement(context).measure(jobs, on_progress)


def make(context: Context) -> Chapter:
    costs = context.costs
    rows = []
    for cost in costs:
        paper = LOOKS * paper_checks(cost.disks, cost.k)
        rows.append((cost.disks, cost.k, cost.packing_fraction, cost.seconds, cost.spread, cost.checks, cost.free_checks,
                     LOOKS * uniform_checks(cost.disks, cost.k), paper, cost.checks / paper, cost.free_checks / paper,
                     cost.halted_fraction))
    context.write_table("figure_5.csv", "disks k packing_fraction seconds seconds_spread distance_checks free_distance_checks "
                        "uniform_distance_checks paper_distance_checks checks_over_paper free_over_paper halted_fraction", rows)
    context.draw("figure_5", lambda: _draw_times(costs))
    context.draw("figure_5_checks", lambda: _draw_checks(costs))
    free = Laws(costs, lambda cost: cost.free_checks)
    made = Laws(costs, lambda cost: cost.checks)
    seconds = Laws(costs, lambda cost: cost.seconds)
    per_disk, per_check = fit_look_cost(costs)
    return Chapter(
        title="Figure 5: what the grid saves",
        introduction=[
            f"Disks of constant size, so large that {max(context.extent.timing_counts)} of them just fit the square lattice (φ = "
            f"{plain(LARGEST_PACKING_FRACTION)}); fewer disks are a thinner gas. Times are the CPU time of the process in one "
            f"call that advances a fresh simulation by {STEPS} steps, with nothing else running in the process, the median of "
            f"{context.extent.timing_repeats} repeats on this machine; distance checks are counted exactly and are the same on "
            "every machine."
        ],
        set_ups=_set_ups(context),
        drawings=[
            Drawing(("figure_5",), (
                f"CPU time of 100 steps against the number of disks. Dashed: {1e9 * per_disk:.0f} ns for each disk and "
                f"{1e9 * per_check:.2f} ns for each of 9N²/k² distances in every sub-step, two numbers taken from the dilute "
                "sizes of all k together. Towards the largest N the box is full, most disks halt at once, and a step costs less "
                "than without halting. Rings: the two set-ups that the paper circles as equally costly.")),
            Drawing(("figure_5_checks",), (
                "The distances checked in 100 steps over 500 · 9N²/k² (five sub-steps a step). Dashed: if no disk halted, from "
                "counting the disks of every block at every step.")),
        ],
        claims=[_cost_claim(costs, free), _growth_claim(costs, free, made, seconds), *_equal_cost_claims(costs)],
        tables=[_law_table(free, made, seconds)],
    )
