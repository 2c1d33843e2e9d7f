"""Figure 7: structure of jammed mixtures, and of equal disks, which crystallize."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import bond_orientation, spectral_density, voronoi

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, mean_over_runs
from .context import Context
from .runs import DECOMPRESS, Outcome, Run, run_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _equal(context: Context) -> list[Run]:
    stages: list[dict[str, Any]] = [{"stage": "grow", "rate": 2e-3, "until_pressure": 1e5}, {"stage": "compress", "until_pressure": 1e-6},
                                    DECOMPRESS]
    return [run_of("equal disks", stages, seed, 3.0, disks=context.extent.equal_disks, packing_fraction=0.4, start="random",
                   is_mixture=False) for seed in context.seeds(context.extent.equal_starts)]


def plan(context: Context) -> list[Run]:
    return [*context.decompressed(), *_equal(context)]


def _local_order(outcome: Outcome) -> float:
    """⟨|ψ6|⟩ over the Voronoi neighbours."""
    neighbours = voronoi(outcome.positions, 1.0).neighbors
    return float(np.mean(np.abs(bond_orientation(outcome.positions, box=1.0, neighbors=neighbours))))


def _density(outcomes: list[Outcome]) -> tuple[Any, Any]:
    """χ_V over the area of a disk against q times the mean diameter."""
    curves = []
    for outcome in outcomes:
        diameter = 2.0 * float(np.mean(outcome.radii))
        found = spectral_density(outcome.positions, outcome.radii, 1.0, largest_q=12.0 / diameter, bins=60)
        curves.append((found.q * diameter, found.density / (np.pi * 0.25 * diameter**2)))
    shortest = min(len(curve[0]) for curve in curves)
    return np.mean([curve[0][:shortest] for curve in curves], axis=0), np.mean([curve[1][:shortest] for curve in curves], axis=0)


def _draw(mixture: list[Outcome], equal: list[Outcome]) -> Figure:
    figure, axes = style.new_axes("q · mean diameter", f"{style.CHI_V}(q) / area of a disk")
    for outcomes, label, colour in ((mixture, "mixture 1 : 1.4", style.COLOURS[0]), (equal, "equal disks", style.COLOURS[1])):
        if outcomes:
            axes.plot(*_density(outcomes), color=colour, label=label)
    style.logarithmic(axes, "y")
    axes.legend(loc="upper left")
    return figure


def _verdict(jamming: Estimate, equal: Estimate, mixture: Estimate) -> Verdict:
    """On equal disks that jam as polycrystals: their packing fraction and their order, as far as errors tell."""
    margins = [(jamming.value - 0.865, jamming.known_error), (0.9069 - jamming.value, jamming.known_error),
               (equal.value - mixture.value - 0.1, math.hypot(equal.known_error, mixture.known_error))]
    if any(margin < -2.0 * error for margin, error in margins):
        return Verdict.DIFFERS
    return Verdict.AGREES if all(margin > 2.0 * error for margin, error in margins) else Verdict.UNDECIDED


def make(context: Context) -> Chapter:
    mixture, equal = context.outcomes(context.decompressed()), context.outcomes(_equal(context))
    rows = []
    for name, outcomes in (("mixture", mixture), ("equal", equal)):
        rows += [(name, context.seed + number, outcome.result("jamming_packing_fraction"), outcome.result("excess_contacts"),
                  outcome.result("rattler_share"), _local_order(outcome)) for number, outcome in enumerate(outcomes)]
    context.write_table("figure_7.csv", "disks seed jamming_packing_fraction excess_contacts rattler_share local_order", rows)
    context.draw("figure_7", lambda: _draw(mixture, equal))
    orders = {name: mean_over_runs([row[5] for row in rows if row[0] == name]) for name in ("mixture", "equal") if any(
        row[0] == name for row in rows)}
    jamming = mean_over_runs([outcome.result("jamming_packing_fraction") for outcome in equal])
    verdict = _verdict(jamming, orders["equal"], orders["mixture"])
    return Chapter(
        title="Figure 7: structure",
        introduction=["With two sizes the structure factor of the centres says little; the spectral density counts the area of the disks."],
        drawings=[Drawing(("figure_7",), "Means over starts. Crystals show peaks; small values at small q mean that the area covered hardly "
                          "fluctuates over long distances.")],
        claims=[Claim("Figure 7", "Equal disks jam as polycrystals at φ ≈ 0.88 (Atkinson et al. 2014).",
                      f"φ_J = {jamming} for {len(equal)} starts; local hexatic order {orders['equal']} against {orders['mixture']} of the "
                      "mixture. Agreement means between 0.865 and the crystal's 0.9069, and an order higher by 0.1, both by two standard "
                      "errors.", verdict)],
    )
