#!/usr/bin/env python3
"""Mean time of 100 steps of 80,000 birds and of 200,000 agents of Schelling's, without making them, as FLAMEGPU/ABM_Framework_Comparisons has it.

    PYTHONPATH=build/python comparisons/flamegpu/ABM_Framework_Comparisons/Gridlock/benchmark.py

In the plane, as FLAME GPU's program boids2D: 400 × 400, periodic, 39 neighbours each. Birds act at the same time there, as in Gridlock's C++; in those of
Agents.jl, Mesa and Gridlock's Python they act one after the other. The rule is that of Agents.jl and Mesa. FLAME GPU's has another separation,
(1 − r/r0)² (x − y), keeps 0.5 ≤ |v| ≤ 1, and takes a bird's old velocity away where it has neighbours. Cities have walls, as with Agents.jl;
those of FLAME GPU and Mesa have none, and FLAME GPU's agents move at the same time.
"""

import statistics
import sys
import time

import gridlock
from gridlock.library import Boids, Schelling

SAMPLES = int(sys.argv[1]) if len(sys.argv) > 1 else 3
SKY = {"box": {"width": 400.0, "height": 400.0, "edge": "periodic"}}
CITY = {"side": 500, "count": 200_000, "radius": 1, "wanted": 3}
FLOCK = {"model.kind": "flocking", "flocking": {"rule": "boids", "count": 80_000, "radius": 5.0, "speed": 1.0}, **SKY}
MODELS = {
    "Flocking, C++": {**FLOCK, "engine.threads": 1},
    "Flocking, C++, all cores": FLOCK,
    "Flocking, Python": {"model": Boids(count=80_000), **SKY, "engine.threads": 1},
    "Schelling, C++": {"model.kind": "segregation", "segregation": CITY, "box.edge": "wall"},
    "Schelling, Python": {"model": Schelling(**CITY), "box.edge": "wall", "engine.threads": 1},
}


def seconds(settings, seed):
    simulation = gridlock.Simulation({**settings, "observe.every": 101, "observe.structure_every": 0, "run.seed": seed})
    began = time.perf_counter()
    simulation.run(steps=100)
    return time.perf_counter() - began


for name, settings in MODELS.items():
    times = [1e3 * seconds(settings, seed) for seed in range(SAMPLES + 1)][1:]  # Numba compiles in the first.
    print(f"Gridlock {name} (mean ms): {statistics.mean(times):.1f}", flush=True)
