"""The simulations of the study: each is done once, whichever figures need it, and kept until the report is written."""

from __future__ import annotations

import concurrent.futures
import contextlib
import dataclasses
import functools
import hashlib
import io
import json
import math
import os
import pathlib
import re
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from ..errors import Error, RunFailure
from ..simulation import Simulation

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The columns of the series that are kept of a run.
SERIES = ("step", "time", "mean_displacement", "centre_displacement", "halted_fraction", "collision_rate",
          "compressibility_factor", "wall_pressure")
#: The root mean square displacement about the centre of the disks, over the side of the box.
ABOUT_CENTRE = "displacement_about_centre"


@dataclasses.dataclass(frozen=True)
class Run:
    """The settings that tell two runs apart: equal runs have equal bits."""

    disks: int
    packing_fraction: float
    steps: int
    sample_every: int
    seed: int
    engine: str = "stepped"
    start: str = "square"
    #: Which sites the lattice uses: "fitted" to the box, "to walls" for the square lattice with its outermost disks touching
    #: the walls, "perfect" for the unstretched triangular lattice in the middle of the box.
    sites: str = "fitted"
    edge: str = "wall"
    time_step: float = 0.1  #: diameters per v_max
    contact: str = "always"

    @property
    def work(self) -> float:
        """What it costs, in disk-steps of the paper's rule; only for the order and the progress.

        Exact disks cost by the collision, of which there are φ g(σ) times as many, g at contact by Enskog's theory; the two
        numbers are measured, to a third of the cost.
        """
        cost = 1.0
        if self.engine == "exact":
            density = self.packing_fraction
            cost = 0.17 + 0.36 * density * (1.0 - 7.0 / 16.0 * density) / (1.0 - density) ** 2
        return cost * self.disks * self.steps

    def simulation(self) -> Simulation:
        """:raises Error: where the start does not exist."""
        settings: dict[str, Any] = {
            "disks": {"count": self.disks, "packing_fraction": self.packing_fraction, "start": self.start},
            "box": {"edge": self.edge},
            "engine": {"kind": self.engine, "time_step": self.time_step, "contact": self.contact},
            "run": {"steps": self.steps, "seed": self.seed},
            "observe": {"every": self.sample_every, "structure_every": 0},
        }
        if self.engine == "exact":
            del settings["engine"]["contact"]
        # The cores are busy with other runs.
        make = functools.partial(Simulation, threads=1)
        simulation = make(settings)
        if self.sites == "fitted":
            return simulation
        # Displacements count from the state a simulation is made with, so that the moved disks become a start of their own.
        agents, side = simulation.agents, simulation.box.width
        radius = float(agents.radius[0])
        sites, largest = square_sites_to_walls(side, self.disks, radius) if self.sites == "to walls" else \
            perfect_triangular_sites(side, self.disks)
        if radius > largest:
            raise Error(f"disks of radius {radius:.6g} do not fit on these sites; the largest is {largest:.6g}\n"
                        "  hint: use a smaller packing fraction")
        agents.positions[...] = sites
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "start.xyz")
            simulation.write(file)
            return make({**settings, "disks": {"file": file}})


def square_sites_to_walls(side: float, count: int, radius: float) -> tuple[NDArray[np.float64], float]:
    """The sites, shape (count, 2), and the largest radius they have room for."""
    rows = round(math.sqrt(count))
    if rows * rows != count or rows < 2:
        raise Error(f"{count} is not the square of a number of rows, at least 2\n  hint: use a square number, such as the "
                    "paper's 841")
    along = radius + np.arange(rows) * ((side - 2.0 * radius) / (rows - 1))
    # The last disk touches the wall exactly, whatever the rounding of the spacing.
    along[-1] = side - radius
    y, x = np.meshgrid(along, along, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=1), 0.5 * side / rows


def perfect_triangular_sites(side: float, count: int) -> tuple[NDArray[np.float64], float]:
    """Rows of p and p − 1 sites with the spacing that touches two opposite walls; and the largest radius they have room for."""
    height = 0.5 * math.sqrt(3.0)  # of a row, in spacings
    best = (np.empty((0, 2)), 0.0)
    for rows in range(2, count + 1):
        longest = (count + rows // 2 + rows - 1) // rows
        if longest < 2:
            break
        # Spacing and diameter are one: p spacings across, (rows − 1)·√3/2 + 1 up.
        spacing = side / max(float(longest), (rows - 1) * height + 1.0)
        # Rounding must not make disks in contact overlap.
        radius = 0.5 * spacing - 1e-15 * side
        if radius <= best[1]:
            continue
        left = 0.5 * (side - (longest - 1) * spacing)
        bottom = 0.5 * (side - (rows - 1) * height * spacing)
        lines = []
        for row in range(rows):
            x = left + (np.arange(longest - row % 2) + 0.5 * (row % 2)) * spacing
            lines.append(np.stack([x, np.full(len(x), bottom + row * height * spacing)], axis=1))
        places = np.concatenate(lines)
        best = (places[np.arange(count) * len(places) // count], radius)
    return best


@dataclasses.dataclass(frozen=True, eq=False)
class Outcome:
    """What the study keeps of a finished run."""

    series: Mapping[str, NDArray[np.float64]]  #: one number for each sample, by the names of SERIES and ABOUT_CENTRE
    state_hash: str
    seconds: float

    @classmethod
    def of(cls, simulation: Simulation, seconds: float) -> Outcome:
        table, side = simulation.series, simulation.box.width
        present = table.dtype.names or ()
        series = {name: np.array(table[name], dtype=np.float64) for name in SERIES if name in present}
        centre = series["centre_displacement"]
        squared = table["mean_squared_displacement"] / (side * side) - centre * centre
        # Rounding may leave less than nothing where all disks move together.
        series[ABOUT_CENTRE] = np.sqrt(np.maximum(0.0, squared))
        return cls(series, simulation.state_hash, seconds)

    @property
    def arrays(self) -> dict[str, Any]:
        """To be kept."""
        return {"names": list(self.series), "series": np.stack(list(self.series.values())), "state_hash": self.state_hash,
                "seconds": self.seconds}

    @classmethod
    def restored(cls, arrays: Mapping[str, NDArray[Any]]) -> Outcome:
        """From what was kept."""
        series = dict(zip(arrays["names"].tolist(), arrays["series"]))
        return cls(series, str(arrays["state_hash"]), float(arrays["seconds"]))


class PartialResults:
    """Finished pieces of a study that is not finished, one file each, so that a study that is stopped or killed continues
    without doing them again.

    A piece is found by its key, which says everything that its result depends on. Its file holds the key and the version of the
    library as well; a file that is damaged or of another version counts as none. Every file is written whole or not at all.
    """

    def __init__(self, directory: pathlib.Path) -> None:
        self.directory = directory
        self.problem = ""  #: why a piece could not be kept

    def _file(self, key: str) -> pathlib.Path:
        return self.directory / f"{hashlib.sha256(key.encode()).hexdigest()[:16]}.npz"

    def restore(self, key: str) -> dict[str, NDArray[Any]] | None:
        """The arrays that were kept, or None."""
        try:
            with np.load(self._file(key), allow_pickle=False) as file:
                arrays = dict(file.items())
        except Exception:  # Whatever is wrong with the file, the piece is done again.
            return None
        is_this = str(arrays.pop("key", "")) == key and str(arrays.pop("version", "")) == _core.version
        return arrays if is_this else None

    def keep(self, key: str, arrays: Mapping[str, Any]) -> None:
        """Where it cannot be written the study continues, and ``problem`` says why."""
        data = io.BytesIO()
        np.savez(data, key=np.array(key), version=np.array(_core.version), **arrays)
        file = self._file(key)
        part = file.with_name(f".{file.name}.part")
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            part.write_bytes(data.getbuffer())
            part.replace(file)
        except OSError as error:
            self.problem = self.problem or str(error)

    def remove_all(self) -> None:
        """Removes all pieces, and the directory where nothing else is in it."""
        for file in self.directory.glob("*"):
            # What a killed process has left of a piece is hidden and ends with "part".
            if re.fullmatch(r"[0-9a-f]{16}\.npz|\.[0-9a-f]{16}\.npz\.part", file.name):
                file.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.directory.rmdir()


class _Stopped(Exception):
    """Ends a run that nobody waits for any more."""


def cores() -> int:
    """How many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class RunPool:
    """Simulations that several figures share."""

    def __init__(self, partial_results: PartialResults) -> None:
        self._partial_results = partial_results
        self._outcomes: dict[Run, Outcome | None] = {}
        self._failures: dict[Run, str] = {}
        self._done: dict[Run, float] = {}  # the share that is done of each run of this call
        self._is_stopped = False

    def add(self, run: Run) -> None:
        """Notes that a run is needed; one that was asked for before is not done twice."""
        if run in self._outcomes:
            return
        kept = self._partial_results.restore(_key(run))
        if kept is None:
            self._outcomes[run] = None
        else:
            self._outcomes[run] = Outcome.restored(kept)

    def __len__(self) -> int:
        return len(self._outcomes)

    def __iter__(self) -> Iterator[tuple[Run, Outcome]]:
        """The finished runs."""
        return ((run, outcome) for run, outcome in self._outcomes.items() if outcome is not None)

    def __getitem__(self, run: Run) -> Outcome | None:
        """What came out of a run; None where it is not finished, or was never asked for."""
        return self._outcomes.get(run)

    @property
    def finished(self) -> int:
        return sum(1 for _ in self)

    @property
    def work(self) -> float:
        """Of all runs that are not finished, in disk-steps of the paper's rule."""
        return sum(run.work for run, outcome in self._outcomes.items() if outcome is None)

    @property
    def failures(self) -> list[str]:
        """Runs that broke, in words."""
        return [f"{run.start} start, packing fraction {run.packing_fraction}, seed {run.seed}: {text}"
                for run, text in self._failures.items()]

    def run_all(self, threads: int, on_progress: Callable[[float], None]) -> None:
        """Does what is not finished, ``threads`` runs at a time, the longest first.

        on_progress is called a few times a second with the share of the work that is done; whatever it raises stops every run at
        its next look.
        """
        runs = sorted((run for run, outcome in self._outcomes.items() if outcome is None), key=lambda run: -run.work)
        work = sum(run.work for run in runs)
        self._done = {run: 0.0 for run in runs}
        self._is_stopped = False
        with concurrent.futures.ThreadPoolExecutor(threads) as executor:
            waiting = {executor.submit(self._carry_out, run) for run in runs}
            try:
                while waiting:
                    ended, waiting = concurrent.futures.wait(waiting, timeout=0.1)
                    for future in ended:
                        future.result()
                    on_progress(sum(run.work * share for run, share in self._done.items()) / work)
            finally:
                self._is_stopped = True
                for future in waiting:
                    future.cancel()

    def _carry_out(self, run: Run) -> None:
        start = time.perf_counter()
        try:
            simulation = run.simulation()
            simulation.run(progress=functools.partial(self._note, run))
        except _Stopped:
            return
        except (Error, RunFailure) as error:
            self._failures[run] = str(error)
            self._done[run] = 1.0
            return
        outcome = Outcome.of(simulation, time.perf_counter() - start)
        self._partial_results.keep(_key(run), outcome.arrays)
        self._outcomes[run] = outcome
        self._done[run] = 1.0

    def _note(self, run: Run, steps: int, fraction: float) -> None:
        if self._is_stopped:
            raise _Stopped
        self._done[run] = fraction


def _key(run: Run) -> str:
    return json.dumps(dataclasses.asdict(run))
