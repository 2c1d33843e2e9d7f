"""Figure 6: forces and gaps at jamming."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gridlock import Contacts, contacts

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict
from .context import Context
from .runs import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

#: P. Charbonneau et al. (2015): P(f) ~ f^θ of bucklers and of other forces, gaps h^(−γ).
BUCKLERS, EXTENDED, GAPS = 0.17462, 0.42311, 0.41269


def plan(context: Context) -> list[Run]:
    return context.decompressed()


def _exponent(values: NDArray[np.float64], cutoff: float) -> Estimate | None:
    """Of a density x^θ below the cutoff, by maximum likelihood: θ + 1 = 1/⟨ln(cutoff/x)⟩."""
    below = values[(values > 0.0) & (values < cutoff)]
    if len(below) < 20:
        return None
    sum_one = 1.0 / float(np.mean(np.log(cutoff / below)))
    return Estimate(sum_one - 1.0, sum_one / len(below) ** 0.5)


def _beyond(values: NDArray[np.float64], *cutoffs: float) -> str:
    return ", ".join(f"{_exponent(values, cutoff)} below {cutoff:g}" for cutoff in cutoffs)


def _draw(forces: NDArray[np.float64], bucklers: NDArray[np.float64], gaps: NDArray[np.float64]) -> Figure:
    figure, first = style.new_axes("f/⟨f⟩", "share below")
    first.remove()
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, values, label, colour, exponent in (
            (left, forces, "forces of other disks", style.COLOURS[0], EXTENDED + 1.0),
            (left, bucklers, "forces of bucklers", style.COLOURS[1], BUCKLERS + 1.0),
            (right, gaps, "gaps", style.COLOURS[2], 1.0 - GAPS)):
        if len(values) == 0:
            continue
        x, share = np.sort(values), np.arange(1, len(values) + 1) / len(values)
        axes.step(x, share, color=colour, where="post", label=label)
        axes.plot(x, share[len(x) // 4] * (x / x[len(x) // 4]) ** exponent, color=colour, linestyle=style.DASHED, linewidth=0.8)
    left.set(xlabel="force f/⟨f⟩", ylabel="share below", xlim=(1e-3, 10.0), ylim=(1e-3, 1.5))
    right.set(xlabel="gap h = r/σ − 1", xlim=(1e-6, 1.0))
    for axes in (left, right):
        axes.plot([], [], color="black", linestyle=style.DASHED, linewidth=0.8, label="Charbonneau et al. (2015)")
        style.logarithmic(axes, "x", "y")
        axes.legend(loc="lower right")
    return figure


def _claim(what: str, published: float, found: Estimate | None, statement: str) -> Claim:
    if found is None:
        return Claim("Figure 6", statement, "too few values to tell", Verdict.UNDECIDED)
    distance = abs(found.value - published) / found.known_error
    verdict = Verdict.UNDECIDED if found.known_error > 0.05 else Verdict.AGREES if distance < 3.0 else Verdict.DIFFERS
    return Claim("Figure 6", statement, f"{what}: {found}, {distance:.1f} standard errors away. An error above 0.05 decides nothing.", verdict)


def make(context: Context) -> Chapter:
    found: list[Contacts] = [contacts(outcome.positions, outcome.radii, 1.0, stiffness=False)
                             for outcome in context.outcomes(context.decompressed())]
    empty = np.zeros(0)
    bucklers = np.concatenate([empty, *(one.relative_forces[one.is_of_buckler] for one in found)])
    forces = np.concatenate([empty, *(one.relative_forces[~one.is_of_buckler] for one in found)])
    gaps = np.concatenate([empty, *(one.gaps for one in found)])
    context.write_table("figure_6.csv", "kind value", [*(("force", value) for value in forces), *(("buckler", value) for value in bucklers),
                                                       *(("gap", value) for value in gaps)])
    context.draw("figure_6", lambda: _draw(forces, bucklers, gaps))
    small = gaps[gaps > 1e-6]
    return Chapter(
        title="Figure 6: forces and gaps at jamming",
        introduction=["Contact forces over their mean, and gaps between disks that nearly touch, at p = 1e-8. Disks with exactly three "
                      "contacts buckle; the forces on them are counted apart."],
        drawings=[Drawing(("figure_6",), "The share of values below; dashed: published exponents, of which only the slope means anything.")],
        claims=[
            _claim("exponent of the forces below 0.3", EXTENDED, _exponent(forces, 0.3), "Weak forces of other disks are as rare as f^0.42311."),
            # A power law of weak forces and small gaps alone: towards larger ones the exponent drifts, as the claims show.
            _claim(f"exponent of the forces below 0.1 ({_beyond(bucklers, 0.3)})", BUCKLERS, _exponent(bucklers, 0.1),
                   "Weak forces of bucklers are as rare as f^0.17462."),
            _claim(f"exponent of the gaps below 0.005 ({_beyond(small, 0.01, 0.03)})", -GAPS, _exponent(small, 0.005),
                   "Small gaps are as frequent as h^(−0.41269)."),
        ],
    )
