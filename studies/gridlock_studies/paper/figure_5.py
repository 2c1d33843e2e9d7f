"""Figure 5: what the grid saves, in distances checked and in time."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing, SetUp, Table
from ..statistics import Estimate, PowerLaw, Verdict, fit_power_law, mean_over_runs, plain, verdict_within
from .context import Context
from .step_cost import (DILUTE, KS, LARGEST_PACKING_FRACTION, LIQUID, LOOKS, STEPS, Measurement, StepCost, mean_block_size, paper_checks,
                        settings_of, uniform_checks)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def _set_ups(context: Context) -> list[SetUp]:
    """A few of the sizes, from a gas to a lattice that hardly moves, on each grid."""
    counts = sorted(context.extent.timing_counts)
    few = sorted({counts[0], counts[len(counts) // 2], counts[-1]})
    return [SetUp(f"N = {count}", settings_of(context, count, k), f"k = {k}", colour="neighbourhood", has_grid=True)
            for k in KS for count in few]


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


def _is_lower(exponent: Estimate, bound: float, error: float) -> Verdict:
    """Whether an exponent is below a bound, both with errors, by more than two standard errors; differs where it is above."""
    allowed = 2.0 * math.hypot(exponent.known_error, error)
    if abs(exponent.value - bound) <= allowed:
        return Verdict.UNDECIDED
    return Verdict.AGREES if exponent.value < bound else Verdict.DIFFERS


def _time_of_dilute(seconds: Laws) -> str:
    """How the time grows where few disks halt, with the reason where there is one."""
    text = f"the time as N^({_text(seconds.dilute, 0)})"
    if seconds.dilute is not None and _is_lower(seconds.dilute.exponents[0], 2.0, 0.0) is Verdict.AGREES:
        text += ", since handling a disk costs too, however few neighbours it has"
    return text


def _growth_claim(costs: Sequence[StepCost], free: Laws, made: Laws, seconds: Laws) -> Claim:
    first = min(costs, key=lambda cost: cost.packing_fraction)
    last = [cost for cost in costs if cost.packing_fraction == max(cost.packing_fraction for cost in costs)][-1]
    verdict = Verdict.UNDECIDED
    if made.dense is not None and free.dense is not None and seconds.dense is not None:
        of_made, of_free, of_time = (law.exponents[0] for law in (made.dense, free.dense, seconds.dense))
        by_checks = _is_lower(of_made, of_free.value - 0.1, of_free.known_error)
        by_time = _is_lower(of_time, 2.0, 0.0)
        verdict = Verdict.DIFFERS if Verdict.DIFFERS in (by_checks, by_time) else (
            Verdict.AGREES if by_checks is by_time is Verdict.AGREES else Verdict.UNDECIDED)
    return Claim(
        "Figure 5",
        "With disks of constant size the time grows more slowly than N², because disks in dense systems halt early.",
        f"Above φ = {DILUTE} the CPU time grows as N^({_text(seconds.dense, 0)}) and the distances checked as "
        f"N^({_text(made.dense, 0)}); without halting they would grow as N^({_text(free.dense, 0)}). Below, where few halt, the "
        f"distances grow as N^({_text(made.dilute, 0)}); {_time_of_dilute(seconds)}. "
        f"From φ = {first.packing_fraction:.2f} to {last.packing_fraction:.2f} the "
        f"share of the checks that is made falls from {first.checks / first.free_checks:.3f} to "
        f"{last.checks / last.free_checks:.3f}, while the share of halted moves rises from {first.halted_fraction:.3f} to "
        f"{last.halted_fraction:.3f}. Agreement means, by more than two standard errors, an exponent of the checks that is more than 0.1 "
        "lower than without halting, and one of the time below 2.",
        verdict,
    )


def _equal_cost_claims(costs: Sequence[StepCost]) -> list[Claim]:
    """The claims about 1000 and 2000 disks, where both were measured."""
    by_size = {(cost.disks, cost.k): cost for cost in costs}
    small, large = by_size.get((1000, 10)), by_size.get((2000, 20))
    if small is None or large is None:
        return []
    checks, free = large.checks / small.checks, large.free_checks / small.free_checks
    return [
        Claim(
            "Figure 5", "1000 disks on 10×10 neighbourhoods need as many distance checks as 2000 disks on 20×20.",
            f"Distance checks in 100 steps: {small.checks:.0f} and {large.checks:.0f}, a ratio of {checks:.3f}. Without halting "
            f"it would be {free:.3f}, since the finer grid loses less at the walls "
            f"({uniform_checks(2000, 20) / uniform_checks(1000, 10):.3f} for disks anywhere with equal chance); halting takes "
            f"away {100.0 * (1.0 - checks / free):.0f} % of it, since the 2000 disks fill φ = {large.packing_fraction:.2f} "
            f"instead of {small.packing_fraction:.2f}. Agreement means within 10 %.",
            verdict_within(checks - 1.0, 0.0, 0.1),
        ),
        _equal_time_claim(small, large),
    ]


def _ratio_of_times(small: StepCost, large: StepCost) -> Estimate:
    """Round by round, since a machine that slows down for a while does so for both."""
    rounds = [there / here for here, there in zip(small.times, large.times)]
    return mean_over_runs(rounds) if rounds else Estimate(math.nan)


def _equal_time_claim(small: StepCost, large: StepCost) -> Claim:
    from scipy.special import stdtrit  # type: ignore[import-untyped]

    ratio, repeats = _ratio_of_times(small, large), min(len(small.times), len(large.times))
    statement = "1000 disks on 10×10 neighbourhoods cost the same time as 2000 disks on 20×20."
    if ratio.error is None:
        return Claim("Figure 5", statement, "One repeat has no error.", Verdict.UNDECIDED)
    half_width = float(stdtrit(repeats - 1, 0.975)) * ratio.error
    spreads = " and ".join(f"{1e3 * cost.seconds:.1f} ms ({1e3 * min(cost.times):.1f} to {1e3 * max(cost.times):.1f})"
                           for cost in (small, large))
    here, there = (1e9 * cost.seconds / cost.checks for cost in (small, large))
    verdict = verdict_within(ratio.value - 1.0, half_width, 0.1)
    return Claim(
        "Figure 5", statement,
        f"CPU time of 100 steps, median of {repeats} repeats and their range: {spreads}. The ratio, repeat by repeat: {ratio}; with 95 % "
        f"confidence (Student's t) {ratio.value - half_width:.2f} to {ratio.value + half_width:.2f}. "
        f"{_reason_for_times(ratio.value - 1.0, half_width, large.checks / small.checks, here, there)} Agreement means within 10 %; not "
        "decided, that this range has a limit of agreement in it.",
        verdict,
    )


def _reason_for_times(difference: float, half_width: float, checks: float, here: float, there: float) -> str:
    """Why one set-up takes longer, from the distances checked and the time of each, in nanoseconds; nothing where neither does."""
    if abs(difference) <= half_width:
        return "The repeats do not tell which takes longer."
    parts = f"{checks:.2f} times as many distances are checked, and each takes {there:.2f} ns instead of {here:.2f} ns"
    if difference > 0.0 and there > here:
        return (f"The 2000 disks take longer: {parts}, in which the time of each disk besides its distances is counted, and there are "
                "twice as many disks.")
    if difference < 0.0 and there < here:
        return (f"The 2000 disks take less: {parts}, although the time of each disk besides its distances is counted in them and there are "
                "twice as many disks.")
    return f"The 2000 disks take {'longer' if difference > 0.0 else 'less'}: {parts}."


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
    figure, axes = style.new_axes("number of disks N", "CPU time of 100 steps / ms")
    per_disk, per_check = fit_look_cost(costs)
    n = np.linspace(0.0, 1.04 * max(cost.disks for cost in costs), 200)
    for k, colour, marker in zip(KS, style.COLOURS, style.MARKERS):
        mine = [cost for cost in costs if cost.k == k]
        middle = np.array([cost.seconds for cost in mine])
        ranges = np.array([(cost.seconds - min(cost.times), max(cost.times) - cost.seconds) for cost in mine]).T
        axes.errorbar([cost.disks for cost in mine], 1e3 * middle, 1e3 * ranges, color=colour, marker=marker, elinewidth=0.8, capsize=2,
                      label=f"k = {k}")
        axes.plot(n, 1e3 * LOOKS * (per_disk * n + per_check * 9.0 * n**2 / k**2), color=colour, linestyle="--", linewidth=0.8)
    axes.plot([], [], color=style.GREY, linestyle="--", linewidth=0.8, label="if no disk halted")
    # The paper's circles.
    marked = [cost for cost in costs if (cost.disks, cost.k) in ((1000, 10), (2000, 20))]
    if marked:
        axes.plot([cost.disks for cost in marked], [1e3 * cost.seconds for cost in marked], "o", markersize=13,
                  markerfacecolor="none", markeredgecolor=style.COLOURS[1], label="of equal cost, says the paper")
    axes.set(xlim=(0.0, None), ylim=(0.0, 1.25e3 * max(max(cost.times) for cost in costs)))
    _name_standstill(axes, costs)
    axes.legend(loc="upper left")
    return figure


def _name_standstill(axes: Axes, costs: Sequence[StepCost]) -> None:
    """Says of the fullest box why its steps cost so little, where most disks do halt."""
    fullest = max((cost for cost in costs if cost.k == KS[0]), key=lambda cost: cost.disks)
    if fullest.halted_fraction > 0.5:
        axes.annotate(f"φ = {fullest.packing_fraction:.2f}:\n{100.0 * fullest.halted_fraction:.0f} % of the\nmoves halted",
                      (fullest.disks, 1e3 * fullest.seconds), (-8, 30), textcoords="offset points", ha="right", fontsize=8,
                      color=style.GREY, bbox={"color": "white", "alpha": 0.8, "pad": 1.0},
                      arrowprops={"arrowstyle": "-", "color": style.GREY, "linewidth": 0.6})


def _draw_checks(costs: Sequence[StepCost]) -> Figure:
    figure, axes = style.new_axes("number of disks N", "distance checks / (9N²/k²)")
    style.reference(axes, 1.0, "9N²/k²")
    for k, colour, marker in zip(KS, style.COLOURS, style.MARKERS):
        mine = [cost for cost in costs if cost.k == k]
        disks = [cost.disks for cost in mine]
        paper = [LOOKS * paper_checks(cost.disks, k) for cost in mine]
        axes.plot(disks, [cost.free_checks / checks for cost, checks in zip(mine, paper)], color=colour, linestyle="--")
        axes.plot(disks, [cost.checks / checks for cost, checks in zip(mine, paper)], color=colour, marker=marker, label=f"k = {k}")
    axes.plot([], [], color=style.GREY, label="made")
    axes.plot([], [], color=style.GREY, linestyle="--", label="if no disk halted")
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
                "CPU time of 100 steps against the number of disks, with bars from the shortest repeat to the longest. Dashed: "
                f"{1e9 * per_disk:.0f} ns for each disk and "
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
