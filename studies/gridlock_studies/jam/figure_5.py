"""Figure 5: the equation of state while disks grow, for several rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing, Table
from ..statistics import Estimate, Verdict, mean_over_runs, plain
from .context import Context
from .runs import DECOMPRESS, Outcome, Run, run_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DENSITIES = (0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.72, 0.74, 0.76, 0.78, 0.79, 0.8, 0.81, 0.82)
PRESSURES = (1e2, 1e3, 1e4)
RUN = len(DENSITIES) + len(PRESSURES) + 1  #: the stage in which nothing grows and the pressure is measured


def _runs(context: Context, rate: float) -> list[Run]:
    extent = context.extent
    stages: list[dict[str, Any]] = [{"stage": "grow", "rate": rate, "until_packing_fraction": density} for density in DENSITIES]
    stages += [{"stage": "grow", "rate": rate, "until_pressure": pressure} for pressure in PRESSURES]
    stages += [{"stage": "run", "collisions_per_disk": 500}, {"stage": "run", "collisions_per_disk": 2500},
               {"stage": "compress", "until_pressure": 1e-6}, DECOMPRESS]
    return [run_of(f"growth at {rate}", stages, seed, 1.0 + 2e-3 / rate, disks=extent.growth_disks, packing_fraction=0.4, start="random")
            for seed in context.seeds(extent.growth_starts)]


def plan(context: Context) -> list[Run]:
    return [run for rate in context.extent.growth_rates for run in _runs(context, rate)]


def free_volume(outcome: Outcome, disks: int) -> float:
    """p (1 − φ/φ_J) N/[2 (N₀ − 1)] without growth, 1 where disks rattle in the cages of a jammed packing."""
    jamming, backbone = outcome.result("jamming_packing_fraction"), outcome.result("backbone_disks")
    share = 1.0 - outcome.stage(RUN, "packing_fraction") / jamming
    return outcome.stage(RUN, "pressure") * share * disks / (2.0 * (backbone - 1.0))


def _draw(groups: dict[float, list[Outcome]]) -> Figure:
    figure, axes = style.new_axes("packing fraction φ", "1 / reduced pressure")
    stages = len(DENSITIES) + len(PRESSURES)
    for (rate, outcomes), colour, marker in zip(groups.items(), style.COLOURS, style.MARKERS):
        if not outcomes:
            continue
        density = np.mean([[outcome.stage(k, "packing_fraction") for k in range(stages)] for outcome in outcomes], axis=0)
        pressure = np.mean([[outcome.stage(k, "pressure") for k in range(stages)] for outcome in outcomes], axis=0)
        axes.plot(density, 1.0 / pressure, color=colour, marker=marker, label=f"γ = {rate:g}")
    axes.set_ylim(0.0, None)
    axes.legend(loc="upper right")
    return figure


def make(context: Context) -> Chapter:
    extent = context.extent
    groups = {rate: context.outcomes(_runs(context, rate)) for rate in extent.growth_rates}
    rows = [(rate, context.seed + number, stage + 1, outcome.stage(stage, "packing_fraction"), outcome.stage(stage, "pressure"))
            for rate, outcomes in groups.items() for number, outcome in enumerate(outcomes) for stage in range(RUN + 1)]
    context.write_table("figure_5.csv", "rate seed stage packing_fraction pressure", rows)
    context.draw("figure_5", lambda: _draw(groups))
    table = Table(["γ", "φ_J", "p (1 − φ/φ_J) N/[2(N₀ − 1)] without growth"], "Means over starts; the second is measured at p near 10⁴, "
                  "after growth has ended, and is 1 for disks that rattle in the cages of a jammed packing.")
    ratios: dict[float, Estimate] = {}
    for rate, outcomes in groups.items():
        if outcomes:
            ratios[rate] = mean_over_runs([free_volume(outcome, extent.growth_disks) for outcome in outcomes])
            jamming = mean_over_runs([outcome.result("jamming_packing_fraction") for outcome in outcomes])
            table.rows.append([f"{rate:g}", str(jamming), str(ratios[rate])])
    slowest = min(ratios, default=None)
    verdict, text = Verdict.UNDECIDED, "no run"
    if slowest is not None:
        is_close = abs(ratios[slowest].value - 1.0) < 0.04
        verdict = Verdict.UNDECIDED if ratios[slowest].known_error > 0.02 else Verdict.AGREES if is_close else Verdict.DIFFERS
        text = (f"{ratios[slowest]} for the slowest growth, γ = {plain(slowest)}; agreement means within 0.04 of 1, and an error above 0.02 "
                "decides nothing.")
    return Chapter(
        title="Figure 5: the equation of state during growth",
        introduction=[f"{extent.growth_disks} hard disks grow from φ = 0.4 at rates γ until their reduced pressure is 10⁴. Fast growth leaves "
                      "equilibrium early, ends at a lower density, and looks jammed where it is not."],
        drawings=[Drawing(("figure_5",), "Means over starts.")],
        claims=[Claim("Figure 5", "Close to jamming, p (1 − φ/φ_J) = 2 (N₀ − 1)/N in equilibrium (free volume).", text, verdict)],
        tables=[table],
    )
