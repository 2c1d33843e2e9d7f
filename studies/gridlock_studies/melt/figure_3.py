"""Figure 3: the correlation of bond orientations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing, Table
from ..statistics import Estimate, Verdict, mean_over_runs, plain
from . import theory
from .context import Context
from .points import Point, decay_exponent, errors_text
from .runs import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plan(context: Context) -> list[Run]:
    return context.runs_of([context.largest])


def exponent_of(point: Point, number: int) -> Estimate:
    """η from each run that has one, and its error from their scatter."""
    values = [decay_exponent(outcome, number) for outcome in point.trusted]
    known = [value for value in values if not math.isnan(value)]
    return mean_over_runs(known) if known else Estimate(math.nan)


def draw_decays(axes: Axes, points: list[Point], number: int, exponent: float, law: str) -> None:
    """Curves of all densities, the densest darkest, beside a power law."""
    for point, colour in zip(points, style.sequential(len(points))):
        curves = [outcome.curve(number) for outcome in point.trusted]
        distance, mean = curves[0][0], np.mean([curve for _, curve in curves], axis=0)
        use = mean > 2e-3
        axes.plot(distance[use], mean[use], color=colour, marker="." if point.is_equilibrated else None, markersize=3.0,
                  linestyle="-" if point.is_equilibrated else ":", label=f"φ = {plain(point.packing_fraction)}{point.note}")
    reach = np.array([2.0, distance[-1]])
    axes.plot(reach, 0.95 * (reach / 2.0) ** -exponent, color="black", linewidth=0.8, linestyle=style.DASHED, label=law)
    style.logarithmic(axes, "x", "y")
    axes.set(ylim=(2e-3, 1.2))
    axes.legend(loc="lower left", fontsize=7)


def decay_table(points: list[Point], number: int, name: str) -> Table:
    table = Table(["φ", name, "starts"], "Exponents of r^(−η) fitted from three diameters to about a quarter of the box, or to where "
                                         "the curve is below 0.01; in a liquid there is no power law, and the number grows with the "
                                         "range.")
    table.rows += [[plain(point.packing_fraction), "–" if math.isnan(exponent_of(point, number).value) else str(exponent_of(point, number)),
                    "agree" if point.is_equilibrated else "crystal alone"] for point in points]
    return table


def rows_of(points: list[Point], number: int) -> list[tuple[float, ...]]:
    return [(point.packing_fraction, float(distance), float(value), int(point.is_equilibrated)) for point in points
            for distance, value in zip(point.trusted[0].curve(number)[0],
                                       np.mean([outcome.curve(number)[1] for outcome in point.trusted], axis=0))]


def bound_claim(where: str, statement: str, points: list[Point], number: int, bound: float, liquid: float) -> Claim:
    """Whether the exponent is above a bound in the liquid, and below it in the densest system."""
    below = [point for point in points if point.packing_fraction <= liquid and point.is_equilibrated]
    if not below or len(points) < 2:
        return Claim(where, statement, "no liquid in equilibrium", Verdict.UNDECIDED)
    texts, margins = [], []
    for point, sign in ((below[-1], 1.0), (points[-1], -1.0)):
        found = exponent_of(point, number)
        if found.error is None or not found.error > 0.0:
            return Claim(where, statement, f"no exponent with an error at φ = {plain(point.packing_fraction)}", Verdict.UNDECIDED)
        margins.append(sign * (found.value - bound) / found.error)
        texts.append(f"{found} at φ = {plain(point.packing_fraction)}{point.note}, {errors_text(margins[-1])} "
                     f"{'above' if found.value > bound else 'below'}")
    verdict = Verdict.AGREES if min(margins) > 3.0 else Verdict.DIFFERS if min(margins) < -3.0 else Verdict.UNDECIDED
    return Claim(where, statement, f"{'; '.join(texts)}. Agreement means three standard errors on the right side.", verdict)


def make(context: Context) -> Chapter:
    points = context.points(context.largest)
    context.write_table("figure_3.csv", "packing_fraction distance orientation_correlation is_equilibrated", rows_of(points, 0))

    def draw() -> Figure:
        figure, axes = style.new_axes("distance r, diameters", "g₆(r)")
        draw_decays(axes, points, 0, theory.HEXATIC_EXPONENT, "r^(−1/4)")
        return figure

    context.draw("figure_3", draw)
    return Chapter(
        title="Figure 3: correlation of bond orientations",
        introduction=[f"g₆(r) = ⟨Re ψ6(0)* ψ6(r)⟩ of {context.largest.disks:,} disks, with ψ6 of Voronoi neighbours, up to half the box. "
                      "It falls exponentially in a liquid, as a power r^(−η) with η ≤ 1/4 in a hexatic, and to a constant in a "
                      "crystal."],
        drawings=[Drawing(("figure_3",), "Lighter: lower density. Dotted: runs from the crystal alone, where starts do not agree.")],
        claims=[bound_claim("Figure 3", "g₆(r) falls faster than r^(−1/4) in the liquid, and more slowly where orientations are ordered "
                                        "(Halperin, Nelson 1979).", points, 0, theory.HEXATIC_EXPONENT, 0.69)],
        tables=[decay_table(points, 0, "η6")],
    )
