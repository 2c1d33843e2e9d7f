"""Frames as objects of MDAnalysis and ASE, and as GSD files, where these libraries are installed.

Those libraries know three dimensions: z is 0 everywhere, and the box has height 1 (in GSD 0, its sign of two dimensions).
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from .errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .files import Frame


def library(module: str, package: str) -> Any:
    """A library that is used only here.

    >>> library("no_such_library", "no-such-library")
    Traceback (most recent call last):
    gridlock.errors.Error: no_such_library is not installed
      hint: pip install no-such-library
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise Error(f"{module.partition('.')[0]} is not installed\n  hint: pip install {package}") from None


def kind_names(kinds: NDArray[np.int64]) -> list[str]:
    """A, B, C … for the kinds 0, 1, 2 …, as in the files of ``gridlock export``; beyond Z they have numbers."""
    return [chr(ord("A") + kind) if kind < 26 else f"kind_{kind}" for kind in range(int(kinds.max(initial=-1)) + 1)]


def _kinds(frame: Frame) -> NDArray[np.int64]:
    """One kind for all agents where no column tells them apart."""
    try:
        return frame.kinds
    except Error:
        return np.zeros(len(frame), dtype=np.int64)


def _solid(flat: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors of the plane with z = 0."""
    return np.concatenate([flat, np.zeros((len(flat), 1))], axis=1)


def _positions(frame: Frame, unwrapped: bool) -> NDArray[np.float64]:
    crossed = [f"image_{axis}" for axis in "xy" if getattr(frame.box, f"periodic_{axis}")]
    if unwrapped and any(image not in frame.columns for image in crossed):
        raise Error("the frame does not say how often an agent has crossed the edges\n"
                    "  hint: unwrapped=False takes the positions inside the box")
    return _solid(frame.unwrapped if unwrapped else frame.positions)


def _velocities(frame: Frame) -> NDArray[np.float64] | None:
    if "velocity_x" not in frame.columns:
        return None
    return _solid(np.stack([frame.columns["velocity_x"], frame.columns["velocity_y"]], axis=1))


def to_ase(frame: Frame, *, unwrapped: bool = True) -> Any:
    """One frame as ``ase.Atoms`` with the symbol X; kinds are in the array "kind", all other columns in arrays of their names."""
    ase = library("ase", "ase")
    sides = [[frame.box.width, 0.0, 0.0], [frame.box.shift, frame.box.height, 0.0], [0.0, 0.0, 1.0]]
    periodic = [frame.box.periodic_x, frame.box.periodic_y, False]
    atoms = ase.Atoms(numbers=np.zeros(len(frame), dtype=int), positions=_positions(frame, unwrapped), cell=sides, pbc=periodic,
                      info={"step": frame.clock.step, "time": frame.clock.time})
    atoms.set_masses(frame.columns.get("mass", np.ones(len(frame))))
    velocities = _velocities(frame)
    if velocities is not None:
        atoms.set_velocities(velocities)
    atoms.set_array("id", frame.ids)
    atoms.set_array("kind", _kinds(frame))
    for name, values in frame.columns.items():
        if name not in ("x", "y", "velocity_x", "velocity_y", "mass"):
            atoms.set_array(name, values)
    return atoms


def to_mdanalysis(frames: Sequence[Frame], *, unwrapped: bool = True) -> Any:
    """All frames as an ``MDAnalysis.Universe`` in memory, in single precision as MDAnalysis has it.

    Atoms have ids, types (A, B, C … by kind), and masses and radii where the frames have them. Between walls there are no
    dimensions, for MDAnalysis takes every box for a periodic one.
    """
    mda = library("MDAnalysis", "MDAnalysis")
    reader = library("gridlock._mdanalysis", "MDAnalysis").TimedReader
    if len(frames) == 0:
        raise Error("a trajectory without frames\n  hint: wait for the first, or set trajectory.every")
    first = frames[0]
    for frame in frames:
        expect_same_agents(first, frame)
    universe = mda.Universe.empty(len(first), trajectory=True)
    kinds = _kinds(first)
    names = kind_names(kinds)
    universe.add_TopologyAttr("types", [names[kind] for kind in kinds])
    universe.add_TopologyAttr("ids", first.ids.astype(np.int64))
    for attribute, column in (("masses", "mass"), ("radii", "radius")):
        if column in first.columns:
            universe.add_TopologyAttr(attribute, first.columns[column])
    velocities = [_velocities(frame) for frame in frames]
    sides = np.array([[box.width, np.hypot(box.height, box.shift), 1.0, 90.0, 90.0, np.degrees(np.arctan2(box.height, box.shift))]
                      for box in (frame.box for frame in frames)])
    universe.load_new(
        np.array([_positions(frame, unwrapped) for frame in frames], dtype=np.float32), format=reader,
        velocities=None if velocities[0] is None else np.array(velocities, dtype=np.float32),
        dimensions=sides if first.box.periodic_x and first.box.periodic_y else None,
        moments=[frame.clock.time for frame in frames])
    return universe


def protect(path: str | os.PathLike[str], maker: str, overwrite: bool, inputs: Sequence[str | os.PathLike[str]] = ()) -> None:
    """Refuses to replace a file that ``maker`` has not listed as its own in the directory of a run, unless ``overwrite``; inputs and
    results of a run in any case."""
    hint = "name another file, or say overwrite=True"
    _core.protect_files([os.fspath(path)], maker, hint, overwrite, [os.fspath(read) for read in inputs])


def to_gsd(frames: Iterable[Frame], path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
    """Writes frames as a GSD file of two dimensions, as HOOMD-blue, OVITO and freud read it, in single precision.

    The origin is the middle of the box. Images, velocities, masses, diameters and kinds (types A, B, C …) are in it where the
    frames have them; the log has ``time``. A GSD box is always periodic, so that walls are lost.
    """
    gsd = library("gsd.hoomd", "gsd")
    source = getattr(frames, "path", None)
    protect(path, "gridlock.Trajectory.to_gsd", overwrite, [] if source is None else [source])
    with gsd.open(os.fspath(path), "w") as file:
        for frame in frames:
            file.append(_gsd_frame(gsd, frame))


def _gsd_frame(gsd: Any, frame: Frame) -> Any:
    result = gsd.Frame()
    result.configuration.step = frame.clock.step
    result.configuration.dimensions = 2
    result.configuration.box = [frame.box.width, frame.box.height, 0, frame.box.tilt, 0, 0]
    result.log["time"] = np.array([frame.clock.time])
    particles = result.particles
    particles.N = len(frame)
    particles.position = _solid(frame.positions - [0.5 * frame.box.width, 0.5 * frame.box.height])
    particles.typeid = _kinds(frame)
    particles.types = kind_names(particles.typeid)
    particles.velocity = _velocities(frame)
    particles.mass = frame.columns.get("mass")
    if "radius" in frame.columns:
        particles.diameter = 2 * frame.columns["radius"]
    if "image_x" in frame.columns:
        particles.image = _solid(np.stack([frame.columns["image_x"], frame.columns["image_y"]], axis=1)).astype(np.int32)
    return result


def expect_same_agents(first: Frame, frame: Frame) -> None:
    """Refuses births and deaths: an agent has one place in arrays over frames."""
    if np.array_equal(frame.ids, first.ids):
        return
    born, dead = len(np.setdiff1d(frame.ids, first.ids)), len(np.setdiff1d(first.ids, frame.ids))
    raise Error(f"the agents of step {frame.clock.step} are not those of step {first.clock.step}: {born} are new and {dead} are gone\n"
                "  hint: take the frames one by one, or a part without births and deaths")
