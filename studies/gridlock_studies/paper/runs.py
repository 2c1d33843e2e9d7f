"""The simulations of the study."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
import os
import tempfile
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import Error, Simulation

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

    @property
    def key(self) -> str:
        return json.dumps(dataclasses.asdict(self))

    @property
    def title(self) -> str:
        return f"{self.start} start, packing fraction {self.packing_fraction}, seed {self.seed}"

    def carry_out(self, on_progress: Callable[[int, float], None]) -> Outcome:
        """Runs it to its end."""
        start = time.perf_counter()
        simulation = self.simulation()
        simulation.run(progress=on_progress)
        return Outcome.of(simulation, time.perf_counter() - start)

    def restored(self, arrays: Mapping[str, NDArray[Any]]) -> Outcome:
        return Outcome.restored(arrays)

    @property
    def settings(self) -> dict[str, Any]:
        """Those of the simulation, where its lattice is fitted to the box."""
        settings: dict[str, Any] = {
            "disks": {"count": self.disks, "packing_fraction": self.packing_fraction, "start": self.start},
            "box": {"edge": self.edge},
            "engine": {"kind": self.engine, "time_step": self.time_step, "contact": self.contact},
            "run": {"steps": self.steps, "seed": self.seed},
            "observe": {"every": self.sample_every, "structure_every": 0},
        }
        if self.engine == "exact":
            del settings["engine"]["contact"]
        return settings

    @property
    def recorded_settings(self) -> str:
        """In JSON, for ``gridlock verify``; empty where the study places the disks itself."""
        return json.dumps(self.settings) if self.sites == "fitted" else ""

    def simulation(self) -> Simulation:
        """:raises Error: where the start does not exist."""
        settings = self.settings
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
