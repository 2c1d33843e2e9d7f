"""The simulations of the study: protocols and what is kept of them."""

from __future__ import annotations

import dataclasses
import json
import math
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import RunFailure, Simulation

if TYPE_CHECKING:
    from numpy.typing import NDArray

Stage = dict[str, Any]

MIXTURE = [{"fraction": 0.5, "size_ratio": 1.0}, {"fraction": 0.5, "size_ratio": 1.4}]
DECOMPRESS: Stage = {"stage": "decompress", "until_pressure": 1e-8}


@dataclasses.dataclass(frozen=True)
class Run:
    """The settings that tell two runs apart: equal runs have equal bits."""

    settings: str  #: JSON
    work: float  #: in seconds, roughly
    title: str

    @property
    def key(self) -> str:
        return self.settings

    def carry_out(self, on_progress: Callable[[int, float], None]) -> Outcome:
        """Carries out the protocol."""
        start = time.perf_counter()
        simulation = Simulation(json.loads(self.settings), threads=1)
        simulation.run(progress=on_progress)
        return Outcome.of(simulation, time.perf_counter() - start)

    def restored(self, arrays: Mapping[str, NDArray[Any]]) -> Outcome:
        return Outcome({name: np.asarray(values) for name, values in arrays.items()})


def run_of(title: str, stages: list[Stage], seed: int, work: float, *, disks: int, packing_fraction: float, start: str = "uniform",
           is_mixture: bool = True, potential: str = "harmonic", residual: float | None = None) -> Run:
    """Disks in a periodic unit box that go through these stages."""
    settings: dict[str, Any] = {
        "box": {"edge": "periodic"},
        "disks": {"count": disks, "packing_fraction": packing_fraction, "start": start},
        "velocities": {"kind": "maxwell"},
        "engine": {"kind": "exact"},
        "run": {"seed": seed},
        "protocol": stages,
    }
    if is_mixture:
        settings["disks"]["species"] = MIXTURE
    if potential != "harmonic":
        settings["soft"] = {"potential": potential}
    if residual is not None:
        settings.setdefault("soft", {})["residual"] = residual
    return Run(json.dumps(settings, sort_keys=True), work, f"{title}, seed {seed}")


def flow_of(title: str, seed: int, *, disks: int, packing_fraction: float, rate: float, strain: float) -> Run:
    """Disks of diameter 1 and 1.4 with friction against a steady flow, up to a strain; a fifth of it is left out of the means."""
    side = math.sqrt(0.5 * disks * 0.25 * math.pi * (1.0 + 1.4**2) / packing_fraction)
    time_step = 0.2
    steps = math.ceil(strain / (rate * time_step))
    settings: dict[str, Any] = {
        "box": {"edge": "periodic", "side": side},
        "disks": {"count": disks, "radius": 0.5, "start": "uniform", "species": MIXTURE},
        "protocol": [{"stage": "quench"}],
        "engine": {"kind": "soft", "time_step": time_step},
        "thermostat": {"kind": "overdamped", "temperature": 0.0, "friction": 1.0},
        "flow": {"shear_rate": rate},
        "observe": {"every": max(1, steps // 2000), "structure_every": 1, "equilibration": 0.2},
        "run": {"seed": seed, "steps": steps},
    }
    return Run(json.dumps(settings, sort_keys=True), 1e-7 * disks * steps, f"{title}, seed {seed}")


@dataclasses.dataclass(frozen=True, eq=False)
class Outcome:
    """What the study keeps of a protocol: the tables ``stages``, ``levels`` and ``shear``, the results, and the last packing."""

    arrays: dict[str, Any]

    @classmethod
    def of(cls, simulation: Simulation, seconds: float) -> Outcome:
        arrays: dict[str, Any] = {"state_hash": simulation.state_hash, "seconds": seconds}
        for table, rows in simulation.distributions.items():
            if table in ("stages", "levels", "shear"):
                arrays.update({f"{table}.{name}": np.array(rows[name]) for name in rows.dtype.names or ()})
        arrays.update({f"result.{name}": float(result.value) for name, result in simulation.results.items()})
        agents = simulation.agents
        arrays["positions"], arrays["radii"] = np.array(agents.positions), np.array(agents.radius)
        return cls(arrays)

    def result(self, name: str) -> float:
        """A number of the end; nan where there is none."""
        return float(self.arrays.get(f"result.{name}", math.nan))

    def stage(self, number: int, column: str) -> float:
        """A number of a stage, from 0."""
        return float(self.arrays[f"stages.{column}"][number])

    def level(self, column: str) -> NDArray[np.float64]:
        """A number of each minimum of the last stage, the highest pressure first."""
        if "levels.stage" not in self.arrays:
            raise RunFailure("no levels were kept")
        last = self.arrays["levels.stage"] == self.arrays["levels.stage"][-1]
        return np.asarray(self.arrays[f"levels.{column}"][last], dtype=np.float64)

    def sheared(self, column: str) -> NDArray[np.float64]:
        """A number of each minimum of quasi-static shear, from strain 0 on."""
        return np.asarray(self.arrays[f"shear.{column}"], dtype=np.float64)

    @property
    def positions(self) -> NDArray[np.float64]:
        return np.asarray(self.arrays["positions"], dtype=np.float64)

    @property
    def radii(self) -> NDArray[np.float64]:
        return np.asarray(self.arrays["radii"], dtype=np.float64)
