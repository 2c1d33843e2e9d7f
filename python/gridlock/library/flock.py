"""Vicsek's flock."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import gridlock


@gridlock.register_model
class Flock(gridlock.Model):
    """Agents of constant speed that turn to where their neighbours go, all at the same time.

    x' = x + v θ, θ' = direction of Σ θ_j over all agents within the radius and the agent itself, turned by an angle uniform in [−η/2, η/2].
    The law of Gridlock's model ``flocking`` in C++, which is 1.5 times as fast. Order vanishes with the noise: at η = 2π headings are
    independent, and |Σ θ| / N is √(π / 4N) on average.

    Cost: about 20 ns an agent, step and neighbour. Source: T. Vicsek et al. (1995), doi:10.1103/PhysRevLett.75.1226.
    """

    name = "flock"
    columns = {"heading_x": float, "heading_y": float}
    observations = {"order": "|Σ heading| / N: 1 where all move in one direction."}

    count = gridlock.Setting(300, "Agents.", least=1)
    radius = gridlock.Setting(1.0, "How far an agent sees.", unit="length", least=1e-6)
    speed = gridlock.Setting(0.03, "Of every agent.", unit="length / step", least=0.0)
    noise = gridlock.Setting(1.0, "η: headings turn by a random angle in [−η/2, η/2].", unit="radian", least=0.0, most=2 * np.pi)

    def start(self, start: gridlock.Start) -> None:
        angle = 2 * np.pi * start.uniform(self.count)
        start.add(positions=start.anywhere(self.count), heading_x=np.cos(angle), heading_y=np.sin(angle))

    def step(self, world: gridlock.World) -> None:
        heading = np.stack([world.heading_x, world.heading_y], axis=1)
        mean = heading + world.neighbors(self.radius).sum(heading)
        angle = np.arctan2(mean[:, 1], mean[:, 0]) + self.noise * (world.uniform() - 0.5)
        world.move(self.speed * heading)
        world.heading_x = np.cos(angle)
        world.heading_y = np.sin(angle)

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        return {"order": np.hypot(world.heading_x.mean(), world.heading_y.mean())}
