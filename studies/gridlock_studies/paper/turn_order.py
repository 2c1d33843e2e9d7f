"""Whether it matters in which order the disks take their turns: stepped beside tiled, from the same starts, beside exact."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import style
from ..chapter import Chapter, Drawing, Table
from .extent import Engine
from .replicas import USUAL_TIME_STEP, Measured, ReplicaSet, paper_replica_set, sampled_evenly
from .runs import ABOUT_CENTRE, Outcome
from ..statistics import Estimate, mean_over_runs, plain, tail_mean, three_sigma
from .context import Context

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEPPED, TILED, EXACT = (Engine(kind, kind) for kind in ("stepped", "tiled", "exact"))
#: What does not change with time but for chance, each over the last half of the runs: column and name.
QUANTITIES = (("wall_pressure", "pressure on the walls"), ("compressibility_factor", "compressibility factor"),
              ("collision_rate", "collisions per disk and time"))
_SHARE_THAT_COUNTS = 0.5


class Orders(NamedTuple):
    """The same runs in both orders of turns, and without turns."""

    by_id: ReplicaSet
    by_tile: ReplicaSet
    reference: ReplicaSet


@dataclasses.dataclass(frozen=True)
class Comparison:
    """One quantity measured in both orders from the same starts, and without a time step."""

    by_id: Estimate
    by_tile: Estimate
    reference: Estimate
    difference: Estimate  #: tiled minus stepped, mean and error over the pairs of runs from one start
    seeds: int

    @property
    def error(self) -> float:
        return math.hypot(self.by_id.known_error, self.by_tile.known_error)

    @property
    def is_known(self) -> bool:
        return self.seeds > 1 and self.error > 0.0

    @property
    def deviation(self) -> float:
        """In standard errors of two independent means."""
        return (self.by_tile.value - self.by_id.value) / self.error

    @property
    def differs(self) -> bool:
        """Whether chance explains it in less than 0.3 % of all cases."""
        return self.is_known and abs(self.deviation) > three_sigma(2 * (self.seeds - 1))

    @property
    def deviation_pairwise(self) -> float:
        """The same from start to start, which is sharper: what the two orders share of a start's own pressure drops out."""
        return self.difference.value / self.difference.known_error if self.difference.known_error > 0.0 else 0.0

    @property
    def differs_pairwise(self) -> bool:
        return self.is_known and abs(self.deviation_pairwise) > three_sigma(self.seeds - 1)

    @property
    def resolution(self) -> float:
        """The smallest difference from start to start that would count, of the value of stepped."""
        return three_sigma(self.seeds - 1) * self.difference.known_error / abs(self.by_id.value)

    @property
    def relative_difference(self) -> Estimate:
        """Of the value of stepped."""
        return Estimate(self.difference.value / self.by_id.value, self.difference.known_error / abs(self.by_id.value))

    @property
    def distance_from_reference(self) -> float:
        """Of the value without a time step."""
        return self.by_id.value / self.reference.value - 1.0


@dataclasses.dataclass(frozen=True)
class Row:
    """All that is compared for one start, density and time step."""

    start: str
    edge: str
    packing_fraction: float
    time_step: float
    times: Sequence[float] = ()  #: in diameters per v_max
    displacements: Sequence[Comparison] = ()  #: at the times; about the centre in a periodic box
    centres: Sequence[Comparison] = ()  #: how far the centre has come, at the times
    whole: Comparison | None = None  #: mean displacement at the end, the centre's included
    rates: Sequence[tuple[str, str, Comparison]] = ()  #: columns and names of QUANTITIES; a periodic box has no walls

    @property
    def is_periodic(self) -> bool:
        return self.edge == "periodic"

    @property
    def names(self) -> list[str]:
        return [self.start, self.edge, plain(self.packing_fraction), plain(self.time_step)]

    @property
    def place(self) -> str:
        return f"φ = {plain(self.packing_fraction)} {self.start}{' periodic' if self.is_periodic else ''}"


def orders_of(context: Context) -> list[Orders]:
    extent = context.extent
    orders = []
    for start, edge, densities in (("square", "wall", extent.order_square_densities),
                                   ("triangular", "wall", extent.order_triangular_densities),
                                   ("square", "periodic", extent.order_periodic_densities)):
        for density in densities:
            base = paper_replica_set(extent, context.seed, extent.figure_6, STEPPED, start, density).changed(edge=edge)
            base = ReplicaSet(base.engine, base.run, extent.order_seeds)
            reference = sampled_evenly(base.changed(time_step=USUAL_TIME_STEP), extent.order_diameters, 256).moved_by(EXACT)
            for step in extent.order_time_steps:
                by_id = sampled_evenly(base.changed(time_step=step), extent.order_diameters, 256)
                orders.append(Orders(by_id, by_id.moved_by(TILED), reference))
    return orders


def plan(context: Context) -> list[ReplicaSet]:
    return [replica_set for orders in orders_of(context) for replica_set in orders]


def _compare(results: Sequence[Measured], value: Callable[[Outcome], float]) -> Comparison:
    here, there, reference = (result.of_each_seed(value) for result in results)
    differences = [b - a for a, b in zip(here, there)]
    return Comparison(mean_over_runs(here), mean_over_runs(there), mean_over_runs(reference),
                      mean_over_runs(differences), len(here))


def _row(orders: Orders, results: Sequence[Measured]) -> Row:
    run, by_id = orders.by_id.run, results[0]
    is_periodic = run.edge == "periodic"
    # The end, a quarter of the run, a sixteenth …
    samples = [by_id.samples - 1]
    while samples[0] >= 4:
        samples.insert(0, samples[0] // 4)

    def compare_at(sample: int, name: str) -> Comparison:
        return _compare(results, lambda outcome: float(outcome.series[name][sample]))

    def compare_tail(name: str) -> Comparison:
        return _compare(results, lambda outcome: tail_mean(outcome.series[name], _SHARE_THAT_COUNTS))

    return Row(
        run.start, run.edge, run.packing_fraction, run.time_step,
        times=[by_id.step(sample) * run.time_step for sample in samples],
        displacements=[compare_at(sample, ABOUT_CENTRE if is_periodic else "mean_displacement") for sample in samples],
        centres=[compare_at(sample, "centre_displacement") for sample in samples],
        whole=compare_at(samples[-1], "mean_displacement"),
        rates=[(column, name, compare_tail(column))
               for column, name in QUANTITIES if not (is_periodic and column == "wall_pressure")],
    )


def rows_of(context: Context) -> list[Row]:
    rows = []
    for orders in orders_of(context):
        results = context.measured(orders)
        # A run without its partner would be compared with another start's.
        if len(results) == 3 and all(result.seeds == orders.by_id.seeds for result in results[:2]):
            rows.append(_row(orders, results))
    return rows


def _write(context: Context, rows: Sequence[Row]) -> None:
    curves, names = [], ("mean_displacement", "centre_displacement", ABOUT_CENTRE)
    for orders in orders_of(context):
        for result in context.measured(orders[:2]):
            run = result.set.run
            for sample in result.samples_spread_out(4):
                cells = [cell for name in names for cell in result.at(name, sample).cells]
                curves.append((run.engine, run.start, run.edge, run.packing_fraction, run.time_step,
                               result.step(sample) * run.time_step, *cells))
    context.write_table("turn_order.csv", "engine start edge packing_fraction time_step diameters mean_displacement "
                        "mean_displacement_error centre_displacement centre_displacement_error displacement_about_centre "
                        "displacement_about_centre_error", curves)

    comparisons: list[tuple[object, ...]] = []

    def add(row: Row, quantity: str, diameters: float, one: Comparison) -> None:
        comparisons.append((quantity, row.start, row.edge, row.packing_fraction, row.time_step, diameters, *one.by_id.cells,
                            *one.by_tile.cells, one.deviation if one.is_known else math.nan, *one.difference.cells,
                            *one.reference.cells, one.seeds))

    for row in rows:
        for time, displacement, centre in zip(row.times, row.displacements, row.centres):
            add(row, ABOUT_CENTRE if row.is_periodic else "mean_displacement", time, displacement)
            if row.is_periodic:
                add(row, "centre_displacement", time, centre)
        for column, _, one in row.rates:
            add(row, column, math.nan, one)
    context.write_table("turn_order_comparisons.csv", "quantity start edge packing_fraction time_step diameters stepped "
                        "stepped_error tiled tiled_error deviation difference difference_error exact exact_error seeds",
                        comparisons)


def _draw(context: Context) -> Figure:
    figure, axes = style.new_axes(f"time / (diameters per {style.V_MAX})", "mean displacement / side of the box")
    drawn = [orders for orders in orders_of(context)
             if orders.by_id.run.edge == "wall" and orders.by_id.run.time_step == context.extent.order_time_steps[0]]
    for orders, colour, marker in zip(drawn, style.COLOURS, style.MARKERS):
        for result in context.measured(orders[:2]):
            run, samples = result.set.run, result.samples_spread_out(4)
            x = [result.step(sample) * run.time_step for sample in samples]
            y, error = np.array([(one.value, one.known_error) for one in map(result.displacement, samples)]).T
            if run.engine == STEPPED.kind:
                axes.plot(x, y, color=colour)
                axes.fill_between(x, y - error, y + error, color=colour, alpha=0.18, linewidth=0)
            else:
                axes.errorbar(x, y, error, color=colour, marker=marker, markersize=3.5, linestyle="none", capsize=2)
        axes.plot([], [], color=colour, marker=marker, label=f"{orders.by_id.run.start}, φ = "
                                                             f"{plain(orders.by_id.run.packing_fraction)}")
    style.logarithmic(axes, "x", "y")
    figure.legend(loc="outside right upper", title="lines: stepped\npoints: tiled", title_fontsize=8)
    return figure


def _deviation_text(one: Comparison) -> str:
    return f"{one.deviation:+.1f}{' *' if one.differs else ''}" if one.is_known else "–"


def _displacement_table(rows: Sequence[Row]) -> Table:
    table = Table(
        ["start", "edges", "φ", "time step", "stepped", "tiled", "exact", *(f"after {time:.3g}" for time in rows[0].times)],
        "Mean displacement over the side at the end of the runs (in a periodic box the root mean square about the centre), and "
        "(tiled − stepped) / standard error after some times, in diameters per v_max. A star: chance explains it in less than "
        "0.3 % of all cases.")
    for row in rows:
        last = row.displacements[-1]
        table.rows.append([*row.names, *map(str, (last.by_id, last.by_tile, last.reference)),
                           *map(_deviation_text, row.displacements)])
    return table


def _rate_table(rows: Sequence[Row]) -> Table:
    table = Table(["quantity", "start", "edges", "φ", "time step", "stepped", "tiled", "difference / standard error",
                   "difference start by start, %", "exact"], (
        "Over the last half of the runs. A star: chance explains it in less than 0.3 % of all cases. The difference start by "
        "start is the sharper test, and the one that counts below."))
    for column, _ in QUANTITIES:
        for row, name, one in ((row, name, one) for row in rows for known, name, one in row.rates if known == column):
            percent = Estimate(100.0 * one.relative_difference.value, 100.0 * one.relative_difference.known_error)
            table.rows.append([name, *row.names, str(one.by_id), str(one.by_tile), _deviation_text(one),
                               f"{percent}{' *' if one.differs_pairwise else ''}", str(one.reference)])
    return table


def _centre_table(rows: Sequence[Row]) -> Table:
    """The centre of the disks in a periodic box, which nothing holds."""
    header = ["start", "φ", "time step", "centre: stepped", "tiled", "exact", "mean displacement: stepped", "tiled", "exact"]
    table = Table(header, (
        "Periodic boxes: how far the centre of the disks has come at the end of the runs, and the mean displacement that has it "
        "in it, over the side."))
    for row in rows:
        if row.is_periodic and row.whole is not None:
            estimates = [estimate for one in (row.centres[-1], row.whole) for estimate in (one.by_id, one.by_tile, one.reference)]
            # What is left of an exact centre is rounding.
            cells = ["0" if abs(estimate.value) < 1e-9 else str(estimate) for estimate in estimates]
            table.rows.append([row.start, plain(row.packing_fraction), plain(row.time_step), *cells])
    return table


class _Findings:
    """What the comparisons of one time step show."""

    def __init__(self, rows: Sequence[Row], step: float) -> None:
        self.count = 0
        self.squares = 0.0  # of the deviations, in standard errors
        self.differing: list[str] = []
        self.resolutions: list[float] = []  # the smallest differences of pressures and collision rates that would count
        for row in rows:
            if row.time_step != step:
                continue
            for time, one in zip(row.times, row.displacements):
                if one.is_known:
                    self._add(f"displacement after {time:.3g}", row, one, one.deviation, one.differs)
            for _, name, one in row.rates:
                if one.is_known:
                    self._add(name, row, one, one.deviation_pairwise, one.differs_pairwise)
                    self.resolutions.append(one.resolution)
        self.resolutions.sort()

    def _add(self, what: str, row: Row, one: Comparison, deviation: float, differs: bool) -> None:
        self.count += 1
        self.squares += deviation * deviation
        if differs:
            self.differing.append(f"{what} at {row.place} ({100.0 * (one.by_tile.value / one.by_id.value - 1.0):+.2g} %, "
                                  f"{deviation:+.1f} standard errors)")

    def text(self, step: float) -> str:
        if not self.count:
            return f"Steps of {plain(step)}: too few runs to tell."
        text = (f"With steps of {plain(step)}, {self.count - len(self.differing)} of {self.count} comparisons of displacements, "
                "pressures and collision rates show no difference (root mean square of the deviations: "
                f"{math.sqrt(self.squares / self.count):.2f} standard errors)")
        if self.differing:
            text += f"; by more than chance explains in 0.3 % of all cases differ: {', '.join(self.differing)}"
        text += "."
        if self.resolutions:
            text += (" So many starts show a difference of pressures and collision rates from "
                     f"{100.0 * self.resolutions[len(self.resolutions) // 2]:.2g} % on (the median; "
                     f"{100.0 * self.resolutions[-1]:.2g} % in the worst case); a smaller one would go unseen.")
        return text


def _verdict_text(rows: Sequence[Row], steps: Sequence[float]) -> str:
    """Whether what differs goes away with the time step."""
    longest, shortest = max(steps), min(steps)
    coarse, fine = _Findings(rows, longest), _Findings(rows, shortest)
    if not (coarse.count and fine.count):
        return "Too few runs to say what the order of the turns changes."
    if not (coarse.differing or fine.differing):
        both = plain(longest) if longest == shortest else f"{plain(longest)} or {plain(shortest)}"
        return f"**In short:** no difference shows with steps of {both}, to the accuracy of these runs."
    if longest == shortest:
        return f"**In short:** with steps of {plain(longest)} the order of the turns changes what is measured."
    if not fine.differing:
        return (f"**In short:** with steps of {plain(longest)} the order of the turns changes what is measured; with steps of "
                f"{plain(shortest)} no difference shows to the accuracy of these runs. So it is an effect of the finite time "
                "step, as far as they can tell.")
    return (f"**In short:** {len(coarse.differing)} of {coarse.count} comparisons differ with steps of {plain(longest)}, and "
            f"{len(fine.differing)} of {fine.count} with steps of {plain(shortest)}: "
            + ("fewer, but the shorter step does not take all of it away." if len(fine.differing) < len(coarse.differing)
               else "the shorter step does not take it away."))


def _order_and_step_text(rows: Sequence[Row], steps: Sequence[float]) -> str:
    """How much the order matters beside the step itself: the largest differences over all densities for each time step."""
    parts = []
    for step in steps:
        known = [one for row in rows if row.time_step == step for _, _, one in row.rates if one.is_known]
        of_order = max((abs(one.relative_difference.value) for one in known), default=0.0)
        of_step = max((abs(one.distance_from_reference) for one in known), default=0.0)
        parts.append(f"{100.0 * of_order:.1f} % with steps of {plain(step)}, which themselves shift them by up to "
                     f"{100.0 * of_step:.0f} % from those of exact disks")
    return ("Start by start, which is sharper than the errors of the means, pressures and collision rates of the two orders "
            f"differ by at most {', and '.join(parts)}.")


def _centre_text(rows: Sequence[Row]) -> str:
    """How far the centre of the disks travels in a periodic box, and whether it matters beside the disks' own displacements."""
    ends = [(row, row.centres[-1], row.displacements[-1]) for row in rows if row.is_periodic]
    if not ends:
        return ""
    parts = [f"{centre.by_id.value:.2g} of the side in stepped and {centre.by_tile.value:.2g} in tiled at φ = "
             f"{plain(row.packing_fraction)} with steps of {plain(row.time_step)}" for row, centre, _ in ends]
    most_of_exact = max(centre.reference.value for _, centre, _ in ends)
    share = max(max(centre.by_id.value / about.by_id.value, centre.by_tile.value / about.by_tile.value)
                for _, centre, about in ends)
    text = (f"**In a periodic box** the total momentum is zero. The centre of the disks has come as far as {', '.join(parts)} "
            f"at the end; that of exact disks {most_of_exact:.1g} at most. ")
    if share > 0.05:
        return text + (f"That is up to {share:.2g} times the root mean square displacement about the centre: halting keeps the "
                       "momentum, but a halted disk does not move, and which disks halt depends on the order. It is in the mean "
                       "displacements of the last table, and is taken out above.")
    return text + f"It does not matter beside the displacements about the centre: at most {share:.1g} times as much."


def conclusions_from(rows: Sequence[Row], steps: Sequence[float]) -> list[str]:
    """Which comparisons differ with each step, how much, whether a shorter step takes it away, and how far the centre travels in
    a periodic box, in words."""
    conclusions = [_Findings(rows, step).text(step) for step in steps]
    conclusions += [_order_and_step_text(rows, steps), _verdict_text(rows, steps)]
    centre = _centre_text(rows)
    return [*conclusions, centre] if centre else conclusions


def make(context: Context) -> Chapter:
    chapter = Chapter("The order of the turns: stepped and tiled")
    rows = rows_of(context)
    if not rows:
        return chapter
    _write(context, rows)
    context.draw("turn_order", lambda: _draw(context))
    chapter.introduction.append(
        "The paper's disks take their turns one after the other; in which order, it does not say. The engine stepped goes by "
        "the names of the disks, the engine tiled tile by tile through the box, so that many cores can share the work. Single "
        "trajectories part after a few collisions. Both orders are the same rule; what is measured of them may differ as far as "
        f"the step is finite. Both, and the exact dynamics, from the same {context.extent.order_seeds} starts at each density, "
        f"for {plain(context.extent.order_diameters)} diameters per v_max.")
    chapter.drawings.append(Drawing(("turn_order",), "Lines: stepped. Points: tiled."))
    chapter.tables += [_displacement_table(rows), _rate_table(rows)]
    if any(row.is_periodic for row in rows):
        chapter.tables.append(_centre_table(rows))
    chapter.conclusions = conclusions_from(rows, context.extent.order_time_steps)
    return chapter
