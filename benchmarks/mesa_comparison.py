#!/usr/bin/env python3
"""Models of the public comparison of agent frameworks in Gridlock and in Mesa, in turns in one process.

    git clone https://github.com/JuliaDynamics/ABMFrameworksComparison comparison
    pip install mesa==3.2.0 numba
    cmake --build build --target gridlock_bench_mesa_comparison
    PYTHONPATH=build/python benchmarks/mesa_comparison.py comparison --rounds 5

Each round makes and runs every model once, with a seed of its own, on processor time. "Gridlock, C++" is a program (mesa_comparison.cpp); "C++ from
Python" is the same model by its settings, most of whose time in small models reads them. Boids of C++ act all at once. Mesa runs the programs of
the comparison as they are. Its table of results has the ratios of Mesa to Agents.jl, measured there on one machine: the least time of Mesa here
divided by them is what Agents.jl would take here.

The published wolves and sheep in Mesa never run the simulator by which their grass grows, so that all animals die; "mended" runs it.
"""

import argparse
import gc
import importlib
import os
import pathlib
import subprocess
import sys
import time
import warnings

import numpy as np
from result_file import ROOT, ResultFile

import gridlock
from gridlock.library import Boids, Schelling, WolfSheep

# Mesa 3.2.0 to Agents.jl 6.2.10; github.com/JuliaDynamics/ABMFrameworksComparison, README.md of 22 February 2026.
PUBLISHED = {
    "wolf_sheep small": 9.38, "wolf_sheep large": 3.28, "flocking small": 159.29, "flocking large": 59.5,
    "schelling small": 29.73, "schelling large": 26.66,
}
STEPS = {"schelling": 20, "wolf_sheep": 100, "flocking": 100}
WALLS = {"box.edge": "wall"}


def sky(side):
    return {"box": {"width": side, "height": side, "edge": "periodic"}}


def flocking(count, radius):
    return {"model.kind": "flocking", "flocking": {"rule": "boids", "count": count, "radius": radius, "speed": 1.0}}


LARGE_CITY = dict(side=100, count=8000, radius=2, wanted=8)
LARGE_MEADOW = dict(side=100, sheep=1000, wolves=500, regrowth=10, sheep_birth=0.4, wolf_birth=0.2)
# Settings of each model in Python and in C++.
OURS = {
    "schelling small": ({"model": Schelling(), **WALLS}, {"model.kind": "segregation", **WALLS}),
    "schelling large": ({"model": Schelling(**LARGE_CITY), **WALLS}, {"model.kind": "segregation", "segregation": LARGE_CITY, **WALLS}),
    "wolf_sheep small": ({"model": WolfSheep(), **WALLS}, {"model.kind": "predation", **WALLS}),
    "wolf_sheep large": ({"model": WolfSheep(**LARGE_MEADOW), **WALLS}, {"model.kind": "predation", "predation": LARGE_MEADOW, **WALLS}),
    "flocking small": ({"model": Boids(), **sky(100.0)}, {**flocking(200, 5.0), **sky(100.0)}),
    "flocking large": ({"model": Boids(count=400, radius=15.0), **sky(150.0)}, {**flocking(400, 15.0), **sky(150.0)}),
}


def run_ours(settings, steps):
    def run(seed):
        simulation = gridlock.Simulation({**settings, "engine.threads": 1, "observe.every": 1_000_000, "observe.structure_every": 0, "run.seed": seed})
        simulation.run(steps=steps)

    return run


def programs_of_ours(model, program):
    """Functions that return the milliseconds of a model, given a seed, by name."""
    steps = STEPS[model.split()[0]]
    in_python, in_cpp = (run_ours(settings, steps) for settings in OURS[model])

    def run_program(seed):
        return float(subprocess.run([program, model, str(seed)], check=True, capture_output=True, text=True).stdout)

    return {"Gridlock, Python": timed(in_python), "Gridlock, C++ from Python": timed(in_cpp), "Gridlock, C++": run_program}


def programs_of_mesa(comparison):
    """Functions that make and run the models of the comparison, given a seed, by name."""
    for folder in ("Schelling", "WolfSheep", "Flocking"):
        sys.path.insert(0, str(comparison / folder / "Mesa"))
    make = {name: getattr(importlib.import_module(module), name)
            for module, name in (("Schelling", "SchellingModel"), ("WolfSheep", "WolfSheep"), ("Flocking", "BoidFlockers"))}

    def run(name, steps, values, *, is_mended=False):
        def once(seed):
            model = make[name](seed, *values)
            if is_mended:
                model.simulator.run_for(steps)
            else:
                for _ in range(steps):
                    model.step()

        return once

    meadows = {"small": (25, 25, 60, 40, 0.2, 0.1, 20), "large": (100, 100, 1000, 500, 0.4, 0.2, 10)}
    programs = {"schelling small": {"Mesa": run("SchellingModel", 20, (40, 40, 3, 1, 0.625))},
                "schelling large": {"Mesa": run("SchellingModel", 20, (100, 100, 8, 2, 0.8))},
                "flocking small": {"Mesa": run("BoidFlockers", 100, (200, 100, 100, 5))},
                "flocking large": {"Mesa": run("BoidFlockers", 100, (400, 150, 150, 15))}}
    for size, values in meadows.items():
        programs[f"wolf_sheep {size}"] = {"Mesa": run("WolfSheep", 100, values), "Mesa, mended": run("WolfSheep", 100, values, is_mended=True)}
    return programs


def timed(run):
    def milliseconds(seed):
        gc.collect()  # Nobody pays for the garbage of those before it.
        began = time.process_time()
        run(seed)
        return 1000 * (time.process_time() - began)

    return milliseconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("comparison", type=pathlib.Path, help="a clone of the public comparison")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/benchmarks/gridlock_bench_mesa_comparison")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "benchmarks/results/mesa_comparison.csv")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    mesa = programs_of_mesa(options.comparison)
    file = ResultFile(options.output, f"Mesa {importlib.import_module('mesa').__version__}, NumPy {np.__version__}; {options.rounds} rounds in turns; "
                      f"{os.getloadavg()[0]:.1f} programs at work on {os.cpu_count()} cores at the beginning; benchmarks/mesa_comparison.py")
    file.write("benchmark,name,milliseconds_min,milliseconds_median,to_mesa,published_mesa_to_agents,to_agents")
    for model, published in PUBLISHED.items():
        ours = programs_of_ours(model, options.program)
        programs = {**{name: timed(run) for name, run in mesa[model].items()}, **ours}
        for run in ours.values():
            run(0)  # Numba compiles.
        times = {name: [] for name in programs}
        for seed in range(1, options.rounds + 1):
            for name, run in programs.items():
                times[name].append(run(seed))
        mesa_least = min(times["Mesa"])
        for name, measured in times.items():
            least = min(measured)
            file.write(f"{model},\"{name}\",{least:.2f},{np.median(measured):.2f},{mesa_least / least:.2f},{published},{mesa_least / published / least:.2f}")


main()
