"""Figure 5: defects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, plain
from .context import Context
from .points import Point, errors_text
from .runs import DEFECTS, Outcome, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

_LABELS = {"disclination_fraction": "disclinations", "dislocation_fraction": "dislocations",
           "dislocation_pair_fraction": "pairs of dislocations, vacancies, interstitials", "other_defect_fraction": "larger clusters"}


def plan(context: Context) -> list[Run]:
    return context.runs_of([context.largest])


def _share(point: Point, name: str) -> Estimate:
    def shares(outcome: Outcome) -> NDArray[Any]:
        return outcome.series(name)
    return point.mean(shares, lambda some: float(np.mean(some)))


def _draw(points: list[Point]) -> Figure:
    figure, axes = style.new_axes("packing fraction φ", "share of the disks")
    for name, colour, marker in zip(DEFECTS, style.COLOURS, style.MARKERS):
        shares = [_share(point, name) for point in points]
        axes.plot([point.packing_fraction for point in points], [share.value for share in shares], color=colour, linewidth=0.7)
        for is_agreed in (True, False):
            some = [(point, share) for point, share in zip(points, shares) if point.is_equilibrated is is_agreed]
            axes.errorbar([point.packing_fraction for point, _ in some], [share.value for _, share in some],
                          [share.known_error for _, share in some], color=colour, marker=marker, linestyle="none", capsize=2,
                          markerfacecolor=colour if is_agreed else "white", label=_LABELS[name] if is_agreed else None)
    style.logarithmic(axes, "y")
    axes.legend(loc="lower left")
    return figure


def _claim(points: list[Point], name: str, statement: str, factor: float) -> Claim:
    """Whether a share has fallen by more than a factor from the densest liquid in equilibrium to the densest system."""
    liquid = next((point for point in reversed(points) if point.is_equilibrated and point.packing_fraction <= 0.70), None)
    if liquid is None:
        return Claim("Figure 5", statement, "no liquid in equilibrium", Verdict.UNDECIDED)
    before, after = _share(liquid, name), _share(points[-1], name)
    texts = " and ".join(f"{100 * share.value:.2g} % ± {100 * share.known_error:.1g} % at φ = {plain(point.packing_fraction)}{point.note}"
                         for point, share in ((liquid, before), (points[-1], after)))
    if before.error is None or after.error is None:
        return Claim("Figure 5", statement, texts, Verdict.UNDECIDED)
    margin = (before.value / factor - after.value) / math.hypot(before.error / factor, after.error, 1e-12)
    return Claim("Figure 5", statement, f"{texts}. Agreement means a share below 1/{factor:g} of that in the liquid by three standard "
                                        f"errors; it is {errors_text(margin).removesuffix(' standard errors')} "
                                        f"{'below' if margin > 0.0 else 'above'}.",
                 Verdict.AGREES if margin > 3.0 else Verdict.DIFFERS if margin < -3.0 else Verdict.UNDECIDED)


def make(context: Context) -> Chapter:
    points = context.points(context.largest)
    rows = [(point.packing_fraction, *(cell for name in DEFECTS for cell in _share(point, name).cells), int(point.is_equilibrated))
            for point in points]
    columns = " ".join(f"{name} {name.removesuffix('_fraction')}_error" for name in DEFECTS)
    context.write_table("figure_5.csv", f"packing_fraction {columns} is_equilibrated", rows)
    context.draw("figure_5", lambda: _draw(points))
    return Chapter(
        title="Figure 5: defects",
        introduction=[f"Shares of {context.largest.disks:,} disks in clusters of Voronoi cells with other than six sides. Free "
                      "dislocations end positional order, free disclinations orientational order; pairs of dislocations, vacancies and "
                      "interstitials end neither."],
        drawings=[Drawing(("figure_5",), "White: runs from the crystal alone, where starts do not agree.")],
        claims=[_claim(points, "disclination_fraction", "Free disclinations are in the liquid alone (Nelson, Halperin 1979): in the "
                                                        "crystal there is less than one for a hundred in the liquid.", 100.0),
                _claim(points, "dislocation_fraction", "Free dislocations melt the crystal: in it there is less than one for ten in the "
                                                       "liquid.",
                       10.0)],
    )
