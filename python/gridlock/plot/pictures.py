"""The pictures of a finished run or sweep, from the files of its directory alone."""

from __future__ import annotations

import json
import os
import pathlib
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from .. import _core
from ..box import Box
from ..errors import Error
from ..files import Frame, RunDirectory, read_xyz
from ..packings import Contacts, contacts
from ..simulation import Simulation
from ..sweeps import SweepDirectory
from .agents import colours_of, frame_of, snapshot, usual_colour
from .charts import combinations, curve, distribution_of_runs, line, mark_contacts, reference, series, sweep, swept_number
from .packings import chart_forces, chart_levels, chart_shear, chart_spectrum, draw_event, packing
from .style import COLUMN, axis_label, style

#: More lines than that cannot be told apart.
MOST_CURVES = 12
#: More samples than that are a line without marks.
MOST_MARKS = 60
#: A grid finer than the disks would hide them.
MOST_CELLS = 40
#: Of what every model can have, a sweep draws these alone.
HEADLINES = ("mean_displacement", "compressibility_factor", "wall_pressure", "collision_rate", "halted_fraction")


class Pictures(NamedTuple):
    """What was drawn, and why something was not."""

    files: list[pathlib.Path]
    notes: list[str]


class _Artist:
    """Draws what can be drawn; a failure becomes a note."""

    def __init__(self, directory: pathlib.Path, pdf: bool, overwrite: bool) -> None:
        self.directory = directory
        self._overwrite = overwrite
        self._extensions = (".svg", ".png", ".pdf") if pdf else (".svg", ".png")
        self.made = Pictures([], [])

    def draw(self, name: str, size: tuple[float, float], draw: Callable[[Any], Any]) -> None:
        """``draw`` is given the axes of a figure of that size in inches."""
        files = [self.directory / (name + extension) for extension in self._extensions]
        try:
            hint = f"move it away, or replace it: gridlock plot {self.directory} --overwrite, in Python overwrite=True"
            _core.protect_files([str(file) for file in files], "", hint, self._overwrite, [])
            for file in files:
                _core.record_result(str(file))
                file.unlink(missing_ok=True)  # one of older data
            figure = Figure(figsize=size, layout="constrained")
            draw(figure.subplots())
            # Once for all files, each of which would be drawn twice otherwise.
            engine = figure.get_layout_engine()
            assert engine is not None
            engine.execute(figure)
            figure.set_layout_engine(None)
            for file in files:
                dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(file.suffix, {})
                figure.savefig(file, metadata=dates)
                self.made.files.append(file)
        except (Error, OSError, ValueError, MemoryError) as error:
            self.note(f"{name}: {error}")

    def chart(self, name: str, draw: Callable[[Any], Any]) -> None:
        self.draw(name, (COLUMN, 0.75 * COLUMN), draw)

    def agents(self, name: str, box: Any, draw: Callable[[Any], Any], *, has_side: bool) -> None:
        width = COLUMN - (0.75 if has_side else 0.1)
        self.draw(name, (COLUMN, float(np.clip(box.height / box.width, 0.2, 2.0)) * width + 0.3), draw)

    def note(self, text: str) -> None:
        self.made.notes.append(text)


def _has(directory: pathlib.Path, name: str) -> bool:
    return (directory / name).exists()


def _state_title(run: RunDirectory, frame: Frame) -> str:
    """When a run ended. After a protocol the packing fraction, and the pressure where no steps followed."""
    when = f"step {frame.clock.step}, t = {frame.clock.time:.4g}"
    if not run.settings.get("protocol"):
        return when
    fraction = f"φ = {np.pi * (frame.radius**2).sum() / frame.box.area:.5g}"
    if len(run.series) > 1:
        return f"{fraction}, {when}"
    pressures = {"pressure": "P D²/ε", "reduced_pressure": "Z"}
    known = [f"{symbol} = {run.results[name].value:.3g}" for name, symbol in pressures.items() if name in list(run.results)]
    return ", ".join([fraction, *known[:1]])


def _draw_last(artist: _Artist, run: RunDirectory, frame: Frame, colour: str) -> None:
    def draw(axes: Any) -> None:
        snapshot(frame, colour, walls=run.settings.get("walls"), axes=axes)
        axes.set_title(_state_title(run, frame))

    artist.agents("final", frame.box, draw, has_side=colour not in ("neighbourhood", "radius"))


def _in_order_of_ids(frame: Frame) -> Frame:
    order = np.argsort(frame.ids)
    return Frame(frame.box, frame.clock, frame.ids[order], {name: values[order] for name, values in frame.columns.items()})


def _start_of_steps(run: RunDirectory, start: Frame) -> Frame | None:
    """The disks from where displacements count: after a protocol, which moves them too, the frame of step 0, where it was kept."""
    if not run.settings.get("protocol"):
        return start
    if not _has(run.path, "trajectory.h5"):
        return None
    frames = run.trajectory
    if len(frames) == 0 or frames.steps[0] != 0:
        return None
    first = frames[0]
    crossed = [f"image_{axis}" for axis in "xy" if getattr(first.box, f"periodic_{axis}")]
    return first if all(image in first.columns for image in crossed) else None


def _draw_displacements(artist: _Artist, start: Frame, last: Frame, walls: Any) -> None:
    """The disks at the end, coloured by how far they have come, in sides of the box."""
    begin = np.searchsorted(start.ids, last.ids)
    is_known = np.isin(last.ids, start.ids)
    moved = last.unwrapped[is_known] - start.unwrapped[begin[is_known]]
    way = np.full(len(last), np.nan)
    way[is_known] = np.hypot(*moved.T) / np.sqrt(last.box.area)

    def draw(axes: Any) -> None:
        snapshot(last, way, label="displacement / side", walls=walls, axes=axes)
        axes.set_title(f"after {last.clock.step - start.clock.step} steps")

    artist.agents("final", last.box, draw, has_side=True)


def _draw_start(artist: _Artist, start: Frame, cells: int, walls: Any, *, is_before_protocol: bool) -> None:
    shows_grid = 0 < cells <= MOST_CELLS
    fraction = np.pi * (start.radius**2).sum() / start.box.area

    def draw(axes: Any) -> None:
        snapshot(start, grid=(cells, cells) if shows_grid else None, walls=walls, axes=axes)
        axes.set_title(f"start{' of the protocol' if is_before_protocol else ''}, φ = {fraction:.4g}")

    artist.agents("start", start.box, draw, has_side=not shows_grid and len(np.unique(start.radius)) > 1)


def _draw_curves(artist: _Artist, run: RunDirectory, last: Frame) -> None:
    """The curves that a run has measured, of whatever model; distances in mean diameters."""
    radii = last.columns.get("radius")
    if _has(run.path, "pair_correlation.csv"):
        def draw(axes: Any) -> None:
            curve(run, "pair_correlation", axes=axes)
            if radii is not None:
                mark_contacts(axes, radii)

        artist.chart("pair_correlation", draw)
        if "orientation_correlation" in (run.table("pair_correlation").dtype.names or ()):
            artist.chart("orientation_correlation", partial(_draw_curve, run, "orientation_correlation"))
    if _has(run.path, "speed_distribution.csv"):
        artist.chart("speed_distribution", lambda axes: curve(run, "speed_distribution", axes=axes))
    for name in ("density_profile_x", "density_profile_y", "mean_squared_displacement", "local_density", "cluster_sizes",
                 "stress_growth", "free_time_distribution", "free_path_distribution"):
        if _has(run.path, f"{name}.csv"):
            artist.chart(name, partial(_draw_curve, run, name))


def _draw_curve(run: RunDirectory, name: str, axes: Any) -> None:
    curve(run, name, axes=axes)


def _draw_series(artist: _Artist, run: RunDirectory, column: str) -> None:
    def draw(axes: Any) -> None:
        series(run, column, axes=axes)
        if np.nanmin(run.series[column], initial=0.0) >= 0.0:
            axes.set_ylim(0.0, None)

    artist.chart(column, draw)


def _draw_levels(artist: _Artist, run: RunDirectory) -> None:
    """The pressures at which a protocol kept a minimum."""
    levels = run.table("levels")
    levels = levels[levels["pressure"] > 0.0]
    if len(levels) > 1:
        names = {row["stage"]: f"{row['stage']:.0f} {row['name']}" for row in run.table("stages")}
        artist.chart("levels", lambda axes: chart_levels(axes, levels, names))


def _draw_density(artist: _Artist, run: RunDirectory) -> None:
    """The packing fraction over the sweeps of each stage at constant pressure."""
    table = run.table("swap_density")
    stages = np.unique(table["stage"])

    def draw(axes: Any) -> None:
        for stage in stages:
            of_stage = table[table["stage"] == stage]
            line(axes, of_stage["sweeps_done"], of_stage["packing_fraction"], label=f"stage {stage:.0f}" if len(stages) > 1 else "")
        axes.set(xlabel="sweeps", ylabel="packing fraction φ")
        if len(stages) > 1:
            axes.legend()

    artist.chart("swap_density", draw)


def _box_at_event(run: RunDirectory, last: Frame, event: Any) -> Box:
    """The box at the last strain before an event: that of the last frame, without the strain of later steps.

    The frame of an interrupted stage is that of its start.
    """
    minima = run.table("shear")
    ended = list(run.table("stages")["stage"]) if _has(run.path, "stages.csv") else []
    box = last.box
    for stage in np.unique(minima["stage"])[::-1]:
        if stage < event["stage"]:
            break
        strains = minima["strain"][minima["stage"] == stage]
        strain = (event["strain"] if stage == event["stage"] else strains[0]) - (strains[-1] if stage in ended else strains[0])
        if run.settings["protocol"][int(stage) - 1].get("deformation") == "pure_shear":
            stretch = float(np.exp(0.5 * strain))
            box = Box(box.width * stretch, box.height / stretch, box.periodic, box.tilt * stretch**2)
        else:
            box = Box(box.width, box.height, box.periodic, box.tilt + float(strain))
    return box


def _draw_shear(artist: _Artist, run: RunDirectory, last: Frame) -> None:
    """Stress against strain of each stage of shear, with a mark where the stress drops, and the motions in the largest drop."""
    minima = run.table("shear")
    events = run.table("shear_events") if _has(run.path, "shear_events.csv") else minima[:0]
    if len(minima) > 1:
        artist.chart("shear", lambda axes: chart_shear(axes, minima, events))
    if len(events) == 0 or not _has(run.path, "shear_motions.csv"):
        return
    event = events[np.argmax(events["stress_drop"])]
    number = 1 + np.count_nonzero(events["stage"][: np.argmax(events["stress_drop"])] == event["stage"])
    motions = run.table("shear_motions")
    motions = motions[(motions["stage"] == event["stage"]) & (motions["event"] == number)]
    if len(motions) > 0:
        box = _box_at_event(run, last, event)
        artist.agents("shear_event", box, lambda axes: draw_event(axes, box, event, motions), has_side=False)


def _require_start_of_steps(first: Frame | None, run: RunDirectory) -> Frame:
    if first is None or len(run.series) < 2:
        raise Error(f"{run.path} does not tell where its disks were after the protocol, from where displacements count\n"
                    "  hint: runs of steps with trajectory.every and the columns image_x and image_y keep that frame")
    return first


def _draw_disks(artist: _Artist, run: RunDirectory, last: Frame, colour: str) -> None:
    file = run.path / "config.resolved.toml"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the run has told them
        simulation = Simulation(file, threads=1)
    start = _in_order_of_ids(frame_of(simulation))
    settings = run.settings
    has_protocol = bool(settings.get("protocol"))
    first = _start_of_steps(run, start)
    # Without steps after a protocol nothing was displaced in a run.
    has_steps = len(run.series) > 1
    if colour == "displacement" or (colour == "" and has_steps and first is not None):
        _draw_displacements(artist, _require_start_of_steps(first, run), last, settings.get("walls"))
    elif not has_steps and _has(run.path, "contacts.csv") and colour in ("", "psi6", "coordination"):
        found = contacts(last.positions, last.radius, last.box, potential=settings["soft"]["potential"], stiffness=False)
        _draw_packing(artist, "final", found, colour, _state_title(run, last))
    else:
        _draw_last(artist, run, last, colour or "psi6")
    cells = 0 if has_protocol else settings["engine"].get("cells", 0)
    _draw_start(artist, start, cells, settings.get("walls"), is_before_protocol=has_protocol)
    # The paper's mark of jamming, of its rule between its walls.
    is_as_in_paper = not start.box.periodic_x and not start.box.periodic_y and settings["engine"]["kind"] in ("stepped", "tiled")
    if has_steps:
        _draw_mean_displacement(artist, run, 0.1 if is_as_in_paper else None)
    if _has(run.path, "levels.csv"):
        _draw_levels(artist, run)
    if _has(run.path, "swap_density.csv"):
        _draw_density(artist, run)
    if _has(run.path, "shear.csv"):
        _draw_shear(artist, run, last)
    _draw_curves(artist, run, last)


def _draw_mean_displacement(artist: _Artist, run: RunDirectory, mark: float | None) -> None:
    """On logarithmic axes, where free flight, cages and diffusion differ, with the error at the end."""
    def draw(axes: Any) -> None:
        table, result = run.series, run.results.get("mean_displacement")
        series(run, "mean_displacement", axes=axes)
        axes.lines[0].set_marker("o" if len(table) <= MOST_MARKS else "")
        error = result.error if result is not None else None
        axes.errorbar(table["time"][-1], table["mean_displacement"][-1], error or 0.0, color=axes.lines[0].get_color())
        if np.count_nonzero((table["time"] > 0.0) & (table["mean_displacement"] > 0.0)) > 1:
            axes.set(xscale="log", yscale="log")
        if mark is not None:
            reference(axes, mark, f"{100 * mark:g} % of the box")

    artist.chart("displacement", draw)


def _parts_of_whole(run: RunDirectory, last: Frame) -> dict[str, list[str]]:
    """Columns of the series that count the agents of each value of a column, by its name: susceptible, infected, recovered."""
    present = run.series.dtype.names or ()
    return {column: names for column, names in last.value_names.items() if len(names) > 1 and all(name in present for name in names)}


def _draw_model(artist: _Artist, run: RunDirectory, last: Frame, colour: str) -> None:
    """A run of a model: its agents at the end, every column of its series against time, and its curves."""
    if colour == "displacement":
        raise Error("final.xyz does not tell how far the agents of a model have come\n"
                    "  hint: gridlock movie DIR --colour displacement shows it, where the run keeps frames")
    _draw_last(artist, run, last, colour or usual_colour(last))
    together = _parts_of_whole(run, last)
    for column, names in together.items():
        def draw(axes: Any, column: str = column, names: list[str] = names) -> None:
            series(run, names, axes=axes)
            axes.set(ylabel=f"agents by {axis_label(column)}", ylim=(0.0, None))

        artist.chart(column, draw)
    for name in run.series.dtype.names or ():
        if name not in ("step", "time") and not any(name in names for names in together.values()):
            _draw_series(artist, run, name)
    _draw_curves(artist, run, last)


def _draw_run(artist: _Artist, run: RunDirectory, colour: str) -> None:
    last = run.final
    is_of_disks = run.settings.get("model", {}).get("kind", "disks") == "disks"
    colour = "neighbourhood" if colour == "neighborhood" else colour
    is_packing = is_of_disks and _has(run.path, "contacts.csv")
    if colour and colour != "displacement" and colour not in colours_of(last) and not (is_packing and colour == "coordination"):
        more = ("displacement, " if is_of_disks else "") + ("coordination, " if is_packing else "")
        raise Error(f"the agents have no column \"{colour}\"\n  hint: these agents can be coloured by {more}{', '.join(colours_of(last))}")
    (_draw_disks if is_of_disks else _draw_model)(artist, run, last, colour)


def _sweep_title(means: Any) -> str:
    """How many runs are behind a point."""
    least, most = means["runs"].min(), means["runs"].max()
    if most == 1:
        return "each point is one run"
    return f"means over {most} runs" if least == most else f"means over {least} to {most} runs"


def _drawn_results(table: Any) -> list[str]:
    """Results with errors, but for those of every model that are no headlines, and those that are yes or no and no share between."""
    of_all_models = {column.name for column in Simulation(disks={"count": 1}).columns}
    names = list(table.dtype.names or ())
    return [name for name in names if f"{name}_error" in names and (name not in of_all_models or name in HEADLINES)
            and not (name.startswith("is_") and np.isin(table[name], (0.0, 1.0)).all())]


def _draw_sweep(artist: _Artist, made: SweepDirectory) -> None:
    means = made.means
    against = swept_number(means)
    if against is None:
        if len(means) == 1:
            _draw_runs(artist, made)
        return
    for name in _drawn_results(means):
        count = len(combinations(means, name, against))
        if count > MOST_CURVES:
            artist.note(f"{name}: {count} curves are too many for one picture; means.csv has them")
        elif count > 0:
            def draw(axes: Any, name: str = name) -> None:
                sweep(made, name, against=against, axes=axes).set_title(_sweep_title(means))

            artist.chart(name, draw)


def _draw_runs(artist: _Artist, made: SweepDirectory) -> None:
    """A sweep over seeds alone: how its results are distributed."""
    if not _has(made.path, "sweep.csv"):
        return
    table = made.table
    for name in _drawn_results(table):
        values = table[name][np.isfinite(table[name])]
        if len(np.unique(values)) > 2:
            def draw(axes: Any, name: str = name, values: Any = values) -> None:
                distribution_of_runs(axes, values)
                axes.set(xlabel=axis_label(name), ylabel="runs")

            artist.chart(name, draw)


def _draw_packing(artist: _Artist, name: str, found: Contacts, colour: str, title: str) -> None:
    def draw(axes: Any) -> None:
        packing(found, colour or "psi6", axes=axes)
        axes.set_title(title)

    artist.agents(name, found.box, draw, has_side=True)
    if len(found.relative_forces) > 0:
        artist.chart("forces", lambda axes: chart_forces(axes, found))


def _draw_contacts(artist: _Artist, colour: str) -> None:
    """What ``gridlock contacts`` has written: the packing with its chains of force, and how its forces and its area are distributed."""
    directory = artist.directory
    summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
    frame = read_xyz(directory / "packing.xyz")
    found = contacts(frame.positions, frame.radius, frame.box, potential=summary["potential"], tolerance=summary["tolerance"], stiffness=False)
    title = f"φ = {found.packing_fraction:.5g}, Z = {found.contact_number:.4g}, {found.is_rattler.sum()} rattlers"
    _draw_packing(artist, "packing", found, colour, title)
    if _has(directory, "spectral_density.csv"):
        artist.chart("spectral_density", lambda axes: chart_spectrum(axes, directory / "spectral_density.csv", found))


def pictures(directory: str | os.PathLike[str], colour: str = "", *, pdf: bool = False, overwrite: bool = False) -> Pictures:
    """Draws the pictures of a finished run, sweep or packing into its directory, as ``gridlock plot`` does: SVG and PNG, with ``pdf`` PDF too.

    A run: start, final (coloured by displacement), displacement, speed_distribution, pair_correlation, orientation_correlation, and the curves that its
    settings ask for: density profiles, mean_squared_displacement, local_density, cluster_sizes. After a protocol displacements count
    from its end, where the frame of step 0 was kept; a run that ends with a packing has its contacts in final, and forces, levels and shear; after stages at constant pressure swap_density. A run of a model: final, and every column of its series, with the numbers of agents of each kind in one chart. A sweep:
    results against the swept number with the most values, one line for each combination of the others; over seeds alone, a histogram of
    each result. A packing, as ``gridlock contacts -o`` writes it: packing, forces, spectral_density.

    A picture whose name a file of the user has is left out, with a note, unless ``overwrite``.

    :param colour: of the disks of a packing, as for :func:`packing`; of the agents at the end, as for :func:`snapshot`, or
        ``"displacement"``.
    :returns: the files, and a note on each picture that could not be drawn.
    :raises Error: for a directory that holds neither, and for a colour that the agents do not have, before anything is drawn.
    """
    path = pathlib.Path(directory)
    artist = _Artist(path, pdf, overwrite)
    with style():
        if _has(path, "config.resolved.toml") and _has(path, "final.xyz"):
            _draw_run(artist, RunDirectory(path), colour)
        elif _has(path, "config.resolved.toml") and _has(path, "summary.json"):
            raise Error(f"{path} holds a run without its last state\n  hint: pictures need final.xyz: leave run.final_state = false out")
        elif _has(path, "contacts.csv") and _has(path, "packing.xyz"):
            _draw_contacts(artist, colour)
        elif _has(path, "means.csv"):
            if colour:
                raise Error("a sweep has no agents to colour\n  hint: name the directory of one of its runs, below runs/")
            _draw_sweep(artist, SweepDirectory(path))
        else:
            raise Error(f"{path} holds neither a run nor a sweep\n  hint: name a directory that gridlock run, gridlock sweep or gridlock contacts has written")
    return artist.made
