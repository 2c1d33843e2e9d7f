"""One style for all charts: colours, sizes, the words on axes."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from cycler import cycler

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

#: The colours of Okabe and Ito for things that differ in kind. Yellow is for areas: a line of it does not show on white. Black last:
#: it is for references.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000")
LINE_COLOURS = COLOURS[:6]
#: Shapes of points differ as colours do, for a printer without colours.
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")
#: The width of one column of a journal, and of a page, in inches.
COLUMN = 3.4
PAGE = 7.0
INK = "#21242A"
GREY = "#666666"

#: What :func:`style` sets. Letters in SVG files are outlines, so that they look the same where DejaVu Sans is not installed.
STYLE: dict[str, Any] = {
    "figure.figsize": (COLUMN, 0.75 * COLUMN),
    "figure.facecolor": "white",
    "savefig.dpi": 300,
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 7,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.4,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.0,
    "errorbar.capsize": 1.5,
    "legend.frameon": False,
    "image.cmap": "viridis",
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "gridlock",
}

_LABELS = {
    "time": "time t / (length / speed)",
    "step": "time steps",
    "lag": "lag t / (length / speed)",
    "distance": "distance r",
    "free_time": "free time τ / (length / speed)",
    "free_path": "free path / length",
    "pair_correlation": "pair correlation g(r)",
    "orientation_correlation": "hexatic correlation g₆(r)",
    "speed": "speed v / (length / time)",
    "density": "probability density / (time / length)",
    "mean_displacement": "mean displacement / side",
    "mean_squared_displacement": "squared displacement ⟨Δr²⟩ / length²",
    "msd": "squared displacement ⟨Δr²⟩ / length²",
    "non_gaussian": "non-Gaussian parameter α₂",
    "scattering": "scattering function F(q, t)",
    "susceptibility": "susceptibility χ₄",
    "total_susceptibility": "susceptibility χ₄",
    "compressibility_factor": "compressibility factor Z",
    "virial_pressure": "virial pressure / (mass / time²)",
    "wall_pressure": "wall pressure / (mass / time²)",
    "collision_rate": "collisions of a disk / time⁻¹",
    "halted_fraction": "share of halted moves",
    "global_bond_orientation_order": "global order |⟨ψ6⟩|",
    "local_bond_orientation_order": "local order ⟨|ψ6|⟩",
    "disks.packing_fraction": "packing fraction φ",
    "disks.count": "number of disks N",
    "is_converged": "share that has converged",
    "is_jammed": "share that is jammed",
    "is_shear_stable": "share that is stable against shear",
    "engine.kind": "engine",
    "run.seed": "seed",
    "engine.cells": "cells a side k",
    "engine.time_step": "time step / (diameters per greatest speed)",
    "run.steps": "time steps",
}


def axis_label(name: str) -> str:
    """What an axis says of a column or a setting.

    >>> axis_label("disks.packing_fraction"), axis_label("flocking.noise"), axis_label("mean_speed")
    ('packing fraction φ', 'noise', 'mean speed')
    """
    return _LABELS.get(name, name.split(".")[-1].replace("_", " "))


@contextlib.contextmanager
def style() -> Iterator[None]:
    """The style of all pictures of Gridlock, for what is drawn and saved inside: one column of a journal, letters of 8 points.

    >>> with style():
    ...     axes = new_axes()
    >>> axes.figure.get_size_inches().tolist()
    [3.4, 2.55]
    """
    settings: Any = {**STYLE, "axes.prop_cycle": cycler(linestyle=["-", "--", ":"]) * cycler(color=LINE_COLOURS)}
    with matplotlib.rc_context(settings):
        yield


def new_axes(height: float = 0.75 * COLUMN, width: float = COLUMN) -> Axes:
    """Axes in a figure of their own, in inches; shown by a notebook."""
    import matplotlib.pyplot as pyplot

    _, axes = pyplot.subplots(figsize=(width, height), layout="constrained")
    return axes


def sequential(count: int) -> list[tuple[float, float, float, float]]:
    """Colours from dark to bright for ``count`` curves that differ in one number; the brightest of viridis is left out."""
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, count))
    return [tuple(colour) for colour in colours.tolist()]


def colour_circle(count: int = 256) -> NDArray[np.float64]:
    """Colours for angles, shape (count, 3): one turn through all hues of equal strength, brightest at yellow.

    Source: B. Ottosson, the colour space Oklab (2020), bottosson.github.io/posts/oklab.
    """
    angle = 2 * np.pi * np.arange(count) / count
    lightness, a, b = 0.70 + 0.12 * np.cos(angle - 1.9), 0.12 * np.cos(angle), 0.12 * np.sin(angle)
    to_cones = np.array([[1, 0.3963377774, 0.2158037573], [1, -0.1055613458, -0.0638541728], [1, -0.0894841775, -1.2914855480]])
    to_rgb = np.array([[4.0767416621, -3.3077115913, 0.2309699292], [-1.2684380046, 2.6097574011, -0.3413193965],
                       [-0.0041960863, -0.7034186147, 1.7076147010]])
    linear = np.clip((np.stack([lightness, a, b], axis=1) @ to_cones.T) ** 3 @ to_rgb.T, 0.0, 1.0)
    encoded: NDArray[np.float64] = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return encoded
