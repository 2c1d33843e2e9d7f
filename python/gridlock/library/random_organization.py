"""Random organization: disks that move as long as they overlap."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

import gridlock


@gridlock.register_model
class RandomOrganization(gridlock.Model):
    """Disks that are kicked in a random direction in each step in which they overlap another one.

    A disk is active where the centre of another one is nearer than a diameter D. All active disks are kicked at the same time, each in any
    direction, by a distance uniform in [0, kick · D]. Below a critical packing fraction the disks find places where none is active, and
    nothing moves any more: an absorbing state. Above it activity never ends; above π / √12 = 0.9069, where disks have no room to lie apart,
    it cannot. Points placed at random are active with the probability 1 − (1 − π D²/A)^(N − 1).

    The isotropic variant of the model of sheared suspensions. Cost: about 0.3 µs a disk and step.

    Source: L. Corté, P. M. Chaikin, J. P. Gollub, D. J. Pine (2008), doi:10.1038/nphys891; E. Tjhung, L. Berthier (2015),
    doi:10.1103/PhysRevLett.114.148301, for the isotropic kicks.
    """

    name = "random_organization"
    columns = {"active": np.uint32}
    value_names = {"active": ("at rest", "kicked")}
    observations = {"active": "Share of the disks that overlap another one: 0 in an absorbing state."}

    count = gridlock.Setting(1000, "Disks.", least=1)
    packing_fraction = gridlock.Setting(0.3, "N π D² / 4A.", least=1e-6, most=2.0)
    kick = gridlock.Setting(0.5, "The longest kick over the diameter.", least=1e-6, most=100.0)

    def diameter(self, box: gridlock.Box) -> float:
        """D of the packing fraction."""
        return math.sqrt(4 * self.packing_fraction * box.area / (math.pi * self.count))

    def start(self, start: gridlock.Start) -> None:
        start.add(positions=start.anywhere(self.count))

    def step(self, world: gridlock.World) -> None:
        diameter = self.diameter(world.box)
        active = world.neighbors(diameter).counts > 0
        towards = world.normal(2)
        length = self.kick * diameter * world.uniform(purpose=1) * active
        world.move(towards * (length / np.sqrt((towards**2).sum(axis=1)))[:, None])
        world.active = active

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        return {"active": float(np.mean(world.neighbors(self.diameter(world.box)).counts > 0))}
