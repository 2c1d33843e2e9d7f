"""Voters who copy the opinions of others on a network."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import gridlock


@gridlock.register_model
class Voter(gridlock.Model):
    """Voters with one of two opinions, who take that of a random neighbour on a network.

    In a step each voter asks with the probability ``activity`` a neighbour, any of them alike, and takes the opinion this one had before the step;
    all at the same time. On average the share of an opinion weighted by degrees, Σ k_i s_i / Σ k_i, never changes: on a connected
    network it is the probability that all end with this opinion. On a complete network the share of edges that join different opinions falls
    by the factor 1 − 2a(1 − a)/(N − 1) − a²(N − 2)/(N − 1)² in a step, where a is the activity and N the number of voters.

    With ``activity`` 1 networks of two halves, in which each voter has neighbours in the other half alone, may alternate for ever.
    Cost: about 0.2 µs a voter and step, and 0.5 µs an edge at the start.

    Source: K. Suchecki, V. M. Eguíluz, M. San Miguel (2005), doi:10.1209/epl/i2004-10329-8; V. Sood, S. Redner (2005),
    doi:10.1103/PhysRevLett.94.178701.
    """

    name = "voter"
    columns = {"opinion": np.uint32}
    value_names = {"opinion": ("no", "yes")}
    networks = {"acquaintances": gridlock.Network()}
    events = ("changes",)
    observations = {"yes": "Share of voters.", "weighted_yes": "The same, weighted by the number of acquaintances; no change on average.",
                    "disputes": "Share of the edges that join different opinions; 0 where all agree."}
    charts = {"Opinions": ("yes", "weighted_yes", "disputes")}

    count = gridlock.Setting(500, "Voters.", least=3)
    network = gridlock.Setting("scale free", "Who knows whom.", choices=["scale free", "small world", "at random", "complete"])
    degree = gridlock.Setting(6, "Acquaintances on average; even. A complete network has all.", least=2, most=1000)
    rewiring = gridlock.Setting(0.1, "Share of the edges of a small world that lead anywhere.", least=0.0, most=1.0)
    yes_at_start = gridlock.Setting(0.3, "Share of voters.", least=0.0, most=1.0)
    convinced = gridlock.Setting("anyone", "Who says yes at the start. In a scale-free network the oldest know most.", choices=["anyone", "oldest"])
    activity = gridlock.Setting(0.5, "Probability that a voter asks in a step.", least=0.0, most=1.0)

    def check(self, box: gridlock.Box) -> None:
        if self.network != "complete" and (self.degree % 2 or self.degree >= self.count):
            raise gridlock.Error(f"each of {self.count} voters has {self.degree} acquaintances\n"
                                 "  hint: use an even degree below the count, or network = \"complete\"")

    def start(self, start: gridlock.Start) -> None:
        order = np.argsort(start.uniform(self.count, purpose=1), kind="stable") if self.convinced == "anyone" else np.arange(self.count)
        opinion = np.zeros(self.count, dtype=np.uint32)
        opinion[order[: int(self.yes_at_start * self.count + 0.5)]] = 1
        start.add(positions=start.anywhere(self.count), opinion=opinion)
        known = start.acquaintances
        if self.network == "scale free":
            known.connect_scale_free(self.degree // 2)
        elif self.network == "small world":
            known.connect_small_world(self.degree, self.rewiring)
        else:
            known.connect_at_random(probability=1.0 if self.network == "complete" else self.degree / (self.count - 1))

    def step(self, world: gridlock.World) -> None:
        random = world.uniform(2)
        asked = world.acquaintances.neighbors().pick(random[:, 0])
        asks = (asked >= 0) & (random[:, 1] < self.activity)
        opinion = np.where(asks, world.opinion[asked], world.opinion)
        world.count("changes", int(np.count_nonzero(opinion != world.opinion)))
        world.opinion = opinion

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        says_yes = world.opinion == 1
        at_ends = says_yes[world.acquaintances.edges]
        edges = max(len(at_ends), 1)
        return {"yes": np.mean(says_yes), "weighted_yes": np.count_nonzero(at_ends) / (2 * edges),
                "disputes": np.count_nonzero(at_ends[:, 0] != at_ends[:, 1]) / edges}
