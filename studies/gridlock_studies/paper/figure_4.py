"""Figure 4: the disks and their neighbourhoods."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import Agents, Simulation, pairs

from .. import style
from ..chapter import Chapter, Claim, Drawing, SetUp
from ..statistics import Verdict, plain, total
from .context import Context

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

K = 10
STEPS = 100
PACKING_FRACTION = 0.7


def neighbourhoods_of(positions: NDArray[Any], k: int) -> NDArray[np.int64]:
    """Column and row of the neighbourhood of each position in the unit box, shape (N, 2)."""
    places: NDArray[np.int64] = np.minimum((positions * k).astype(np.int64), k - 1)
    return places


def _in_how_many(positions: NDArray[Any], k: int) -> NDArray[np.int64]:
    """In how many of the k × k squares each position lies, by their edges; the last ones hold the walls."""
    edges = np.arange(k + 1) / k
    edges[-1] = np.inf
    is_in = (positions[:, :, None] >= edges[:-1]) & (positions[:, :, None] < edges[1:])
    counts: NDArray[np.int64] = is_in.sum(axis=2).prod(axis=1)
    return counts


def _largest_overlap(positions: NDArray[Any], radius: float) -> float:
    near = positions[pairs(positions, 2.0 * radius).astype(np.int64)]
    distances = np.hypot(*(near[:, 0] - near[:, 1]).T)
    return float(np.max(2.0 * radius - distances, initial=0.0))


def _kinetic_energy(agents: Agents) -> float:
    x, y = agents["velocity_x"], agents["velocity_y"]
    return 0.5 * total(agents["mass"] * (x * x + y * y))


def _draw(positions: NDArray[Any], radius: float, when: str) -> Figure:
    figure, axes = style.new_axes(when, "", width=3.3, height=3.5)
    column, row = neighbourhoods_of(positions, K).T
    style.draw_disks(axes, positions, radius, np.array(style.COLOURS)[[4, 0, 3, 2]][column % 2 + 2 * (row % 2)].tolist(), edge=0.0)
    for edge in np.arange(1, K) / K:
        axes.axhline(edge, color="black", linewidth=0.5)
        axes.axvline(edge, color="black", linewidth=0.5)
    return figure


def make(context: Context) -> Chapter:
    settings = {"disks": {"count": context.extent.disks, "packing_fraction": PACKING_FRACTION}, "run": {"seed": context.seed}}
    simulation = Simulation(settings, observe={"structure_every": 0})
    agents = simulation.agents
    radius, energy = float(agents.radius[0]), _kinetic_energy(agents)
    start = np.array(agents.positions)
    simulation.run(steps=STEPS)
    positions = np.array(agents.positions)
    context.draw("figure_4_start", lambda: _draw(start, radius, "start"))
    context.draw("figure_4_after", lambda: _draw(positions, radius, f"after {STEPS} steps"))
    context.write_table("figure_4.csv", "step id x y radius column row", [
        (step, int(id), *place.tolist(), radius, *neighbourhood.tolist())
        for step, places in ((0, start), (STEPS, positions))
        for id, place, neighbourhood in zip(agents.ids, places, neighbourhoods_of(places, K))
    ])

    is_in_one = bool((_in_how_many(positions, K) == 1).all())
    overlap = _largest_overlap(positions, radius)
    energy_change = _kinetic_energy(agents) / energy - 1.0
    counts = simulation.counts
    return Chapter(
        title="Figure 4: the disks and their neighbourhoods",
        introduction=[
            f"{len(start)} disks on the square lattice at φ = {plain(PACKING_FRACTION)}, and the same disks after {STEPS} steps "
            f"of the paper's rule, on {K} × {K} neighbourhoods. Disks of adjacent neighbourhoods have different colours."
        ],
        drawings=[Drawing(("figure_4_start", "figure_4_after"), f"The start, and after {STEPS} steps.")],
        claims=[Claim(
            "Figure 4",
            "Every disk belongs to exactly one of the k × k neighbourhoods, and the rule keeps the disks from overlapping.",
            f"After {STEPS} steps {'every disk is' if is_in_one else 'not every disk is'} in one neighbourhood and in no other; "
            f"the largest overlap of two disks is {plain(overlap)}; kinetic energy has changed by {energy_change:.1e} of itself; "
            f"{100.0 * counts['halted_moves'] / counts['moves']:.0f} % of the moves were halted.",
            Verdict.AGREES if is_in_one and overlap == 0.0 and abs(energy_change) < 1e-12 else Verdict.DIFFERS,
        )],
        set_ups=[SetUp(f"{len(start)} disks on {K} × {K} neighbourhoods", {**settings, "engine": {"cells": K, "grid": "linked"}},
                       colour="neighbourhood", has_grid=True)],
    )
