"""The pictures of a finished run or sweep, from the files of its directory alone."""

from __future__ import annotations

import json
import os
import pathlib
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from .. import _core
from ..errors import Error
from ..files import Frame, RunDirectory, read_xyz
from ..packings import Contacts, contacts
from ..simulation import Simulation
from ..sweeps import SweepDirectory
from .agents import colours_of, frame_of, snapshot, usual_colour
from .charts import combinations, curve, line, reference, series, sweep, swept_number
from .packings import packing
from .style import COLUMN, style

#: More lines than that cannot be told apart.
MOST_CURVES = 12
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
            hint = f"move it away, or draw with gridlock plot {self.directory} --overwrite"
            _core.protect_files([str(file) for file in files], "", hint, self._overwrite)
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


def _draw_last(artist: _Artist, frame: Frame, colour: str) -> None:
    def draw(axes: Any) -> None:
        snapshot(frame, colour, axes=axes)
        axes.set_title(f"step {frame.clock.step}, t = {frame.clock.time:.4g}")

    artist.agents("final", frame.box, draw, has_side=colour not in ("neighbourhood", "radius"))


def _draw_displacements(artist: _Artist, start: Frame, last: Frame) -> None:
    """The disks at the end, coloured by how far they have come, in sides of the box."""
    begin = np.searchsorted(start.ids, last.ids)
    is_known = np.isin(last.ids, start.ids)
    moved = last.unwrapped[is_known] - start.unwrapped[begin[is_known]]
    way = np.full(len(last), np.nan)
    way[is_known] = np.hypot(*moved.T) / np.sqrt(last.box.area)

    def draw(axes: Any) -> None:
        snapshot(last, way, label="displacement / side", axes=axes)
        axes.set_title(f"after {last.clock.step - start.clock.step} steps")

    artist.agents("final", last.box, draw, has_side=True)


def _draw_start(artist: _Artist, start: Frame, cells: int) -> None:
    shows_grid = 0 < cells <= MOST_CELLS
    fraction = np.pi * (start.radius**2).sum() / start.box.area

    def draw(axes: Any) -> None:
        snapshot(start, grid=(cells, cells) if shows_grid else None, axes=axes)
        axes.set_title(f"start, φ = {fraction:.4g}")

    artist.agents("start", start.box, draw, has_side=not shows_grid and len(np.unique(start.radius)) > 1)


def _draw_curves(artist: _Artist, run: RunDirectory, last: Frame) -> None:
    """The curves that a run has measured, of whatever model; distances in mean diameters."""
    radii = last.columns.get("radius")
    if _has(run.path, "pair_correlation.csv"):
        def draw(axes: Any) -> None:
            curve(run, "pair_correlation", unit=1.0 if radii is None else 2.0 * radii.mean(), axes=axes)
            if radii is not None:
                axes.set_xlabel("distance r / diameter σ" if radii.min() == radii.max() else "distance r / mean diameter")

        artist.chart("pair_correlation", draw)
    if _has(run.path, "speed_distribution.csv"):
        artist.chart("speed_distribution", lambda axes: curve(run, "speed_distribution", axes=axes))


def _draw_series(artist: _Artist, run: RunDirectory, column: str, *, name: str = "", mark: float | None = None) -> None:
    def draw(axes: Any) -> None:
        series(run, column, axes=axes)
        if mark is not None:
            reference(axes, mark, f"{100 * mark:g} % of the box")
        if np.nanmin(run.series[column], initial=0.0) >= 0.0:
            axes.set_ylim(0.0, None)

    artist.chart(name or column, draw)


def _draw_levels(artist: _Artist, run: RunDirectory) -> None:
    """The pressures at which a protocol kept a minimum."""
    levels = run.table("levels")
    levels = levels[levels["pressure"] > 0.0]
    if len(levels) < 2:
        return

    def draw(axes: Any) -> None:
        for stage in np.unique(levels["stage"]):
            of_stage = levels[levels["stage"] == stage]
            axes.plot(of_stage["packing_fraction"], of_stage["pressure"], "o-", label=f"stage {stage:.0f}")
        axes.set_yscale("log")
        axes.set_xlabel("packing fraction φ")
        axes.set_ylabel("pressure P D²/ε")
        axes.legend()

    artist.chart("levels", draw)


def _draw_disks(artist: _Artist, run: RunDirectory, last: Frame, colour: str) -> None:
    file = run.path / "config.resolved.toml"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the run has told them
        simulation = Simulation(file, threads=1)
    start = frame_of(simulation)
    order = np.argsort(start.ids)
    start = Frame(start.box, start.clock, start.ids[order], {name: values[order] for name, values in start.columns.items()})
    # Without steps after a protocol nothing was displaced in a run.
    has_steps = len(run.series) > 1
    if colour == "displacement" or (colour == "" and has_steps):
        _draw_displacements(artist, start, last)
    else:
        _draw_last(artist, last, colour or "psi6")
    settings = run.settings
    _draw_start(artist, start, settings["engine"].get("cells", 0))
    # The paper's mark of jamming, of its rule between its walls.
    is_as_in_paper = not start.box.periodic and settings["engine"]["kind"] in ("stepped", "tiled")
    if has_steps:
        _draw_series(artist, run, "mean_displacement", name="displacement", mark=0.1 if is_as_in_paper else None)
    if _has(run.path, "levels.csv"):
        _draw_levels(artist, run)
    _draw_curves(artist, run, last)


def _draw_model(artist: _Artist, run: RunDirectory, last: Frame, colour: str) -> None:
    """A run of a model: its agents at the end, every column of its series against time, and its curves."""
    if colour == "displacement":
        raise Error("final.xyz does not tell how far the agents of a model have come\n"
                    "  hint: gridlock movie DIR --colour displacement shows it, where the run keeps frames")
    _draw_last(artist, last, colour or usual_colour(last))
    for name in run.series.dtype.names or ():
        if name not in ("step", "time"):
            _draw_series(artist, run, name)
    _draw_curves(artist, run, last)


def _draw_run(artist: _Artist, run: RunDirectory, colour: str) -> None:
    last = run.final
    is_of_disks = run.settings.get("model", {}).get("kind", "disks") == "disks"
    colour = "neighbourhood" if colour == "neighborhood" else colour
    if colour and colour != "displacement" and colour not in colours_of(last):
        more = "displacement, " if is_of_disks else ""
        raise Error(f"the agents have no column \"{colour}\"\n  hint: these agents can be coloured by {more}{', '.join(colours_of(last))}")
    (_draw_disks if is_of_disks else _draw_model)(artist, run, last, colour)


def _sweep_title(means: Any) -> str:
    """How many runs are behind a point."""
    least, most = means["runs"].min(), means["runs"].max()
    if most == 1:
        return "each point is one run"
    return f"means over {most} runs" if least == most else f"means over {least} to {most} runs"


def _draw_sweep(artist: _Artist, made: SweepDirectory) -> None:
    means = made.means
    against = swept_number(means)
    if against is None:
        return
    of_all_models = {column.name for column in Simulation(disks={"count": 1}).columns}
    names = list(means.dtype.names or ())
    for name in names:
        if f"{name}_error" not in names or (name in of_all_models and name not in HEADLINES):
            continue
        count = len(combinations(means, name, against))
        if count > MOST_CURVES:
            artist.note(f"{name}: {count} curves are too many for one picture; means.csv has them")
        elif count > 0:
            def draw(axes: Any, name: str = name) -> None:
                sweep(made, name, against=against, axes=axes).set_title(_sweep_title(means))

            artist.chart(name, draw)


def _draw_contacts(artist: _Artist, colour: str) -> None:
    """What ``gridlock contacts`` has written: the packing with its chains of force, and how its forces and its area are distributed."""
    directory = artist.directory
    summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
    frame = read_xyz(directory / "packing.xyz")
    found = contacts(frame.positions, frame.radius, frame.box, potential=summary["potential"], tolerance=summary["tolerance"], stiffness=False)

    def draw(axes: Any) -> None:
        packing(found, colour or "psi6", axes=axes)
        axes.set_title(f"φ = {found.packing_fraction:.5g}, Z = {found.contact_number:.4g}, {found.is_rattler.sum()} rattlers")

    artist.agents("packing", found.box, draw, has_side=True)
    if len(found.relative_forces) > 0:
        artist.chart("forces", lambda axes: _chart_forces(axes, found))
    if _has(directory, "spectral_density.csv"):
        artist.chart("spectral_density", lambda axes: _chart_spectrum(axes, directory, found))


def _chart_forces(axes: Any, found: Contacts) -> None:
    for label, is_drawn in (("extended", ~found.is_of_buckler), ("of bucklers", found.is_of_buckler)):
        forces = found.relative_forces[is_drawn]
        if len(forces) > 0:
            line(axes, forces, np.arange(1, len(forces) + 1) / len(forces), label=f"{label} ({len(forces)})")
    axes.set(xscale="log", yscale="log", xlabel="force f/⟨f⟩", ylabel="share of forces up to f")
    axes.legend()


def _chart_spectrum(axes: Any, directory: pathlib.Path, found: Contacts) -> None:
    q, density = np.loadtxt(directory / "spectral_density.csv", delimiter=",", skiprows=1, ndmin=2)[:, :2].T
    diameter = found.smallest_diameter
    line(axes, q * diameter, density / diameter**2)
    axes.set(xscale="log", yscale="log", xlabel="wave number q D", ylabel="spectral density χ(q) / D²")


def pictures(directory: str | os.PathLike[str], colour: str = "", *, pdf: bool = False, overwrite: bool = False) -> Pictures:
    """Draws the pictures of a finished run, sweep or packing into its directory, as ``gridlock plot`` does: SVG and PNG, with ``pdf`` PDF too.

    A run: start, final (coloured by displacement), displacement, speed_distribution, pair_correlation. A run of a model: final,
    and every column of its series. A sweep: results against the swept number with the most values, one line for each combination of the
    others. A packing, as ``gridlock contacts -o`` writes it: packing, forces, spectral_density.

    A picture whose name a file of the user has is left out, with a note, unless ``overwrite``.

    :param colour: of the disks of a packing, as for :func:`packing`; of the agents at the end, as for :func:`snapshot`, or ``"displacement"``.
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
