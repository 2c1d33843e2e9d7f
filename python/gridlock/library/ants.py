"""Ants that choose between two branches by the scent of those before them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

import gridlock

if TYPE_CHECKING:
    from numpy.typing import NDArray

WAITS, OUT, HOME = range(3)
CELLS = 20


@gridlock.register_model
class Ants(gridlock.Model):
    """Ants that walk between a nest and food over a bridge with two branches, and leave scent on the way.

    An ant that enters the bridge, at either end, takes the first branch with the probability (k + s₁)ⁿ / ((k + s₁)ⁿ + (k + s₂)ⁿ), where s₁ and s₂
    are the scents at the entrances. It leaves 1 in each of the 20 cells of a branch. Of two branches alike the ants come to use one; of a
    short and a long one the short one, from which ants come back first. While none has come back the choices are those of an urn: with n = 1
    that of Pólya, in which the variance of the number of M ants on a branch is (M/4) (2k + M)/(2k + 1).

    The nest is on the left, food on the right, the first branch is the lower half of the box. Cost: about 0.2 ms a step of some hundred ants.

    Source: J.-L. Deneubourg, S. Aron, S. Goss, J. M. Pasteels (1990), doi:10.1007/BF01417909, for the law and k = 20, n = 2; S. Goss et al.
    (1989), doi:10.1007/BF00462870, for branches of different lengths.
    """

    name = "ants"
    columns = {"way": np.uint32, "branch": np.uint32, "walked": np.uint32}
    value_names = {"way": ("waits", "goes out", "comes home"), "branch": ("first", "second")}
    fields = {"scent": gridlock.Field((2, CELLS), "What ants leave behind; a row for each branch.")}
    events = ("trips",)
    observations = {"walking": "Ants on the bridge.", "first_branch": "Share of them on the first branch; 1/2 where there are none."}

    count = gridlock.Setting(500, "Ants.", least=1)
    flow = gridlock.Setting(1, "Ants that leave the nest in a step, where so many wait.", unit="1 / step", least=1)
    detour = gridlock.Setting(1.0, "Length of the second branch over that of the first.", least=1.0, most=100.0)
    k = gridlock.Setting(20.0, "How much scent it takes to be attractive.", least=1e-3, most=1e6)
    n = gridlock.Setting(2, "How sharply ants tell scents apart.", least=1, most=10)
    evaporation = gridlock.Setting(0.0, "Rate at which the scent decays.", unit="1 / step", least=0.0, most=100.0)

    def start(self, start: gridlock.Start) -> None:
        start.add(x=0.0, y=np.full(self.count, start.box.height / 2))

    def step(self, world: gridlock.World) -> None:
        steps = np.array([CELLS, round(CELLS * self.detour)])
        first = (self.k + world.scent) ** self.n
        chances = first[0] / first.sum(axis=0)
        random = world.uniform(2)
        world.walked += world.way != WAITS
        arrives = (world.way != WAITS) & (world.walked >= steps[world.branch])
        turns, is_home = arrives & (world.way == OUT), arrives & (world.way == HOME)
        world.way[is_home] = WAITS
        world.count("trips", int(is_home.sum()))

        waiting = np.flatnonzero(world.way == WAITS)
        leaves = waiting[np.argsort(random[waiting, 0], kind="stable")[: self.flow]]
        for ants, way, chance in ((leaves, OUT, chances[0]), (np.flatnonzero(turns), HOME, chances[-1])):
            world.way[ants] = way
            world.branch[ants] = random[ants, 1] >= chance
            world.walked[ants] = 0
        self._place(world, steps)
        world.deposit("scent", np.where(world.way == WAITS, 0.0, (CELLS / steps)[world.branch]))
        if self.evaporation > 0:
            world.spread("scent", decay=self.evaporation)

    def _place(self, world: gridlock.World, steps: NDArray[np.int64]) -> None:
        """Puts ants into the middle of their cells."""
        cells = world.walked.astype(np.int64) * CELLS // steps[world.branch]
        cells = np.where(world.way == HOME, CELLS - 1 - cells, cells)
        waits = world.way == WAITS
        world.x = np.where(waits, 0.0, (cells + 0.5) * (world.box.width / CELLS))
        world.y = np.where(waits, 0.5, (world.branch + 0.5) / 2) * world.box.height

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        branch = world.branch[world.way != WAITS]
        return {"walking": len(branch), "first_branch": float(np.mean(branch == 0)) if len(branch) else 0.5}
