"""Sugarscape: agents who look for sugar on two hills, and how their wealth is spread."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import gridlock
from gridlock.turns import compiled

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The tops of the hills, and the distances from the nearer one up to which cells hold 4, 3, 2 and 1, in fiftieths of the side.
_tops, _distances = ((15.0, 15.0), (38.0, 38.0)), (6.0, 11.0, 16.5, 22.0)


@gridlock.register_model
class Sugarscape(gridlock.Model):
    """Agents who go to the most sugar that they see, eat of it, and die where they find too little.

    In a step the sugar of each cell grows by ``growback`` up to what the cell holds. Then all agents take their turn, one after the other, in a
    random order. An agent looks along the four directions as far as its vision and goes to the cell with the most sugar, of those with equal
    sugar to the nearest, of those to any; its own is one of them, cells of others are not. It takes all sugar there and uses up as much as its
    metabolism. With no wealth left it starves. With ``replacement`` agents also die above a greatest age, and for each dead one a new
    one appears in an empty cell: the number stays, and wealth becomes unequal.

    Vision, metabolism, endowment and greatest age are whole numbers, all alike within their bounds. Cells hold 4 around two tops and less further
    away, down to 0: nearly the map of the book, which was drawn by hand. At the start the Gini coefficient of endowments a … b is on average
    (1 − 1/N) (n² − 1) / (3 n (a + b)), n = b − a + 1; for 5 … 25 this is 0.233.

    Cost: about 0.9 ms a step of 250 agents on 2500 cells that is observed, with Numba.

    Source: J. M. Epstein, R. Axtell (1996), Growing Artificial Societies, chapter II, rules G, M and R, doi:10.7551/mitpress/3374.001.0001.
    """

    name = "sugarscape"
    columns = {"wealth": float, "metabolism": np.uint32, "vision": np.uint32, "age": np.uint32, "lifespan": np.uint32}
    fields = {"sugar": gridlock.Field("side", "What a cell has now.")}
    events = ("starved", "died_of_age")
    observations = {"gini": "Gini coefficient of the wealth: 0 where all have the same, near 1 where one has all.", "mean_wealth": "Sugar of an agent.",
                    "mean_vision": "Of the living.", "mean_metabolism": "Of the living."}
    charts = {"Fitness of the living": ("mean_vision", "mean_metabolism")}

    side = gridlock.Setting(50, "Cells along x.", least=3, most=5000)
    count = gridlock.Setting(400, "Agents at the start.", least=1)
    growback = gridlock.Setting(1.0, "Sugar that grows in a step; from 4 on all grows back at once.", least=0.0)
    vision = gridlock.Setting(6, "The farthest that an agent may see; the shortest is 1.", unit="cells", least=1, most=2500)
    metabolism = gridlock.Setting(4, "The most that an agent may use up in a step; the least is 1.", least=1, most=100)
    min_endowment = gridlock.Setting(5, "Wealth of an agent at first.", least=1, most=10**6)
    endowment = gridlock.Setting(25, "The most wealth of an agent at first.", least=1, most=10**6)
    replacement = gridlock.Setting(False, "Whether agents die of age, and new ones take the place of the dead.")
    min_lifespan = gridlock.Setting(60, "The greatest age of an agent, with replacement.", unit="steps", least=1, most=10**9)
    lifespan = gridlock.Setting(100, "The most that this age can be.", unit="steps", least=1, most=10**9)

    def check(self, box: gridlock.Box) -> None:
        for name, least, most in (("endowment", self.min_endowment, self.endowment), ("lifespan", self.min_lifespan, self.lifespan)):
            if least > most:
                raise gridlock.Error(f"min_{name} of sugarscape is {least} and {name} {most}\n  hint: the first is not above the second")
        if 2 * self.vision >= min(self.side, round(self.side * box.height / box.width)):
            raise gridlock.Error(f"agents of sugarscape see {self.vision} cells far on {self.side}\n  hint: use a vision below half of the cells")

    def capacity(self, rows: int, columns: int) -> NDArray[np.float64]:
        """What each cell holds, shape (rows, columns)."""
        y, x = np.mgrid[:rows, :columns] + 0.5
        squares = [(50 / columns * x - left) ** 2 + (50 / rows * y - low) ** 2 for left, low in _tops]
        held: NDArray[np.float64] = 4.0 - np.digitize(np.minimum(*squares), np.square(_distances))
        return held

    def start(self, start: gridlock.Start) -> None:
        cells = start.sugar.size
        if self.count > cells:
            raise gridlock.Error(f"{self.count} agents have {cells} cells\n  hint: use a smaller count or a larger side")
        start.sugar = self.capacity(*start.sugar.shape)
        homes = np.argsort(start.uniform(cells), kind="stable")[: self.count]
        start.add(positions=_centres(homes, start.sugar.shape, start.box), **self._newcomers(start.uniform(self.count, 4, purpose=2)))

    def _newcomers(self, random: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """The columns of new agents, from four random numbers for each."""
        bounds = {"metabolism": [1, self.metabolism], "vision": [1, self.vision], "wealth": [self.min_endowment, self.endowment],
                  "lifespan": [self.min_lifespan, self.lifespan]}
        return {name: least + np.floor(random[:, k] * (most - least + 1)) for k, (name, (least, most)) in enumerate(bounds.items())}

    def step(self, world: gridlock.World) -> None:
        shape = rows, columns = world.sugar.shape
        sugar = np.minimum(world.sugar + self.growback, self.capacity(rows, columns)).ravel()
        place = np.ravel_multi_index(world.cells("sugar"), shape)
        is_taken = np.bincount(place, minlength=sugar.size)
        world.age += 1
        is_old = (world.age > world.lifespan) & self.replacement
        dies = np.zeros(len(world), dtype=np.int64)
        _look_and_eat(world.random_order(), world.uniform(purpose=1), place, world.wealth, world.metabolism.astype(np.int64), world.vision.astype(np.int64),
                      is_old.astype(np.int64), dies, sugar, is_taken, rows, columns, world.box.periodic_x, world.box.periodic_y)
        world.sugar = sugar.reshape(shape)
        world.positions[...] = _centres(place, shape, world.box)
        dead = np.flatnonzero(dies)
        world.count("starved", int(np.count_nonzero(world.wealth[dead] <= 0)))
        world.count("died_of_age", int(np.count_nonzero(world.wealth[dead] > 0)))
        world.remove(dead)
        if self.replacement and len(dead):
            empty = np.flatnonzero(is_taken == 0)
            homes = empty[np.argsort(world.uniform_of_step(len(empty)), kind="stable")[: len(dead)]]
            world.add(positions=_centres(homes, shape, world.box), **self._newcomers(world.uniform(4, purpose=2, rows=dead)))

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        if len(world) == 0:
            return dict.fromkeys(self.observations, 0.0)
        return {"gini": gini(world.wealth), "mean_wealth": world.wealth.mean(), "mean_vision": world.vision.mean(),
                "mean_metabolism": world.metabolism.mean()}


def gini(wealth: NDArray[np.float64]) -> float:
    """The Gini coefficient, Σ_ij |w_i − w_j| / (2 N² ⟨w⟩)."""
    ranks = 2 * np.arange(1, len(wealth) + 1) - len(wealth) - 1
    whole = len(wealth) * wealth.sum()
    return float((ranks * np.sort(wealth)).sum() / whole) if whole > 0 else 0.0


@compiled
def _look_and_eat(
    order: Any, random: Any, place: Any, wealth: Any, metabolism: Any, vision: Any, is_old: Any, dies: Any, sugar: Any, is_taken: Any,
    rows: int, columns: int, wraps_x: bool, wraps_y: bool,
) -> None:
    for agent in order:
        there = place[agent]
        row, column = there // columns, there % columns
        most, nearest, alike, chance = sugar[there], 0, 1, random[agent]
        is_taken[there] = 0
        for far in range(1, vision[agent] + 1):
            for way in range(4):
                across = row + (far if way == 0 else -far if way == 1 else 0)
                along = column + (far if way == 2 else -far if way == 3 else 0)
                if wraps_y:
                    across = across % rows
                if wraps_x:
                    along = along % columns
                if across < 0 or across >= rows or along < 0 or along >= columns:
                    continue
                cell = across * columns + along
                if is_taken[cell] != 0 or sugar[cell] < most or (sugar[cell] == most and far > nearest):
                    continue
                if sugar[cell] > most:
                    most, nearest, alike, there = sugar[cell], far, 1, cell
                    continue
                # Of k cells alike the last is taken with the chance 1 / k; what is left of the number is as random as before.
                alike += 1
                if chance * alike < 1.0:
                    there, chance = cell, chance * alike
                else:
                    chance = (chance * alike - 1.0) / (alike - 1)
        place[agent] = there
        wealth[agent] += sugar[there] - metabolism[agent]
        sugar[there] = 0.0
        if wealth[agent] <= 0.0 or is_old[agent] != 0:
            dies[agent] = 1
        else:
            is_taken[there] = 1


def _centres(cells: NDArray[np.int64], shape: tuple[int, ...], box: gridlock.Box) -> NDArray[np.float64]:
    rows, columns = np.divmod(cells, shape[1])
    return np.stack([(columns + 0.5) * (box.width / shape[1]), (rows + 0.5) * (box.height / shape[0])], axis=1)
