"""Readers of what Gridlock writes: run directories, sweeps, trajectories, states, tables."""

from __future__ import annotations

import copy
import dataclasses
import json
import operator
import os
import pathlib
import sys
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsIndex, overload

import numpy as np

from . import _core, converters, formats
from .arrays import MOST_STEPS, as_count, as_number
from .box import Box, box_of
from .errors import Error
from .networks import Edges, graph_of_frame
from .settings import as_threads
from .simulation import Clock, Result, Results
from .tables import structured

if TYPE_CHECKING:
    from numpy.typing import NDArray


#: Columns that change where lengths are in diameters.
LENGTHS = ("x", "y", "radius", "velocity_x", "velocity_y")


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """All agents at one step, in the order of their Ids."""

    box: Box
    clock: Clock
    ids: NDArray[np.uint64]  #: shape (N,)
    columns: dict[str, NDArray[Any]]  #: by name, each of shape (N,)
    value_names: dict[str, list[str]] = dataclasses.field(default_factory=dict)  #: of the numbers 0, 1, 2 … of a column, by its name
    fields: dict[str, NDArray[np.float64]] = dataclasses.field(default_factory=dict)  #: of a model, by name, each of shape (rows, columns)
    networks: dict[str, Edges] = dataclasses.field(default_factory=dict)  #: of a model, by name

    def __len__(self) -> int:
        return len(self.ids)

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self.columns[name]
        except KeyError:
            raise AttributeError(f"the frame has no column {name!r}; it has {', '.join(self.columns)}") from None

    @property
    def positions(self) -> NDArray[np.float64]:
        """Inside the box, shape (N, 2)."""
        positions: NDArray[np.float64] = np.stack([self.columns["x"], self.columns["y"]], axis=1)
        return positions

    @property
    def unwrapped(self) -> NDArray[np.float64]:
        """Positions that do not jump at periodic edges, shape (N, 2): for displacements.

        :raises Error: where the frame does not have the columns ``image_x`` and ``image_y`` of the axes that are periodic.
        """
        crossed = [(axis, f"image_{name}") for axis, name in enumerate("xy") if getattr(self.box, f"periodic_{name}")]
        if any(image not in self.columns for _, image in crossed):
            raise Error(
                "the frame does not say how often an agent has crossed the edges\n"
                "  hint: of disks, keep the columns image_x and image_y in trajectory.columns; a model of your own needs such columns, "
                "of type int32, in which move() counts"
            )
        unwrapped = self.positions
        for axis, image in crossed:
            unwrapped[:, axis] += self.columns[image] * (self.box.width, self.box.height)[axis]
            if axis == 1:
                unwrapped[:, 0] += self.columns[image] * self.box.shift
        return unwrapped

    @property
    def kinds(self) -> NDArray[np.int64]:
        """The kind of each agent, shape (N,): by the column ``species`` or ``kind``, else by radius and mass, the smallest first.

        :raises Error: for frames with none of these columns, as those of most models.
        """
        for name in ("species", "kind"):
            if name in self.columns:
                return np.unique(self.columns[name], return_inverse=True)[1].reshape(-1)
        named = [self.columns[name] for name in ("radius", "mass") if name in self.columns]
        if not named:
            raise Error(
                "the frame has neither species, radii nor masses, so there are no kinds\n"
                "  hint: keep the column radius or species in trajectory.columns; where all agents are alike, no kinds are needed"
            )
        return np.unique(np.stack(named, axis=1), axis=0, return_inverse=True)[1].reshape(-1)

    def of_kind(self, kind: str) -> Frame:
        """The agents of one kind, by the names of the values of the column ``kind``; columns that they do not have are 0.

        :raises Error: for a kind that the model does not have.
        """
        names = self.value_names.get("kind", [])
        if kind not in names:
            raise Error(f"the frame has no kind {kind!r}\n  hint: it has {', '.join(names) or 'none'}")
        rows = self.columns["kind"] == names.index(kind)
        columns = {name: values[rows] for name, values in self.columns.items()}
        return dataclasses.replace(self, ids=self.ids[rows], columns=columns)

    @property
    def diameter(self) -> float:
        """The mean diameter of the agents.

        :raises Error: for agents without a radius.
        """
        if "radius" not in self.columns or len(self) == 0:
            raise Error("the frame has no radii, so there is no diameter\n  hint: keep the column radius in trajectory.columns")
        return 2 * float(self.columns["radius"].mean())

    def in_diameters(self, diameter: float | None = None) -> Frame:
        """The same frame with lengths in diameters: the box, x, y, radius, and the velocities, which are in diameters per time.

        :param diameter: the unit; the mean :attr:`diameter` where left out.
        """
        unit = self.diameter if diameter is None else as_number(diameter, "the diameter")
        columns = {name: values / unit if name in LENGTHS else values for name, values in self.columns.items()}
        box = Box(self.box.width / unit, self.box.height / unit, self.box.periodic, self.box.tilt)
        return dataclasses.replace(self, box=box, columns=columns)

    def __repr__(self) -> str:
        step, time = self.clock
        return f"<gridlock.Frame of {len(self)} agents, step {step}, time {time:.6g}: {', '.join(self.columns)}>"

    def to_ase(self, *, unwrapped: bool = True) -> Any:
        """An ``ase.Atoms`` of symbol X, with z = 0 and a cell of height 1; kinds and further columns are in arrays of their names.

        :param unwrapped: False for positions inside the box.
        :raises Error: where ASE is not installed, and as :attr:`unwrapped`.
        """
        return converters.to_ase(self, unwrapped=unwrapped)

    def to_mdanalysis(self, *, unwrapped: bool = True) -> Any:
        """An ``MDAnalysis.Universe`` of this frame; see :meth:`Trajectory.to_mdanalysis`."""
        return converters.to_mdanalysis([self], unwrapped=unwrapped)

    def to_networkx(self, network: str) -> Any:
        """A ``networkx.Graph`` or ``DiGraph`` of a network: nodes are Ids with all columns, edges have a weight.

        :raises Error: where NetworkX is not installed, and for a network that the frame does not have.
        """
        return graph_of_frame(self, network)

    def to_gsd(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes a GSD file of this frame; see :meth:`Trajectory.to_gsd`."""
        converters.to_gsd([self], path, overwrite=overwrite)


class FrameContacts(NamedTuple):
    """The contacts between agents at one time, with their forces: C contacts."""

    clock: Clock
    ids: NDArray[np.uint64]  #: of the two agents of each contact, the smaller Id first; shape (C, 2)
    forces: NDArray[np.float64]  #: in ε per length, shape (C,)

    def __repr__(self) -> str:
        return f"<gridlock.FrameContacts: {len(self.ids)} contacts at step {self.clock.step}>"


def frame_of_values(values: Any, value_names: dict[str, list[str]] | None = None) -> Frame:
    ids, columns, box, step, time, *others = values  # of files of other programs without fields and networks
    fields, networks = others or ({}, {})
    names = {name: names for name, names in (value_names or {}).items() if name in columns}
    return Frame(box_of(box), Clock(step, time), ids, columns, names, fields, {name: Edges(*edges) for name, edges in networks.items()})


def read_xyz(path: str | os.PathLike[str], *, frame: int | None = None) -> Frame:
    """A state in extended XYZ, packed by gzip or not. Of a periodic box positions come inside, and images count that.

    :param frame: of a file with several, from 0, or from -1 for the last.
    :raises Error: with line and column for anything damaged, and for a file of several frames where none is chosen.
    """
    found = frame_of_values(_core.read_xyz(os.fspath(path), frame))
    if (_core.recognize_format(os.fspath(path)) or ("",))[0] == "hdf5":
        _warn_of_left_out(_core.Trajectory(os.fspath(path)))
    return found


def _warn_of_left_out(frames: Any) -> None:
    """Warns of what a trajectory has and its frames have not, at the line of the user that opens it."""
    note = frames.note_on_left_out()
    if not note:
        return
    level, caller = 1, sys._getframe()
    while caller is not None and caller.f_code.co_filename == __file__:
        level, caller = level + 1, caller.f_back  # type: ignore[assignment]
    warnings.warn(note, stacklevel=level)


class Trajectory:
    """The frames of a file, read one at a time; of a run that still writes those up to its last checkpoint.

    It reads H5MD, of Gridlock and of other programs, dumps of LAMMPS in text, and GSD where the package gsd is installed: in the plane,
    with the columns that the file has. Boxes may be sheared in H5MD and extended XYZ, and are rectangles in the other formats.

    ``len(trajectory)``, ``trajectory[3]``, ``trajectory[-1]``, ``for frame in trajectory``; ``steps`` and ``times`` of all.
    ``trajectory[10:]`` and ``trajectory.since(1000)`` are trajectories too: with fewer frames, of the same file.

    :raises Error: for damage, with the place, and for what does not fit: agents in space, sheared boxes, boxes that are periodic in one
        direction alone.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(path)
        self._core: Any = formats.frames_of(os.fspath(path))
        self._frames = range(self._core.size())
        _warn_of_left_out(self._core)

    def __len__(self) -> int:
        return len(self._frames)

    @overload
    def __getitem__(self, k: SupportsIndex) -> Frame: ...
    @overload
    def __getitem__(self, k: slice) -> Trajectory: ...
    def __getitem__(self, k: SupportsIndex | slice) -> Frame | Trajectory:
        if isinstance(k, slice):
            if k.step is not None and k.step < 1:
                raise Error(f"frames in steps of {k.step}\n  hint: frames of a trajectory ascend in time")
            part = copy.copy(self)
            part._frames = self._frames[k]
            return part
        if not -len(self) <= operator.index(k) < len(self):
            raise IndexError(f"there is no frame {k} among {len(self)}")
        return frame_of_values(self._core.frame(self._frames[k]), self._core.value_names())

    def __iter__(self) -> Iterator[Frame]:
        return (self[k] for k in range(len(self)))

    def since(self, step: int) -> Trajectory:
        """The frames from a step on: those after the equilibration."""
        first = as_count(step, "the step", "use a whole number, 0 or above", least=0, most=MOST_STEPS)
        return self[int(np.searchsorted(self.steps, np.uint64(first))) :]

    @property
    def settings(self) -> dict[str, Any]:
        """All settings of the run that wrote it; none in a file of another program."""
        return settings_in(self._core.configuration())

    @property
    def steps(self) -> NDArray[np.uint64]:
        """Of each frame, shape (frames,)."""
        steps: NDArray[np.uint64] = self._core.steps()[self._frames.start : self._frames.stop : self._frames.step]
        return steps

    @property
    def times(self) -> NDArray[np.float64]:
        """Of each frame, shape (frames,)."""
        times: NDArray[np.float64] = self._core.times()[self._frames.start : self._frames.stop : self._frames.step]
        return times

    @property
    def contacts(self) -> FrameContacts | None:
        """The contacts of the packing that the run began with; ``None`` where no protocol had ended in a minimum of the energy.

        Those with walls are left out; ``gridlock.contacts(frame.positions, frame.radius, frame.box)`` has them too.
        """
        found: Any = self._core.contacts()
        return None if found is None else FrameContacts(Clock(*found[:2]), *found[2:])

    def positions(self, *, unwrapped: bool = True) -> NDArray[np.float64]:
        """Of all frames, shape (frames, N, 2), for a run without births and deaths: what :func:`dynamics` takes.

        In diameters: ``trajectory.positions() / trajectory.diameter``.

        :raises Error: for births and deaths, no frames, and as :attr:`Frame.unwrapped`.
        """
        self.expect_frames()
        first, frames = self[0], []
        for frame in self:
            converters.expect_same_agents(first, frame)
            frames.append(frame.unwrapped if unwrapped else frame.positions)
        return np.array(frames)

    def expect_frames(self) -> None:
        """Refuses a trajectory without frames.

        :raises Error: with the steps that the file has.
        """
        if len(self) > 0:
            return
        steps = self._core.steps()
        if len(steps) == 0:
            raise Error(f"{self.path} has no frames\n  hint: wait for the first, or set trajectory.every")
        raise Error(f"this part of {self.path} has no frames\n"
                    f"  hint: its {len(steps)} frames are those of steps {steps[0]} to {steps[-1]}")

    @property
    def kinds(self) -> NDArray[np.int64]:
        """The kind of each agent, shape (N,), as :attr:`Frame.kinds` of the first frame."""
        self.expect_frames()
        return self[0].kinds

    @property
    def diameter(self) -> float:
        """The mean diameter, as :attr:`Frame.diameter` of the first frame."""
        self.expect_frames()
        return self[0].diameter

    def to_mdanalysis(self, *, unwrapped: bool = True) -> Any:
        """An ``MDAnalysis.Universe`` in memory: times, ids, types (A, B, C … by kind, or A alone), masses and radii; z is 0.

        :param unwrapped: False for positions inside the box. The default is what ``EinsteinMSD`` needs.
        :raises Error: where MDAnalysis is not installed, for births and deaths, and as :attr:`Frame.unwrapped`.

        MDAnalysis has single precision, and its densities count volumes: with a box of height 1, its ``InterRDF`` is not g(r)
        of the plane;
        :func:`pair_correlation` is.
        """
        self.expect_frames()
        return converters.to_mdanalysis(list(self), unwrapped=unwrapped)

    def to_ase(self, *, unwrapped: bool = True) -> list[Any]:
        """A list of ``ase.Atoms``; see :meth:`Frame.to_ase`."""
        return [frame.to_ase(unwrapped=unwrapped) for frame in self]

    def to_gsd(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes a GSD file of two dimensions: positions about the middle of the box, images, velocities, masses, diameters.

        :raises Error: where gsd is not installed, and where the file is there already, unless ``overwrite``.

        Single precision. A GSD box is always periodic: walls are lost. ``gsd.hoomd.read_log`` finds the times.
        """
        self.expect_frames()
        converters.to_gsd(self, path, overwrite=overwrite)

    def __repr__(self) -> str:
        return f"<gridlock.Trajectory {self.path}: {len(self)} frames>"


class RunDirectory:
    """What a run has written, read when it is asked for."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(path)

    @property
    def settings(self) -> dict[str, Any]:
        """All settings of the run. Needs Python 3.11 or the package tomli."""
        return settings_in((self.path / "config.resolved.toml").read_text(encoding="utf-8"))

    @property
    def summary(self) -> dict[str, Any]:
        """summary.json."""
        file = self.path / "summary.json"
        if not file.exists():
            raise Error(f"{self.path} holds a run that is not finished\n  hint: gridlock resume {self.path}")
        try:
            found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        except ValueError:
            found = {}
        if not isinstance(found, dict) or not isinstance(found.get("state_hash"), str):
            raise Error(f"{file} is damaged: it is not the summary of a run\n  hint: remove it, and gridlock resume writes it again")
        return found

    @property
    def state_hash(self) -> str:
        return str(self.summary["state_hash"])

    @property
    def results(self) -> Results:
        """Averages with their errors."""
        return Results({
            name: Result(entry["value"], entry.get("error"), entry.get("unit", ""))
            for name, entry in self.summary.items()
            if isinstance(entry, dict) and name != "value_names" and isinstance(entry.get("value"), (int, float))
        })

    @property
    def series(self) -> NDArray[Any]:
        """Every sample: a structured array with a field for each column."""
        return self.table("series")

    def table(self, name: str) -> NDArray[Any]:
        """A table of the directory: "pair_correlation", "speed_distribution" …"""
        return structured(_core.read_csv(str(self.path / f"{name}.csv")))

    @property
    def trajectory(self) -> Trajectory:
        """Its frames, where the run keeps some."""
        return Trajectory(self.path / "trajectory.h5")

    @property
    def final(self) -> Frame:
        """The last state."""
        names = self.summary.get("value_names", {}) if (self.path / "summary.json").exists() else {}
        frame = frame_of_values(_core.read_xyz(str(self.path / "final.xyz"), None), names)
        fields, networks = self.path / "final_fields.h5", self.path / "final_networks.h5"
        if fields.exists():
            frame = dataclasses.replace(frame, fields=_core.read_fields(str(fields)))
        if networks.exists():
            frame = dataclasses.replace(frame, networks={name: Edges(*edges) for name, edges in _core.read_networks(str(networks)).items()})
        return frame

    @property
    def diameter(self) -> float:
        """The mean diameter of the last state: ``run.table("pair_correlation")["distance"] / run.diameter`` is r/σ."""
        return self.final.diameter

    def resume(self, *, steps: int | None = None, threads: int | None = None) -> None:
        """Finishes a run that was interrupted; with ``steps``, makes it that long from its start."""
        if steps is not None:
            steps = as_count(steps, "steps", most=MOST_STEPS)
        _core.resume_directory(str(self.path), steps, None if threads is None else as_threads(threads), None)

    def __repr__(self) -> str:
        return f"<gridlock.RunDirectory {self.path}>"


class Verification(NamedTuple):
    """What :func:`verify` has found."""

    is_verified: bool  #: whether everything that was replayed agrees, bit for bit
    text: str  #: the sentence of ``gridlock verify``: what agrees, or where the first difference is; of several runs a line for each
    steps: int  #: replayed
    hashes: int  #: that agree, as have the next three
    states: int
    frames: int
    results: int  #: files: tables, final.xyz and summary.json
    runs: int  #: in which all agrees


def verify(directory: str | os.PathLike[str], *, windows: int = 0, seed: int = 1, window_steps: int | None = None,
           threads: int | None = None) -> Verification:
    """Replays a run, all runs of a sweep or those of a study, and compares them with what they have recorded, as ``gridlock verify`` does.

    :param windows: how many parts to replay, chosen at random from the states of ``checkpoint.keep_states``, of a study how many
        runs; 0: the whole run.
    :param window_steps: the length of a part; None: up to the next recorded hash.
    :raises Error: for the directory of one run that cannot be verified, as where its settings were changed since; of several runs
        ``text`` names those.
    """
    return Verification(**_core.verify_directory(
        str(directory), as_count(windows, "windows", "use a whole number, 0 or above", least=0, most=MOST_STEPS),
        as_count(seed, "seed", "use a whole number, 0 or above", least=0, most=MOST_STEPS),
        None if window_steps is None else as_count(window_steps, "window_steps", most=MOST_STEPS),
        None if threads is None else as_threads(threads)))


def open(path: str | os.PathLike[str]) -> RunDirectory | Any:
    """A run directory, a sweep directory, a trajectory or a state, by what the path holds; of a file its first bytes tell, not its name.

    :returns: :class:`RunDirectory`, :class:`SweepDirectory`, :class:`Trajectory` for H5MD, GSD and dumps of LAMMPS, or :class:`Frame`
        for extended XYZ.
    :raises Error: for a path that holds none of them, with the name of the format where it is known.
    """
    from .sweeps import SweepDirectory

    path = pathlib.Path(path)
    if path.is_file():
        is_trajectory = formats.format_of(os.fspath(path)) in ("hdf5", "gsd", "lammps_dump")
        return Trajectory(path) if is_trajectory else read_xyz(path)
    if (path / "plan.json").exists():
        return SweepDirectory(path)
    if (path / "config.resolved.toml").exists():
        return RunDirectory(path)
    raise Error(f"{path} holds neither a run nor a sweep\n  hint: name a directory that Gridlock has written")


def settings_in(text: str) -> dict[str, Any]:
    """A text in TOML as tables of settings."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib
    return tomllib.loads(text)
