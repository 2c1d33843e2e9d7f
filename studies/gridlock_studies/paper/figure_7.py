"""Figure 7: displacement against packing fraction, and what follows for it without simulation."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import Simulation

from .. import style
from ..chapter import Chapter, Claim, Drawing, Table
from .extent import Engine, Extent, Length
from .replicas import Measured, ReplicaSet, paper_replica_set, paper_replica_sets, set_ups
from ..statistics import NOT_MEASURED, Crossing, Estimate, Verdict, find_crossing, plain, three_sigma
from .context import Context
from .theory import enskog_diffusion, mean_distance, mean_distance_after_diffusion, mean_distance_in_square

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

STARTS = ("square", "triangular")
JAMMING_LEVEL = 0.1
#: Freezing: Engel et al. (2013); random quenches of two sizes, 1 : 1.4: O'Hern et al. (2003); equal disks, which jam as polycrystals:
#: Atkinson et al. (2014).
FREEZING = 0.700
PUBLISHED_DENSITIES = {FREEZING: "freezing", 0.842: "quenched mixtures jam", 0.88: "equal disks jam"}
TEMPERATURE_OF_START = 0.25  # kT/m = v_max²/4 for v_max = 1
SHARE_OF_PLATEAU = 0.4  # of a plateau run that counts
DIFFUSIVE_UP_TO = 0.6  # where Enskog's theory is drawn
PACKING_FRACTION_OF_INSETS = 0.7


def _radius_at(packing_fraction: float, disks: int) -> float:
    return math.sqrt(packing_fraction / (disks * math.pi))


class Prediction:
    """What follows from the sites of a start: the plateau and the approach to it."""

    def __init__(self, extent: Extent, start: str) -> None:
        self._disks = extent.disks
        simulation = Simulation(disks={"count": extent.disks, "packing_fraction": 0.1, "start": start})
        self._sites: NDArray[Any] = np.array(simulation.agents.positions)

    def plateau(self, packing_fraction: float) -> float:
        radius = _radius_at(packing_fraction, self._disks)
        return mean_distance(self._sites, radius, 1.0 - radius)

    def diffused(self, packing_fraction: float, time: float) -> float:
        """Enskog diffusion for some physical time, nan where it is not claimed; at short times disks still fly straight on, hence
        the delay."""
        if packing_fraction > DIFFUSIVE_UP_TO:
            return math.nan
        radius = _radius_at(packing_fraction, self._disks)
        diffusion = enskog_diffusion(packing_fraction, radius, TEMPERATURE_OF_START)
        memory = diffusion / TEMPERATURE_OF_START
        effective = time - memory * (1.0 - math.exp(-time / memory))
        return mean_distance_after_diffusion(self._sites, radius, 1.0 - radius, diffusion * effective)


def plateau_replica_sets(context: Context) -> list[ReplicaSet]:
    """Runs at low density that last until the start is forgotten."""
    extent, samples = context.extent, 200
    sets = []
    for density in extent.plateau_densities:
        radius = _radius_at(density, extent.disks)
        room = 1.0 - 2.0 * radius
        diffusion = enskog_diffusion(density, radius, TEMPERATURE_OF_START)
        relaxation = room * room / (math.pi * math.pi * diffusion)
        every = math.ceil(extent.plateau_relaxations * relaxation / (extent.plateau_time_step * 2.0 * radius) / samples)
        length = Length(every * samples, every, extent.plateau_seeds)
        sets += [paper_replica_set(extent, context.seed, length, extent.engines[0], start, density)
                 .changed(time_step=extent.plateau_time_step) for start in STARTS]
    return sets


def plan(context: Context) -> list[ReplicaSet]:
    extent = context.extent
    return [*paper_replica_sets(extent, context.seed, extent.figure_6),
            *paper_replica_sets(extent, context.seed, extent.figure_7), *plateau_replica_sets(context)]


@dataclasses.dataclass
class _Figure:
    """What the chapter is written from."""

    context: Context
    predictions: dict[str, Prediction]
    points: list[Measured]  #: the points of the figure
    plateaus: list[Measured]

    def prediction_of(self, result: Measured) -> Prediction:
        return self.predictions[result.set.run.start]

    def plateau_of(self, result: Measured) -> float:
        return self.prediction_of(result).plateau(result.set.run.packing_fraction)

    def diffused(self, result: Measured) -> float:
        return self.prediction_of(result).diffused(result.set.run.packing_fraction, result.time(-1))


def _write_points(figure: _Figure) -> None:
    figure.context.write_table(
        "figure_7.csv", "engine start packing_fraction time mean_displacement mean_displacement_error plateau enskog_diffusion "
        "halted_fraction halted_fraction_error collision_rate collision_rate_error steps seeds arrested",
        [(result.set.engine.kind, result.set.run.start, result.set.run.packing_fraction, result.time(-1),
          *result.displacement().cells, figure.plateau_of(result), figure.diffused(result),
          *result.halted_fraction.cells, *result.collision_rate.cells,
          result.set.run.steps, result.seeds, result.arrested) for result in figure.points])
    figure.context.write_table(
        "figure_7_plateau.csv", "start packing_fraction time mean_displacement mean_displacement_error plateau seeds",
        [(result.set.run.start, result.set.run.packing_fraction, result.time(-1),
          *result.tail("mean_displacement", SHARE_OF_PLATEAU).cells, figure.plateau_of(result), result.seeds)
         for result in figure.plateaus])


def _theory(figure: _Figure) -> list[tuple[float, ...]]:
    """Rows of packing fraction, plateau and diffusion for both starts, and the mean distance of two random points."""
    extent = figure.context.extent
    rows = []
    for density in (0.02 * i for i in range(1, 40)):
        radius = _radius_at(density, extent.disks)
        time = 0.1 * 2.0 * radius * extent.figure_7.steps
        predictions = figure.predictions.values()
        rows.append((density, *(one.plateau(density) for one in predictions),
                     *(one.diffused(density, time) for one in predictions), mean_distance_in_square(1.0 - 2.0 * radius)))
    figure.context.write_table("figure_7_theory.csv", "packing_fraction plateau_square plateau_triangular diffusion_square "
                               "diffusion_triangular two_random_points", rows)
    return rows


def _draw(figure: _Figure, theory: list[tuple[float, ...]]) -> Figure:
    extent = figure.context.extent
    chart, axes = style.new_axes("packing fraction φ", "mean displacement / side of the box", height=5.6)
    style.reference(axes, JAMMING_LEVEL, "10 %", at=0.06)
    for engine in extent.engines:
        is_first = engine == extent.engines[0]
        for start, colour, marker in zip(STARTS, style.COLOURS, style.MARKERS):
            mine = [result for result in figure.points if result.set.engine == engine and result.set.run.start == start]
            y = [result.displacement() for result in mine]
            axes.errorbar([result.set.run.packing_fraction for result in mine], [one.value for one in y],
                          [one.known_error for one in y] if any(one.error for one in y) else None, color=colour, marker=marker,
                          markersize=4.5 if is_first else 6.5, markerfacecolor=colour if is_first else "none",
                          linestyle="-" if is_first else "none", capsize=2, label=f"{start} start, {engine.label}")
    density, plateau, _, diffusion, _, _ = np.array(theory).T
    axes.plot(density, plateau, color=style.COLOURS[2], label="plateau: start site to random point, exact")
    axes.plot(density, diffusion, color=style.COLOURS[3], linestyle=style.DASHED,
              label="Enskog diffusion for the same time, in the fluid (φ ≤ 0.6)")
    forgotten = [result.tail("mean_displacement", SHARE_OF_PLATEAU) for result in figure.plateaus]
    axes.errorbar([result.set.run.packing_fraction for result in figure.plateaus], [one.value for one in forgotten],
                  [one.known_error for one in forgotten], color=style.COLOURS[4], marker="v", linestyle="none", capsize=2,
                  label="longer runs, start forgotten")
    for density, name in PUBLISHED_DENSITIES.items():
        axes.axvline(density, color=style.GREY, linewidth=0.8, linestyle=":")
        axes.annotate(name, (density, 1.0), xycoords=axes.get_xaxis_transform(), xytext=(-2, -9), textcoords="offset points",
                      rotation=90, fontsize=7, color=style.GREY, ha="right", va="top")
    axes.set(xlim=(0.0, 0.92), ylim=(0.0, 0.6))
    chart.legend(loc="outside lower center", ncols=2)
    for left, start in zip((0.05, 0.3), STARTS):
        inset = axes.inset_axes((left, 0.2, 0.2, 0.36))
        simulation = Simulation(disks={"count": extent.disks, "packing_fraction": PACKING_FRACTION_OF_INSETS, "start": start},
                                run={"seed": figure.context.seed})
        radius = float(simulation.agents.radius[0])
        style.draw_disks(inset, np.array(simulation.agents.positions), radius, style.COLOURS[5], edge=0.0)
        inset.set_title(start, fontsize=8, pad=3)
    return chart


def crossing(context: Context, engine: Engine, start: str, length: Length, share_of_run: float = 1.0) -> Crossing:
    """Where the curve of one engine and start falls through 10 % after a share of runs of some length."""
    points = []
    for result in context.measured(paper_replica_sets(context.extent, context.seed, length)):
        if result.set.engine == engine and result.set.run.start == start:
            sample = max(1, math.floor(share_of_run * (result.samples - 1) + 0.5))
            points.append((result.set.run.packing_fraction, result.displacement(sample)))
    return find_crossing([(x, y) for x, y in points if y.value > 0.0], JAMMING_LEVEL)


def early_and_late_crossing(context: Context, engine: Engine, start: str) -> tuple[Crossing, Crossing]:
    """After a tenth of the runs of the length of Figure 6, which have errors, and at their end."""
    length = context.extent.figure_6
    return crossing(context, engine, start, length, 0.1), crossing(context, engine, start, length)


def _seeds_text(length: Length) -> str:
    return "1 seed" if length.seeds == 1 else f"{length.seeds} seeds"


def _crossing_table(context: Context) -> Table:
    extent = context.extent
    times = [(extent.figure_6, share) for share in (0.1, 0.3, 1.0)]
    if extent.figure_7.steps > extent.figure_6.steps:
        times.append((extent.figure_7, 1.0))
    header = ["start", "engine", *(f"after {share * length.steps:.0f} steps, {_seeds_text(length)}" for length, share in times)]
    table = Table(header, "Packing fraction at which the mean displacement falls through 10 % of the side. Errors: standard "
                  "error over seeds, where there are several, and uncertainty of the interpolation.")
    for engine in extent.engines:
        for start in STARTS:
            table.rows.append([start, engine.label, *(str(crossing(context, engine, start, *at)) for at in times)])
    return table


def _crossing_claim(context: Context) -> Claim:
    length = context.extent.figure_7
    crossings = [crossing(context, context.extent.engines[0], start, length) for start in STARTS]
    measured = (f"After {length.steps} steps ({_seeds_text(length)}) the square start crosses at φ = {crossings[0]}, the "
                f"triangular start at φ = {crossings[1]}.")
    if length.seeds == 1:
        measured += " The errors are those of the interpolation alone."
    verdict = Verdict.DIFFERS
    if any(one.missing == NOT_MEASURED for one in crossings):
        verdict = Verdict.UNDECIDED
    elif all(one.is_crossed and not one.comes_back for one in crossings):
        verdict = Verdict.AGREES
    return Claim("Figure 7", "With rising packing fraction the mean displacement falls through 10 % of the side of the box: the "
                 "system jams.", measured, verdict)


def _duration_claim(context: Context) -> Claim:
    """Whether the 10 % line marks a density, or only how long one has waited."""
    statement = "The density at which the curve falls below 10 % of the side marks the jamming transition."
    steps = context.extent.figure_6.steps
    text, is_moving = "", False
    for start in STARTS:
        first, last = early_and_late_crossing(context, context.extent.engines[0], start)
        if not (first.is_crossed and last.is_crossed):
            continue
        shift = last.moved_from(first)
        is_moving = is_moving or shift.value > 3.0 * shift.known_error
        text += f"{start.capitalize()} start: the crossing moves by {shift} from {0.1 * steps:.0f} to {steps} steps. "
    if not text:
        return Claim("Figure 7", statement, "Not crossed both after a tenth of the runs and at their end.", Verdict.UNDECIDED)
    text += ("The longer one waits, the denser a system still passes 10 %: the line measures slow diffusion and the length of "
             "the run, not only a density." if is_moving else "No shift beyond three standard errors.")
    text += " Closest packing in this box lies higher, at φ = 0.785 for the square lattice and 0.865 for the triangular one."
    return Claim("Figure 7", statement, text, Verdict.DIFFERS if is_moving else Verdict.UNDECIDED)


def _deviation_text(measured: Estimate, exact: float) -> str:
    if not measured.known_error > 0.0:
        return "–"
    deviation = (measured.value - exact) / measured.known_error
    return f"{'−' if deviation < 0.0 else '+'}{abs(deviation):.1f}"


def _plateau_comparison(figure: _Figure) -> Table:
    extent = figure.context.extent
    table = Table(["start", "φ", "runs", "measured", "exact plateau", "deviation / standard error"], (
        f"Runs of {plain(extent.plateau_relaxations)} relaxation times of the slowest mode of the box, of which the last "
        f"{100.0 * SHARE_OF_PLATEAU:.0f} % count; time step {plain(extent.plateau_time_step)} diameters per v_max, since the "
        "plateau does not depend on it."))
    for result in figure.plateaus:
        measured, exact = result.tail("mean_displacement", SHARE_OF_PLATEAU), figure.plateau_of(result)
        table.rows.append([result.set.run.start, plain(result.set.run.packing_fraction), str(result.seeds), str(measured),
                           f"{exact:.5f}", _deviation_text(measured, exact)])
    return table


def _approach_comparison(figure: _Figure) -> Table:
    header = ["engine", "start", "φ", "measured", "Enskog diffusion", "exact plateau", "from the plateau / standard error"]
    table = Table(header, (
        f"The points of Figure 7 at low density, after {figure.context.extent.figure_7.steps} steps: how near to the plateau "
        "they can be after that time, by Enskog's diffusion between walls."))
    for result in figure.points:
        run, exact = result.set.run, figure.plateau_of(result)
        if run.packing_fraction <= DIFFUSIVE_UP_TO:
            table.rows.append([result.set.engine.label, run.start, plain(run.packing_fraction), str(result.displacement()),
                               f"{figure.diffused(result):.4f}", f"{exact:.5f}", _deviation_text(result.displacement(), exact)])
    return table


def _plateau_claim(figure: _Figure) -> Claim:
    is_within, parts = True, []
    for result in figure.plateaus:
        if result.seeds < 2:
            continue
        measured, exact = result.tail("mean_displacement", SHARE_OF_PLATEAU), figure.plateau_of(result)
        is_within = is_within and abs(measured.value - exact) < three_sigma(result.seeds - 1) * measured.known_error
        parts.append(f"{measured} at φ = {plain(result.set.run.packing_fraction)} ({result.set.run.start} start; exact "
                     f"{exact:.4f})")
    statement = "At low packing fractions the mean displacement levels off near 0.5 of the side."
    if not parts:
        return Claim("Figure 7", statement, "Not measured.", Verdict.UNDECIDED)
    return Claim(
        "Figure 7", statement,
        f"Once the start is forgotten: {', '.join(parts)}. Nothing is fitted: the plateau is the mean distance from a start "
        "site to a point uniform in the room of the centres; for two random points of the whole box it would be "
        f"{mean_distance_in_square(1.0):.4f}. Disagreement would be a deviation that chance explains in less than 0.3 % of all "
        "cases (Student's t).",
        Verdict.AGREES if is_within else Verdict.DIFFERS,
    )


def _standstill_text(figure: _Figure) -> str:
    """Replica sets that have come to a standstill, in words."""
    parts = [f"φ = {plain(result.set.run.packing_fraction)} {result.set.run.start} ({result.arrested} of {result.seeds} runs, "
             f"{100.0 * result.halted_fraction.value:.1f} % of the moves halted)" for result in figure.points if result.arrested]
    if not parts:
        return "No run came to a standstill: nowhere were more than 98 % of the moves halted."
    return (f"Runs that came to a standstill, with more than 98 % of all moves halted over the last fifth: {'; '.join(parts)}. "
            "Hard disks that move from collision to collision do not stop; at these densities the points of the figure show the "
            "finite step, not physics.")


def _freezing_text(context: Context) -> str:
    """Where the line is crossed beside the published freezing of an infinite system."""
    text = ("For comparison: an infinite system of hard disks in equilibrium freezes between φ = 0.700 (liquid) and 0.720 (hexatic and "
            "solid), Engel et al. 2013, doi:10.1103/PhysRevE.87.042134.")
    crossings = [crossing(context, context.extent.engines[0], start, context.extent.figure_7) for start in STARTS]
    known = [one.x for one in crossings if one.is_crossed]
    if known and all(abs(x - FREEZING) < 0.05 for x in known):
        text += (" That the 10 % line is crossed near this density is what one expects of a crystal, whose disks keep their neighbours; "
                 "the lattices themselves are jammed only when close packed.")
    elif known:
        text += f" The 10 % line is crossed elsewhere, at φ = {', '.join(f'{x:.3f}' for x in known)}."
    return text


def _three_densities_text(context: Context) -> str:
    waiting = ("depends on how long one waits" if _duration_claim(context).verdict is Verdict.DIFFERS
               else "may depend on how long one waits, which these runs do not show")
    return (f"**Mobility, freezing and jamming are three different densities.** Where the mean displacement falls through 10 % {waiting}. "
            "Freezing is a property of the equilibrium of equal disks (Engel et al. 2013); it is not measured here. They jam, as "
            "polycrystals, near 0.88, and mixtures of two sizes, quenched from random points, at 0.842 (O'Hern et al. 2003, "
            "doi:10.1103/PhysRevE.68.011306), or higher from denser fluids. gridlock jam takes disks there and measures it.")


def _errors_text(extent: Extent) -> str:
    """Where the points of the figure have their errors from."""
    if extent.figure_7.seeds > 1:
        return f"error bars are standard errors over {extent.figure_7.seeds} seeds"
    return (f"each point is one run, which has no error over seeds: what compares points rests on {extent.figure_6.seeds} seeds "
            f"and {extent.figure_6.steps} steps")


def make(context: Context) -> Chapter:
    extent = context.extent
    figure = _Figure(context, {start: Prediction(extent, start) for start in STARTS},
                     context.measured(paper_replica_sets(extent, context.seed, extent.figure_7)),
                     context.measured(plateau_replica_sets(context)))
    _write_points(figure)
    theory = _theory(figure)
    context.draw("figure_7", functools.partial(_draw, figure, theory))
    caption = (
        f"Mean displacement after {extent.figure_7.steps:,} steps; lines and filled symbols: the paper's rule. The plateau is "
        "no fit: it is the mean distance from a site of the start to a random point, exactly. The triangular start has a few "
        "sites too many, which stay empty. Points below the plateau at low density have had too little time: Enskog's diffusion between walls "
        "for the same time gives the dashed curve.")
    if extent.figure_7.densest_of_others < 1.0:
        caption += (f" Above φ = {plain(extent.figure_7.densest_of_others)} the paper's rule alone was run: other dynamics "
                    "collide too often there for a quick study.")
    return Chapter(
        title="Figure 7: displacement against packing fraction",
        introduction=[
            f"The mean displacement of {extent.disks} disks after {extent.figure_7.steps} steps, for square and triangular "
            f"starts; {_errors_text(extent)}. Insets: the two starts at φ = {plain(PACKING_FRACTION_OF_INSETS)}."
        ],
        drawings=[Drawing(("figure_7",), caption)],
        set_ups=set_ups(paper_replica_sets(extent, context.seed, extent.figure_7)),
        claims=[_plateau_claim(figure), _crossing_claim(context), _duration_claim(context)],
        tables=[_crossing_table(context), _plateau_comparison(figure), _approach_comparison(figure)],
        conclusions=[
            _standstill_text(figure),
            _freezing_text(context),
            _three_densities_text(context),
        ],
    )
