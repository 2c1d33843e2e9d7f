#!/usr/bin/env python3
"""Agents that stand still: a forest fire of 200 × 200 patches as agents, as a field and in NumPy alone, in turns in one run.

    PYTHONPATH=build/python benchmarks/standing_agents.py 200 7
"""

import sys
import time

import numpy as np

import gridlock


@gridlock.register_model
class Patches(gridlock.Model):
    """Patches that stand on the points of a lattice; burning ones set fire to those beside them."""

    name = "patches"
    columns = {"state": np.uint32}
    value_names = {"state": ("bare", "tree", "on fire", "burnt")}
    side = gridlock.Setting(200, "Patches along each side.", least=2)
    density = gridlock.Setting(0.6, "Share of patches with a tree.", least=0.0, most=1.0)

    def start(self, start):
        row, column = np.divmod(np.arange(self.side**2), self.side)
        length = start.box.width / self.side
        state = (start.uniform(self.side**2) < self.density) * np.where(column == 0, 2, 1)
        start.add(x=(column + 0.5) * length, y=(row + 0.5) * length, state=state)

    def step(self, world):
        burning = np.flatnonzero(world.state == 2)
        beside = world.neighbors(1.1 * world.box.width / self.side).of(burning)
        world.state[beside[world.state[beside] == 1]] = 2
        world.state[burning] = 3

    def observe(self, world):
        return {"burnt": np.mean(world.state == 3)}


class Everywhere(Patches):
    """The same, where all patches look at all neighbours."""

    name = "everywhere"

    def step(self, world):
        fire = world.state == 2
        near = world.neighbors(1.1 * world.box.width / self.side).sum(fire)
        world.state[(near > 0) & (world.state == 1)] = 2
        world.state[fire] = 3


class Forest(Patches):
    """The same as a field."""

    name = "forest_in_field"
    columns = {}
    value_names = {}
    fields = {"forest": gridlock.Field("side")}

    def start(self, start):
        start.forest = forest_of(start.uniform(self.side**2) < self.density, self.side)

    def step(self, world):
        spread(world.forest)

    def observe(self, world):
        return {"burnt": np.mean(world.forest == 3)}


def forest_of(trees, side):
    forest = trees.reshape(side, side) * 1.0
    forest[:, 0] *= 2
    return forest


def spread(forest):
    fire = forest == 2
    near = np.zeros_like(fire)
    near[1:] |= fire[:-1]
    near[:-1] |= fire[1:]
    near[:, 1:] |= fire[:, :-1]
    near[:, :-1] |= fire[:, 1:]
    forest[near & (forest == 1)] = 2
    forest[fire] = 3


class Alone:
    """NumPy without Gridlock, with the trees of a simulation."""

    def __init__(self, simulation: gridlock.Simulation) -> None:
        self.forest = simulation.frame.fields["forest"].copy()

    def run(self, steps: int) -> None:
        for _ in range(steps):
            spread(self.forest)


def main() -> None:
    side, turns = int(sys.argv[1]), int(sys.argv[2])
    steps = 5 * side
    times: dict[str, list[float]] = {"NumPy": [], "field": [], "agents": [], "agents, all look": []}
    burnt: dict[str, float] = {}
    for turn in range(turns):
        common = {"engine": {"threads": 1}, "observe": {"every": 1_000_000, "structure_every": 0}, "run": {"seed": turn}}
        models = {"field": Forest, "agents": Patches, "agents, all look": Everywhere}
        runs = {label: gridlock.Simulation(model=model(side=side), **common) for label, model in models.items()}
        alone = Alone(runs["field"])
        for label, run in {"NumPy": alone, **runs}.items():
            began = time.process_time()
            run.run(steps) if run is alone else run.run(steps=steps)
            times[label].append(time.process_time() - began)
        burnt = {
            "NumPy": np.mean(alone.forest == 3),
            "field": np.mean(runs["field"].frame.fields["forest"] == 3),
            **{label: np.mean(runs[label].agents.state == 3) for label in ("agents", "agents, all look")},
        }
    base = float(np.median(times["NumPy"]))
    for label, measured in times.items():
        median = float(np.median(measured))
        print(f"{label:<17} {1e6 * median / steps:8.1f} µs a step of {side} × {side}, {median / base:5.2f} times NumPy, {burnt[label]:.4f} burnt")


main()
