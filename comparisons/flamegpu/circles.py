#!/usr/bin/env python3
"""Circles, the benchmark of neighbour searches of FLAME GPU 2, in the plane: the time of a step by the number of agents.

    PYTHONPATH=build/python comparisons/flamegpu/circles.py 10000 100000

Rules and parameters of github.com/FLAMEGPU/FLAMEGPU2-circles-benchmark: density 1, radius of communication 2, repulsion 0.05, 200 steps, all
agents at the same time. In a step an agent moves by the mean over its neighbours of k r/|r|, with k = 0.05 sin(−2π |r|/2) and r the vector to the
neighbour. The published benchmark has three dimensions, where an agent has 33 neighbours, and an open box; here there are two, 11.6
neighbours and a periodic box, so that its times are not to be set beside the published ones: seconds for each neighbour visited may be.

Source: R. Chisholm, P. Richmond, S. Maddock (2016), doi:10.1007/978-3-319-58943-5_25.
"""

import math
import sys
import time

import gridlock

STEPS = 200


@gridlock.register_model
class Circles(gridlock.Model):
    """Agents that come to a distance of half the radius from each other."""

    name = "circles"
    observations = {"neighbors": "Mean number within the radius."}
    count = gridlock.Setting(10_000, "Agents.", least=1)
    cutoff = gridlock.Setting(2.0, "How far agents see each other.", unit="length", least=1e-6)
    repulsion = gridlock.Setting(0.05, "Scale of a move.", unit="length")

    def start(self, start):
        start.add(positions=start.anywhere(self.count))

    @staticmethod
    def turn(row, neighbors, separations, now, next, settings, random, events):
        for k in range(len(neighbors)):
            x, y = separations[k]
            distance = math.sqrt(x * x + y * y)
            if distance > 0:
                factor = settings.repulsion * math.sin(-2 * math.pi * distance / settings.cutoff) / (distance * len(neighbors))
                next.dx[row] += factor * x
                next.dy[row] += factor * y

    def observe(self, world):
        return {"neighbors": world.neighbors(self.cutoff).counts.mean()}


def main():
    if not all(word.isdigit() and int(word) > 0 for word in sys.argv[1:]):
        sys.exit("usage: circles.py [AGENTS…]")
    print("agents,milliseconds_a_step,nanoseconds_a_neighbor")
    for count in [int(word) for word in sys.argv[1:]] or [10_000]:
        side = math.sqrt(count)
        simulation = gridlock.Simulation({"model": Circles(count=count), "box": {"width": side, "height": side, "edge": "periodic"},
                                          "engine.threads": 1, "observe.every": STEPS + 1, "run.seed": 1})
        simulation.run(steps=1)  # Numba compiles.
        began = time.process_time()
        simulation.run(steps=STEPS)
        seconds = (time.process_time() - began) / STEPS
        neighbors = simulation.series["neighbors"][-1]
        print(f"{count},{1e3 * seconds:.3f},{1e9 * seconds / count / neighbors:.1f}")


main()
