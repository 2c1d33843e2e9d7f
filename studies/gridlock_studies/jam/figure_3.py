"""Figure 3: contacts beyond those of a marginal packing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, mean_over_runs
from .context import Context
from .figure_2 import distances
from .runs import Outcome, Run

#: Of the published prefactor 3.6 ± 0.5, relative.
PUBLISHED_ERROR = 0.5 / 3.6

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


def plan(context: Context) -> list[Run]:
    return [*context.decompressed(), *context.decompressed(is_large=True)]


def _excess(outcome: Outcome) -> NDArray[np.float64]:
    """Z − 4 + 2/N₀, 0 for one contact more than isostatic."""
    backbone = outcome.level("backbone_disks")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(outcome.level("contact_number") - 4.0 + 2.0 / backbone)


def _draw(groups: dict[int, list[Outcome]]) -> Figure:
    figure, axes = style.new_axes(f"Δφ = φ − {style.PHI_J}", "Z − 4 + 2/N₀")
    for (disks, outcomes), colour, marker in zip(groups.items(), style.COLOURS, style.MARKERS):
        if not outcomes:
            continue
        x = np.concatenate([distances(outcome) for outcome in outcomes])
        y = np.concatenate([_excess(outcome) for outcome in outcomes])
        axes.plot(x[y > 1e-9], y[y > 1e-9], marker=marker, color=colour, linestyle="none", markersize=3, alpha=0.7, label=f"N = {disks}")
    x = np.geomspace(1e-6, 0.02, 50)
    axes.plot(x, 3.6 * x**0.49, color=style.GREY, linestyle=style.DASHED, label="3.6 Δφ$^{0.49}$ (O'Hern et al.)")
    style.logarithmic(axes, "x", "y")
    axes.legend(loc="upper left")
    return figure


def _exponent(outcomes: list[Outcome]) -> Estimate | None:
    """Over 3e-4 < Δφ < 0.02, where many contacts are beyond."""
    found = []
    for outcome in outcomes:
        x, y = distances(outcome), _excess(outcome)
        use = (x > 3e-4) & (x < 0.02) & (y > 0.0)
        if np.count_nonzero(use) >= 3:
            found.append(float(np.polyfit(np.log(x[use]), np.log(y[use]), 1)[0]))
    return mean_over_runs(found) if len(found) > 1 else None


def _ratio_to_published(outcomes: list[Outcome]) -> Estimate | None:
    """Of the excess contacts to 3.6 Δφ^0.49 where they are many."""
    ratios = []
    for outcome in outcomes:
        x, y = distances(outcome), _excess(outcome)
        use = x > 1e-3
        if use.any():
            ratios.append(float(np.mean(y[use] / (3.6 * x[use]**0.49))))
    return mean_over_runs(ratios) if len(ratios) > 1 else None


def _exponent_text(exponent: Estimate | None) -> str:
    """The exponent, and why it is larger than the published one, where it is."""
    if exponent is None:
        return "There are too few minima for an exponent."
    text = f"The exponent is {exponent} over 3e-4 < Δφ < 0.02"
    if exponent.value - 0.49 > 2.0 * exponent.known_error:
        text += ": in so small systems contacts come one by one, and the few at small Δφ make it larger"
    return text + "."


def make(context: Context) -> Chapter:
    groups = {context.extent.decompressed_disks: context.outcomes(context.decompressed()),
              context.extent.large_disks: context.outcomes(context.decompressed(is_large=True))}
    rows = [(disks, context.seed + number, *values) for disks, outcomes in groups.items() for number, outcome in enumerate(outcomes)
            for values in zip(distances(outcome), outcome.level("contact_number"), outcome.level("excess_contacts"),
                              outcome.level("backbone_disks"))]
    context.write_table("figure_3.csv", "disks seed distance contact_number excess_contacts backbone_disks", rows)
    context.draw("figure_3", lambda: _draw(groups))
    small = groups[context.extent.decompressed_disks]
    exponent = _exponent(small)
    ends = [outcome.result("excess_contacts") for outcome in small]
    marginal = sum(one == 0.0 for one in ends)
    least = min(ends, default=0.0)
    ratio = _ratio_to_published(small)
    verdict = Verdict.UNDECIDED
    if ratio is not None:
        distance = abs(ratio.value - 1.0) / math.hypot(ratio.known_error, PUBLISHED_ERROR)
        verdict = Verdict.AGREES if distance < 3.0 else Verdict.DIFFERS
    return Chapter(
        title="Figure 3: contacts beyond those of a marginal packing",
        introduction=["A packing that just carries one state of stress has 2 (N₀ − 1) + 1 contacts among the N₀ disks of its backbone, so "
                      "that Z = 4 − 2/N₀. Compression adds contacts."],
        drawings=[Drawing(("figure_3",), "Every minimum of every start with more contacts than that. The row of points that does not follow the "
                          "line at small Δφ is of minima with one contact more, 2/N₀ a disk, the least there can be.")],
        claims=[
            Claim("Figure 3", "There are (3.6 ± 0.5) Δφ^0.49 excess contacts a disk (O'Hern et al. 2003).",
                  f"{ratio} of that, mean over minima with Δφ > 1e-3 of {context.extent.decompressed_disks} disks. {_exponent_text(exponent)}",
                  verdict),
            Claim("Figure 3", "At jamming packings are isostatic: they have one state of self-stress, and never fewer contacts.",
                  f"At p = 1e-8 {marginal} of {len(ends)} packings have no excess contact; the least excess is {least:.0f}.",
                  Verdict.UNDECIDED if not ends else Verdict.AGREES if least >= 0.0 and marginal >= 0.8 * len(ends) else Verdict.DIFFERS),
        ],
    )
