"""Pictures of packings: who touches whom, and how hard."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap

from ..analysis import bond_orientation, voronoi
from ..errors import Error
from ..files import Frame
from ..packings import Contacts
from ..simulation import Clock
from .agents import _draw_box, _rows_with_images, _values_given
from .disks import Disks
from .style import INK, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

#: Over the mean diameter: so wide is the line of the mean force, and the rim of a rattler. The strongest forces are at most three times as wide.
MEAN_WIDTH = 0.1
RIM = 0.04
#: Pale colours, on which dark lines show.
PALE = ListedColormap(colormaps["YlGnBu"](np.linspace(0.04, 0.62, 256)), name="pale")
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
    disks.set_cmap(PALE)
    disks.set_clim(*limits)
    if not is_hollow.all():
        axes.figure.colorbar(disks, ax=axes, label=label or usual, fraction=0.05, pad=0.02)
    rattlers = found.radii[rows][is_hollow]
    rim = RIM * 2.0 * found.radii.mean() if len(found.radii) > 0 else 0.0
    for radii, face in ((rattlers, RATTLER), (np.maximum(rattlers - rim, 0.5 * rattlers), "white")):
        Disks(axes, places[is_hollow], radii).set_facecolor(face)
    axes.add_collection(PolyCollection(list(_lines_of(found, frame.positions)), facecolors=INK, linewidths=0), autolim=False)
    _draw_box(axes, frame, None)
    return axes


def _frame_of(found: Contacts) -> Frame:
    """The disks inside the box."""
    sides = np.array([found.box.width, found.box.height])
    places = found.points % sides if found.box.periodic else found.points
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


def _lines_of(found: Contacts, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """The four corners of each line: from the first disk to the second, and around the edges of a periodic box back from there."""
    separations = found.normals * found.distances[:, None]
    forces = found.forces if found.forces.any() else np.ones(len(separations))
    mean = forces[forces > 0].mean() if (forces > 0).any() else 1.0
    diameter = 2.0 * found.radii.mean() if len(found.radii) > 0 else 0.0
    widths = MEAN_WIDTH * diameter * np.minimum(forces / mean, 3.0)
    is_of_disks = found.pairs[:, 1] < len(places)
    first = places[found.pairs[:, 0]]
    second = places[found.pairs[is_of_disks, 1]]
    starts = np.concatenate([first, second])
    separations = np.concatenate([separations, -separations[is_of_disks]])
    normals = np.concatenate([found.normals, found.normals[is_of_disks]])
    aside = np.concatenate([widths, widths[is_of_disks]])[:, None] / 2 * np.column_stack([-normals[:, 1], normals[:, 0]])
    corners: NDArray[np.float64] = np.stack([starts - aside, starts + aside, starts + separations + aside, starts + separations - aside], axis=1)
    return corners
