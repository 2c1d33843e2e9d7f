#!/usr/bin/env python3
"""A model in Python beside the same model in C++: Vicsek's flock, in turns in one run.

    pip install numba
    PYTHONPATH=build/python benchmarks/python_model.py 100000 7
"""

import sys
import time

import numpy as np

import gridlock


@gridlock.register_model
class Flock(gridlock.Model):
    """Agents of constant speed that turn to where their neighbours go (Vicsek et al. 1995, doi:10.1103/PhysRevLett.75.1226)."""

    name = "flock"
    columns = {"heading_x": float, "heading_y": float}
    count = gridlock.Setting(400, "Agents.", least=1)
    radius = gridlock.Setting(1.0, "How far an agent sees.", unit="length", least=0.0)
    speed = gridlock.Setting(0.03, "Of every agent.", unit="length / step", least=0.0)
    noise = gridlock.Setting(1.0, "Headings turn by an angle in [-noise/2, noise/2].", unit="radian", least=0.0)

    def start(self, start):
        angle = 2 * np.pi * start.uniform(self.count)
        start.add(positions=start.anywhere(self.count), heading_x=np.cos(angle), heading_y=np.sin(angle))

    def step(self, world):
        heading = np.stack([world.heading_x, world.heading_y], axis=1)
        mean = heading + world.neighbors(self.radius).sum(heading)
        angle = np.arctan2(mean[:, 1], mean[:, 0]) + self.noise * (world.uniform() - 0.5)
        world.move(self.speed * heading)
        world.heading_x = np.cos(angle)
        world.heading_y = np.sin(angle)

    def observe(self, world):
        return {"order": np.hypot(world.heading_x.mean(), world.heading_y.mean())}


@gridlock.register_model
class FlockInTurns(Flock):
    """The same, agent by agent."""

    name = "flock_in_turns"
    cutoff = property(lambda self: self.radius)
    step = gridlock.Model.step

    @staticmethod
    def turn(row, neighbors, separations, now, next, settings, random, events):
        x, y = now.heading_x[row], now.heading_y[row]
        next.dx[row], next.dy[row] = settings.speed * x, settings.speed * y
        for k in neighbors:
            x += now.heading_x[k]
            y += now.heading_y[k]
        angle = np.arctan2(y, x) + settings.noise * (random[0] - 0.5)
        next.heading_x[row], next.heading_y[row] = np.cos(angle), np.sin(angle)


def main() -> None:
    agents, turns = int(sys.argv[1]), int(sys.argv[2])
    side = float(np.sqrt(agents * np.pi / 6.0))  # six neighbours each
    common = {"box": {"width": side, "height": side, "edge": "periodic"}, "engine": {"threads": 1}, "observe": {"every": 1_000_000, "structure_every": 0}}
    steps = max(1, 2_000_000 // agents)
    names = {"C++": "flocking", "Python": "flock", "Numba": "flock_in_turns"}
    models = {label: gridlock.Simulation({**common, "model.kind": kind, f"{kind}.count": agents}) for label, kind in names.items()}
    for simulation in models.values():
        simulation.run(steps=steps)
    times: dict[str, list[float]] = {label: [] for label in models}
    for _ in range(turns):
        for label, simulation in models.items():
            began = time.perf_counter()
            simulation.run(steps=steps)
            times[label].append((time.perf_counter() - began) / steps / agents * 1e9)
    base = float(np.median(times["C++"]))
    for label, measured in times.items():
        print(f"{label:<8} {np.min(measured):8.1f} least {np.median(measured):8.1f} ns per agent and step, "
              f"{np.median(measured) / base:5.2f} times C++, state hash {models[label].state_hash}")


main()
