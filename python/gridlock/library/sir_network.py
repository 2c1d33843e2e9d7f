"""A disease on a network: susceptible, infected, recovered."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import gridlock

SUSCEPTIBLE, INFECTED, RECOVERED = range(3)


@gridlock.register_model
class SIRNetwork(gridlock.Model):
    """People who infect their contacts on a network and recover.

    In a step each infected person infects each susceptible contact with the probability ``infection``, and then recovers with the
    probability ``recovery``. Whoever is infected infects others from the next step on. With ``recovery`` 1 on a complete network this is the
    chain of Reed and Frost, on any network the percolation of its edges. A large network at random, with c contacts each, of whom few are
    infected at first, spares with ``recovery`` 1 the share s = exp(−c p (1 − s)), where p is ``infection``.

    Cost: about 0.2 µs a person and step, and 0.5 µs an edge at the start.

    Source: M. E. J. Newman (2002), doi:10.1103/PhysRevE.66.016128; F. Ball (1986), doi:10.2307/1427301, for the exact sizes of epidemics.
    """

    name = "sir_network"
    columns = {"health": np.uint32}
    value_names = {"health": ("susceptible", "infected", "recovered")}
    networks = {"contacts": gridlock.Network()}
    events = ("infections", "recoveries")
    observations = {"susceptible": "People.", "infected": "People.", "recovered": "People."}
    charts = {"People": ("susceptible", "infected", "recovered")}

    count = gridlock.Setting(2000, "People.", least=3)
    network = gridlock.Setting("small world", "Who meets whom.", choices=["scale free", "small world", "at random", "complete"])
    degree = gridlock.Setting(6, "Contacts on average; even. A complete network has all.", least=2, most=1000)
    rewiring = gridlock.Setting(0.1, "Share of the edges of a small world that lead anywhere.", least=0.0, most=1.0)
    infected_at_start = gridlock.Setting(0.005, "Share of people, any of them alike.", least=0.0, most=1.0)
    infection = gridlock.Setting(0.1, "Probability that a contact is infected in a step.", least=0.0, most=1.0)
    recovery = gridlock.Setting(0.2, "Probability that an infected person recovers in a step.", least=0.0, most=1.0)

    def check(self, box: gridlock.Box) -> None:
        if self.network != "complete" and (self.degree % 2 or self.degree >= self.count):
            raise gridlock.Error(f"each of {self.count} people has {self.degree} contacts\n"
                                 "  hint: use an even degree below the count, or network = \"complete\"")

    def start(self, start: gridlock.Start) -> None:
        first = np.argsort(start.uniform(self.count, purpose=1), kind="stable")
        health = np.zeros(self.count, dtype=np.uint32)
        health[first[: int(self.infected_at_start * self.count + 0.5)]] = INFECTED
        start.add(positions=start.anywhere(self.count), health=health)
        if self.network == "scale free":
            start.contacts.connect_scale_free(self.degree // 2)
        elif self.network == "small world":
            start.contacts.connect_small_world(self.degree, self.rewiring)
        else:
            start.contacts.connect_at_random(probability=1.0 if self.network == "complete" else self.degree / (self.count - 1))

    def step(self, world: gridlock.World) -> None:
        random = world.uniform(2)
        sick = world.health == INFECTED
        exposures = world.contacts.neighbors().sum(sick).astype(np.int64)
        # Products in place of a power, whose last bit depends on the machine.
        escape = np.cumprod([1.0] + [1 - self.infection] * int(exposures.max(initial=0)))
        falls_ill = (world.health == SUSCEPTIBLE) & (random[:, 0] >= escape[exposures])
        recovers = sick & (random[:, 1] < self.recovery)
        world.health[falls_ill] = INFECTED
        world.health[recovers] = RECOVERED
        world.count("infections", int(falls_ill.sum()))
        world.count("recoveries", int(recovers.sum()))

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        counts = np.bincount(world.health, minlength=3)
        return {"susceptible": counts[SUSCEPTIBLE], "infected": counts[INFECTED], "recovered": counts[RECOVERED]}
