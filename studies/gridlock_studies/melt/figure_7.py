"""Figure 7: the density at constant pressure, by Monte Carlo, against the equation of state by dynamics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gridlock import combine

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict
from .context import Context
from .extent import System
from .loop import area_per_disk, curve_through, density_at_pressure
from .runs import Run, at_pressure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _system(context: Context) -> System | None:
    return next((system for system in context.systems if system.disks == context.extent.constant_pressure.disks), None)


def _runs(context: Context, pressure: float) -> list[Run]:
    extent = context.extent.constant_pressure
    return [at_pressure(extent, pressure, context.seed + number) for number in range(extent.starts)]


def plan(context: Context) -> list[Run]:
    system = _system(context)
    return [*(run for pressure in context.extent.constant_pressure.pressures for run in _runs(context, pressure)),
            *context.runs_of([system] if system else [])]


def _draw(curve: list[tuple[float, Estimate]], found: dict[float, Estimate], expected: dict[float, Estimate | None]) -> Figure:
    figure, axes = style.new_axes("packing fraction φ", "P* = βP(2R)²")
    if len(curve) > 1:
        density = np.linspace(curve[0][0], curve[-1][0], 200)
        pressure = curve_through([(one, value.value) for one, value in curve])
        axes.plot(density, pressure(area_per_disk(1.0) / density), color=style.COLOURS[0], label="constant area, dynamics")
    axes.errorbar([value.value for value in found.values()], list(found), xerr=[value.known_error for value in found.values()],
                  color=style.COLOURS[1], marker="s", linestyle="none", capsize=2, label="constant pressure, Monte Carlo")
    known = [(pressure, value.value) for pressure, value in expected.items() if value is not None]
    axes.plot([value for _, value in known], [pressure for pressure, _ in known], color="black", marker="x", linestyle="none", zorder=5,
              label="expected at constant pressure")
    axes.legend(loc="upper left")
    return figure


def _claim(found: dict[float, Estimate], expected: dict[float, Estimate | None], disks: int) -> Claim:
    statement = ("The mean density at constant pressure is that of the weight exp(N∫(P*(a′) − P*)da′), with the pressures of the same "
                 "number of disks at constant area.")
    texts, distances = [], []
    for pressure, value in found.items():
        known = expected[pressure]
        if known is None or value.error is None:
            texts.append(f"{value} at P* = {pressure:g}, where pressures in equilibrium do not reach far enough")
            continue
        distances.append(abs(value.value - known.value) / math.hypot(value.error, known.known_error))
        texts.append(f"{value} against {known} at P* = {pressure:g}")
    text = f"{'; '.join(texts) or 'nothing was run'} for N = {disks}"
    if not distances:
        return Claim("Figure 7", statement, text, Verdict.UNDECIDED)
    return Claim("Figure 7", statement, f"{text}. The largest distance is {max(distances):.1f} standard errors; agreement means below "
                                        "four.",
                 Verdict.AGREES if max(distances) < 4.0 else Verdict.DIFFERS)


def make(context: Context) -> Chapter:
    extent, system = context.extent.constant_pressure, _system(context)
    points = context.points(system) if system else []
    curve = [(point.packing_fraction, point.pressures()) for point in points if point.is_equilibrated]
    found, expected = {}, {}
    for pressure in extent.pressures:
        outcomes = context.outcomes(_runs(context, pressure))
        if not outcomes:
            continue
        mean = combine([outcome.result("packing_fraction_at_pressure") for outcome in outcomes])
        found[pressure] = Estimate(mean.value, None if math.isnan(mean.error) else mean.error)
        expected[pressure] = density_at_pressure(curve, pressure, extent.disks) if len(curve) > 3 else None
    context.write_table("figure_7.csv", "pressure packing_fraction error expected expected_error",
                        [(pressure, *value.cells, *(expected[pressure] or Estimate(math.nan)).cells) for pressure, value in found.items()])
    context.draw("figure_7", lambda: _draw(curve, found, expected))
    return Chapter(
        title="Figure 7: constant pressure",
        introduction=[f"{extent.disks} disks by Monte Carlo with moves of the area, from a liquid, {extent.starts} starts at each "
                      "pressure. The density fluctuates, so its mean is not that at which the pressure at constant area is the same; "
                      "the weight of each density follows from pressures at constant area alone."],
        drawings=[Drawing(("figure_7",), "Error bars are one standard error over starts and blocks.")],
        claims=[_claim(found, expected, extent.disks)],
    )
