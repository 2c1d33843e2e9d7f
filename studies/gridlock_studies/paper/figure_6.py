"""Figure 6: how far the disks have come, against time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from .replicas import Measured, ReplicaSet, is_run, paper_replica_set, set_ups
from ..statistics import MeanOfRuns, plain, verdict_on_fall
from .context import Context

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CLOSEST_SQUARE_PACKING = 0.25 * math.pi


def plan(context: Context) -> list[ReplicaSet]:
    """The densities of the fan: on the square lattice as far as it goes, beyond on the triangular one."""
    extent = context.extent
    return [
        paper_replica_set(extent, context.seed, extent.figure_6, engine,
                          "square" if density < CLOSEST_SQUARE_PACKING else "triangular", density)
        for engine in extent.engines
        for density in extent.fan_densities
        if is_run(extent, extent.figure_6, engine, density)
    ]


def _apart(heights: list[float], distance: float = 0.048) -> list[float]:
    """Rising heights moved so far apart that labels there cover no other, and not above the frame where there is room below."""
    for k in range(1, len(heights)):
        heights[k] = max(heights[k], heights[k - 1] + distance)
    highest = 0.99
    for k in reversed(range(len(heights))):
        heights[k] = min(heights[k], highest)
        highest = heights[k] - distance
    return heights


def _label(axes: Axes, result: Measured, y: float, colour: tuple[float, ...], marker: str) -> None:
    """The density of a curve beside its end, at a height where it covers no other, with the shape of its points."""
    run = result.set.run
    end = (result.step(-1), result.displacement().value)
    place = (1.02, y)
    leader = {"arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, xytext=place, textcoords="axes fraction", arrowprops=leader, annotation_clip=False)
    axes.plot(1.035, y, marker=marker, color=colour, transform=axes.transAxes, clip_on=False)
    axes.text(1.06, y, f"φ = {run.packing_fraction:.2f}{' tri.' if run.start == 'triangular' else ''}", transform=axes.transAxes,
              va="center", fontsize=8)


def _draw(context: Context, results: Sequence[Measured], *, is_logarithmic: bool) -> Figure:
    figure, axes = style.new_axes("time steps", "mean displacement / side of the box", height=4.8)
    first_engine = context.extent.engines[0]
    densities = context.extent.fan_densities
    colours = style.sequential(len(densities))
    for result in results:
        number = densities.index(result.set.run.packing_fraction)
        is_first = result.set.engine == first_engine
        samples = result.samples_spread_out(50)
        steps = np.array([result.step(sample) for sample in samples])
        y, error = np.array([(one.value, one.known_error) for one in map(result.displacement, samples)]).T
        # Shapes stand at other places for each curve, so that they do not cover one another.
        every = (len(samples) * (number + 1) // (8 * len(densities)), max(1, len(samples) // 8))
        axes.plot(steps, y, color=colours[number], linestyle="-" if is_first else style.DASHED, linewidth=1.3,
                  marker=style.MARKERS[number % len(style.MARKERS)] if is_first else None, markevery=every, markersize=4.5)
        axes.fill_between(steps, y - error, y + error, color=colours[number], alpha=0.18, linewidth=0)
    for engine in context.extent.engines:
        axes.plot([], [], color="black", linestyle="-" if engine == first_engine else style.DASHED, label=engine.label)
    axes.axhline(0.1, color=style.GREY, linewidth=0.8, linestyle=":", label="10 % of the side")
    axes.set(xlim=(context.extent.figure_6.sample_every if is_logarithmic else 0, context.extent.figure_6.steps))
    if is_logarithmic:
        style.logarithmic(axes, "x", "y")
    else:
        axes.set_ylim(-0.012 * axes.get_ylim()[1], None)  # the densest curves are nearly 0, and do not lie on the frame
        axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.legend(loc="upper left")
    ends = sorted((result for result in results if result.set.engine == first_engine), key=lambda one: one.displacement().value)
    figure.draw_without_rendering()  # fixes the limits that the heights are fractions of
    places = axes.transData.transform([(result.step(-1), result.displacement().value) for result in ends])
    for result, height in zip(ends, _apart(list(axes.transAxes.inverted().transform(places)[:, 1]))):
        number = densities.index(result.set.run.packing_fraction)
        _label(axes, result, height, colours[number], style.MARKERS[number % len(style.MARKERS)])
    return figure


def _order_claim(context: Context, results: Sequence[Measured]) -> Claim:
    """Whether the final displacements fall from each density to the next, as far as the errors can tell."""
    mine = [result for result in results if result.set.engine == context.extent.engines[0]]
    values = [MeanOfRuns(result.displacement(), result.seeds) for result in mine]
    text = ", ".join(f"{value.mean} at φ = {plain(result.set.run.packing_fraction)}" for value, result in zip(values, mine))
    return Claim(
        "Figure 6",
        "The denser the system, the less the disks move away from where they started; dense systems stay near their start for "
        "the whole run.",
        f"After {context.extent.figure_6.steps} steps, in sides of the box: {text}. Disorder would be a rise from any density "
        "to a higher one that chance explains in less than 0.3 % of all cases; staying near means less than 10 % of the side.",
        verdict_on_fall(values, 0.1),
    )


def make(context: Context) -> Chapter:
    extent = context.extent
    results = context.measured(plan(context))
    columns = "engine start packing_fraction step time mean_displacement mean_displacement_error seeds"
    context.write_table("figure_6.csv", columns, [
        # A point every two percent is enough.
        (result.set.engine.kind, result.set.run.start, result.set.run.packing_fraction, result.step(sample), result.time(sample),
         *result.displacement(sample).cells, result.seeds)
        for result in results for sample in result.samples_spread_out(50)
    ])
    if results:
        context.draw("figure_6", lambda: _draw(context, results, is_logarithmic=False))
        context.draw("figure_6_logarithmic", lambda: _draw(context, results, is_logarithmic=True))
    caption = "Mean displacement against time; each curve ends beside its packing fraction (tri.: triangular start)."
    limit = f", up to φ = {plain(extent.figure_6.densest_of_others)}" if extent.figure_6.densest_of_others < 1.0 else ""
    for engine in extent.engines[1:]:
        caption += f" Dashed: {engine.label}, from the same starts for the same physical time{limit}."
    return Chapter(
        title="Figure 6: how far the disks have come",
        introduction=[
            f"The mean distance of {extent.disks} disks from where they started, over the side of the box, against time, for "
            f"{extent.figure_6.steps} steps of 0.1 diameters per v_max. Starts on the square lattice up to its closest packing "
            f"π/4 = 0.785, above on the triangular one. Bands are one standard error over {extent.figure_6.seeds} seeds."
        ],
        drawings=[
            Drawing(("figure_6",), caption),
            Drawing(("figure_6_logarithmic",), (
                "The same on logarithmic axes, which show what the dense systems do: they rattle in their cages, and most still "
                "creep on.")),
        ],
        claims=[_order_claim(context, results)],
        set_ups=set_ups([result.set for result in results]),
    )
