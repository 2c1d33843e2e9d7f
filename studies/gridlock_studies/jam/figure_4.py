"""Figure 4: the J-line, how the jamming packing fraction depends on the fluid that is quenched."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, mean_over_runs, plain
from .context import Context
from .runs import DECOMPRESS, Run, run_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Of an independent program with 24 starts of 256 disks: packing fraction of the fluid, jamming packing fraction, error.
REFERENCE = ((0.40, 0.8427, 0.0004), (0.60, 0.8417, 0.0005), (0.70, 0.8420, 0.0004), (0.74, 0.8428, 0.0004), (0.775, 0.8462, 0.0003))


def _runs(context: Context, density: float, collisions: float) -> list[Run]:
    extent = context.extent
    grow: list[dict[str, Any]] = [{"stage": "grow", "rate": 0.01, "until_packing_fraction": density}] if density > 0.4 else []
    stages = [*grow, {"stage": "run", "collisions_per_disk": collisions}, {"stage": "quench", "packing_fraction": 0.86}, DECOMPRESS]
    return [run_of(f"the fluid at {density}", stages, seed, 0.5 + 3e-4 * collisions, disks=extent.fluid_disks,
                   packing_fraction=0.4, start="random") for seed in context.seeds(extent.fluid_starts)]


def plan(context: Context) -> list[Run]:
    return [run for density, collisions in context.extent.fluid_densities for run in _runs(context, density, collisions)]


def _draw(context: Context, line: dict[float, Estimate]) -> Figure:
    figure, axes = style.new_axes("packing fraction of the fluid", f"jamming packing fraction {style.PHI_J}")
    axes.errorbar(list(line), [one.value for one in line.values()], [one.known_error for one in line.values()], color=style.COLOURS[0],
                  marker=style.MARKERS[0], capsize=2, label=f"here, {context.extent.fluid_starts} starts")
    axes.errorbar([one[0] for one in REFERENCE], [one[1] for one in REFERENCE], [one[2] for one in REFERENCE], color=style.GREY,
                  marker="s", markerfacecolor="white", linestyle=style.DASHED, capsize=2, label="independent program, 24 starts")
    axes.legend(loc="upper left")
    return figure


def make(context: Context) -> Chapter:
    line: dict[float, Estimate] = {}
    pressures: dict[float, Estimate] = {}
    rows = []
    for density, collisions in context.extent.fluid_densities:
        outcomes = context.outcomes(_runs(context, density, collisions))
        if not outcomes:
            continue
        fluid = 1 if density > 0.4 else 0
        line[density] = mean_over_runs([outcome.result("jamming_packing_fraction") for outcome in outcomes])
        pressures[density] = mean_over_runs([outcome.stage(fluid, "pressure") for outcome in outcomes])
        rows.append((density, collisions, *line[density].cells, *pressures[density].cells, len(outcomes)))
    context.write_table("figure_4.csv", "packing_fraction collisions_per_disk jamming_packing_fraction error pressure pressure_error starts",
                        rows)
    context.draw("figure_4", lambda: _draw(context, line))
    return Chapter(
        title="Figure 4: the J-line",
        introduction=[f"Fluids of {context.extent.fluid_disks} hard disks come to equilibrium at a packing fraction, then are inflated to 0.86 "
                      "as soft disks, quenched and decompressed."],
        drawings=[Drawing(("figure_4",), "Error bars are one standard error over starts.")],
        claims=[_rise_claim(line), _reference_claim(line)],
        conclusions=["Reduced pressure of the fluids: " + ", ".join(f"{value} at φ = {plain(density)}" for density, value in pressures.items())
                     + ". The densest still ages: its dynamics is arrested, and its pressure falls as long as one waits."],
    )


def _rise_claim(line: dict[float, Estimate]) -> Claim:
    statement = ("The jamming packing fraction does not depend on the fluid while that is dilute, and rises with it where it is dense "
                 "(Chaudhuri et al. 2010, Ozawa et al. 2012, in three dimensions).")
    if not {0.4, 0.7, 0.775} <= set(line):
        return Claim("Figure 4", statement, "too few fluids to tell", Verdict.UNDECIDED)
    flat = Estimate(line[0.7].value - line[0.4].value, math.hypot(line[0.7].known_error, line[0.4].known_error))
    rise = Estimate(line[0.775].value - line[0.4].value, math.hypot(line[0.775].known_error, line[0.4].known_error))
    is_flat = abs(flat.value) < 3.0 * flat.known_error
    has_risen = rise.value > 3.0 * rise.known_error
    verdict = Verdict.AGREES if is_flat and has_risen else Verdict.UNDECIDED if is_flat and rise.value > 0.0 else Verdict.DIFFERS
    return Claim("Figure 4", statement, f"From 0.40 to 0.70 φ_J changes by {flat}, from 0.40 to 0.775 by {rise}; flat and risen mean "
                 "within and beyond three standard errors.", verdict)


def _reference_claim(line: dict[float, Estimate]) -> Claim:
    distances = [abs(line[density].value - value) / math.hypot(line[density].known_error, error)
                 for density, value, error in REFERENCE if density in line]
    texts = [f"{line[density]} against {Estimate(value, error)} at {plain(density)}" for density, value, error in REFERENCE if density in line]
    verdict = Verdict.UNDECIDED if not distances else Verdict.AGREES if max(distances) < 4.0 else Verdict.DIFFERS
    return Claim("Figure 4", "An independent program finds these jamming packing fractions.",
                 f"{'; '.join(texts)}. Agreement means less than four standard errors everywhere. The densest fluid depends on how long one waits.",
                 verdict)
