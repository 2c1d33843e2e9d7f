#!/usr/bin/env python3
"""Eight pictures of what Gridlock simulates, each made from its own simulation.

    python examples/gallery.py DIR            # half a minute on two cores, with a million disks
    python examples/gallery.py DIR --small    # some seconds

Needs the Python package with its plots: pip install ".[plots]" in the sources.
"""

from __future__ import annotations

import argparse
import pathlib
import tempfile
import warnings
from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import gridlock
import gridlock.plot as plot

PERIODIC = {"box": {"edge": "periodic"}}


def save(directory: pathlib.Path, name: str, draw: Callable[[Axes], None], size: tuple[float, float] = (3.4, 2.55)) -> None:
    figure = Figure(figsize=size, layout="constrained")
    draw(figure.subplots())
    figure.savefig(directory / f"gallery_{name}.png", dpi=150)


def million_disks(axes: Axes, small: bool) -> None:
    """A crystal that is hot in the middle: a shock runs into the cold part."""
    count = 2_500 if small else 1_000_000
    simulation = gridlock.Simulation(PERIODIC, disks={"count": count, "packing_fraction": 0.72, "start": "triangular"},
                                     engine={"kind": "tiled", "time_step": 0.2}, velocities={"kind": "maxwell"}, threads=0)
    positions = simulation.agents.positions - 0.5
    simulation.agents.velocities *= np.where(np.hypot(*positions.T) < 0.3, 6.0, 0.2)[:, None]
    simulation.run(steps=20 if small else 60)
    plot.snapshot(simulation, "speed", limits=(0.0, 6.0), axes=axes)
    axes.set_title(f"{count:,} disks, hot in the middle")


def melting(axes: Axes, small: bool) -> None:
    simulation = gridlock.Simulation(PERIODIC, disks={"count": 400 if small else 3_600, "packing_fraction": 0.69, "start": "triangular"},
                                     engine={"kind": "exact"}, velocities={"kind": "maxwell"})
    simulation.run(steps=50 if small else 3_000)
    plot.snapshot(simulation, "psi6", axes=axes)
    axes.set_title("a crystal that melts, φ = 0.69")


def flock(axes: Axes, small: bool) -> None:
    simulation = gridlock.Simulation(PERIODIC, model={"kind": "flocking"}, flocking={"count": 2_000, "noise": 1.0}, box={"side": 22.36})
    simulation.run(steps=20 if small else 300)
    plot.snapshot(simulation, "direction", axes=axes)
    axes.set_title("Vicsek's flock, η = 1")


def mixture(axes: Axes, small: bool) -> None:
    species = [{"fraction": 0.7, "size_ratio": 1.0}, {"fraction": 0.3, "size_ratio": 2.0}]
    simulation = gridlock.Simulation(PERIODIC, disks={"count": 600, "packing_fraction": 0.62, "start": "random", "species": species},
                                     engine={"kind": "exact"})
    simulation.run(steps=20 if small else 500)
    plot.snapshot(simulation, "radius", axes=axes)
    axes.set_title("a mixture of two sizes, φ = 0.62")


def pair_correlation(axes: Axes, small: bool) -> None:
    for number, fraction in enumerate((0.3, 0.5, 0.68)):
        simulation = gridlock.Simulation(PERIODIC, disks={"count": 1_000, "packing_fraction": fraction}, engine={"kind": "exact"},
                                         observe={"every": 10, "structure_every": 1})
        simulation.equilibrate(steps=10 if small else 400)
        simulation.run(steps=20 if small else 1_000)
        plot.curve(simulation, "pair_correlation", label=f"φ = {fraction}", axes=axes)
    axes.set_xlim(0.8, 5)
    axes.legend()


def displacement(axes: Axes, small: bool) -> None:
    """The mean over seeds with its standard error."""
    colours = plot.sequential(3)
    for colour, fraction in zip(colours, (0.3, 0.5, 0.65)):
        runs = []
        for seed in range(1, 4 if small else 9):
            simulation = gridlock.Simulation(disks={"count": 100, "packing_fraction": fraction}, run={"seed": seed}, observe={"every": 20})
            simulation.run(steps=200 if small else 6_000)
            runs.append(simulation.series["mean_displacement"])
        error = np.std(runs, axis=0, ddof=1) / np.sqrt(len(runs))
        plot.line(axes, simulation.series["time"], np.mean(runs, axis=0), error, label=f"φ = {fraction}", color=colour)
    plot.reference(axes, 0.1, "10 % of the box")
    axes.set(xlabel=plot.axis_label("time"), ylabel=plot.axis_label("mean_displacement"), title="the paper's rule between walls", ylim=(0, 0.68))
    axes.legend(loc="upper left", ncols=3)


def equation_of_state(axes: Axes, small: bool) -> None:
    """Exact dynamics and the rule with its time step, beside the equation of Henderson (1975), doi:10.1080/00268977500102511."""
    with tempfile.TemporaryDirectory() as directory:
        made = gridlock.sweep({"box.edge": "periodic", "disks.count": 400, "run.steps": 100 if small else 3_000, "observe.every": 20},
                              {"disks.packing_fraction": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.65], "engine.kind": ["exact", "tiled"]}, directory)
        plot.sweep(made, "compressibility_factor", axes=axes)
    fraction = np.linspace(0.05, 0.69, 100)
    plot.line(axes, fraction, (1 + fraction**2 / 8) / (1 - fraction) ** 2, color="black", linestyle=":")


def speeds(axes: Axes, small: bool) -> None:
    simulation = gridlock.Simulation(PERIODIC, disks={"count": 400, "packing_fraction": 0.4}, engine={"kind": "exact"}, observe={"every": 10})
    simulation.equilibrate(steps=20 if small else 200)
    simulation.run(steps=40 if small else 3_000)
    plot.curve(simulation, "speed_distribution", axes=axes)


PICTURES = {"million_disks": million_disks, "melting": melting, "flock": flock, "mixture": mixture, "pair_correlation": pair_correlation,
            "displacement": displacement, "equation_of_state": equation_of_state, "speeds": speeds}
BOXES = ("million_disks", "melting", "flock", "mixture")


def main() -> None:
    parser = argparse.ArgumentParser(description="Eight pictures of what Gridlock simulates.")
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path)
    parser.add_argument("--small", action="store_true", help="small systems, for a look in some seconds")
    options = parser.parse_args()
    options.directory.mkdir(parents=True, exist_ok=True)
    warnings.simplefilter("ignore")  # what a run would note
    with plot.style():
        for name, draw in PICTURES.items():
            save(options.directory, name, lambda axes: draw(axes, options.small), (3.4, 2.9) if name in BOXES else (3.4, 2.55))
            print(options.directory / f"gallery_{name}.png")


if __name__ == "__main__":
    main()
