"""Figure 10: the packing fraction at which the pressure of slow shear vanishes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, mean_over_runs, three_sigma, verdict_within
from .context import Context
from .runs import Run, run_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEP = 5e-3  #: strain of a step; pressures with 10⁻³ are the same within their errors
LATE = 0.25  #: the strain from which on the pressure is that of steady flow
BOUND = 2e-3  #: what 256 disks and a straight line may differ from large systems
#: P. Olsson and S. Teitel (2011) from slow flow, D. Vågberg et al. (2011) from quasi-static shear and from random quenches.
PUBLISHED = (("slow flow", 0.84347), ("quasi-static shear", 0.8432), ("random quench", 0.84177))


def _runs(context: Context) -> dict[float, list[Run]]:
    extent = context.extent
    shear = {"stage": "shear", "until_strain": extent.slow_strain, "strain_step": STEP, "strain_accuracy": STEP}
    return {density: [run_of(f"{extent.slow_disks} disks at {density}, sheared", [{"stage": "quench"}, shear], seed,
                             0.006 * extent.slow_disks * extent.slow_strain, disks=extent.slow_disks, packing_fraction=density)
                      for seed in context.seeds(extent.slow_starts)] for density in extent.slow_densities}


def plan(context: Context) -> list[Run]:
    return [run for runs in _runs(context).values() for run in runs]


def _draw(pressures: dict[float, Estimate], jamming: Estimate | None) -> Figure:
    figure, axes = style.new_axes("packing fraction φ", "pressure p D²/ε")
    densities = list(pressures)
    axes.errorbar(densities, [pressure.value for pressure in pressures.values()], [pressure.known_error for pressure in pressures.values()],
                  marker="o", linestyle="none", markersize=3.5, elinewidth=0.7, color=style.COLOURS[0], label="slow shear")
    if jamming is not None:
        slope = np.mean([pressure.value for pressure in pressures.values()]) / (np.mean(densities) - jamming.value)
        ends = np.array([jamming.value, max(densities)])
        axes.plot(ends, slope * (ends - jamming.value), color=style.COLOURS[0], linewidth=0.7)
    for (name, density), linestyle in zip(PUBLISHED, ("dotted", style.DASHED, "solid")):
        axes.axvline(density, color=style.GREY, linestyle=linestyle, linewidth=0.7, label=name)
    axes.set(xlim=(0.84, None), ylim=(0.0, None))
    axes.legend(loc="lower right")
    return figure


def make(context: Context) -> Chapter:
    rows: list[tuple[float, int, float, float]] = []
    of_seed: dict[int, dict[float, float]] = {}
    for density, runs in _runs(context).items():
        for number, run in enumerate(runs):
            for outcome in context.outcomes([run]):
                late = outcome.sheared("strain") > LATE
                pressure, stress = (float(np.mean(outcome.sheared(name)[late])) for name in ("pressure", "shear_stress"))
                rows.append((density, context.seed + number, pressure, stress))
                of_seed.setdefault(number, {})[density] = pressure
    context.write_table("figure_10.csv", "packing_fraction seed pressure shear_stress", rows)
    pressures = {density: mean_over_runs(found) for density in context.extent.slow_densities
                 if (found := [row[2] for row in rows if row[0] == density])}
    # A straight line through the pressures of each start, which vanishes at its φ_J.
    lines = [np.polyfit(list(found), list(found.values()), 1) for found in of_seed.values() if len(found) > 1]
    jamming = mean_over_runs([float(-shift / slope) for slope, shift in lines]) if lines else None
    context.draw("figure_10", lambda: _draw(pressures, jamming))
    name, published = PUBLISHED[1]
    statement = "The pressure of slow shear vanishes near the packing fraction that is published for quasi-static shear."
    if jamming is None or len(lines) < 2:
        claim = Claim("Figure 10", statement, "too few starts.", verdict_within(0.0, np.inf, BOUND))
    else:
        error = jamming.known_error * three_sigma(len(lines) - 1) / 3.0
        claim = Claim("Figure 10", statement, f"φ_J = {jamming} of {context.extent.slow_disks} disks; published for large systems: {published} by "
                      f"{name}, 0.84347(20) by slow flow. Agreement means within {BOUND}, which does not tell it from random quenches of large systems, 0.84177(1).",
                      verdict_within(jamming.value - published, error, BOUND))
    return Chapter(
        title="Figure 10: jamming under slow shear",
        introduction=[f"{context.extent.slow_disks} harmonic disks at packing fractions above jamming are sheared in steps of {STEP} to a strain of "
                      f"{context.extent.slow_strain}. φ_J is where a straight line through their mean pressures vanishes."],
        drawings=[Drawing(("figure_10",), f"Means above γ = {LATE} with errors over starts, a straight line, and published values.")],
        claims=[claim],
    )
