"""What the paper leaves open, and how much it matters: the time step, the contact rule, the sites of the lattice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from .. import style
from ..chapter import Chapter, Drawing, Table
from .extent import Extent
from .replicas import USUAL_TIME_STEP, Measured, ReplicaSet, paper_replica_set, sampled_evenly
from ..statistics import plain, three_sigma
from .context import Context

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CONTACTS = ("always", "approaching")
_NAMES_OF_SITES = {"fitted": "fitted", "to walls": "square, stretched to the walls", "perfect": "triangular, unstretched"}


class Choices(NamedTuple):
    """What is compared from one start at one density."""

    start: str
    packing_fraction: float
    reference: ReplicaSet  #: the same start without a time step; its samples are as far apart as with the usual one
    rules: list[ReplicaSet]  #: every time step under "always", then under "approaching"
    sites: tuple[ReplicaSet, ReplicaSet]  #: fitted sites and others

    @property
    def always(self) -> list[ReplicaSet]:
        return self.rules[: len(self.rules) // 2]

    @property
    def approaching(self) -> list[ReplicaSet]:
        return self.rules[len(self.rules) // 2:]


def choices_of(context: Context) -> list[Choices]:
    """Square before triangular starts."""
    extent = context.extent
    choices = []
    for start, densities, sites in (("square", extent.choice_square_densities, "to walls"),
                                    ("triangular", extent.choice_triangular_densities, "perfect")):
        for density in densities:
            base = paper_replica_set(extent, context.seed, extent.figure_6, extent.engines[0], start, density)
            base = ReplicaSet(base.engine, base.run, extent.choice_seeds)

            def with_step(step: float, base: ReplicaSet = base) -> ReplicaSet:
                return sampled_evenly(base.changed(time_step=step), extent.choice_diameters, 100)

            usual = with_step(USUAL_TIME_STEP)
            rules = [with_step(step).changed(contact=contact) for contact in CONTACTS for step in extent.choice_time_steps]
            reference = usual.moved_by(extent.choice_reference)
            choices.append(Choices(start, density, reference, rules, (usual, usual.changed(sites=sites))))
    return choices


def plan(context: Context) -> list[ReplicaSet]:
    choices = choices_of(context)
    return [*(one for choice in choices for one in (choice.reference, *choice.rules)),
            *(one for choice in choices for one in choice.sites)]


def _has_steps(extent: Extent, replica_set: ReplicaSet) -> bool:
    return replica_set.engine != extent.choice_reference


def _rule_results(context: Context, choices: Sequence[Choices]) -> list[Measured]:
    return context.measured(one for choice in choices for one in (choice.reference, *choice.rules))


def _write(context: Context, choices: Sequence[Choices]) -> None:
    rows = []
    for result in _rule_results(context, choices) + context.measured(choice.sites[1] for choice in choices):
        run, has_steps = result.set.run, _has_steps(context.extent, result.set)
        rows.append((result.set.engine.kind, run.start, _NAMES_OF_SITES[run.sites], run.contact if has_steps else "none",
                     run.packing_fraction, run.time_step if has_steps else 0.0, result.time(-1), *result.displacement().cells,
                     result.halted_fraction.value, result.collision_rate.value, result.seeds, result.arrested))
    context.write_table("open_choices.csv", "engine start sites contact packing_fraction time_step time mean_displacement "
                        "mean_displacement_error halted_fraction collision_rate seeds arrested", rows)


def _arrest_text(result: Measured) -> str:
    return f"{result.arrested} of {result.seeds}" if result.arrested else "none"


def _rule_table(context: Context, choices: Sequence[Choices]) -> Table:
    extent = context.extent
    header = ["start", "φ", "rule", "time step", "mean displacement", "halted moves", "collisions per disk and time",
              "standstill"]
    table = Table(header, (
        f"After {plain(extent.choice_diameters)} diameters per v_max of physical time, {extent.choice_seeds} seeds. Halted "
        "moves and collisions over the last fifth of the run; a smaller step is halted less often for the same physics, so "
        "compare the collision rate."))
    for result in _rule_results(context, choices):
        run, has_steps = result.set.run, _has_steps(extent, result.set)
        table.rows.append([run.start, plain(run.packing_fraction), run.contact if has_steps else result.set.engine.label,
                           plain(run.time_step) if has_steps else "none", str(result.displacement()),
                           f"{100.0 * result.halted_fraction.value:.1f} %" if has_steps else "–",
                           f"{result.collision_rate.value:.0f}", _arrest_text(result)])
    return table


def _site_table(context: Context, choices: Sequence[Choices]) -> Table:
    table = Table(["start", "φ", "sites", "mean displacement", "standstill"], (
        f"The same physical time, time step {USUAL_TIME_STEP}, contact = \"always\". Fitted: the square lattice centred in its "
        "cells; the triangular one stretched to fill the box."))
    for result in context.measured(one for choice in choices for one in choice.sites):
        table.rows.append([result.set.run.start, plain(result.set.run.packing_fraction), _NAMES_OF_SITES[result.set.run.sites],
                           str(result.displacement()), _arrest_text(result)])
    return table


def _draw(context: Context, choices: Sequence[Choices]) -> Figure:
    figure, axes = style.new_axes(f"time step / (diameters per {style.V_MAX})",
                                  "mean displacement / side of the box", height=3.8)
    for choice, colour, marker in zip(choices, style.COLOURS, style.MARKERS):
        label: str | None = f"{choice.start}, φ = {plain(choice.packing_fraction)}"
        line: Any
        for replica_sets, line in ((choice.always, "-"), (choice.approaching, style.DASHED), ([choice.reference], "none")):
            results = context.measured(replica_sets)
            y = [result.displacement() for result in results]
            x = [result.set.run.time_step if _has_steps(context.extent, result.set) else 0.0 for result in results]
            axes.errorbar(x, [one.value for one in y], [one.known_error for one in y], color=colour, marker=marker,
                          linestyle=line, capsize=2, label=label)
            label = None
    for contact, line in zip(CONTACTS, ("-", style.DASHED)):
        axes.plot([], [], color=style.GREY, linestyle=line, label=f"contact: {contact}")
    axes.axvline(0.0, color=style.GREY, linewidth=0.8, linestyle=":", zorder=0)
    axes.annotate(context.extent.choice_reference.label, (0.0, 0.02), xycoords=axes.get_xaxis_transform(), xytext=(3, 0),
                  textcoords="offset points", color=style.GREY, fontsize=8)
    longest = max(context.extent.choice_time_steps)
    # The dynamics without a time step is at 0, a little inside the frame.
    axes.set_xlim(-0.1 * longest, 1.1 * longest)
    style.logarithmic(axes, "y")
    figure.legend(loc="outside right upper")
    return figure


class _LargestDifference:
    """The largest difference among pairs of replica sets that differ in one choice."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._pairs = 0
        self._significant = 0
        self._ratio = 0.0
        self._text = ""

    def compare(self, a: ReplicaSet, b: ReplicaSet) -> None:
        first, second = Measured(self._context.runs, a), Measured(self._context.runs, b)
        if first.seeds < 2 or second.seeds < 2:
            return
        here, there = first.displacement(), second.displacement()
        error = math.hypot(here.known_error, there.known_error)
        if not error > 0.0:
            return
        self._pairs += 1
        distance = abs(here.value - there.value) / error
        self._significant += distance > three_sigma(first.seeds + second.seeds - 2)
        ratio = max(here.value, there.value) / min(here.value, there.value)
        if ratio > self._ratio:
            self._ratio = ratio
            self._text = (f"{here} against {there} ({a.run.start} start, φ = {plain(a.run.packing_fraction)}; a factor "
                          f"{ratio:.2g}, {distance:.1f} standard errors)")

    def __str__(self) -> str:
        if not self._pairs:
            return "too few runs to tell"
        return (f"{self._significant} of {self._pairs} comparisons differ by more than chance does in 0.3 % of all cases; the "
                f"largest ratio is {self._text}")


def _collision_text(context: Context, choices: Sequence[Choices]) -> str:
    """The collision rates as multiples of those without a step: the most direct sign that the step changes the dynamics, and one
    that needs no long average."""
    parts = []
    for choice in choices:
        for baseline in context.measured([choice.reference]):
            rate = baseline.collision_rate.value
            ratios = [f"{result.collision_rate.value / rate:.2f}" for result in context.measured(choice.always)]
            parts.append(f"{', '.join(ratios)} at φ = {plain(choice.packing_fraction)} ({choice.start})")
    if not parts:
        return ""
    return (f" Collision rates with steps {', '.join(map(plain, context.extent.choice_time_steps))}, as multiples of that of "
            f"{context.extent.choice_reference.label}: {'; '.join(parts)}.")


def _time_step_conclusion(context: Context, choices: Sequence[Choices]) -> str:
    difference = _LargestDifference(context)
    for choice in choices:
        for replica_set in choice.always:
            difference.compare(choice.reference, replica_set)
    return (f"Time step with \"always\", against {context.extent.choice_reference.label}: {difference}."
            f"{_collision_text(context, choices)}")


def _contact_conclusion(context: Context, choices: Sequence[Choices]) -> str:
    difference = _LargestDifference(context)
    always = context.measured(one for choice in choices for one in choice.always)
    approaching = context.measured(one for choice in choices for one in choice.approaching)
    for choice in choices:
        for a, b in zip(choice.always, choice.approaching):
            difference.compare(a, b)
    with_always, with_approaching = (sum(one.arrested for one in ended) for ended in (always, approaching))
    text = (f"Contact rule, \"always\" against \"approaching\": {difference}. Of {sum(one.seeds for one in always)} runs each, "
            f"{with_always} came to a standstill with \"always\" and {with_approaching} with \"approaching\"")
    if with_approaching > with_always:
        text += (": there halted disks that do not approach keep their velocities, try the same blocked displacement again, and whole "
                 "systems freeze although nothing is jammed")
    return text + "."


def _site_conclusion(context: Context, choices: Sequence[Choices]) -> str:
    difference = _LargestDifference(context)
    for choice in choices:
        difference.compare(*choice.sites)
    return f"Sites of the lattice in the box: {difference}."


def make(context: Context) -> Chapter:
    choices = choices_of(context)
    _write(context, choices)
    context.draw("open_choices", lambda: _draw(context, choices))
    return Chapter(
        title="What the paper leaves open, and how much it matters",
        introduction=[
            "The rule does not fix the length of the time step, whether a halted pair collides when it is already receding, or "
            "how a lattice is fitted to the box. Each is varied here with everything else as in the figures."
        ],
        drawings=[Drawing(("open_choices",), (
            "Mean displacement after the same physical time against the time step, for both contact rules (dashed: "
            "\"approaching\"). At 0: without a time step."))],
        tables=[_rule_table(context, choices), _site_table(context, choices)],
        conclusions=[_time_step_conclusion(context, choices), _contact_conclusion(context, choices),
                     _site_conclusion(context, choices)],
    )
