"""Figure 2: the hexatic order of the whole system, its fluctuations and its distribution."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, plain
from . import theory
from .context import Context
from .extent import System
from .points import Point, errors_text
from .runs import Outcome, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


def _systems(context: Context) -> list[System]:
    return [system for system in context.systems if system.frames]


def plan(context: Context) -> list[Run]:
    return context.runs_of(_systems(context))


def _order(outcome: Outcome) -> NDArray[Any]:
    return outcome.order


def _squared_order(point: Point) -> Estimate:
    """⟨|Ψ6|²⟩."""
    return point.mean(_order, lambda order: float(np.mean(order**2)))


def _susceptibility(point: Point) -> Estimate:
    """χ6 = N(⟨|Ψ6|²⟩ − ⟨|Ψ6|⟩²)."""
    return point.mean(_order, lambda order: point.disks * float(np.var(order)))


def _moment_ratio(point: Point) -> Estimate:
    return point.mean(_order, lambda order: float(np.mean(order**2) / np.mean(order) ** 2))


def _draw(curves: dict[int, list[Point]], what: str) -> Figure:
    is_order = what == "order"
    figure, axes = style.new_axes("packing fraction φ", "⟨|Ψ6|²⟩" if is_order else "χ6 = N(⟨|Ψ6|²⟩ − ⟨|Ψ6|⟩²)", width=3.4, height=3.2)
    for (disks, points), colour, marker in zip(curves.items(), style.COLOURS, style.MARKERS):
        for is_agreed in (True, False):
            some = [point for point in points if point.is_equilibrated is is_agreed]
            values = [_squared_order(point) if is_order else _susceptibility(point) for point in some]
            axes.errorbar([point.packing_fraction for point in some], [one.value for one in values], [one.known_error for one in values],
                          color=colour, marker=marker, linewidth=0.8, capsize=2, linestyle="-" if is_agreed else "none",
                          markerfacecolor=colour if is_agreed else "white", label=f"N = {disks:,}" if is_agreed else None)
    style.logarithmic(axes, "y")
    axes.legend(loc="lower right" if is_order else "upper right")
    return figure


def _draw_distribution(points: list[Point]) -> Figure:
    figure, axes = style.new_axes("|Ψ6|", "probability density", height=3.2)
    edges = np.linspace(0.0, 1.0, 61)
    colours = style.sequential(len(points))
    for point, colour in zip(points, colours):
        order = np.concatenate([outcome.order for outcome in point.trusted])
        height = np.histogram(order, edges, density=True)[0]
        axes.step(edges[:-1], height, where="post", color=colour, linewidth=1.0, linestyle="-" if point.is_equilibrated else ":",
                  label=f"φ = {plain(point.packing_fraction)}{point.note}")
    style.logarithmic(axes, "y")
    axes.set(xlim=(0.0, 0.85), ylim=(0.02, 1000.0))
    axes.legend(loc="upper left", fontsize=7, ncols=3)
    return figure


def _gaussian_claim(system: System, points: list[Point]) -> Claim:
    statement = "In the liquid, far below the transition, Ψ6 is a sum of many independent regions, so ⟨|Ψ6|²⟩/⟨|Ψ6|⟩² = 4/π."
    point = points[0]
    found = _moment_ratio(point)
    if not point.is_equilibrated or found.error is None:
        return Claim("Figure 2", statement, f"no equilibrium at the lowest density: {point.difference}", Verdict.UNDECIDED)
    distance = abs(found.value - 4.0 / math.pi) / found.error
    return Claim("Figure 2", statement, f"{found} against {4.0 / math.pi:.4f} for N = {system.disks:,} at φ = "
                                        f"{plain(point.packing_fraction)}, {distance:.1f} standard errors "
                                        "away.", Verdict.UNDECIDED if found.error > 0.1 else Verdict.AGREES if distance < 4.0
                 else Verdict.DIFFERS)


def _size_exponent(curves: dict[int, list[Point]], density: float) -> tuple[Estimate, str] | None:
    """d ln⟨|Ψ6|²⟩ / d ln N between the two largest numbers of disks at one density."""
    found = {disks: point for disks, points in curves.items() for point in points if point.packing_fraction == density}
    if len(found) < 2:
        return None
    (few, first), (many, second) = list(found.items())[-2:]
    low, high = _squared_order(first), _squared_order(second)
    if low.error is None or high.error is None:
        return None
    span = math.log(many / few)
    error = math.hypot(low.error / low.value, high.error / high.value) / span
    note = first.note or second.note
    return Estimate(math.log(high.value / low.value) / span, error), f"between {few:,} and {many:,} disks at φ = {plain(density)}{note}"


def _exponent_claim(curves: dict[int, list[Point]]) -> Claim:
    statement = ("⟨|Ψ6|²⟩ falls as 1/N in the liquid, and as N^(−η/2) with η < 1/4 where orientations are ordered (Kosterlitz, "
                 "Thouless, Halperin, Nelson, Young).")
    densities = sorted({point.packing_fraction for point in list(curves.values())[-1]})
    liquid, solid = _size_exponent(curves, densities[0]), _size_exponent(curves, densities[-1])
    if liquid is None or solid is None:
        return Claim("Figure 2", statement, "too few numbers of disks", Verdict.UNDECIDED)
    (fall, fall_text), (order, order_text) = liquid, solid
    bound = -0.5 * theory.HEXATIC_EXPONENT
    distance = abs(fall.value + 1.0) / fall.known_error
    margin = (order.value - bound) / order.known_error
    text = (f"The exponent is {fall} {fall_text}, {errors_text(distance)} from −1, and {order} {order_text}, {errors_text(margin)} "
            f"{'above' if margin > 0.0 else 'below'} −η/2 = −1/8.")
    if fall.known_error > 0.25:
        return Claim("Figure 2", statement, text, Verdict.UNDECIDED)
    return Claim("Figure 2", statement, text, Verdict.AGREES if distance < 4.0 and margin > 3.0 else Verdict.UNDECIDED
                 if distance < 4.0 and margin > -3.0 else Verdict.DIFFERS)


def make(context: Context) -> Chapter:
    curves = {system.disks: context.points(system) for system in _systems(context)}
    rows = [(disks, point.packing_fraction, *_squared_order(point).cells, *_susceptibility(point).cells, int(point.is_equilibrated))
            for disks, points in curves.items() for point in points]
    context.write_table("figure_2.csv", "disks packing_fraction squared_order error susceptibility susceptibility_error "
                                        "is_equilibrated", rows)
    largest = curves[context.largest.disks]
    context.draw("figure_2_order", lambda: _draw(curves, "order"))
    context.draw("figure_2_susceptibility", lambda: _draw(curves, "susceptibility"))
    context.draw("figure_2_distribution", lambda: _draw_distribution(largest))
    peaks = []
    for disks, points in curves.items():
        agreeing = [point for point in points if point.is_equilibrated]
        if agreeing:
            highest = max(agreeing, key=lambda point: _susceptibility(point).value)
            peaks.append(f"{plain(highest.packing_fraction)} for N = {disks:,}")
    return Chapter(
        title="Figure 2: hexatic order",
        introduction=["Ψ6 is the mean of ψ6 over all disks: in a liquid it is as small as 1/√N, in an ordered system it tends to a "
                      "constant or falls as a power of N. Where starts do not agree, the runs from the crystal are shown, in white or "
                      "dotted."],
        drawings=[Drawing(("figure_2_order", "figure_2_susceptibility"), "Mean square and fluctuations, with one standard error."),
                  Drawing(("figure_2_distribution",), f"Distribution of |Ψ6| for N = {context.largest.disks:,}.")],
        claims=[_gaussian_claim(context.largest, largest), _exponent_claim(curves)],
        conclusions=[f"Fluctuations are largest at φ = {', '.join(peaks)}, among densities with an equilibrium."] if peaks else [],
    )
