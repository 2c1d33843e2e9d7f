"""Boids, by the rules of the public comparison of agent frameworks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

import gridlock
from gridlock.turns import compiled


@gridlock.register_model
class Boids(gridlock.Model):
    """Birds that keep together, keep apart and align, one after the other in a random order.

    In its turn a bird with n neighbours within the radius takes the direction of v + (c Σ r_j − s Σ' r_j + a Σ v_j)/n, where r_j is the vector to the
    neighbour j, v_j its direction and Σ' goes over those nearer than the separation; then it moves on by its speed. Those after it see it there.

    The defaults are those of the public comparison (doi:10.5281/zenodo.8016506); its small flock has 200 birds in a periodic box of 100 × 100,
    its large one 400 of a ``radius`` of 15 in 150 × 150. Cost: with Numba 0.1 ms a step and 0.5 µs a bird; without: 3 µs a bird and 1 µs a neighbour.
    Gridlock's model ``flocking`` in C++ has ``rule = "boids"``, in which all act at the same time.

    Source: C. W. Reynolds (1987), doi:10.1145/37402.37406.
    """

    name = "boids"
    columns = {"heading_x": float, "heading_y": float}
    observations = {"order": "|Σ heading| / N: 1 where all move in one direction."}

    count = gridlock.Setting(200, "Birds.", least=1)
    radius = gridlock.Setting(5.0, "How far a bird sees.", unit="length", least=1e-6)
    speed = gridlock.Setting(1.0, "Of every bird.", unit="length / step", least=0.0)
    separation = gridlock.Setting(1.0, "Birds nearer than this keep apart.", unit="length", least=0.0)
    cohesion_factor = gridlock.Setting(0.03, "c: how much birds come together.", least=0.0, most=1e6)
    separation_factor = gridlock.Setting(0.015, "s: how much birds keep apart.", least=0.0, most=1e6)
    alignment_factor = gridlock.Setting(0.05, "a: how much birds align.", least=0.0, most=1e6)

    def check(self, box: gridlock.Box) -> None:
        if not (box.periodic_x and box.periodic_y):
            raise gridlock.Error("the sky of boids has no edges\n  hint: use box.edge = \"periodic\"")
        reach = self.radius + self.speed
        if 2 * reach > min(box.width, box.height):
            raise gridlock.Error(f"birds see and move as far as {reach:g} in a box of {box.width:g} × {box.height:g}\n"
                                 "  hint: use a larger box, or a smaller radius: beyond half a side two images of a bird are neighbours")

    def start(self, start: gridlock.Start) -> None:
        heading = start.normal(self.count, 2)
        heading /= np.sqrt((heading**2).sum(axis=1))[:, None]
        start.add(positions=start.anywhere(self.count), heading_x=heading[:, 0], heading_y=heading[:, 1])

    def step(self, world: gridlock.World) -> None:
        # While the others move, none comes from farther away than its speed.
        near = world.neighbors(self.radius + self.speed)
        box, moves = world.box, np.empty((len(world), 2))
        factors = (self.cohesion_factor, self.separation_factor, self.alignment_factor)
        _fly(world.random_order(), near.indptr.view(np.int64), near.indices, world.x.copy(), world.y.copy(), world.heading_x, world.heading_y,
             moves.ravel(), box.width, box.height, self.radius, self.speed, self.separation, *factors)
        world.move(moves)

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        return {"order": math.hypot(world.heading_x.mean(), world.heading_y.mean())}


@compiled
def _fly(order: Any, begins: Any, near: Any, x: Any, y: Any, u: Any, v: Any, moves: Any, width: float, height: float, radius: float,
         speed: float, separation: float, cohere: float, separate: float, align: float) -> None:
    for row in order:
        together_x = together_y = apart_x = apart_y = along_x = along_y = 0.0
        neighbors = 0
        for place in range(begins[row], begins[row + 1]):
            other = near[place]
            dx, dy = x[other] - x[row], y[other] - y[row]
            dx -= width * round(dx / width)
            dy -= height * round(dy / height)
            squared = dx * dx + dy * dy
            if squared > radius * radius:
                continue
            neighbors += 1
            together_x, together_y = together_x + dx, together_y + dy
            along_x, along_y = along_x + u[other], along_y + v[other]
            if squared < separation * separation:
                apart_x, apart_y = apart_x - dx, apart_y - dy
        share = 1 / max(neighbors, 1)
        to_x = u[row] + share * (cohere * together_x + separate * apart_x + align * along_x)
        to_y = v[row] + share * (cohere * together_y + separate * apart_y + align * along_y)
        length = math.sqrt(to_x * to_x + to_y * to_y)
        if length > 0:
            u[row], v[row] = to_x / length, to_y / length
        moves[2 * row], moves[2 * row + 1] = speed * u[row], speed * v[row]
        x[row] = (x[row] + moves[2 * row]) % width
        y[row] = (y[row] + moves[2 * row + 1]) % height
