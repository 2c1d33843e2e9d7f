"""Charts by matplotlib: snapshots, series, curves and sweeps with error bands.

Colours are those of Okabe and Ito, and viridis: both are told apart by colour-blind readers and in grey. Every function draws into
``axes``, or into new ones, and returns them; ``axes.figure.savefig("picture.pdf")`` writes a file. matplotlib has to be installed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import Error
from .files import Frame, RunDirectory
from .simulation import Simulation
from .sweeps import SweepDirectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]
    from numpy.typing import ArrayLike, NDArray

#: Black last: it is for references.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000")
#: The width of one column of a journal, in inches.
COLUMN = 3.4


def _axes(axes: Any, height: float = 0.75) -> Any:
    if axes is not None:
        return axes
    try:
        import matplotlib.pyplot as pyplot
    except ImportError:
        raise Error("drawing needs matplotlib\n  hint: pip install matplotlib") from None
    _, axes = pyplot.subplots(figsize=(COLUMN, COLUMN * height), layout="constrained")
    axes.set_prop_cycle(color=COLOURS)
    return axes


def _positions(agents: Any) -> tuple[NDArray[np.float64], NDArray[np.float64] | None, Any]:
    """Positions, radii where there are some, and the box."""
    if isinstance(agents, Simulation):
        names = agents.agents.names
        return np.array(agents.agents.positions), np.array(agents.agents.radius) if "radius" in names else None, agents.box
    if isinstance(agents, RunDirectory):
        agents = agents.final
    if isinstance(agents, Frame):
        return agents.positions, agents.columns.get("radius"), agents.box
    raise Error(f"a {type(agents).__name__} has no agents to draw\n  hint: give a Simulation, a Frame or a RunDirectory")


def snapshot(agents: Any, colour: ArrayLike | None = None, *, label: str = "", axes: Axes | None = None) -> Axes:
    """The agents in their box, disks at their true size, points where they have no radius.

    :param agents: a :class:`~gridlock.Simulation`, a :class:`~gridlock.Frame` or a :class:`~gridlock.RunDirectory`.
    :param colour: one number for each agent, shape (N,), in the order of ``agents``; ``label`` names it beside the bar.

    Cost: about 2 µs an agent; above 20,000 agents the disks are an image also in PDF and SVG files.
    """
    positions, radii, box = _positions(agents)
    values = None if colour is None else np.asarray(colour, dtype=np.float64)
    if values is not None and values.shape != (len(positions),):
        raise Error(f"colour has shape {values.shape} for {len(positions)} agents\n  hint: give one number for each agent")
    axes = _axes(axes, box.height / box.width)
    from matplotlib.collections import EllipseCollection
    from matplotlib.patches import Rectangle

    is_image = len(positions) > 20_000
    disks: Any
    if radii is not None:
        widths = 2.0 * np.asarray(radii)
        disks = EllipseCollection(widths, widths, np.zeros(len(widths)), units="xy", offsets=positions,
                                  offset_transform=axes.transData, linewidths=0, rasterized=is_image)
    else:
        disks = axes.scatter(positions[:, 0], positions[:, 1], s=4, linewidths=0, rasterized=is_image)
    if values is None:
        disks.set_facecolor(COLOURS[0])
    else:
        disks.set_array(values)
        disks.set_cmap("viridis")
        axes.figure.colorbar(disks, ax=axes, label=label)
    if radii is not None:
        axes.add_collection(disks)
    axes.add_patch(Rectangle((0, 0), box.width, box.height, fill=False, linestyle="--" if box.periodic else "-", linewidth=0.8))
    axes.set(xlim=(-0.01 * box.width, 1.01 * box.width), ylim=(-0.01 * box.height, 1.01 * box.height), aspect="equal")
    axes.axis("off")
    return axes


def series(run: Any, columns: str | Sequence[str], *, against: str = "time", axes: Axes | None = None) -> Axes:
    """Columns of the series of a simulation or a run directory against time."""
    table = run.series
    axes = _axes(axes)
    present = list(table.dtype.names or ())
    names = [columns] if isinstance(columns, str) else list(columns)
    for name in [*names, against]:
        if name not in present:
            raise Error(f"the series has no column {name}\n  hint: it has {', '.join(present)}")
    for name in names:
        axes.plot(table[against], table[name], label=name.replace("_", " "), linewidth=1)
    axes.set(xlabel=against.replace("_", " "), ylabel=names[0].replace("_", " ") if len(names) == 1 else "")
    if len(names) > 1:
        axes.legend(frameon=False)
    return axes


def curve(run: Any, name: str, *, axes: Axes | None = None, label: str = "") -> Axes:
    """A measured curve with its band of one standard error: "pair_correlation", "speed_distribution", "velocity_autocorrelation"."""
    table = run.distributions.get(name) if isinstance(run, Simulation) else run.table(name)
    if table is None:
        raise Error(f"there is no curve {name} yet\n  hint: there are {', '.join(run.distributions) or 'none'}")
    axes = _axes(axes)
    present = list(table.dtype.names or ())
    x, y = present[:2]
    (line,) = axes.plot(table[x], table[y], label=label or None, linewidth=1)
    if "error" in present:
        error = np.nan_to_num(table["error"])
        axes.fill_between(table[x], table[y] - error, table[y] + error, color=line.get_color(), alpha=0.3, linewidth=0)
    if name == "pair_correlation":
        axes.axhline(1.0, color="0.6", linewidth=0.6, zorder=0)
    axes.set(xlabel=x.replace("_", " "), ylabel=y.replace("_", " "))
    return axes


def sweep(made: SweepDirectory, result: str, *, against: str | None = None, axes: Axes | None = None) -> Axes:
    """A result against a swept setting, with bars of one standard error; one line for each combination of the others."""
    means = made.means
    names = list(means.dtype.names or ())
    if result not in names:
        raise Error(f"the sweep has no result {result}\n  hint: it has {', '.join(n for n in names if n + '_error' in names)}")
    keys = names[: names.index("runs")]
    numbers = [key for key in keys if means[key].dtype.kind in "fiu"]
    if against is None:
        against = max(numbers, key=lambda key: len(np.unique(means[key])), default=None)
    if against not in numbers:
        raise Error(f"the sweep has no numbers {against}\n  hint: it has {', '.join(numbers)}")
    axes = _axes(axes)
    others = [key for key in keys if key != against]
    for combination in sorted({tuple(row[key] for key in others) for row in means}, key=str):
        rows = means[np.array([tuple(row[key] for key in others) == combination for row in means])]
        rows = rows[np.argsort(rows[against])]
        label = ", ".join(f"{key.split('.')[-1]} = {value}" for key, value in zip(others, combination))
        axes.errorbar(rows[against], rows[result], np.nan_to_num(rows[result + "_error"]), label=label or None,
                      marker="o", markersize=3, linewidth=1, capsize=2)
    axes.set(xlabel=against.split(".")[-1].replace("_", " "), ylabel=result.replace("_", " "))
    if others:
        axes.legend(frameon=False, fontsize="small")
    return axes
