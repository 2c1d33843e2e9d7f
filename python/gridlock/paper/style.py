"""How the pictures of the study look: one style, colours that colour-blind readers tell apart, text that stays text in SVG."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..plot import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

#: The shapes of points, one for each colour, so that no curve is told by its colour alone.
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")
GREY = "#5d6672"
#: The width of a picture in inches, that of a page of print.
WIDTH = 6.4
#: Longer dashes than those of matplotlib, which show where curves are short.
DASHED = (0, (5, 2.5))

_SETTINGS: dict[str, Any] = {
    "font.family": "sans-serif", "font.sans-serif": ["DejaVu Sans", "Liberation Sans", "Arial", "Helvetica"], "font.size": 9.0,
    "axes.titlesize": 10.0, "axes.labelsize": 9.0, "legend.fontsize": 8.0, "legend.frameon": False, "axes.linewidth": 0.7,
    "axes.grid": True, "grid.color": "#dfe2e6", "grid.linewidth": 0.5, "axes.axisbelow": True, "lines.linewidth": 1.2,
    "lines.markersize": 4.5, "xtick.direction": "in", "ytick.direction": "in",
    # The same bytes for the same numbers.
    "svg.fonttype": "none", "svg.hashsalt": "gridlock", "savefig.dpi": 160.0,
}


def rendered(draw: Callable[[], Figure]) -> dict[str, bytes]:
    """What draw() makes, by the ending of the file."""
    import matplotlib

    default: Any = matplotlib.rcParamsDefault
    context: Any = matplotlib.rc_context
    with context({**default, **_SETTINGS}):
        figure = draw()
        pictures = {}
        for format in ("svg", "png"):
            content = io.BytesIO()
            if format == "svg":
                figure.savefig(content, format=format, metadata={"Date": None})
            else:
                figure.savefig(content, format=format, metadata={"Software": None}, pil_kwargs={"compress_level": 3})
            pictures[format] = content.getvalue()
            figure.set_layout_engine("none")  # it is laid out by now
    return pictures


def new_axes(title: str, x: str, y: str, *, width: float = WIDTH, height: float = 4.4) -> tuple[Figure, Axes]:
    """An empty chart."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.add_subplot()
    axes.set(title=title, xlabel=x, ylabel=y)
    return figure, axes


def reference(axes: Axes, y: float, label: str) -> None:
    """A thin line across the chart with a label at its right end."""
    axes.axhline(y, color=GREY, linewidth=0.8, linestyle=":")
    axes.annotate(label, (1.0, y), xycoords=axes.get_yaxis_transform(), xytext=(-4, 2), textcoords="offset points", color=GREY,
                  fontsize=8, ha="right")


def logarithmic(axes: Axes, *names: str) -> None:
    """Makes the axes of these names, "x" and "y", logarithmic, with plain numbers at their ticks."""
    for name in names:
        axes.set(**{f"{name}scale": "log"})
        axis = axes.xaxis if name == "x" else axes.yaxis
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")


def sequence(count: int) -> list[tuple[float, ...]]:
    """Colours from dark to bright for curves that differ in one number; the palest end, which paper swallows, is left out."""
    import matplotlib

    return [tuple(colour) for colour in matplotlib.colormaps["viridis"](np.linspace(0.0, 0.88, count))]


def draw_disks(axes: Axes, positions: NDArray[Any], radius: float, colours: ArrayLike | str, *, edge: float = 0.3) -> None:
    """Disks of one size in the unit box."""
    from matplotlib.collections import PathCollection
    from matplotlib.path import Path
    from matplotlib.transforms import AffineDeltaTransform

    to_picture: Any = axes.transData
    # One circle used at all places keeps the SVG small.
    disks = PathCollection([Path.circle((0.0, 0.0), radius)], offsets=positions, offset_transform=to_picture,
                           facecolors=colours, edgecolors="black", linewidths=edge)
    disks.set_transform(AffineDeltaTransform(to_picture))
    axes.add_collection(disks)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0), aspect="equal", xticks=[], yticks=[])
    axes.grid(False)


__all__ = ["COLOURS", "DASHED", "GREY", "MARKERS", "WIDTH", "draw_disks", "logarithmic", "new_axes", "reference", "rendered", "sequence"]
