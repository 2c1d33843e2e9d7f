"""Figure 9: steady shear at finite rates: flow curves around jamming."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, mean_over_runs, plain
from .context import Context
from .runs import Outcome, Run, flow_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DENSITIES = (0.82, 0.8435, 0.86)
#: Shear stress of 256 disks by an independent program, at a packing fraction and a rate; errors of blocks, twice.
REFERENCE = {
    (0.82, 1e-3): Estimate(1.189e-3, 2.8e-5), (0.82, 1e-4): Estimate(2.32e-4, 1.8e-5),
    (0.8435, 1e-3): Estimate(1.894e-3, 5.0e-5), (0.8435, 1e-4): Estimate(6.84e-4, 3.8e-5),
    (0.86, 1e-3): Estimate(2.51e-3, 8.0e-5), (0.86, 1e-4): Estimate(1.113e-3, 4.8e-5),
}


def _runs(context: Context, density: float, rate: float) -> list[Run]:
    extent = context.extent
    return [flow_of(f"flow at {rate}", seed, disks=extent.flow_disks, packing_fraction=density, rate=rate, strain=extent.flow_strain)
            for seed in context.seeds(extent.flow_starts)]


def plan(context: Context) -> list[Run]:
    return [run for density in DENSITIES for rate in context.extent.flow_rates for run in _runs(context, density, rate)]


def _stress(outcomes: list[Outcome]) -> Estimate:
    return mean_over_runs([outcome.result("stress_xy") for outcome in outcomes])


def _draw(stresses: dict[tuple[float, float], Estimate]) -> Figure:
    figure, axes = style.new_axes("shear rate γ̇, ε/(mγ D²)", "shear stress σ, ε/D²")
    for density, colour, marker in zip(DENSITIES, style.COLOURS, style.MARKERS):
        points = sorted((rate, stress) for (other, rate), stress in stresses.items() if other == density)
        axes.errorbar([rate for rate, _ in points], [stress.value for _, stress in points], [stress.known_error for _, stress in points],
                      color=colour, marker=marker, label=f"φ = {plain(density)}")
    axes.plot([rate for _, rate in REFERENCE], [stress.value for stress in REFERENCE.values()], linestyle="none", marker="x",
              color=style.GREY, label="independent program")
    style.logarithmic(axes, "x")
    style.logarithmic(axes, "y")
    axes.legend(loc="lower right")
    return figure


def _reference_claim(stresses: dict[tuple[float, float], Estimate], disks: int) -> Claim:
    statement = "An independent program finds these shear stresses with friction against the mean flow (Durian 1995)."
    known = [key for key in REFERENCE if key in stresses and stresses[key].error is not None]
    if disks != 256 or not known:
        return Claim("Figure 9", statement, "its numbers are those of 256 disks in several runs", Verdict.UNDECIDED)
    distances = [abs(stresses[key].value - REFERENCE[key].value) / math.hypot(stresses[key].known_error, REFERENCE[key].known_error)
                 for key in known]
    texts = [f"{stresses[key]} against {REFERENCE[key]} at φ = {plain(key[0])}, γ̇ = {plain(key[1])}" for key in known]
    return Claim("Figure 9", statement, f"{'; '.join(texts)}. Agreement means less than four standard errors everywhere.",
                 Verdict.AGREES if max(distances) < 4.0 else Verdict.DIFFERS)


def _yield_claim(stresses: dict[tuple[float, float], Estimate]) -> Claim:
    statement = ("Above jamming, at φ_J = 0.8435 for slow shear (Olsson, Teitel 2011), the stress tends to a yield stress as the rate falls; "
                 "below, it falls faster.")
    rates = sorted({rate for _, rate in stresses})
    if len(rates) < 2 or any((density, rate) not in stresses for density in DENSITIES for rate in rates[:2]):
        return Claim("Figure 9", statement, "too few rates to tell", Verdict.UNDECIDED)
    slow, fast = rates[0], rates[1]
    slopes = {}
    for density in DENSITIES:
        low, high = stresses[density, slow], stresses[density, fast]
        error = math.hypot(low.known_error / low.value, high.known_error / high.value) / math.log(fast / slow)
        slopes[density] = Estimate(math.log(high.value / low.value) / math.log(fast / slow), error)
    below, above = slopes[DENSITIES[0]], slopes[DENSITIES[-1]]
    margin, error = below.value - above.value, math.hypot(below.known_error, above.known_error)
    verdict = Verdict.UNDECIDED if abs(margin) < 2.0 * error else Verdict.AGREES if margin > 0.0 else Verdict.DIFFERS
    texts = [f"{slope} at {plain(density)}" for density, slope in slopes.items()]
    return Claim("Figure 9", statement, f"d ln σ/d ln γ̇ between the two lowest rates is {', '.join(texts)}. Agreement means a larger slope at the "
                 "lowest density than at the highest, by two standard errors.", verdict)


def make(context: Context) -> Chapter:
    stresses = {}
    rows = []
    for density in DENSITIES:
        for rate in context.extent.flow_rates:
            outcomes = context.outcomes(_runs(context, density, rate))
            if not outcomes:
                continue
            stresses[density, rate] = _stress(outcomes)
            pressure = mean_over_runs([-0.5 * (outcome.result("stress_xx") + outcome.result("stress_yy")) for outcome in outcomes])
            rows.append((density, rate, *stresses[density, rate].cells, *pressure.cells, len(outcomes)))
    context.write_table("figure_9.csv", "packing_fraction shear_rate shear_stress error pressure pressure_error starts", rows)
    context.draw("figure_9", lambda: _draw(stresses))
    return Chapter(
        title="Figure 9: flow curves",
        introduction=[f"{context.extent.flow_disks} harmonic disks without thermal motion are sheared at a constant rate between Lees–Edwards edges."],
        drawings=[Drawing(("figure_9",), "Error bars are one standard error over starts.")],
        claims=[_reference_claim(stresses, context.extent.flow_disks), _yield_claim(stresses)],
    )
