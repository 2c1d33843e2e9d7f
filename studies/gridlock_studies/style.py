"""How the pictures of the study look: one style, colours that colour-blind readers tell apart, text that stays text in SVG."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock.plot import COLOURS, GREY, MARKERS, STYLE, sequential

__all__ = ["CHI_V", "COLOURS", "DASHED", "GREY", "MARKERS", "PHI_J", "V_MAX", "draw_disks", "logarithmic", "new_axes",
           "reference", "rendered", "sequential", "tick_text"]

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

#: The width of a picture in inches, that of a page of print.
WIDTH = 6.4
#: Symbols with an index.
V_MAX, PHI_J, CHI_V = (f"{letter}$_\\mathrm{{{index}}}$" for letter, index in (("v", "max"), ("φ", "J"), ("χ", "V")))
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


def new_axes(x: str, y: str, *, width: float = WIDTH, height: float = 4.4) -> tuple[Figure, Axes]:
    """An empty chart. Its caption stands beside it, and says what a title would."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlabel=x, ylabel=y)
    return figure, axes


def reference(axes: Axes, y: float, label: str, *, at: float = 1.0) -> None:
    """A thin line across the chart with a label, which ends at a share of its width."""
    axes.axhline(y, color=GREY, linewidth=0.8, linestyle=":")
    axes.annotate(label, (at, y), xycoords=axes.get_yaxis_transform(), xytext=(-4, 2), textcoords="offset points", color=GREY,
                  fontsize=8, ha="right")


_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def tick_text(x: float, *, as_power: bool = False) -> str:
    """A number at a tick of a logarithmic axis.

    >>> tick_text(10000.0), tick_text(0.05), tick_text(1e-5, as_power=True), tick_text(5e6, as_power=True)
    ('10,000', '0.05', '10⁻⁵', '5·10⁶')
    """
    if not as_power:
        return f"{x:,.10g}"
    digits, exponent = f"{x:.0e}".split("e")
    power = f"10{str(int(exponent)).translate(_SUPERSCRIPTS)}"
    return power if digits == "1" else f"{digits}·{power}"


def logarithmic(axes: Axes, *names: str) -> None:
    """Makes the axes of these names, "x" and "y", logarithmic: numbers at the ticks, powers of ten where they reach far, and 2 and 5
    between where there are few decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for name in names:
        axes.set(**{f"{name}scale": "log"})
        axis = axes.xaxis if name == "x" else axes.yaxis
        low, high = sorted(axis.get_view_interval())
        as_power = low < 1e-4 or high > 1e6
        formatter = FuncFormatter(lambda x, _, as_power=as_power: tick_text(x, as_power=as_power))
        axis.set_major_formatter(formatter)
        is_short = high < 100.0 * low
        if is_short:
            axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
        axis.set_minor_formatter(formatter if is_short else NullFormatter())


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
