"""Pictures of packings: who touches whom, and how hard."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import PolyCollection
from matplotlib.patches import Rectangle

from ..analysis import bond_orientation, voronoi
from ..errors import Error
from ..files import Frame
from ..packings import Contacts
from ..simulation import Clock
from .agents import _draw_box, _rows_with_images, _values_given
from .charts import line
from .disks import Disks
from .style import GREY, INK, LINE_COLOURS, MARKERS, new_axes

if TYPE_CHECKING:
    import os

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from ..box import Box

#: Over the mean diameter: so wide is the line of the mean force, and the rim of a rattler. The strongest forces are at most three times as wide.
MEAN_WIDTH = 0.1
RIM = 0.04
#: Around dark lines, so that they show on dark disks too; over the mean diameter.
HALO = 0.035
#: Mean-field exponents of the densities of weak forces, of disks with three contacts and of others: P. Charbonneau et al. (2015),
#: doi:10.1103/PhysRevLett.114.125504. The share of forces up to f grows with one more.
BUCKLER_EXPONENT, EXTENDED_EXPONENT = 0.17462, 0.42311
RATTLER = "#8C8C8C"


def packing(found: Contacts, colour: ArrayLike | str = "psi6", *, label: str = "", axes: Axes | None = None) -> Axes:
    """A packing with its chains of force: lines between disks that touch, as wide as their force is strong. Rattlers are hollow.

    :param found: what :func:`gridlock.contacts` gives. Without forces, as of hard disks, all lines have one width.
    :param colour: ``"psi6"`` (|ψ6| over the Voronoi neighbours), ``"coordination"``, or one number for each disk, shape (N,).
    :param label: beside the bar of colours.
    :raises Error: for a colour that is none of these.

    >>> from gridlock import contacts
    >>> axes = packing(contacts([[0.3, 0.5], [0.68, 0.5]], 0.2, 1.0), "coordination")
    >>> len(axes.collections[-1].get_paths())  # a line from each of the two
    2
    """
    values, usual, limits = _values_of(found, colour)
    if axes is None:
        axes = new_axes(np.clip(found.box.height / found.box.width, 0.2, 2.0) * 3.0)
    frame = _frame_of(found)
    rows, places = _rows_with_images(frame, found.radii)
    is_hollow = found.is_rattler[rows]
    disks: Any = Disks(axes, places[~is_hollow], found.radii[rows][~is_hollow])
    disks.set_array(values[rows][~is_hollow])
    disks.set_cmap(colormaps["viridis"])
    disks.set_clim(*limits)
    if not is_hollow.all():
        axes.figure.colorbar(disks, ax=axes, label=label or usual, fraction=0.05, pad=0.02)
    rattlers = found.radii[rows][is_hollow]
    rim = RIM * 2.0 * found.radii.mean() if len(found.radii) > 0 else 0.0
    for radii, face in ((rattlers, RATTLER), (np.maximum(rattlers - rim, 0.5 * rattlers), "white")):
        Disks(axes, places[is_hollow], radii).set_facecolor(face)
    for wider, face in ((HALO, "white"), (0.0, INK)):
        axes.add_collection(PolyCollection(list(_lines_of(found, frame.positions, wider)), facecolors=face, linewidths=0), autolim=False)
    _draw_box(axes, frame, None)
    if found.forces.any():
        _draw_key(axes, found)
    return axes


def _draw_key(axes: Axes, found: Contacts) -> None:
    """Below the box how wide the line of the mean force is, and that of three times as much."""
    diameter = 2.0 * float(found.radii.mean())
    height = -0.6 * max(diameter, 0.05 * found.box.height)
    for place, times, text in ((0.0, 1.0, "⟨f⟩"), (0.3, 3.0, "3⟨f⟩ or more")):
        left, width = place * found.box.width, times * MEAN_WIDTH * diameter
        axes.add_patch(Rectangle((left, height - width / 2), 0.06 * found.box.width, width, facecolor=INK, linewidth=0, clip_on=False))
        axes.annotate(text, (left + 0.075 * found.box.width, height), va="center", fontsize="small", annotation_clip=False)


def _frame_of(found: Contacts) -> Frame:
    """The disks inside the box."""
    sides = np.array([found.box.width, found.box.height])
    boxes_up = np.floor(found.points[:, 1:] / found.box.height)
    places = (found.points - boxes_up * (found.box.shift, 0.0)) % sides if found.box.periodic else found.points
    return Frame(found.box, Clock(0, 0.0), np.arange(len(places), dtype=np.uint64),
                 {"x": places[:, 0], "y": places[:, 1], "radius": found.radii})


def _values_of(found: Contacts, colour: Any) -> tuple[NDArray[np.float64], str, tuple[float, float]]:
    """A number for each disk, what it is, and the ends of its bar."""
    if isinstance(colour, str) and colour == "psi6":
        if len(found.points) < 3:
            return np.zeros(len(found.points)), "|ψ6|", (0.0, 1.0)
        neighbors = voronoi(found.points, found.box).neighbors
        return np.abs(bond_orientation(found.points, box=found.box, neighbors=neighbors)), "|ψ6|", (0.0, 1.0)
    if isinstance(colour, str) and colour == "coordination":
        return found.coordination.astype(np.float64), "contacts of a disk", (3.0, max(6.0, float(found.coordination.max(initial=0))))
    if isinstance(colour, str):
        raise Error(f"the disks of a packing have no \"{colour}\"\n  hint: use \"psi6\", \"coordination\" or one number for each disk")
    values = _values_given(colour, len(found.points))
    return values, "", (min(0.0, values.min(initial=0.0)), values.max(initial=0.0) or 1.0)


def _lines_of(found: Contacts, places: NDArray[np.float64], wider: float = 0.0) -> NDArray[np.float64]:
    """The four corners of each line: from the first disk to the second, and around the edges of a periodic box back from there.

    ``wider`` is over the mean diameter.
    """
    separations = found.normals * found.distances[:, None]
    forces = found.forces if found.forces.any() else np.ones(len(separations))
    mean = forces[forces > 0].mean() if (forces > 0).any() else 1.0
    diameter = 2.0 * found.radii.mean() if len(found.radii) > 0 else 0.0
    widths = MEAN_WIDTH * diameter * np.minimum(forces / mean, 3.0) + wider * diameter
    is_of_disks = found.pairs[:, 1] < len(places)
    first = places[found.pairs[:, 0]]
    second = places[found.pairs[is_of_disks, 1]]
    starts = np.concatenate([first, second])
    separations = np.concatenate([separations, -separations[is_of_disks]])
    normals = np.concatenate([found.normals, found.normals[is_of_disks]])
    aside = np.concatenate([widths, widths[is_of_disks]])[:, None] / 2 * np.column_stack([-normals[:, 1], normals[:, 0]])
    corners: NDArray[np.float64] = np.stack([starts - aside, starts + aside, starts + separations + aside, starts + separations - aside], axis=1)
    return corners


def chart_forces(axes: Axes, found: Contacts) -> None:
    """Which share of the forces is weaker, beside the mean-field powers of large packings at jamming."""
    kinds = (("extended", ~found.is_of_buckler, EXTENDED_EXPONENT), ("of bucklers", found.is_of_buckler, BUCKLER_EXPONENT))
    for number, (label, is_drawn, exponent) in enumerate(kinds):
        forces = np.sort(found.relative_forces[is_drawn])
        if len(forces) == 0:
            continue
        shares = np.arange(1, len(forces) + 1) / len(forces)
        line(axes, forces, shares, label=f"{label} ({len(forces)})", color=LINE_COLOURS[number])
        middle = len(forces) // 4
        line(axes, forces, shares[middle] * (forces / forces[middle]) ** (1.0 + exponent), color=LINE_COLOURS[number], linestyle=":",
             label=f"∝ f$^{{{1.0 + exponent:.2f}}}$, mean field")
    axes.set(xscale="log", yscale="log", xlabel="force f/⟨f⟩", ylabel="share of forces up to f", title=_size_of(found))
    axes.set_ylim(0.5 / max(1, len(found.relative_forces)), 1.5)
    axes.legend()


def _size_of(found: Contacts) -> str:
    return f"one packing of {len(found.points)} disks"


def chart_spectrum(axes: Axes, file: str | os.PathLike[str], found: Contacts) -> None:
    """The spectral density of the area of the disks, which falls towards small q where a packing is hyperuniform."""
    q, density = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2)[:, :2].T
    diameter = found.smallest_diameter
    line(axes, q * diameter, density / diameter**2)
    axes.set(xscale="log", yscale="log", xlabel="wave number q D", ylabel="spectral density χ(q) / D²", title=_size_of(found))


def chart_levels(axes: Axes, levels: NDArray[Any], names: dict[float, str]) -> None:
    """Pressure against packing fraction, stage by stage. Earlier stages are rings around the points of later ones."""
    stages = np.unique(levels["stage"])
    for number, stage in enumerate(stages):
        of_stage = levels[levels["stage"] == stage]
        axes.plot(of_stage["packing_fraction"], of_stage["pressure"], color=LINE_COLOURS[number % len(LINE_COLOURS)],
                  marker=MARKERS[number % len(MARKERS)], markerfacecolor="none" if number + 1 < len(stages) else None,
                  markersize=3.0 + 3.0 * (len(stages) - 1 - number), label=f"stage {names.get(stage, f'{stage:.0f}')}")
    axes.set(yscale="log", xlabel="packing fraction φ", ylabel="pressure P D²/ε")
    axes.locator_params(axis="x", nbins=5)
    axes.legend()


def draw_event(axes: Axes, box: Box, event: Any, motions: NDArray[Any]) -> None:
    """How disks moved against the affine motion in an event of shear: an arrow for each that moved, the longest a tenth of the box."""
    length = np.hypot(motions["motion_x"], motions["motion_y"])
    scale = 0.1 * box.width / length.max()
    axes.quiver(motions["x"], motions["y"], scale * motions["motion_x"], scale * motions["motion_y"], length, cmap="viridis",
                angles="xy", scale_units="xy", scale=1.0, width=0.004)
    axes.set(aspect="equal", xlim=(0.0, box.width), ylim=(0.0, box.height), xticks=[], yticks=[])
    axes.set_title(f"event at γ = {event['strain']:.5g}, motions × {scale:.2g}")


def chart_shear(axes: Axes, minima: NDArray[Any], events: NDArray[Any]) -> None:
    """Shear stress against strain, stage by stage, with a line at each strain where the stress drops."""
    for number, stage in enumerate(np.unique(minima["stage"])):
        of_stage = minima[minima["stage"] == stage]
        axes.plot(of_stage["strain"], of_stage["shear_stress"], color=LINE_COLOURS[number % len(LINE_COLOURS)], marker="", label=f"stage {stage:.0f}")
    for strain in events["strain"]:
        axes.axvline(strain, color=GREY, linewidth=0.4, zorder=0)
    axes.set(xlabel="strain γ", ylabel="shear stress σ D²/ε")
    if len(np.unique(minima["stage"])) > 1:
        axes.legend()
