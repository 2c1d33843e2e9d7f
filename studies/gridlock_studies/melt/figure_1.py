"""Figure 1: the equation of state through the transition, and its loop in finite boxes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing, Table
from ..statistics import Estimate, Verdict, joint_deviation, plain
from . import theory
from .context import Context
from .extent import System
from .loop import Loop, find_loop, interface_free_energy
from .points import Point
from .runs import CRYSTAL, LIQUID, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plan(context: Context) -> list[Run]:
    return context.runs_of(context.systems)


class _Maxwell:
    """The loop of one system, from points where both starts agree, or with those of the crystal beyond them."""

    def __init__(self, disks: int, points: list[Point]) -> None:
        self.disks = disks
        agreeing = [(point.packing_fraction, point.pressures()) for point in points if point.is_equilibrated]
        self.loop: Loop | None = find_loop(agreeing)
        self.needs_crystal = self.loop is None
        if self.needs_crystal:
            last = max((density for density, _ in agreeing), default=1.0)
            beyond = [(point.packing_fraction, point.pressures(CRYSTAL)) for point in points if point.packing_fraction > last]
            self.loop = find_loop([*agreeing, *beyond])


def _draw(curves: dict[int, list[Point]], loops: list[_Maxwell]) -> Figure:
    figure, axes = style.new_axes("packing fraction φ", "P* = βP(2R)²", height=5.0)
    fluid = np.linspace(0.6, theory.LAST_FLUID, 50)
    axes.plot(fluid, [theory.fluid_pressure(density) for density in fluid], color=style.GREY, linestyle=style.DASHED,
              label="Kolafa, Rottner 2006")
    axes.errorbar([one.packing_fraction for one in theory.LARGE], [one.pressure.value for one in theory.LARGE], color="black", marker="x",
                  linestyle=":", linewidth=0.8, label="N = 1,024², Engel et al. 2013")
    for (disks, points), maxwell, colour, marker in zip(curves.items(), loops, style.COLOURS, style.MARKERS):
        agreeing = [point for point in points if point.is_equilibrated]
        pressures = [point.pressures() for point in agreeing]
        axes.errorbar([point.packing_fraction for point in agreeing], [one.value for one in pressures],
                      [one.known_error for one in pressures], color=colour, marker=marker, linewidth=0.8, capsize=2, label=f"N = {disks:,}")
        for point in points:
            if not point.is_equilibrated:
                for kind, sign in ((CRYSTAL, "^"), (LIQUID, "v")):
                    value = point.pressures(kind)
                    axes.errorbar([point.packing_fraction], [value.value], [value.known_error], color=colour, marker=sign,
                                  markerfacecolor="white", linestyle="none", capsize=2)
        for small in theory.SMALL.get(disks, ()):
            axes.plot(small.packing_fraction, small.pressure.value, marker="+", markersize=9, color=colour, linestyle="none")
        if maxwell.loop is not None:
            axes.plot([maxwell.loop.liquid.value, maxwell.loop.solid.value], [maxwell.loop.pressure.value] * 2, color=colour, linewidth=0.7,
                      linestyle=style.DASHED if maxwell.needs_crystal else "-")
    for sign, label in (("^", "starts differ: from the crystal"), ("v", "starts differ: from the liquid")):
        axes.plot([], [], color=style.GREY, marker=sign, markerfacecolor="white", linestyle="none", label=label)
    axes.plot([], [], color=style.GREY, marker="+", markersize=9, linestyle="none", label="this N, Li et al. 2022")
    axes.set(xlim=(0.645, 0.7235), ylim=(6.8, 9.65))
    axes.legend(loc="lower right", fontsize=7)
    return figure


def _small_claim(curves: dict[int, list[Point]]) -> Claim:
    statement = "72, 224 and 870 disks in a periodic square have these pressures (Li et al. 2022)."
    deviations, freedoms, texts, left_out = [], [], [], []
    for disks, points in curves.items():
        for known in theory.SMALL.get(disks, ()):
            point = next((one for one in points if one.packing_fraction == known.packing_fraction), None)
            if point is None:
                continue
            found = point.pressures()
            if not point.is_equilibrated or found.error is None:
                left_out.append(f"N = {disks} at φ = {plain(known.packing_fraction)}: {point.difference}")
                continue
            deviations.append((found.value - known.pressure.value) / math.hypot(found.error, known.pressure.known_error))
            freedoms.append(sum(map(len, point.runs.values())) - 1)
            texts.append(f"{found} against {known.pressure.value:.4f} for N = {disks} at φ = {plain(known.packing_fraction)}")
    if not deviations:
        return Claim("Figure 1", statement, "; ".join(left_out) or "none of these numbers of disks was run", Verdict.UNDECIDED)
    together = joint_deviation(deviations, freedoms)
    is_close = max(map(abs, deviations)) < 4.0 and abs(together) < 3.0
    text = (f"{'; '.join(texts)}. The largest deviation is {max(deviations, key=abs):+.1f} standard errors, all together are "
            f"{together:+.1f}; agreement means below four and three.")
    return Claim("Figure 1", statement, text + (f" Left out: {'; '.join(left_out)}." if left_out else ""),
                 Verdict.AGREES if is_close else Verdict.DIFFERS)


def _densest_shared(curves: dict[int, list[Point]]) -> tuple[dict[int, Estimate], float]:
    """P* by the number of disks, at the highest density of the fluid that most of them have in equilibrium."""
    at: dict[float, dict[int, Estimate]] = {}
    for disks, points in curves.items():
        for point in points:
            pressure = point.pressures()
            if point.packing_fraction <= theory.LAST_FLUID and point.is_equilibrated and pressure.known_error > 0.0:
                at.setdefault(point.packing_fraction, {})[disks] = pressure
    density = max(at, key=lambda one: (len(at[one]), one), default=0.0)
    return at.get(density, {}), density


def _fluid_claim(curves: dict[int, list[Point]]) -> Claim:
    statement = "Large systems of the fluid have the pressure of Kolafa and Rottner (2006)."
    found, density = _densest_shared(curves)
    if len(found) < 2:
        return Claim("Figure 1", statement, "no density of the fluid has two numbers of disks in equilibrium", Verdict.UNDECIDED)
    # Smaller systems have corrections beyond 1/N: those of the published pressures of 72, 224 and 870 disks are on no line.
    (few, low), (many, high) = list(found.items())[-2:]
    share = few / (many - few)
    limit = Estimate(high.value + share * (high.value - low.value), math.hypot((1.0 + share) * high.known_error, share * low.known_error))
    known = theory.fluid_pressure(density)
    distance = abs(limit.value - known) / limit.known_error
    verdict = Verdict.UNDECIDED if limit.known_error > 0.005 * known else Verdict.AGREES if distance < 3.0 else Verdict.DIFFERS
    return Claim("Figure 1", statement, f"P* at φ = {plain(density)} is "
                                        f"{', '.join(f'{one} for N = {disks:,}' for disks, one in found.items())}; a straight line in "
                                        f"1/N through the last two ends at {limit} against {known:.4f}, {distance:.1f} standard errors "
                                        "away.", verdict)


def _loop_texts(loops: list[_Maxwell]) -> list[str]:
    texts = []
    for maxwell in loops:
        if maxwell.loop is not None:
            how = ", with pressures of the crystal alone at the upper end" if maxwell.needs_crystal else ""
            texts.append(f"N = {maxwell.disks:,}: P* = {maxwell.loop.pressure} between φ = {maxwell.loop.liquid} and "
                         f"{maxwell.loop.solid}{how}")
    return texts


def _coexistence_claim(loops: list[_Maxwell]) -> Claim:
    statement = "Liquid at φ = 0.700 and hexatic at 0.716 coexist at P* = 9.185 (Bernard, Krauth 2011; Engel et al. 2013)."
    texts = _loop_texts(loops)
    if not texts:
        return Claim("Figure 1", statement, "no number of disks has a loop beyond its errors", Verdict.UNDECIDED)
    text = "; ".join(texts)
    best = next((one for one in reversed(loops) if one.loop is not None), None)
    if best is None or best.loop is None or best.needs_crystal or best.disks < theory.MANY_DISKS:
        return Claim("Figure 1", statement, f"{text}. A box of fewer than {theory.MANY_DISKS:,} disks moves both densities by more than "
                                            "the errors, and starts have to agree on both sides: these runs are too small to see "
                                            "it.", Verdict.UNDECIDED)
    known = (theory.COEXISTENCE, theory.LIQUID, theory.HEXATIC)
    distances = [abs(one.value - value) / math.hypot(one.known_error, 1e-3) for one, value in zip(best.loop[:3], known)]
    return Claim("Figure 1", statement, f"{text}. The largest distance is {max(distances):.1f} standard errors, with 0.001 for the "
                                        "published ones.",
                 Verdict.AGREES if max(distances) < 3.0 else Verdict.DIFFERS)


def _large_claim(system: System, points: list[Point]) -> Claim:
    statement = "1,024² disks have these pressures through the transition (Engel et al. 2013, Li et al. 2022)."
    pairs = [(point, known) for point in points for known in theory.LARGE if point.packing_fraction == known.packing_fraction]
    texts = [f"{point.pressures() if point.is_equilibrated else point.difference} against {known.pressure.value:.4f} at φ = "
             f"{plain(point.packing_fraction)}" for point, known in pairs]
    agreeing = [(point.pressures(), known.pressure) for point, known in pairs if point.is_equilibrated and point.pressures().error]
    if system.disks < theory.MANY_DISKS or not agreeing:
        return Claim("Figure 1", statement, f"{'; '.join(texts) or 'none'} for N = {system.disks:,}. So few disks have a loop where many "
                                            "have a plateau: too small to tell.", Verdict.UNDECIDED)
    largest = max(abs(found.value - known.value) / math.hypot(found.known_error, known.known_error) for found, known in agreeing)
    return Claim("Figure 1", statement, f"{'; '.join(texts)} for N = {system.disks:,}. The largest distance is {largest:.1f} standard "
                                        "errors.",
                 Verdict.AGREES if largest < 4.0 else Verdict.DIFFERS)


def _conclusions(loops: list[_Maxwell], curves: dict[int, list[Point]]) -> list[str]:
    texts = [f"βγ(2R) = {interface_free_energy(one.loop, one.disks)} for N = {one.disks:,}" for one in loops if one.loop is not None]
    lines = [f"Free energy of the interface between liquid and solid from the area of the loop: {', '.join(texts)}."] if texts else []
    parted = [f"N = {disks:,} at {', '.join(plain(p.packing_fraction) for p in points if not p.is_equilibrated)}"
              for disks, points in curves.items() if any(not point.is_equilibrated for point in points)]
    if parted:
        lines.append(f"Runs from a crystal and from a liquid have not met at {'; '.join(parted)}: **no equilibrium** in these runs, and "
                     "left out of curves and constructions. A liquid there becomes a crystal that is turned against the box and keeps "
                     "defects.")
    return lines


def make(context: Context) -> Chapter:
    curves = {system.disks: context.points(system) for system in context.systems}
    loops = [_Maxwell(disks, points) for disks, points in curves.items()]
    table = Table(["N", "φ", "P* from the crystal", "P* from the liquid", "starts"], "P* = βP(2R)² with one standard error.")
    rows = []
    for disks, points in curves.items():
        for point in points:
            first, second = point.pressures(CRYSTAL), point.pressures(LIQUID)
            rows.append((disks, point.packing_fraction, *point.pressures().cells, *first.cells, *second.cells, int(point.is_equilibrated)))
            table.rows.append([f"{disks:,}", plain(point.packing_fraction), str(first), str(second), point.difference or "agree"])
    context.write_table("figure_1.csv", "disks packing_fraction pressure error crystal_pressure crystal_error liquid_pressure liquid_error "
                        "is_equilibrated", rows)
    context.draw("figure_1", lambda: _draw(curves, loops))
    return Chapter(
        title="Figure 1: equation of state",
        introduction=["Hard disks in a periodic square, by exact dynamics, once from a triangular crystal and once from a liquid that "
                      "is compressed slowly. A point is an equilibrium only if both starts agree: blocks of P* and of |Ψ6| overlap for "
                      "every pair of runs, and the mean pressures are within three standard errors."],
        drawings=[Drawing(("figure_1",), "Error bars are one standard error. Filled: both starts agree. White triangles: they do not. "
                                         "Horizontal lines: Maxwell's construction, dashed where its upper end is of the crystal alone. "
                                         "Data to φ = 0.74 are in the table.")],
        claims=[_small_claim(curves), _fluid_claim(curves), _coexistence_claim(loops),
                _large_claim(context.largest, curves[context.largest.disks])],
        tables=[table],
        conclusions=_conclusions(loops, curves),
    )
