"""The simulations of the study: disks from a crystal or a liquid, and what is kept of them."""

from __future__ import annotations

import dataclasses
import json
import math
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gridlock import Simulation, bond_orientation, order_correlation, structure_peak, voronoi

from .extent import ConstantPressure, System

if TYPE_CHECKING:
    from numpy.typing import NDArray

CRYSTAL, LIQUID = "crystal", "liquid"
DEFECTS = ("disclination_fraction", "dislocation_fraction", "dislocation_pair_fraction", "other_defect_fraction")
#: The packing fraction from which a liquid grows, and that from which it grows slowly.
_DILUTE, _DENSE = 0.4, 0.68
#: Pair collisions of a disk in the time in which the speed √(kT/m) goes a diameter, around φ = 0.7.
_COLLISION_RATE = 22.0
#: Correlations reach at most so many diameters; one bin is a diameter.
_FARTHEST = 60
#: Cells of the local density are at least so wide, in diameters, if there are more than 16.
_CELL = 25.0


@dataclasses.dataclass(frozen=True)
class Run:
    """The settings that tell two runs apart: equal runs have equal bits."""

    settings: str  #: JSON
    frames: int
    work: float  #: in seconds, roughly
    title: str

    @property
    def key(self) -> str:
        return f"{self.frames} frames, {self.settings}"

    def carry_out(self, on_progress: Callable[[int, float], None]) -> Outcome:
        """Carries out the protocol and the run."""
        start = time.perf_counter()
        settings = json.loads(self.settings)
        simulation = Simulation(settings, threads=1)
        recorder = _Recorder(settings["run"].get("steps", 0), self.frames, settings["observe"]["equilibration"])
        if recorder.steps:
            simulation.on_step(1, recorder.see)
        simulation.run(progress=on_progress)
        return Outcome.of(simulation, recorder, time.perf_counter() - start)

    def restored(self, arrays: Mapping[str, NDArray[Any]]) -> Outcome:
        return Outcome({name: np.asarray(values) for name, values in arrays.items()})


def _settings(disks: int, packing_fraction: float, kind: str, seed: int) -> dict[str, Any]:
    """Disks of diameter 1, mass 1 and kT = 1 in a periodic square, once the protocol is done."""
    is_crystal = kind == CRYSTAL
    first = packing_fraction if is_crystal else _DILUTE
    grow = [{"stage": "grow", "rate": 0.01, "until_packing_fraction": min(packing_fraction, _DENSE)},
            {"stage": "grow", "rate": 2e-4, "until_packing_fraction": packing_fraction}]
    return {
        "box": {"edge": "periodic", "side": math.sqrt(disks * math.pi / (4.0 * packing_fraction))},
        "disks": {"count": disks, "packing_fraction": first, "start": "triangular" if is_crystal else "random"},
        "velocities": {"kind": "maxwell", "max": 2.0},
        "engine": {"kind": "exact"},
        "protocol": [] if is_crystal else grow[:1 if packing_fraction <= _DENSE else 2],
        "observe": {"every": 1, "equilibration": 0.25, "structure_every": 1, "pair_correlation_range": 2.0, "pair_correlation_bins": 10,
                    "defects_every": 1},
        "run": {"seed": seed},
    }


def run_of(system: System, packing_fraction: float, kind: str, samples: int, seed: int) -> Run:
    """Disks of one system at one packing fraction from one kind of start."""
    settings = _settings(system.disks, packing_fraction, kind, seed)
    # A time step is a diameter of the start over the largest speed.
    diameter = math.sqrt(settings["disks"]["packing_fraction"] / packing_fraction)
    settings["engine"]["time_step"] = system.collisions_per_disk / _COLLISION_RATE / samples * 2.0 / diameter
    settings["run"]["steps"] = samples
    work = system.disks * (1.4e-7 * system.collisions_per_disk + 1.3e-8 * system.frames * min(system.disks, 10_000) + 3e-6 * samples)
    return Run(json.dumps(settings, sort_keys=True), system.frames, work,
               f"{system.disks} disks at {packing_fraction} from the {kind}, seed {seed}")


def at_pressure(extent: ConstantPressure, pressure: float, seed: int) -> Run:
    """Monte Carlo at constant pressure, from a liquid."""
    settings = _settings(extent.disks, _DENSE, LIQUID, seed)
    settings["protocol"] = [{**settings["protocol"][0], "until_packing_fraction": 0.62},
                            {"stage": "monte_carlo", "sweeps": extent.sweeps, "pressure": pressure}]
    return Run(json.dumps(settings, sort_keys=True), 0, 1.5e-7 * extent.disks * extent.sweeps,
               f"{extent.disks} disks at P* = {pressure}, seed {seed}")


class _Recorder:
    """Counts the disks in cells in every sample, and measures correlations in some."""

    def __init__(self, steps: int, frames: int, equilibration: float) -> None:
        self.steps = steps
        self.counts: list[NDArray[np.int64]] = []
        self.peaks: list[float] = []
        self.curves: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        self._first = math.ceil(equilibration * steps)
        self._every = max(1, (steps - self._first) // frames) if frames else 0

    def see(self, simulation: Simulation) -> None:
        step = simulation.clock.step
        if step <= self._first:
            return
        points, side = np.array(simulation.agents.positions), float(simulation.box.width)
        cells = max(4, round(side / _CELL))
        column, row = (points * (cells / side)).astype(np.int64).T % cells
        self.counts.append(np.bincount(column * cells + row, minlength=cells * cells))
        if self._every and (step - self._first) % self._every == 0:
            self._measure(points, side)

    def _measure(self, points: NDArray[np.float64], side: float) -> None:
        reach = min(int(side / 2.0), _FARTHEST)
        psi = bond_orientation(points, box=side, neighbors=voronoi(points, side).neighbors)
        peak = structure_peak(points, side)
        self.peaks.append(peak.height)
        orders = psi, np.exp(1j * points @ peak.at)
        curves = [order_correlation(points, order, side, range=float(reach), bins=reach).correlation for order in orders]
        self.curves.append((curves[0], curves[1]))


@dataclasses.dataclass(frozen=True, eq=False)
class Outcome:
    """What the study keeps of a run: series of samples that count, mean correlations, and results."""

    arrays: dict[str, Any]

    @classmethod
    def of(cls, simulation: Simulation, recorder: _Recorder, seconds: float) -> Outcome:
        arrays: dict[str, Any] = {"state_hash": simulation.state_hash, "seconds": seconds}
        for name, result in simulation.results.items():
            if name in ("compressibility_factor", "packing_fraction_at_pressure", "defect_fraction"):
                arrays[name] = np.array([result.value, math.nan if result.error is None else result.error])
        if recorder.steps:
            series = simulation.series[-len(recorder.counts):]
            for name in ("compressibility_factor", "global_bond_orientation_order", *DEFECTS):
                arrays[f"series.{name}"] = np.array(series[name])
            arrays["counts"] = np.array(recorder.counts)
        if recorder.curves:
            arrays["peaks"] = np.array(recorder.peaks)
            arrays["curves"] = np.mean(recorder.curves, axis=0)
        return cls(arrays)

    def result(self, name: str) -> tuple[float, float]:
        """A mean and its error from blocks; nan where there is none."""
        value, error = self.arrays[name]
        return float(value), float(error)

    def series(self, name: str) -> NDArray[np.float64]:
        """The samples that count."""
        return np.asarray(self.arrays[f"series.{name}"], dtype=np.float64)

    @property
    def order(self) -> NDArray[np.float64]:
        """|Ψ6| of the samples that count."""
        return self.series("global_bond_orientation_order")

    @property
    def counts(self) -> NDArray[np.int64]:
        """Disks in each cell, shape (samples, cells)."""
        return np.asarray(self.arrays["counts"], dtype=np.int64)

    @property
    def peaks(self) -> NDArray[np.float64]:
        """S(G)/N of the frames."""
        return np.asarray(self.arrays["peaks"], dtype=np.float64)

    def curve(self, number: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Distances and g₆(r), number 0, or c_G(r), number 1, from a diameter on."""
        values = np.asarray(self.arrays["curves"], dtype=np.float64)[number]
        return np.arange(1, len(values), dtype=np.float64) + 0.5, values[1:]
