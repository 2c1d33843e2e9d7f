"""Figure 4: positional order: its correlation, and the Bragg peak."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, plain
from . import theory
from .context import Context
from .figure_2 import plan as plan_of_all_sizes
from .figure_3 import bound_claim, decay_table, draw_decays, rows_of
from .points import Point
from .runs import Outcome, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


def plan(context: Context) -> list[Run]:
    return plan_of_all_sizes(context)


def _peak(point: Point) -> Estimate:
    def peaks(outcome: Outcome) -> NDArray[Any]:
        return outcome.peaks
    return point.mean(peaks, lambda some: float(np.mean(some)))


def _draw_peaks(curves: dict[int, list[Point]]) -> Figure:
    figure, axes = style.new_axes("number of disks N", "S(G)/N", width=3.4, height=3.6)
    densities = [point.packing_fraction for point in list(curves.values())[-1]]
    for density, colour in zip(densities, style.sequential(len(densities))):
        some = [(disks, point) for disks, points in curves.items() for point in points if point.packing_fraction == density]
        values = [_peak(point) for _, point in some]
        is_agreed = all(point.is_equilibrated for _, point in some)
        axes.errorbar([disks for disks, _ in some], [one.value for one in values], [one.known_error for one in values], color=colour,
                      marker="o", linestyle="-" if is_agreed else ":", capsize=2, label=f"φ = {plain(density)}")
    style.logarithmic(axes, "x", "y")
    axes.legend(loc="lower left", fontsize=6.5)
    return figure


def _peak_claim(curves: dict[int, list[Point]]) -> Claim:
    statement = "In the crystal S(G)/N falls as N^(−η/2) with η ≤ 1/3 (Nelson, Halperin 1979); without positional order it falls as 1/N."
    densest = [(disks, points[-1]) for disks, points in curves.items()][-2:]
    if len(densest) < 2 or densest[0][1].packing_fraction != densest[1][1].packing_fraction:
        return Claim("Figure 4", statement, "too few numbers of disks", Verdict.UNDECIDED)
    (few, first), (many, second) = densest
    low, high = _peak(first), _peak(second)
    if low.error is None or high.error is None:
        return Claim("Figure 4", statement, "one run has no error", Verdict.UNDECIDED)
    span = math.log(many / few)
    eta = Estimate(-2.0 * math.log(high.value / low.value) / span, 2.0 * math.hypot(low.error / low.value, high.error / high.value) / span)
    margin = (theory.CRYSTAL_EXPONENT - eta.value) / eta.known_error
    return Claim("Figure 4", statement, f"η = {eta} between {few:,} and {many:,} disks at φ = {plain(first.packing_fraction)}"
                 f"{first.note or second.note}, {abs(margin):.1f} standard errors {'below' if margin > 0.0 else 'above'} 1/3.",
                 Verdict.AGREES if margin > 3.0 else Verdict.DIFFERS if margin < -3.0 else Verdict.UNDECIDED)


def make(context: Context) -> Chapter:
    curves = {system.disks: context.points(system) for system in context.systems if system.frames}
    points = curves[context.largest.disks]
    context.write_table("figure_4.csv", "packing_fraction distance positional_correlation is_equilibrated", rows_of(points, 1))
    context.write_table("figure_4_peaks.csv", "disks packing_fraction peak error is_equilibrated",
                        [(disks, point.packing_fraction, *_peak(point).cells, int(point.is_equilibrated))
                         for disks, some in curves.items() for point in some])

    def draw() -> Figure:
        figure, axes = style.new_axes("distance r, diameters", "c_G(r)".replace("_G", "$_G$"), width=3.4, height=3.6)
        draw_decays(axes, points, 1, theory.CRYSTAL_EXPONENT, "r^(−1/3)")
        return figure

    context.draw("figure_4_correlation", draw)
    context.draw("figure_4_peak", lambda: _draw_peaks(curves))
    return Chapter(
        title="Figure 4: positional order",
        introduction=["c_G(r) = ⟨cos G·r⟩ over pairs at the distance r, G the wave vector of the largest S(q) of each frame. In a "
                      "two-dimensional crystal it falls as a power r^(−η) with η ≤ 1/3, and exponentially in a hexatic and in a "
                      "liquid; the largest of many S(q) leaves a tail of that height there."],
        drawings=[Drawing(("figure_4_correlation", "figure_4_peak"), f"Left: {context.largest.disks:,} disks. Right: the height of the "
                                                                     "Bragg peak. Dotted: runs from the crystal alone, where starts do "
                                                                     "not agree.")],
        claims=[bound_claim("Figure 4", "c_G(r) falls faster than r^(−1/3) in the liquid, and more slowly in the crystal.", points, 1,
                            theory.CRYSTAL_EXPONENT, 0.70), _peak_claim(curves)],
        tables=[decay_table(points, 1, "η")],
    )
