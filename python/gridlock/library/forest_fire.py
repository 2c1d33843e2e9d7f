"""A forest fire: percolation made visible."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import gridlock

BARE, TREE, BURNING, BURNT = range(4)


@gridlock.register_model
class ForestFire(gridlock.Model):
    """Trees on a grid that burn for one step and set fire to the trees beside them.

    Each cell has a tree with the probability ``density``. The fire begins in the whole leftmost column, and reaches every tree that a chain of
    neighbours joins to it. A large forest burns through where the density is above the threshold of site percolation: 0.59274605 with four
    neighbours, 1 − 0.59274605 with eight. At the threshold it burns through with the probability 1/2.

    An automaton: a field with a step, without agents. Cost: about 3 ns a cell and step.

    Source: M. E. J. Newman, R. M. Ziff (2000), doi:10.1103/PhysRevLett.85.4104, for the threshold; R. M. Ziff (1992),
    doi:10.1103/PhysRevLett.69.2670, for the probability.
    """

    name = "forest_fire"
    fields = {"forest": gridlock.Field("side", "0 bare, 1 a tree, 2 burning, 3 burnt.")}
    observations = {
        "burning": "Trees on fire.",
        "burnt": "Share of the trees that burn or have burnt.",
        "crossed": "1 where the fire has reached the rightmost column.",
    }

    side = gridlock.Setting(200, "Cells along x.", least=2, most=20000)
    density = gridlock.Setting(0.6, "Share of cells with a tree.", least=0.0, most=1.0)
    neighbors = gridlock.Setting("four", "Whom a tree sets on fire.", choices=["four", "eight"])

    def start(self, start: gridlock.Start) -> None:
        forest = start.forest
        forest[...] = (start.uniform(forest.size) < self.density).reshape(forest.shape)
        forest[:, 0] *= BURNING

    def step(self, world: gridlock.World) -> None:
        forest = world.forest
        fire = forest == BURNING
        near = fire.copy()
        near[1:] |= fire[:-1]
        near[:-1] |= fire[1:]
        beside = near.copy() if self.neighbors == "eight" else fire
        near[:, 1:] |= beside[:, :-1]
        near[:, :-1] |= beside[:, 1:]
        forest[near & (forest == TREE)] = BURNING
        forest[fire] = BURNT

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        forest = world.forest
        trees = int(np.count_nonzero(forest))
        return {
            "burning": int(np.count_nonzero(forest == BURNING)),
            "burnt": int(np.count_nonzero(forest >= BURNING)) / max(trees, 1),
            "crossed": bool((forest[:, -1] >= BURNING).any()),
        }
