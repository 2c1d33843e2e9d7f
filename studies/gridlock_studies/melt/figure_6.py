"""Figure 6: the distribution of the local density."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, plain
from . import theory
from .context import Context
from .points import Point
from .runs import Outcome, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


def plan(context: Context) -> list[Run]:
    return context.runs_of([context.largest])


def _densities(point: Point, outcome: Outcome) -> NDArray[np.float64]:
    """Packing fractions of all cells of all samples: the mean count belongs to the mean density."""
    counts = outcome.counts
    return np.asarray(counts.ravel() * (point.packing_fraction * counts.shape[1] / point.disks), dtype=np.float64)


def _counts(outcome: Outcome) -> NDArray[Any]:
    return outcome.counts


def _kurtosis(point: Point) -> Estimate:
    """⟨δ⁴⟩/⟨δ²⟩² − 3 of the counts: 0 for one normal peak, −2 for two narrow ones."""
    def of_counts(counts: NDArray[Any]) -> float:
        deviations = counts - counts.mean()
        return float(np.mean(deviations**4) / np.mean(deviations**2) ** 2 - 3.0)
    return point.mean(_counts, of_counts)


def _width(point: Point) -> Estimate:
    unit = point.packing_fraction * point.trusted[0].counts.shape[1] / point.disks
    return point.mean(_counts, lambda counts: unit * float(np.std(counts)))


def _draw(points: list[Point]) -> Figure:
    figure, axes = style.new_axes("packing fraction of a cell", "probability density")
    for point, colour in zip(points, style.sequential(len(points))):
        values = np.concatenate([_densities(point, outcome) for outcome in point.trusted])
        # A bin is two numbers of disks wide, and no number is at its edge.
        step = 2.0 * point.packing_fraction * point.trusted[0].counts.shape[1] / point.disks
        edges = (math.floor(values.min() / step) - 1.25 + np.arange(math.ceil(np.ptp(values) / step) + 4)) * step
        height = np.histogram(values, edges, density=True)[0]
        axes.plot(0.5 * (edges[1:] + edges[:-1]), height, color=colour, linestyle="-" if point.is_equilibrated else ":",
                  label=f"φ = {plain(point.packing_fraction)}{point.note}")
    for density in (theory.LIQUID, theory.HEXATIC):
        axes.axvline(density, color=style.GREY, linestyle=style.DASHED, linewidth=0.8)
    axes.set(xlim=(0.6, 0.8), ylim=(0.0, None))
    axes.legend(loc="upper left", fontsize=7)
    return figure


def _claim(points: list[Point]) -> Claim:
    statement = ("In the coexistence, at φ = 0.708, the local density has two peaks, at 0.700 and 0.716 (Bernard, Krauth 2011; Engel et "
                 "al. 2013).")
    point = min(points, key=lambda one: abs(one.packing_fraction - 0.5 * (theory.LIQUID + theory.HEXATIC)))
    width, kurtosis = _width(points[0]), _kurtosis(point)
    cells = math.sqrt(point.disks * math.pi / (4.0 * point.packing_fraction) / point.trusted[0].counts.shape[1])
    text = (f"In cells of {cells:.0f} diameters the density of the liquid at φ = {plain(points[0].packing_fraction)} scatters by "
            f"{width}, and the peaks are {theory.HEXATIC - theory.LIQUID:.3f} apart. At {plain(point.packing_fraction)} the excess "
            f"kurtosis is {kurtosis}: 0 is one normal peak, −2 are two narrow ones.")
    if point.disks < theory.MANY_DISKS or not point.is_equilibrated or not kurtosis.known_error:
        return Claim("Figure 6", statement, f"{text} Two peaks part where both phases are wider than cells of 25 diameters: more than "
                     f"{theory.MANY_DISKS:,} disks in equilibrium. These runs are too small to see it.", Verdict.UNDECIDED)
    margin = -kurtosis.value / kurtosis.known_error
    return Claim("Figure 6", statement, text, Verdict.AGREES if margin > 3.0 else Verdict.DIFFERS if margin < -3.0 else Verdict.UNDECIDED)


def make(context: Context) -> Chapter:
    points = context.points(context.largest)
    context.write_table("figure_6.csv", "packing_fraction width width_error kurtosis kurtosis_error is_equilibrated",
                        [(point.packing_fraction, *_width(point).cells, *_kurtosis(point).cells, int(point.is_equilibrated))
                         for point in points])
    context.draw("figure_6", lambda: _draw(points))
    return Chapter(
        title="Figure 6: local density",
        introduction=[f"Disks of {context.largest.disks:,} are counted in the cells of a square grid, in every sample."],
        drawings=[Drawing(("figure_6",), "Dashed: the published densities of liquid and hexatic that coexist. Dotted curves: runs from "
                                         "the crystal alone, where starts do not agree.")],
        claims=[_claim(points)],
    )
