"""Figure 1: which share of random quenches is jammed, and how the share depends on the number of disks."""

from __future__ import annotations

import math
from statistics import median
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing, Table
from ..statistics import Estimate, Verdict, joint_deviation, plain
from .context import Context
from .runs import Run, run_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Of an independent program with 600 and 150 starts: packing fraction, share, its standard error.
REFERENCE = {64: ((0.820, 0.033, 0.007), (0.830, 0.305, 0.019), (0.835, 0.572, 0.020), (0.840, 0.845, 0.015)),
             256: ((0.830, 0.013, 0.009), (0.835, 0.133, 0.028), (0.840, 0.687, 0.038))}
#: C. S. O'Hern et al. (2003): where half of all quenches jam in large systems; width = 0.16 N^(−0.55).
PUBLISHED_FRACTION, PUBLISHED_WIDTH, PUBLISHED_EXPONENT = 0.842, 0.16, Estimate(-0.55, 0.03)


class Share(NamedTuple):
    """Of starts that jam at one packing fraction."""

    disks: int
    packing_fraction: float
    jammed: int
    starts: int

    @property
    def value(self) -> float:
        return self.jammed / self.starts

    @property
    def error(self) -> float:
        """Of a share of independent starts; with all or none jammed that of one more."""
        share = (self.jammed + 0.5) / (self.starts + 1)
        return math.sqrt(share * (1.0 - share) / self.starts)


def _runs(context: Context, disks: int, starts: int, density: float) -> list[Run]:
    return [run_of(f"{disks} disks quenched at {density}", [{"stage": "quench"}], seed, 3e-5 * disks ** 1.5, disks=disks,
                   packing_fraction=density) for seed in context.seeds(starts)]


def plan(context: Context) -> list[Run]:
    return [run for disks, starts in context.extent.quench_starts for density in context.extent.quench_densities
            for run in _runs(context, disks, starts, density)]


def _shares(context: Context) -> list[Share]:
    shares = []
    for disks, starts in context.extent.quench_starts:
        for density in context.extent.quench_densities:
            outcomes = context.outcomes(_runs(context, disks, starts, density))
            if outcomes:
                shares.append(Share(disks, density, sum(one.result("is_jammed") == 1.0 for one in outcomes), len(outcomes)))
    return shares


class Rise(NamedTuple):
    """The share is that of a normal distribution of jamming packing fractions."""

    middle: Estimate
    width: Estimate


def _rise(shares: list[Share]) -> Rise | None:
    """By maximum likelihood; errors from the curvature of the likelihood at its maximum."""
    from scipy.optimize import minimize  # type: ignore[import-untyped]
    from scipy.special import log_ndtr  # type: ignore[import-untyped]

    density = np.array([share.packing_fraction for share in shares])
    jammed = np.array([share.jammed for share in shares])
    starts = np.array([share.starts for share in shares])
    if np.count_nonzero((jammed > 0) & (jammed < starts)) < 2:
        return None

    def cost(parameters: np.ndarray) -> float:
        z = (density - parameters[0]) / np.exp(parameters[1])
        return -float(np.sum(jammed * log_ndtr(z) + (starts - jammed) * log_ndtr(-z)))

    found = minimize(cost, (0.838, math.log(0.004)), method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-9})
    width = math.exp(found.x[1])
    steps = np.diag((0.05 * width, 0.05))
    curvature = np.array([[(cost(found.x + a + b) - cost(found.x + a - b) - cost(found.x - a + b) + cost(found.x - a - b))
                           / (4.0 * a.sum() * b.sum()) for b in steps] for a in steps])
    errors = np.sqrt(np.diag(np.linalg.inv(curvature)))
    return Rise(Estimate(float(found.x[0]), float(errors[0])), Estimate(width, width * float(errors[1])))


def _draw(shares: list[Share], rises: dict[int, Rise | None]) -> Figure:
    from scipy.special import ndtr

    figure, axes = style.new_axes("packing fraction φ", "share that is jammed")
    for number, disks in enumerate(rises):
        mine = [share for share in shares if share.disks == disks]
        colour = style.COLOURS[number]
        axes.errorbar([share.packing_fraction for share in mine], [share.value for share in mine], [share.error for share in mine],
                      color=colour, marker=style.MARKERS[number], linestyle="none", capsize=2, label=f"N = {disks}")
        rise = rises[disks]
        if rise is not None:
            x = np.linspace(min(s.packing_fraction for s in mine), max(s.packing_fraction for s in mine), 200)
            axes.plot(x, ndtr((x - rise.middle.value) / rise.width.value), color=colour)
        for density, share, error in REFERENCE.get(disks, ()):
            axes.errorbar([density], [share], [error], color=colour, marker="s", markerfacecolor="white", linestyle="none", capsize=2)
    axes.plot([], [], color=style.GREY, marker="s", markerfacecolor="white", linestyle="none", label="independent program")
    axes.axvline(PUBLISHED_FRACTION, color=style.GREY, linestyle=":", linewidth=0.8, label="O'Hern et al., N → ∞")
    axes.legend(loc="upper left")
    return figure


def _reference_claim(shares: list[Share]) -> Claim:
    statement = "An independent program finds these shares of jammed quenches."
    deviations, errors, texts = [], [], []
    for share in shares:
        for density, value, error in REFERENCE.get(share.disks, ()):
            if density != share.packing_fraction:
                continue
            errors.append(math.hypot(share.error, error))
            deviations.append((share.value - value) / errors[-1])
            texts.append(f"{Estimate(share.value, share.error)} against {Estimate(value, error)} at φ = {plain(density)}, N = {share.disks}")
    if not deviations:
        return Claim("Figure 1", statement, "no packing fraction of the independent program was run", Verdict.UNDECIDED)
    # With so many starts chance is nearly normal.
    together = joint_deviation(deviations, [10_000] * len(deviations))
    is_close = max(map(abs, deviations)) < 4.0 and abs(together) < 3.0
    return Claim("Figure 1", statement,
                 f"{'; '.join(texts)}. All deviations together are {together:+.1f} standard errors. Agreement means less than four standard "
                 f"errors everywhere and less than three together; at one packing fraction alone a difference below {4.0 * median(errors):.2f} "
                 "(median) would go unseen.", Verdict.AGREES if is_close else Verdict.DIFFERS)


def _width_claim(rises: dict[int, Rise | None]) -> Claim:
    known = [(disks, rise.width) for disks, rise in rises.items() if rise is not None]
    statement = "The rise becomes narrower with more disks as N^(−0.55 ± 0.03) (O'Hern et al. 2003)."
    if len(known) < 2:
        return Claim("Figure 1", statement, "too few numbers of disks to tell", Verdict.UNDECIDED)
    (few, wide), (many, narrow) = known[0], known[-1]
    span = math.log(many / few)
    exponent = Estimate(math.log(narrow.value / wide.value) / span,
                        math.hypot(narrow.known_error / narrow.value, wide.known_error / wide.value) / span)
    distance = abs(exponent.value - PUBLISHED_EXPONENT.value) / math.hypot(exponent.known_error, PUBLISHED_EXPONENT.known_error)
    texts = ", ".join(f"{width} for N = {disks}" for disks, width in known)
    return Claim("Figure 1", statement, f"Width (standard deviation) {texts}: N^({exponent}), {distance:.1f} standard errors away.",
                 Verdict.UNDECIDED if exponent.known_error > 0.2 else Verdict.AGREES if distance < 3.0 else Verdict.DIFFERS)


def make(context: Context) -> Chapter:
    shares = _shares(context)
    context.write_table("figure_1.csv", "disks packing_fraction share error jammed starts",
                        [(s.disks, s.packing_fraction, s.value, s.error, s.jammed, s.starts) for s in shares])
    rises = {disks: _rise([share for share in shares if share.disks == disks]) for disks, _ in context.extent.quench_starts}
    context.draw("figure_1", lambda: _draw(shares, rises))
    table = Table(["N", "half are jammed at φ", "width"], "Middle and standard deviation of a normal distribution of jamming packing "
                                                          "fractions, by maximum likelihood.")
    table.rows += [[str(disks), str(rise.middle), str(rise.width)] for disks, rise in rises.items() if rise is not None]
    return Chapter(
        title="Figure 1: random quenches that are jammed",
        introduction=["Points anywhere in a periodic box become harmonic disks at a fixed packing fraction and move downhill. Jammed means "
                      "that forces balance, the pressure is above 0 and contacts are no fewer than a rigid packing needs."],
        drawings=[Drawing(("figure_1",), "Error bars are one standard error of a share. Lines: normal distributions.")],
        claims=[_reference_claim(shares), _width_claim(rises)],
        tables=[table],
    )
