"""Pictures of agents in their box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.colors import ListedColormap, to_rgba_array
from matplotlib.patches import Patch, Rectangle

from ..analysis import bond_orientation
from ..arrays import as_array, as_numbers
from ..errors import Error
from ..files import Frame, RunDirectory, Trajectory, settings_in
from ..simulation import Simulation
from .disks import Disks
from .style import COLOURS, INK, axis_label, colour_circle, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

#: How many kinds colours can tell apart.
MOST_KINDS = 8
#: Of an agent without a value.
UNKNOWN = "#bfbfbf"


def frame_of(agents: Any) -> Frame:
    """The agents of a simulation, of the end of a run directory or a trajectory, or those of a frame."""
    if isinstance(agents, Simulation):
        return agents.frame
    if isinstance(agents, RunDirectory):
        return agents.final
    if isinstance(agents, Trajectory):
        agents.expect_frames()
        return agents[-1]
    if isinstance(agents, Frame):
        return agents
    raise Error(f"a {type(agents).__name__} has no agents to draw\n  hint: give a Simulation, a Frame, a RunDirectory or a Trajectory")


def _walls_of(agents: Any) -> Any:
    """The setting ``walls``, where the settings are known."""
    if isinstance(agents, Simulation):
        return settings_in(agents.settings).get("walls", ())
    return agents.settings.get("walls", ()) if isinstance(agents, (RunDirectory, Trajectory)) else ()


def colours_of(frame: Frame) -> list[str]:
    """What the agents of a frame can be coloured by."""
    colours = ["psi6", "neighbourhood", "radius"]
    if "velocity_x" in frame.columns:
        colours.append("speed")
    if "velocity_x" in frame.columns or "heading_x" in frame.columns:
        colours.append("direction")
    return colours + [name for name in frame.columns if name not in colours]


def usual_colour(frame: Frame) -> str:
    """The last column of whole numbers, such as a species, the direction of motion, or one colour for each radius."""
    for name in reversed(list(frame.columns)):
        if frame.columns[name].dtype.kind == "u":
            return name
    if "heading_x" in frame.columns:
        return "direction"
    return "direction" if "radius" not in frame.columns and "direction" in colours_of(frame) else "radius"


def values_of(frame: Frame, colour: str) -> NDArray[Any]:
    """The numbers that a colour shows: one for each agent."""
    if colour == "psi6":
        return _local_order(frame)
    if colour == "speed" and "velocity_x" in frame.columns:
        speeds: NDArray[Any] = np.hypot(frame.velocity_x, frame.velocity_y)
        return speeds
    motion = "heading" if "heading_x" in frame.columns else "velocity"
    if colour == "direction" and motion + "_x" in frame.columns:
        angles: NDArray[Any] = np.arctan2(frame.columns[motion + "_y"], frame.columns[motion + "_x"])
        return angles
    if colour in frame.columns:
        return frame.columns[colour]
    raise Error(f"the agents have no column \"{colour}\"\n  hint: these agents can be coloured by {', '.join(colours_of(frame))}")


def _local_order(frame: Frame) -> NDArray[np.float64]:
    """|ψ6| with the neighbours of the observable local_bond_orientation_order: nearer than 1.5 spacings of a triangular lattice."""
    if len(frame) == 0:
        return np.empty(0)
    cutoff = 1.5 * np.sqrt(2.0 / np.sqrt(3.0) * frame.box.area / len(frame))
    periods = [side for side, periodic in zip(frame.box[:2], (frame.box.periodic_x, frame.box.periodic_y)) if periodic]
    cutoff = min([cutoff, *(0.5 * period for period in periods)])
    return np.abs(bond_orientation(frame.positions, cutoff, frame.box))


def _radii(frame: Frame) -> NDArray[np.float64]:
    """Radii; for agents that have none a third of the distance to the next one, but neither a dot nor a blot."""
    if "radius" in frame.columns:
        radii: NDArray[np.float64] = frame.columns["radius"]
        return radii
    spacing = np.sqrt(frame.box.area / max(1, len(frame)))
    side = np.sqrt(frame.box.area)
    return np.full(len(frame), np.clip(0.33 * spacing, 0.0015 * side, 0.008 * side))


def _rows_with_images(frame: Frame, radii: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Rows and positions of all that shows in the box: a disk that a periodic edge cuts shows on both sides."""
    positions, sides, radius = frame.positions, np.array([frame.box.width, frame.box.height]), radii[:, None]
    rows, places = [np.arange(len(frame))], [positions]
    periodic = np.array([frame.box.periodic_x, frame.box.periodic_y])
    is_cut = (((positions < radius) | (positions > sides - radius)) & periodic).any(axis=1)
    cut = np.flatnonzero(is_cut)
    for shift in [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0) and periodic[np.flatnonzero((i, j))].all()]:
        images = positions[cut] + shift * sides + (shift[1] * frame.box.shift, 0.0)
        shows = ((images > -radius[cut]) & (images < sides + radius[cut])).all(axis=1)
        rows.append(cut[shows])
        places.append(images[shows])
    return np.concatenate(rows), np.concatenate(places)


def neighbourhood_colours(frame: Frame, columns: int, rows: int) -> NDArray[np.intp]:
    """A number below nine for each agent, from its cell in a grid: no two of the nine cells of a block have the same.

    An axis with an odd number of cells that closes on itself needs three numbers, all others two.
    """
    def along(coordinates: Any, side: float, count: int, periodic: bool) -> Any:
        cells = np.clip(np.nan_to_num(np.asarray(coordinates) * (count / side)), 0, count - 1).astype(int)
        closes = periodic and count % 2 == 1 and count > 1
        return np.where(closes & (cells == count - 1), 2, cells % 2)

    box = frame.box
    numbers: NDArray[np.intp] = (along(frame.x, box.width, columns, box.periodic_x)
                                 + 3 * along(frame.y, box.height, rows, box.periodic_y))
    return numbers


#: The first, second, fourth and fifth are those of an even grid.
NEIGHBOURHOODS = ("#4095C5", "#EAAD26", "#D96E1A", "#33B18F", "#D186B0", "#78C3ED", "#F0E442", "#8C8C8C", "#73422E")


def _legend(axes: Any, colours: Sequence[Any], names: Sequence[str], title: str) -> None:
    patches = [Patch(facecolor=colour, label=name) for colour, name in zip(colours, names)]
    axes.legend(handles=patches, title=title or None, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2,
                handlelength=1.0, handleheight=1.0, frameon=False)


def _rgba(colours: Sequence[str]) -> NDArray[np.float64]:
    array: NDArray[np.float64] = to_rgba_array(colours)
    return array


def _colour_by_kind(axes: Any, disks: Any, kinds: NDArray[Any], rows: NDArray[np.intp], names: Sequence[str], label: str) -> None:
    """``kinds`` are places in ``COLOURS``; ``names`` what they are called."""
    disks.set_facecolor(_rgba(COLOURS)[kinds[rows].astype(int)])
    if len(names) > 1:
        _legend(axes, COLOURS, names, label)


def _colour_by_radius(axes: Any, disks: Any, radii: NDArray[np.float64], rows: NDArray[np.intp]) -> None:
    different, kinds = np.unique(radii, return_inverse=True)
    if len(different) < 2:
        disks.set_facecolor(COLOURS[0])
    elif len(different) <= MOST_KINDS:
        # The ratios are what a mixture is known by.
        names = ["R", *(f"{radius / different[0]:.4g} R" for radius in different[1:])]
        _colour_by_kind(axes, disks, kinds.reshape(-1), rows, names, f"R = {different[0]:.4g}")
    else:
        _colour_by_value(axes, disks, radii[rows], "radius", None)


def _colour_by_value(axes: Any, disks: Any, values: Any, label: str, limits: tuple[float, float] | None) -> None:
    """On a bar from the least value, or 0 if none is negative, to the largest; agents without a value are grey."""
    finite = values[np.isfinite(values)]
    disks.set_array(np.ma.masked_invalid(values))
    disks.set_cmap(matplotlib.colormaps["viridis"].with_extremes(bad=UNKNOWN))
    disks.set_clim(*(limits or (min(0.0, finite.min(initial=0.0)), finite.max(initial=0.0) or 1.0)))
    axes.figure.colorbar(disks, ax=axes, label=label, fraction=0.05, pad=0.02)


def _colour_by_angle(axes: Any, disks: Any, angles: Any, label: str) -> None:
    circle = colour_circle()
    disks.set_array(np.ma.masked_invalid(angles))
    disks.set_cmap(ListedColormap(np.roll(circle, len(circle) // 2, axis=0), name="directions").with_extremes(bad=UNKNOWN))
    disks.set_clim(-np.pi, np.pi)
    bar = axes.figure.colorbar(disks, ax=axes, label=label, fraction=0.05, pad=0.02)
    bar.set_ticks([-np.pi, -np.pi / 2, 0.0, np.pi / 2, np.pi], labels=["−π", "−π/2", "0", "π/2", "π"])


def _colour_by_name(axes: Any, disks: Any, frame: Frame, rows: NDArray[np.intp], colour: str, label: str, names: Sequence[str],
                    limits: tuple[float, float] | None) -> None:
    if colour == "neighbourhood":
        cells = [max(1, int(side / (2 * _radii(frame).max(initial=side)))) for side in (frame.box.width, frame.box.height)]
        disks.set_facecolor(_rgba(NEIGHBOURHOODS)[neighbourhood_colours(frame, *cells)[rows]])
        return
    if colour == "radius":
        _colour_by_radius(axes, disks, _radii(frame), rows)
        return
    values = values_of(frame, colour)
    if colour == "direction":
        _colour_by_angle(axes, disks, values[rows], label or colour)
    elif values.dtype.kind == "u" and values.max(initial=0) < MOST_KINDS:
        listed = [*names, *map(str, range(len(names), MOST_KINDS))][:max(len(names), int(values.max(initial=0)) + 1)]
        _colour_by_kind(axes, disks, values, rows, listed, label or axis_label(colour))
    else:
        usual = {"psi6": "|ψ6|", "speed": "speed / (length / time)"}.get(colour, axis_label(colour))
        limits = (0.0, 1.0) if colour == "psi6" and limits is None else limits
        _colour_by_value(axes, disks, values[rows].astype(float), label or usual, limits)


def _draw_headings(axes: Any, frame: Frame, places: NDArray[np.float64], radii: NDArray[np.float64], rows: NDArray[np.intp]) -> None:
    """A dot near the rim of each disk, where it is heading."""
    headings = np.stack([frame.columns["heading_x"], frame.columns["heading_y"]], axis=1)[rows]
    dots: Any = Disks(axes, places + 0.6 * radii[rows, None] * headings, 0.25 * radii[rows])
    dots.set_facecolor(INK)


def _border(periodic: bool) -> dict[str, Any]:
    """Periodic edges are thin and dashed, walls are thick."""
    return {"linestyle": (0, (4, 3)), "linewidth": 0.6} if periodic else {"linestyle": "-", "linewidth": 1.4}


def _draw_box(axes: Any, frame: Frame, grid: tuple[int, int] | None, walls: Any = ()) -> None:
    box = frame.box
    if grid is not None:
        style = {"color": INK, "linewidth": 0.4, "alpha": 0.7}
        axes.vlines(np.arange(1, grid[0]) * box.width / grid[0], 0, box.height, **style)
        axes.hlines(np.arange(1, grid[1]) * box.height / grid[1], 0, box.width, **style)
    if box.periodic_x == box.periodic_y:
        axes.add_patch(Rectangle((0, 0), box.width, box.height, fill=False, edgecolor=INK, clip_on=False, **_border(box.periodic_x)))
    else:
        for x in (0, box.width):
            axes.plot([x, x], [0, box.height], color=INK, clip_on=False, **_border(box.periodic_x))
        for y in (0, box.height):
            axes.plot([0, box.width], [y, y], color=INK, clip_on=False, **_border(box.periodic_y))
    for wall in walls:
        axes.plot(*zip(wall["from"], wall["to"]), color=INK, linewidth=1.0, solid_capstyle="butt")
    axes.set(xlim=(0, box.width), ylim=(0, box.height), aspect="equal")
    axes.axis("off")


def _draw_field(axes: Any, frame: Frame, name: str) -> None:
    """From white, the least value or 0 if none is negative, to green, the largest."""
    if not name:
        return
    if name not in frame.fields:
        raise Error(f"there is no field {name!r} to draw\n  hint: there {'are' if frame.fields else 'is'} {', '.join(frame.fields) or 'none'}")
    values, sides = frame.fields[name], (frame.box.width, frame.box.height)
    low, high = min(0.0, values.min()), values.max()
    image = axes.imshow(values, origin="lower", extent=(0.0, sides[0], 0.0, sides[1]), cmap="YlGn", vmin=low, vmax=high if high > low else low + 1.0,
                        interpolation="nearest", zorder=0)
    axes.figure.colorbar(image, ax=axes, label=axis_label(name), location="bottom", fraction=0.05, pad=0.02)


def _values_given(colour: Any, count: int) -> NDArray[np.float64]:
    hint = "give one number for each agent"
    values = as_array(colour, "the colours are", hint)
    if values.shape != (count,):
        raise Error(f"colour has shape {values.shape} for {count} agents\n  hint: {hint}")
    return values.astype(np.float64)


def _limits_given(limits: Any) -> tuple[float, float]:
    hint = "give two numbers, the lower one first"
    low, high = as_numbers(limits, "the limits of the colours", (2,), hint)
    if not low < high:
        raise Error(f"the limits of the colours are {low:g} and {high:g}\n  hint: {hint}")
    return float(low), float(high)


def snapshot(
    agents: Any,
    colour: ArrayLike | str | None = None,
    *,
    label: str = "",
    limits: tuple[float, float] | None = None,
    names: Sequence[str] = (),
    grid: tuple[int, int] | None = None,
    walls: Sequence[Mapping[str, Sequence[float]]] | None = None,
    field: str | None = None,
    axes: Axes | None = None,
) -> Axes:
    """The agents in their box, disks at their true size, round marks where they have no radius.

    :param agents: a :class:`~gridlock.Simulation`, a :class:`~gridlock.Frame`, a :class:`~gridlock.RunDirectory` or a
        :class:`~gridlock.Trajectory`, whose last frame is drawn.
    :param colour: one number for each agent, shape (N,), in the order of ``agents``; or ``"psi6"`` (|ψ6|), ``"speed"``, ``"direction"``,
        ``"neighbourhood"`` (the grid cell), ``"radius"`` or the name of a column. Left out: one colour for each radius.
    :param label: beside the bar of colours.
    :param limits: the ends of the bar, the lower one first.
    :param names: of the kinds 0, 1, 2 …, where the colour is a column of them; those of the model where left out.
    :param grid: cells along both axes of a grid that is drawn over the agents, which are coloured by their cells without ``colour``.
    :param walls: inside the box, as the setting ``walls`` has them; left out, those of the run, which a frame alone does not know.
    :param field: the field beneath the agents of a model that has some; left out, the first by name of more than one cell;
        ``""`` for none.

    Cost: about 2 µs an agent. Above 10,000 agents they are an image also in PDF and SVG files.

    >>> from gridlock import Simulation
    >>> axes = snapshot(Simulation(disks={"count": 16, "packing_fraction": 0.3}), "speed")
    >>> len(axes.collections[0].get_offsets())
    16
    """
    frame = frame_of(agents)
    values = None if colour is None or isinstance(colour, str) else _values_given(colour, len(frame))
    limits = None if limits is None else _limits_given(limits)
    if isinstance(colour, str) and colour not in colours_of(frame):
        values_of(frame, colour)
    if axes is None:
        axes = new_axes(np.clip(frame.box.height / frame.box.width, 0.2, 2.0) * 3.0)
    _draw_field(axes, frame, next((name for name, values in frame.fields.items() if values.size > 1), "") if field is None else field)
    radii = _radii(frame)
    rows, places = _rows_with_images(frame, radii)
    disks: Any = Disks(axes, places, radii[rows])
    if values is not None:
        _colour_by_value(axes, disks, values[rows], label, limits)
    elif isinstance(colour, str):
        _colour_by_name(axes, disks, frame, rows, colour, label, names or frame.value_names.get(colour, ()), limits)
    elif grid is not None:
        disks.set_facecolor(_rgba(NEIGHBOURHOODS)[neighbourhood_colours(frame, *grid)[rows]])
    else:
        _colour_by_radius(axes, disks, radii, rows)
    if "radius" in frame.columns and "heading_x" in frame.columns:
        _draw_headings(axes, frame, places, radii, rows)
    _draw_box(axes, frame, grid, _walls_of(agents) if walls is None else walls)
    return axes
