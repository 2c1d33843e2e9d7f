"""Figure 8: stress against strain in quasi-static shear, and the modulus by a finite strain beside that of the Hessian."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .. import style
from ..chapter import Chapter, Claim, Drawing, Table
from ..statistics import Estimate, Verdict, mean_over_runs
from .context import Context
from .runs import Outcome, Run, run_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DENSITY = 0.86
LATE = 0.5  #: the strain from which on the stress is that of steady flow
SMALL = 1e-8  #: a strain in which no contact opens or closes
#: Of 64 disks by an independent program: stress, pressure and energy of a disk in steady flow.
REFERENCE = {"shear_stress": Estimate(4.97e-4, 1.5e-5), "pressure": Estimate(6.24e-3, 9e-5), "energy": Estimate(1.011e-4, 2.9e-6)}
NAMES = {"shear_stress": "σ", "pressure": "p", "energy": "E/N"}


def _sheared(context: Context) -> list[Run]:
    extent = context.extent
    shear = {"stage": "shear", "until_strain": extent.sheared_strain, "strain_step": 1e-3, "strain_accuracy": 1e-3}
    return [run_of(f"{extent.sheared_disks} disks, sheared", [{"stage": "quench"}, shear], seed, extent.sheared_strain,
                   disks=extent.sheared_disks, packing_fraction=DENSITY) for seed in context.seeds(extent.sheared_starts)]


def _strained(context: Context) -> list[Run]:
    extent = context.extent
    shear = {"stage": "shear", "until_strain": SMALL, "strain_step": SMALL}
    return [run_of(f"{extent.sheared_disks} disks, strained a little", [{"stage": "quench"}, shear], seed, 0.1,
                   disks=extent.sheared_disks, packing_fraction=DENSITY, residual=1e-13) for seed in context.seeds(extent.sheared_starts)]


def plan(context: Context) -> list[Run]:
    return [*_sheared(context), *_strained(context)]


def _steady(outcome: Outcome, name: str) -> float:
    """The mean over the late part of a run; of the energy for each disk."""
    late = outcome.sheared("strain") > LATE
    share = len(outcome.radii) if name == "energy" else 1
    return float(np.mean(outcome.sheared(name)[late])) / share if late.any() else math.nan


def _draw(outcomes: list[Outcome]) -> Figure:
    figure, axes = style.new_axes("shear strain γ", "shear stress σ, ε/D²")
    for number, (outcome, colour) in enumerate(zip(outcomes[:2], style.COLOURS)):
        axes.plot(outcome.sheared("strain"), outcome.sheared("shear_stress"), color=colour, linewidth=0.7, label=f"start {number + 1}")
    axes.axhline(REFERENCE["shear_stress"].value, color=style.GREY, linestyle=style.DASHED, label="independent program, mean")
    axes.legend(loc="lower right", ncols=2)
    return figure


def _flow_claim(outcomes: list[Outcome], disks: int) -> Claim:
    statement = "Harmonic disks 1 : 1.4 at φ = 0.86, sheared slowly, flow at a stress, a pressure and an energy that an independent program finds."
    if disks != 64:
        return Claim("Figure 8", statement, "its numbers are those of 64 disks", Verdict.UNDECIDED)
    found = {name: mean_over_runs([_steady(outcome, name) for outcome in outcomes]) for name in REFERENCE}
    distances = [abs(found[name].value - known.value) / math.hypot(found[name].known_error, known.known_error)
                 for name, known in REFERENCE.items()]
    is_known = found["shear_stress"].known_error < 0.15 * found["shear_stress"].value
    verdict = Verdict.UNDECIDED if not is_known else Verdict.AGREES if max(distances) < 4.0 else Verdict.DIFFERS
    texts = [f"{NAMES[name]} = {found[name]} against {known}" for name, known in REFERENCE.items()]
    return Claim("Figure 8", statement, f"{'; '.join(texts)}. Agreement means less than four standard errors everywhere; an error of the "
                 "stress above 15 % decides nothing.", verdict)


def make(context: Context) -> Chapter:
    sheared, strained = context.outcomes(_sheared(context)), context.outcomes(_strained(context))
    rows = [(context.seed + number, float(strain), float(stress), float(pressure), float(energy), int(contacts))
            for number, outcome in enumerate(sheared)
            for strain, stress, pressure, energy, contacts in zip(*(outcome.sheared(name) for name in (
                "strain", "shear_stress", "pressure", "energy", "contacts")))]
    context.write_table("figure_8.csv", "seed strain shear_stress pressure energy contacts", rows)
    context.draw("figure_8", lambda: _draw(sheared))
    table = Table(["start", "dσ/dγ of a strain of 10⁻⁸", "simple-shear modulus of the Hessian"], "Units of ε/D².")
    differences = []
    for number, outcome in enumerate(strained):
        slope, modulus = outcome.result("first_shear_modulus"), outcome.result("simple_shear_modulus")
        table.rows.append([str(number + 1), f"{slope:.8g}", f"{modulus:.8g}"])
        differences.append(abs(slope - modulus))
    largest = max(differences, default=math.nan)
    verdict = Verdict.UNDECIDED if math.isnan(largest) else Verdict.AGREES if largest < 1e-5 else Verdict.DIFFERS
    return Chapter(
        title="Figure 8: quasi-static shear",
        introduction=[f"{context.extent.sheared_disks} harmonic disks at φ = {DENSITY} are sheared in steps of 10⁻³, with a minimum of the energy "
                      "after each. The stress rises as in a solid until disks rearrange; each drop is such an event."],
        drawings=[Drawing(("figure_8",), f"Two of the starts. The mean is that above γ = {LATE}.")],
        claims=[_flow_claim(sheared, context.extent.sheared_disks),
                Claim("Figure 8", "The slope of the stress in a small strain is C_xyxy − p/2 + (σ_yy − σ_xx)/2, with C of the Hessian.",
                      f"The largest difference of {len(strained)} packings is {largest:.2g} ε/D²; agreement means below 10⁻⁵.", verdict)],
        tables=[table],
    )
