"""Trajectories that other programs write and the library of C++ does not read: dumps of LAMMPS, and GSD.

Each class has the methods of ``_core.Trajectory``. Positions count from the lower left corner of the box, and lie inside it.
"""

from __future__ import annotations

import gzip
import os
import weakref
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from . import _core, converters
from .errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .box import BoxValues

    Columns = dict[str, NDArray[Any]]
    #: ids, columns, box (width, height, whether periodic in x and in y), step, time
    FrameValues = tuple[NDArray[np.uint64], Columns, BoxValues, int, float]

#: Positions of LAMMPS have six digits, so that one on a wall may be beyond it by so much of the side.
ROUNDING = 5e-6


class Frames(Protocol):
    """What a trajectory reads its frames from."""

    def size(self) -> int: ...
    def steps(self) -> NDArray[np.uint64]: ...
    def times(self) -> NDArray[np.float64]: ...
    def frame(self, k: int) -> Any: ...
    def contacts(self) -> Any: ...
    def value_names(self) -> dict[str, list[str]]: ...
    def configuration(self) -> str: ...
    def note_on_left_out(self) -> str: ...


def frames_of(path: str) -> Frames:
    """The frames of a file, by the format that its first bytes show.

    :raises Error: for a format that is none of a trajectory, and where a library is missing that reads it.
    """
    word = format_of(path)
    if word == "lammps_dump":
        return LammpsDump(path)
    if word == "gsd":
        return GsdFile(path)
    return _core.Trajectory(path)


def format_of(path: str) -> str:
    """The word for the format of a file, as the library has it; that of what is packed for a dump that gzip packed; empty for a text without a
    mark."""
    form = _core.recognize_format(path)
    if form is not None:
        return form[0]
    return "lammps_dump" if _is_gzip(path) and _is_packed_dump(path) else ""


def _is_gzip(path: str) -> bool:
    with open(path, "rb") as file:
        return file.read(2) == b"\x1f\x8b"


def _is_packed_dump(path: str) -> bool:
    try:
        with gzip.open(path) as file:
            return file.read(6) == b"ITEM: "
    except (OSError, EOFError):
        return False  # the reader of XYZ tells what is wrong with it


class Side(NamedTuple):
    """The box in one direction."""

    begin: float
    length: float
    is_periodic: bool

    def put_inside(self, values: NDArray[np.float64], where: str) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Positions inside the box, and the number of the box that each was in."""
        inside = values - self.begin
        if not np.isfinite(inside).all():
            raise Error(f"{where}: an agent is at {values[~np.isfinite(inside)][0]}\n  hint: positions are finite numbers")
        if self.is_periodic:
            boxes = np.floor(inside / self.length)
            inside -= self.length * boxes
            inside[inside >= self.length] = 0.0  # negative numbers that round away
            return inside, boxes.astype(np.int32)
        clipped = np.clip(inside, 0.0, self.length)
        beyond = np.abs(inside - clipped)
        if beyond.max(initial=0.0) > ROUNDING * self.length:
            found = values[beyond.argmax()]
            raise Error(f"{where}: an agent is at {found:.6g}, outside the walls at {self.begin:.6g} and {self.begin + self.length:.6g}")
        return clipped, np.zeros(len(values), dtype=np.int32)


def _expect_plane(z: NDArray[np.float64], where: str) -> None:
    if len(z) > 0 and z.max() > z.min():
        raise Error(f"{where}: its agents lie in space, z from {z.min():.6g} to {z.max():.6g}\n  hint: in Gridlock they lie in a plane")


def _expect_rectangle(tilt: float, where: str) -> None:
    if tilt != 0.0:
        raise Error(f"{where}: its box is sheared by {tilt:.6g}\n  hint: of this format rectangles are read; extended XYZ and H5MD may be sheared")


class OtherFrames:
    """The frames of a file that knows neither contacts nor names of values nor settings."""

    _steps: list[int]
    _times: list[float]

    def _close_in_the_end(self, file: Any) -> None:
        """Frames are read one at a time, so that the file stays open as long as they can be asked for."""
        weakref.finalize(self, file.close)

    def size(self) -> int:
        return len(self._steps)

    def steps(self) -> NDArray[np.uint64]:
        return np.array(self._steps, dtype=np.uint64)

    def times(self) -> NDArray[np.float64]:
        return np.array(self._times)

    def contacts(self) -> None:
        return None

    def value_names(self) -> dict[str, list[str]]:
        return {}

    def configuration(self) -> str:
        return ""

    def note_on_left_out(self) -> str:
        return ""


class LammpsDump(OtherFrames):
    """A dump of LAMMPS in text, packed by gzip or not; LAMMPS calls it ``dump custom`` or ``dump atom``."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._file: Any = gzip.open(path) if _is_gzip(path) else open(path, "rb")
        self._close_in_the_end(self._file)
        self._places: list[int] = []  #: of the first line of each frame
        self._steps, self._times = [], []
        time: float | None = None  # LAMMPS writes it before the step, some others behind it
        count, is_in_head = 0, False
        while (line := self._file.readline()):
            if line.startswith(b"ITEM: TIMESTEP"):
                self._places.append(self._file.tell() - len(line))
                self._steps.append(self._whole_number("the step"))
                self._times.append(float(self._steps[-1]) if time is None else time)
                time, is_in_head = None, True
            elif line.startswith(b"ITEM: TIME"):
                time = self._number("the time")
                if is_in_head:
                    self._times[-1], time = time, None
            elif line.startswith(b"ITEM: NUMBER OF ATOMS"):
                count = self._whole_number("the number of atoms")
            elif line.startswith(b"ITEM: ATOMS"):
                is_in_head = False
                for _ in range(count):
                    if not self._file.readline().strip():
                        raise Error(f"{path}: the frame of step {self._steps[-1]} is cut off\n  hint: is the file whole?")

    def frame(self, k: int) -> FrameValues:
        where = f"{self.path}, step {self._steps[k]}"
        self._file.seek(self._places[k])
        count, sides = 0, list[Side]()
        names = list[str]()
        while not names:
            words = self._file.readline().decode(errors="replace").split()
            if words[:2] == ["ITEM:", "NUMBER"]:
                count = self._whole_number("the number of atoms")
            elif words[:2] == ["ITEM:", "BOX"]:
                sides = self._sides(words[3:], where)
            elif words[:2] == ["ITEM:", "ATOMS"]:
                names = words[2:]
        rows = [self._file.readline().decode(errors="replace").split() for _ in range(count)]
        if any(len(row) != len(names) for row in rows):
            raise Error(f"{where}: a line has another number of columns than the {len(names)} of its head\n  hint: is the file whole?")
        texts = {name: [row[place] for row in rows] for place, name in enumerate(names)}
        return self._values({name: column for name, values in texts.items() if (column := _numbers(values)) is not None}, sides, k, where)

    def _values(self, columns: Columns, sides: list[Side], k: int, where: str) -> FrameValues:
        ids = columns.pop("id", np.arange(count_of(columns))).astype(np.uint64)
        made: Columns = {}
        for side, axis in zip(sides, "xyz"):
            values, is_unwrapped = self._positions(columns, axis, side, where)
            image = columns.pop(f"i{axis}", None)
            if axis == "z":
                _expect_plane(values, where)
                continue
            made[axis], boxes = side.put_inside(values, where)
            if side.is_periodic and (is_unwrapped or image is not None):
                made[f"image_{axis}"] = boxes if image is None or is_unwrapped else boxes + image.astype(np.int32)
        columns.pop("vz", None)
        own = {"vx": "velocity_x", "vy": "velocity_y", "type": "species"}
        made.update({own.get(name, name): values for name, values in columns.items() if name != "diameter"})
        if "diameter" in columns:
            made.setdefault("radius", 0.5 * columns["diameter"])
        order = np.argsort(ids, kind="stable")
        if (np.diff(ids[order]) == 0).any():
            raise Error(f"{where}: two agents have one id\n  hint: write each atom once")
        box = (sides[0].length, sides[1].length, sides[0].is_periodic, sides[1].is_periodic, 0.0)
        return ids[order], {name: values[order] for name, values in made.items()}, box, self._steps[k], self._times[k]

    def _positions(self, columns: Columns, axis: str, side: Side, where: str) -> tuple[NDArray[np.float64], bool]:
        """Of one direction, and whether they do not jump at the edges: those that do not are taken where a dump has both."""
        found: tuple[NDArray[np.float64], bool] | None = None
        for ending, is_scaled, is_unwrapped in (("", False, False), ("s", True, False), ("u", False, True), ("su", True, True)):
            values = columns.pop(axis + ending, None)
            if values is not None:
                found = (side.begin + side.length * values if is_scaled else values.astype(float)), is_unwrapped
        if found is None and axis == "z":
            return np.zeros(0), False
        if found is None:
            raise Error(f"{where}: there is no column {axis}, {axis}s, {axis}u or {axis}su\n  hint: dump positions with id, type and radius")
        return found

    def _sides(self, words: list[str], where: str) -> list[Side]:
        """The box from its three lines: bounds, and after them a tilt where it has one."""
        lines = [[float(word) for word in self._file.readline().split()] for _ in range(3)]
        if words[:1] == ["abc"] or any(len(line) not in (2, 3) for line in lines):
            raise Error(f"{where}: its box is not one of bounds\n  hint: boxes here are rectangles")
        _expect_rectangle(max((line[2] for line in lines if len(line) == 3), key=abs, default=0.0), where)
        flags = [word == "pp" for word in words if len(word) == 2 and word[0] in "pfsm"] or [True, True, True]
        return [Side(begin, end - begin, is_periodic) for (begin, end, *_), is_periodic in zip(lines, flags)]

    def _number(self, what: str) -> float:
        line = self._file.readline()
        try:
            return float(line)
        except ValueError:
            raise Error(f"{self.path}: {what} is {line.decode(errors='replace').strip()!r}\n  hint: is the file whole?") from None

    def _whole_number(self, what: str) -> int:
        number = self._number(what)
        if not 0 <= number < 2**53 or number != int(number):
            raise Error(f"{self.path}: {what} is {number:g}\n  hint: is the file whole?")
        return int(number)


def count_of(columns: Columns) -> int:
    return len(next(iter(columns.values()), np.zeros(0)))


def _numbers(texts: list[str]) -> NDArray[Any] | None:
    """A column as whole numbers or others; none for names of elements."""
    for kind in (np.int64, np.float64):
        try:
            return np.array(texts, dtype=kind)
        except (ValueError, OverflowError):
            pass
    return None


class GsdFile(OtherFrames):
    """A GSD file of HOOMD-blue, read by the package ``gsd``. It has single precision, and every box is periodic."""

    def __init__(self, path: str) -> None:
        gsd = converters.library("gsd.hoomd", "gsd")
        self.path = path
        try:
            self._file = gsd.open(os.fspath(path), "r")
            self._close_in_the_end(self._file)
        except Exception as error:
            raise Error(f"cannot read {path}: {error}\n  hint: is it whole?") from None
        count = len(self._file)
        chunk = self._file.file.read_chunk
        self._steps = [int(chunk(k, "configuration/step")[0]) if self._has(k, "configuration/step") else 0 for k in range(count)]
        self._times = [float(chunk(k, "log/time")[0]) if self._has(k, "log/time") else float(step) for k, step in enumerate(self._steps)]

    def _has(self, k: int, name: str) -> bool:
        return bool(self._file.file.chunk_exists(k, name))

    def frame(self, k: int) -> FrameValues:
        where = f"{self.path}, step {self._steps[k]}"
        frame = self._file[k]
        width, height, _, *tilts = (float(number) for number in frame.configuration.box)
        _expect_rectangle(tilts[0], where)
        positions = np.asarray(frame.particles.position, dtype=float)
        _expect_plane(positions[:, 2], where)
        columns: Columns = {}
        for place, (axis, length) in enumerate((("x", width), ("y", height))):
            columns[axis], boxes = Side(-0.5 * length, length, True).put_inside(positions[:, place], where)
            # Images are left out of a file where all are 0.
            columns[f"image_{axis}"] = boxes + np.asarray(frame.particles.image[:, place], dtype=np.int32)
        if self._is_written(k, "velocity"):
            for place, axis in enumerate("xy"):
                columns[f"velocity_{axis}"] = np.asarray(frame.particles.velocity[:, place], dtype=float)
        for name, own, factor in (("mass", "mass", 1.0), ("diameter", "radius", 0.5)):
            if self._is_written(k, name):
                columns[own] = factor * np.asarray(getattr(frame.particles, name), dtype=float)
        columns["species"] = np.asarray(frame.particles.typeid, dtype=np.int64)
        return np.arange(len(positions), dtype=np.uint64), columns, (width, height, True, True, 0.0), self._steps[k], self._times[k]

    def _is_written(self, k: int, name: str) -> bool:
        """Whether the file has it, of this frame or the first: gsd makes up all that it has not."""
        return self._has(k, f"particles/{name}") or self._has(0, f"particles/{name}")
