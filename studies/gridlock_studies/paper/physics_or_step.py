"""Which part of Figures 6 and 7 is physics and which the time step: the paper's rule beside the dynamics without one."""

from __future__ import annotations

import dataclasses
import math
import statistics
from collections.abc import Sequence

from ..chapter import Chapter, Table
from .extent import Engine
from .figure_7 import STARTS, early_and_late_crossing
from .open_choices import choices_of
from .replicas import Measured, paper_replica_sets
from ..statistics import Crossing, Estimate, joint_deviation, plain, span_text, three_sigma
from .context import Context

TITLE = "Physics, or the time step?"


@dataclasses.dataclass(frozen=True)
class Point:
    """One point of Figure 7 under the rule and without a time step."""

    start: str
    packing_fraction: float
    rule: Estimate
    exact: Estimate
    seeds: int

    @property
    def deviation(self) -> float:
        """In standard errors, nan where there are none."""
        error = math.hypot(self.rule.known_error, self.exact.known_error)
        return (self.rule.value - self.exact.value) / error if error > 0.0 else math.nan

    @property
    def resolution(self) -> float:
        """The smallest relative difference that would count here."""
        error = math.hypot(self.rule.known_error, self.exact.known_error)
        return three_sigma(2 * (self.seeds - 1)) * error / self.exact.value

    @property
    def differs(self) -> bool:
        """Whether chance explains the difference in less than 0.3 % of all cases."""
        return abs(self.deviation) > three_sigma(2 * (self.seeds - 1))

    @property
    def ratio(self) -> float:
        return self.rule.value / self.exact.value


@dataclasses.dataclass(frozen=True)
class Line:
    """Where displacement falls through the line of Figure 7, after a tenth of the runs and at their end."""

    start: str
    rule: tuple[Crossing, Crossing]
    exact: tuple[Crossing, Crossing]


@dataclasses.dataclass(frozen=True)
class Outcomes:
    """How runs of one contact rule, or of none, ended."""

    arrested: int
    runs: int
    displacement: Estimate
    collision_rate: float  #: over the last fifth

    @classmethod
    def of(cls, result: Measured) -> Outcomes:
        return cls(result.arrested, result.seeds, result.displacement(), result.collision_rate.value)


@dataclasses.dataclass(frozen=True)
class Contacts:
    """Both contact rules from one start with one time step, and the same start without one, where that was run."""

    start: str
    packing_fraction: float
    time_step: float
    always: Outcomes
    approaching: Outcomes
    exact: Outcomes | None


def _points(context: Context, rule: Engine, exact: Engine) -> list[Point]:
    points = []
    for replica_set in paper_replica_sets(context.extent, context.seed, context.extent.figure_6):
        if replica_set.engine != rule:
            continue
        here, there = Measured(context.runs, replica_set), Measured(context.runs, replica_set.moved_by(exact))
        if here.seeds >= 2 and there.seeds >= 2:
            points.append(Point(replica_set.run.start, replica_set.run.packing_fraction, here.displacement(),
                                there.displacement(), min(here.seeds, there.seeds)))
    return points


def _contacts(context: Context) -> list[Contacts]:
    contacts = []
    for choice in choices_of(context):
        exact = [Outcomes.of(result) for result in context.measured([choice.reference])]
        for pair in zip(choice.always, choice.approaching):
            results = context.measured(pair)
            if len(results) == 2:
                contacts.append(Contacts(choice.start, choice.packing_fraction, pair[0].run.time_step, Outcomes.of(results[0]),
                                         Outcomes.of(results[1]), exact[0] if exact else None))
    return contacts


def _point_table(points: Sequence[Point], steps: int) -> Table:
    table = Table(["start", "φ", "the paper's rule", "exact dynamics", "ratio", "difference / standard error"], (
        f"Mean displacement over the side after the physical time of {steps} steps. A star: chance explains it in less than 0.3 "
        "% of all cases."))
    for point in points:
        table.rows.append([point.start, plain(point.packing_fraction), str(point.rule), str(point.exact), f"{point.ratio:.2f}",
                           f"{point.deviation:+.1f}{' *' if point.differs else ''}"])
    return table


def _point_text(points: Sequence[Point]) -> str:
    if not points:
        return "Too few runs to tell."
    differing = [f"φ = {plain(point.packing_fraction)} {point.start} ({point.ratio:.2f} times as far as exact disks)"
                 for point in points if point.differs]
    alike = [point for point in points if not point.differs]
    text = ""
    if differing:
        text = (f"At {len(differing)} of {len(points)} points the rule and the exact dynamics differ by more than chance explains in 0.3 "
                f"% of all cases: {', '.join(differing)}: there the rule's points show the finite step. ")
    return text + (_joint_text(alike, len(points)) if alike else "")


def _joint_text(points: Sequence[Point], of: int) -> str:
    """Points that do not differ one by one, together: with few seeds none of them alone could."""
    resolution = statistics.median(point.resolution for point in points)
    behind = sum(point.rule.value < point.exact.value for point in points)
    text = (f"At {len(points)} of {of} points no difference shows at one point alone, which with {min(point.seeds for point in points)} seeds could "
            f"only be one of {100.0 * resolution:.0f} % or more (median). Together they tell more: the rule is behind the exact disks at "
            f"{behind} of {len(points)}, ")
    known = [point for point in points if math.isfinite(point.deviation)]
    if not known:
        return text + "and no point has an error."
    deviation = joint_deviation([point.deviation for point in known], [2 * (point.seeds - 1) for point in known])
    ratio = math.exp(statistics.fmean(math.log(point.ratio) for point in known))
    text += f"its disks come {ratio:.3f} times as far (geometric mean), and all deviations together are {deviation:+.1f} standard errors: "
    if abs(deviation) < 3.0:
        return text + "chance explains that in more than 0.3 % of all cases, so no difference shows here, small ones aside."
    return text + f"more than chance explains in 0.3 % of all cases. So the rule is {'ahead' if deviation > 0.0 else 'behind'} here, too."


def _is_beyond_error(difference: Estimate) -> bool:
    return abs(difference.value) > 3.0 * difference.known_error


def _movement_text(crossings: tuple[Crossing, Crossing]) -> str:
    early, late = crossings
    return str(late.moved_from(early)) if early.is_crossed and late.is_crossed else "not known"


def _line_text(lines: Sequence[Line]) -> str:
    """Where the line is crossed, and whether by the rule alone."""
    sentences = []
    for line in lines:
        rule, exact = line.rule[1], line.exact[1]
        sentence = f"From the {line.start} start: {rule} under the rule, {exact} by exact disks"
        if rule.is_crossed and exact.is_crossed:
            shift = rule.moved_from(exact)
            sentence += f"; the difference, {shift}, is {'beyond' if _is_beyond_error(shift) else 'within'} three standard errors"
        sentences.append(sentence)
    return ". ".join(sentences) + "."


def _crossing_verdict(lines: Sequence[Line]) -> str:
    by_rule = sum(line.rule[1].is_crossed for line in lines)
    by_exact = sum(line.exact[1].is_crossed for line in lines)
    if by_rule == by_exact == 0:
        return "Neither crosses it."
    if by_rule == 0:
        return "Exact disks cross it, those under the rule do not: that it is not crossed is the time step."
    if by_exact == 0:
        return "Exact disks do not cross it: that it is crossed under the rule is the time step, not physics."
    if by_rule == by_exact == len(lines):
        return "Exact disks cross it, too: that it is crossed is physics, with or without a step."
    return f"The rule crosses it from {by_rule} and exact disks from {by_exact} of {len(lines)} starts: not all of it is physics."


def _movement_verdict(lines: Sequence[Line]) -> str:
    parts = [f"{_movement_text(line.rule)} under the rule and {_movement_text(line.exact)} for exact disks ({line.start})"
             for line in lines]
    known = [late.moved_from(early) for early, late in (line.exact for line in lines) if early.is_crossed and late.is_crossed]
    moving = sum(map(_is_beyond_error, known))
    if not known:
        verdict = "whether it moves without a step cannot be told"
    elif moving == len(known):
        verdict = "that it moves with the length of the run is physics"
    elif moving == 0:
        verdict = "that it moves without a step does not show beyond three standard errors"
    else:
        verdict = f"without a step it moves, beyond three standard errors, from {moving} of {len(known)} starts"
    return f"From a tenth of the run to its end the crossing moves in φ by {', '.join(parts)}: {verdict}."


def _contact_table(contacts: Sequence[Contacts]) -> Table:
    table = Table(
        ["start", "φ", "time step", "displacement: approaching", "always", "exact",
         "collisions per disk and time: approaching", "always", "exact", "standstill: approaching", "always"],
        "The comparison of the choices above, at the same physical time. Collisions over the last fifth of the runs. "
        "Standstill: more than 98 % of all moves halted there. Exact disks take no turns and are never halted, so there is no "
        "standstill to count.")
    for one in contacts:
        outcomes = (one.approaching, one.always, one.exact)
        table.rows.append([
            one.start, plain(one.packing_fraction), plain(one.time_step),
            *("–" if outcome is None else str(outcome.displacement) for outcome in outcomes),
            *("–" if outcome is None else f"{outcome.collision_rate:.0f}" for outcome in outcomes),
            *(f"{outcome.arrested} of {outcome.runs}" for outcome in (one.approaching, one.always)),
        ])
    return table


def _standstill_text(name: str, outcomes: Sequence[tuple[Contacts, Outcomes]]) -> str:
    """Where one contact rule came to rest, and what the disks did there beside exact ones."""
    runs = sum(outcome.runs for _, outcome in outcomes)
    at_rest = [(one, outcome) for one, outcome in outcomes if outcome.arrested]
    if not at_rest:
        return f"With contact = \"{name}\" none of {runs} runs came to rest."
    places = ", ".join(f"φ = {plain(one.packing_fraction)} {one.start} with steps of {plain(one.time_step)} ({outcome.arrested} "
                       f"of {outcome.runs})" for one, outcome in at_rest)
    text = f"With contact = \"{name}\" {sum(outcome.arrested for _, outcome in at_rest)} of {runs} runs came to rest: {places}."
    beside = [(outcome, one.exact) for one, outcome in at_rest if one.exact is not None]
    if beside:
        collisions = span_text(outcome.collision_rate / exact.collision_rate for outcome, exact in beside)
        displacements = span_text(outcome.displacement.value / exact.displacement.value for outcome, exact in beside)
        text += (f" There the disks collide {collisions} times as often as exact ones at the same density and have moved "
                 f"{displacements} times as far.")
    return text


def _step_text(contacts: Sequence[Contacts]) -> str:
    arrested = sum(one.always.arrested + one.approaching.arrested for one in contacts)
    return (f"{_standstill_text('approaching', [(one, one.approaching) for one in contacts])} "
            f"{_standstill_text('always', [(one, one.always) for one in contacts])} An exact run cannot come to rest, by "
            "construction: no disk is ever halted, each flies on at its speed, and the energy does not change. "
            + ("So every standstill is the rule's." if arrested else "Under the rule none of these runs did either."))


def chapter_from(steps: int, points: Sequence[Point], lines: Sequence[Line], contacts: Sequence[Contacts]) -> Chapter:
    """Every verdict follows from the evidence; what is true by construction is said to be."""
    chapter = Chapter(TITLE, [
        "The same disks from the same starts for the same physical time, moved by the paper's rule with its steps of 0.1 "
        "diameters per v_max, and from collision to collision without a step."])
    chapter.tables.append(_point_table(points, steps))
    chapter.conclusions.append("**The points.** " + _point_text(points))
    if lines:
        chapter.conclusions.append(f"**The 10 % line.** {_line_text(lines)} {_crossing_verdict(lines)} "
                                   f"{_movement_verdict(lines)}")
    if contacts:
        chapter.tables.append(_contact_table(contacts))
        chapter.conclusions.append("**Standstills.** " + _step_text(contacts))
    return chapter


def make(context: Context) -> Chapter:
    rule = context.extent.engines[0]
    exact = next((engine for engine in context.extent.engines[1:] if engine.kind == "exact"), None)
    if exact is None:
        return Chapter(TITLE)
    lines = [Line(start, early_and_late_crossing(context, rule, start), early_and_late_crossing(context, exact, start))
             for start in STARTS]
    return chapter_from(context.extent.figure_6.steps, _points(context, rule, exact), lines, _contacts(context))
