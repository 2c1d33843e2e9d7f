"""How the pictures of the study look: one style, colours that colour-blind readers tell apart, text that stays text in SVG."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..plot.style import COLOURS, GREY, MARKERS, STYLE, sequential

__all__ = ["COLOURS", "DASHED", "GREY", "MARKERS", "draw_disks", "logarithmic", "new_axes", "reference", "rendered", "sequential"]

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

#: The width of a picture in inches, that of a page of print.
WIDTH = 6.4
#: Longer dashes than those of matplotlib, which show where curves are short.
DASHED = (0, (5, 2.5))

#: The endings of the files of a picture.
FORMATS = ("svg", "png")
#: The style of all charts in letters for a page; text stays text in SVG, so that a report can be searched.
_SETTINGS: dict[str, Any] = {
    **STYLE,
    "font.size": 9.0, "axes.titlesize": 10.0, "axes.labelsize": 9.0, "legend.fontsize": 8.0, "xtick.labelsize": 8.0, "ytick.labelsize": 8.0,
    "lines.linewidth": 1.2, "lines.markersize": 4.5, "xtick.direction": "in", "ytick.direction": "in", "svg.fonttype": "none",
    "savefig.dpi": 160.0,
}


def rendered(draw: Callable[[], Figure]) -> dict[str, bytes]:
    """What draw() makes, by the ending of the file."""
    import matplotlib

    default: Any = matplotlib.rcParamsDefault
    context: Any = matplotlib.rc_context
    with context({**default, **_SETTINGS}):
        figure = draw()
        pictures = {}
        for format in FORMATS:
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
