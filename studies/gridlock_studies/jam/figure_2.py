"""Figure 2: pressure and elastic moduli above jamming, for both potentials."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing
from ..statistics import Estimate, Verdict, mean_over_runs
from .context import Context
from .runs import Outcome, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

POTENTIALS = ("harmonic", "hertzian")
#: The exponents of p and G in Δφ where contacts do not change, and those of G as C. S. O'Hern et al. (2003) found them.
EXPONENT_OF_PRESSURE = {"harmonic": 1.0, "hertzian": 1.5}
EXPONENT_OF_SHEAR = {"harmonic": 0.5, "hertzian": 1.0}
QUANTITIES = (("pressure", "p"), ("bulk_modulus", "K"), ("shear_modulus", "G"))


def plan(context: Context) -> list[Run]:
    return [*(run for potential in POTENTIALS for run in context.decompressed(potential)), *context.decompressed(is_box_free=True)]


def distances(outcome: Outcome) -> NDArray[np.float64]:
    """Δφ of every level, the last one's extrapolation being jamming."""
    return outcome.level("packing_fraction") - outcome.result("jamming_packing_fraction")


def _exponent(outcome: Outcome, name: str, least: float, most: float) -> float:
    """By least squares in the logarithms, over levels with a pressure between these."""
    x, y, pressure = distances(outcome), outcome.level(name), outcome.level("pressure")
    use = (pressure > 0.9 * least) & (pressure < 1.1 * most) & (x > 0.0) & (y > 0.0)
    if np.count_nonzero(use) < 3:
        return float("nan")
    return float(np.polyfit(np.log(x[use]), np.log(y[use]), 1)[0])


def _exponents(outcomes: list[Outcome], name: str, least: float, most: float) -> Estimate | None:
    found = [value for value in (_exponent(outcome, name, least, most) for outcome in outcomes) if np.isfinite(value)]
    return mean_over_runs(found) if len(found) > 1 else None


def _means(outcomes: list[Outcome], name: str) -> list[tuple[float, float, float, float]]:
    """Δφ and a quantity, means over starts with their standard errors, at each pressure that two starts or more kept a minimum at."""
    by_pressure: dict[int, list[tuple[float, float]]] = {}
    for outcome in outcomes:
        for pressure, x, y in zip(outcome.level("pressure"), distances(outcome), outcome.level(name)):
            if pressure > 0.0 and np.isfinite(y):
                by_pressure.setdefault(round(4.0 * np.log10(pressure)), []).append((x, y))
    means = []
    for _, found in sorted(by_pressure.items()):
        x, y = (mean_over_runs([one[k] for one in found]) for k in (0, 1))
        if len(found) > 1 and x.value > 0.0 and y.value > 0.0:
            means.append((x.value, y.value, x.known_error, y.known_error))
    return means


def _draw(all_outcomes: dict[str, list[Outcome]], free: list[Outcome]) -> Figure:
    figure, axes = style.new_axes(f"Δφ = φ − {style.PHI_J}", "p D²/ε, K D²/ε, G D²/ε")
    for (name, symbol), marker in zip(QUANTITIES, style.MARKERS):
        for potential, colour in zip(POTENTIALS, style.COLOURS):
            means = _means(all_outcomes[potential], name)
            if means:
                x, y, x_error, y_error = np.array(means).T
                axes.errorbar(x, y, y_error, x_error, marker=marker, color=colour, linestyle="none", markersize=3.5, elinewidth=0.7,
                              markerfacecolor=colour if potential == POTENTIALS[0] else "white", label=f"{symbol}, {potential}")
    means = _means(free, "shear_modulus")
    if means:
        x, y, x_error, y_error = np.array(means).T
        axes.errorbar(x, y, y_error, x_error, marker="D", color=style.COLOURS[2], linestyle="none", markersize=3.5, elinewidth=0.7,
                      label="G, harmonic, free box")
    axes.set(xlim=(1e-8, 0.1))
    style.logarithmic(axes, "x", "y")
    figure.legend(loc="outside right upper")
    return figure


def _claim(name: str, symbol: str, wanted: dict[str, float], bound: float, pressures: tuple[float, float], statement: str,
           all_outcomes: dict[str, list[Outcome]]) -> Claim:
    texts, verdicts = [], []
    for potential in POTENTIALS:
        found = _exponents(all_outcomes[potential], name, *pressures)
        if found is None:
            verdicts.append(Verdict.UNDECIDED)
            continue
        texts.append(f"{symbol} ∝ Δφ^({found}) ({potential})")
        is_close = abs(found.value - wanted[potential]) < max(bound, 3.0 * found.known_error)
        verdicts.append(Verdict.UNDECIDED if found.known_error > 0.1 else Verdict.AGREES if is_close else Verdict.DIFFERS)
    worst = Verdict.DIFFERS if Verdict.DIFFERS in verdicts else Verdict.UNDECIDED if Verdict.UNDECIDED in verdicts else Verdict.AGREES
    least, most = pressures
    return Claim("Figure 2", statement, f"{'; '.join(texts)}, between p = {least:.0e} and {most:.0e}, mean over starts.", worst)


def _claim_of_free_boxes(outcomes: list[Outcome], disks: int) -> Claim:
    statement = ("Where the shape of the box is free, every packing is stable against shear, and has two contacts more at jamming than one "
                 "in a given box (Dagois-Bohy et al. 2012).")
    stable = sum(outcome.result("is_shear_stable") == 1.0 for outcome in outcomes)
    excess = [outcome.result("excess_contacts") for outcome in outcomes]
    agrees = bool(outcomes) and stable == len(outcomes) and min(excess) >= 2.0 and excess.count(2.0) >= 0.75 * len(outcomes)
    texts = [f"{stable} of {len(outcomes)} are stable, {excess.count(2.0)} have 2 contacts more, {sum(one > 2.0 for one in excess)} have more"]
    moduli = [disks * outcome.result("shear_modulus") for outcome in outcomes]
    if len(moduli) > 1:
        texts.append(f"N G D²/ε = {mean_over_runs(moduli)} at p = 1e-8")
    exponent = _exponents(outcomes, "shear_modulus", 1e-3, 1e-2)
    if exponent is not None:
        texts.append(f"G ∝ Δφ^({exponent}) between p = 1e-03 and 1e-02")
    return Claim("Figure 2", statement, "; ".join(texts) + ".", Verdict.AGREES if agrees else Verdict.DIFFERS)


def make(context: Context) -> Chapter:
    all_outcomes = {potential: context.outcomes(context.decompressed(potential)) for potential in POTENTIALS}
    free = context.outcomes(context.decompressed(is_box_free=True))
    rows = []
    for potential, outcomes in {**all_outcomes, "harmonic, free box": free}.items():
        for number, outcome in enumerate(outcomes):
            rows += [(potential, context.seed + number, *values) for values in zip(
                outcome.level("packing_fraction"), distances(outcome), outcome.level("pressure"), outcome.level("bulk_modulus"),
                outcome.level("shear_modulus"), outcome.level("least_shear_modulus"), outcome.level("contact_number"))]
    context.write_table("figure_2.csv", "potential seed packing_fraction distance pressure bulk_modulus shear_modulus "
                        "least_shear_modulus contact_number", rows)
    context.draw("figure_2", lambda: _draw(all_outcomes, free))
    unstable = {potential: sum(outcome.result("is_shear_stable") == 0.0 for outcome in outcomes)
                for potential, outcomes in all_outcomes.items()}
    jamming = mean_over_runs([outcome.result("jamming_packing_fraction") for outcome in all_outcomes["harmonic"]])
    return Chapter(
        title="Figure 2: pressure and elastic moduli above jamming",
        introduction=[f"{context.extent.decompressed_starts} packings of {context.extent.decompressed_disks} disks for each potential, "
                      "quenched at φ = 0.86 and decompressed to p = 1e-8; φ_J is where the pressure of each vanishes. As many harmonic packings "
                      "more are made in boxes whose shape is free."],
        drawings=[Drawing(("figure_2",), "Means over starts at equal pressure, with standard errors; figure_2.csv has every minimum.")],
        claims=[
            _claim("pressure", "p", EXPONENT_OF_PRESSURE, 0.01, (1e-8, 1e-5),
                   "Pressure vanishes as Δφ^(α−1): with the exponent 1 for harmonic and 3/2 for Hertzian disks.", all_outcomes),
            _claim("shear_modulus", "G", EXPONENT_OF_SHEAR, 0.1, (1e-4, 1e-2),
                   "The shear modulus vanishes as Δφ^(α−3/2): 1/2 and 1 (O'Hern et al. 2003).", all_outcomes),
            _claim_of_free_boxes(free, context.extent.decompressed_disks),
        ],
        conclusions=[f"Mean jamming packing fraction {jamming}; published: 0.842 ± 0.001 (O'Hern et al. 2003), 0.84177 ± 0.00001 for "
                     "large systems (Vågberg et al. 2011).",
                     f"Unstable against shear at the end: {unstable['harmonic']} harmonic and {unstable['hertzian']} Hertzian packings. "
                     "They are in the figure: a packing with one state of self-stress in a box that keeps its shape resists compression, and "
                     "some direction of shear only by a term of the order of p, which may be negative (Dagois-Bohy et al. 2012)."],
    )
