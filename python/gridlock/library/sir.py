"""A disease among walkers: susceptible, infected, recovered."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

import gridlock

if TYPE_CHECKING:
    from numpy.typing import NDArray

SUSCEPTIBLE, INFECTED, RECOVERED = range(3)


@gridlock.register_model
class SIR(gridlock.Model):
    """Walkers that infect those near them and recover.

    In a step of length dt a susceptible agent with k infected agents within the radius is infected with the probability 1 − (1 − β dt)^k, an
    infected one recovers with γ dt, and all take a new direction with ``turning_rate`` dt. Where walkers mix fast, the numbers follow
    dS/dt = −β n S I/N, with n = N π r²/A. The law of Gridlock's model ``epidemic`` in C++ without births.

    Cost: about 0.3 µs an agent and step. Source: W. O. Kermack, A. G. McKendrick (1927), doi:10.1098/rspa.1927.0118.
    """

    name = "sir"
    columns = {"velocity_x": float, "velocity_y": float, "health": np.uint32}
    value_names = {"health": ("susceptible", "infected", "recovered")}
    events = ("infections", "recoveries")
    observations = {"susceptible": "Agents.", "infected": "Agents.", "recovered": "Agents."}
    charts = {"Agents": ("susceptible", "infected", "recovered")}

    count = gridlock.Setting(2000, "Agents.", least=1)
    infected_at_start = gridlock.Setting(0.01, "Share of them.", least=0.0, most=1.0)
    radius = gridlock.Setting(0.02, "How far the disease reaches.", unit="length", least=1e-6)
    speed = gridlock.Setting(0.05, "Of every walker.", unit="length / time", least=0.0)
    turning_rate = gridlock.Setting(1.0, "How often a walker takes a new direction.", unit="1 / time", least=0.0)
    infection_rate = gridlock.Setting(1.0, "β, for each infected agent within the radius.", unit="1 / time", least=0.0)
    recovery_rate = gridlock.Setting(0.2, "γ, of each infected agent.", unit="1 / time", least=0.0)
    time_step = gridlock.Setting(0.05, "dt; every rate times dt is a probability.", unit="time", least=1e-6)

    def check(self, box: gridlock.Box) -> None:
        for key in ("turning_rate", "infection_rate", "recovery_rate"):
            chance = self.settings[key] * self.time_step
            if chance > 1:
                raise gridlock.Error(f"{key} · time_step is {chance:g}, but is a probability\n  hint: use a smaller time_step or a smaller rate")

    def start(self, start: gridlock.Start) -> None:
        velocity = self._walk(start.normal(self.count, 2))
        sick = int(self.infected_at_start * self.count + 0.5)
        start.add(positions=start.anywhere(self.count), velocity_x=velocity[:, 0], velocity_y=velocity[:, 1],
                  health=np.arange(self.count) < sick)

    def step(self, world: gridlock.World) -> None:
        dt = self.time_step
        random = world.uniform(3)
        sick = world.health == INFECTED
        escape = (1 - self.infection_rate * dt) ** world.neighbors(self.radius).sum(sick)
        falls_ill = (world.health == SUSCEPTIBLE) & (random[:, 0] >= escape)
        recovers = sick & (random[:, 1] < self.recovery_rate * dt)
        world.health[falls_ill] = INFECTED
        world.health[recovers] = RECOVERED
        world.count("infections", int(falls_ill.sum()))
        world.count("recoveries", int(recovers.sum()))
        turns = random[:, 2] < self.turning_rate * dt
        velocity = self._walk(world.normal(2, purpose=1)[turns])
        world.velocity_x[turns], world.velocity_y[turns] = velocity.T
        bounces = world.move(dt * np.stack([world.velocity_x, world.velocity_y], axis=1))
        world.velocity_x[bounces[:, 0]] *= -1
        world.velocity_y[bounces[:, 1]] *= -1

    def _walk(self, normal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Velocities in any direction, made of two numbers of a normal distribution each."""
        velocities: NDArray[np.float64] = normal * (self.speed / np.sqrt((normal**2).sum(axis=1)))[:, None]
        return velocities

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        counts = np.bincount(world.health, minlength=3)
        return {"susceptible": counts[SUSCEPTIBLE], "infected": counts[INFECTED], "recovered": counts[RECOVERED]}
