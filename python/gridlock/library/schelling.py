"""Schelling's model of segregation, by the rules of the public comparison of agent frameworks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import gridlock
from gridlock.turns import compiled

if TYPE_CHECKING:
    from numpy.typing import NDArray


@gridlock.register_model
class Schelling(gridlock.Model):
    """Agents of two groups that move away where too few of their own group are near.

    Each agent has a cell of its own. In a step all take their turn one after the other, in a random order: an agent with fewer than
    ``wanted`` of its own group in the (2 radius + 1)² − 1 cells around it moves to an empty cell, any of them alike. Few need to want much:
    with ``wanted`` = 3 of 8 cells, like neighbours become the rule.

    The defaults are the small model of the public comparison (doi:10.5281/zenodo.8016506); its large one has ``side`` 100,
    ``count`` 8000, ``radius`` 2 and ``wanted`` 8. Cost: about 0.2 µs an agent and step; without Numba 0.2 µs a cell it looks at.

    Source: T. C. Schelling (1971), doi:10.1080/0022250X.1971.9989794.
    """

    name = "schelling"
    columns = {"group": np.uint32}
    value_names = {"group": ("one", "two")}
    fields = {"homes": gridlock.Field("side", "0 empty, 1 and 2 the group of whom lives there.")}
    events = ("moves",)
    observations = {"like_share": "Share of an agent's neighbours who are of its group; mean over agents with neighbours.",
                    "happy": "Share of agents with as many of their group near as they want."}

    side = gridlock.Setting(40, "Cells along x.", least=2, most=5000)
    count = gridlock.Setting(1000, "Agents, half of each group.", least=1)
    radius = gridlock.Setting(1, "How many cells far an agent looks.", unit="cells", least=1, most=50)
    wanted = gridlock.Setting(3, "Neighbours of its own group with whom an agent stays.", least=0, most=10000)

    def check(self, box: gridlock.Box) -> None:
        if box.periodic_x or box.periodic_y:
            raise gridlock.Error("the city of schelling has edges\n  hint: use box.edge = \"wall\"")

    def start(self, start: gridlock.Start) -> None:
        cells = start.homes.size
        if self.count > cells:
            raise gridlock.Error(f"{self.count} agents have {cells} cells\n  hint: use a smaller count or a larger side")
        group = (2 * np.arange(self.count) >= self.count).astype(np.uint32)
        homes = np.argsort(start.uniform(cells), kind="stable")[: self.count]
        start.homes.flat[homes] = group + 1
        start.add(positions=_centres(homes, start.homes, start.box), group=group)

    def step(self, world: gridlock.World) -> None:
        homes, box = world.homes.reshape(-1), world.box
        rows, columns = world.homes.shape
        moves = _move(world.random_order(), world.uniform(purpose=1), world.x, world.y, np.flatnonzero(homes == 0), homes, rows, columns,
                      box.height / rows, box.width / columns, box.height, box.width, self.radius, self.wanted)
        world.count("moves", moves)

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        homes = np.pad(world.homes, self.radius)
        near = np.stack([_near(homes, self.radius, group) for group in (1, 2)])
        lived_in = homes > 0
        like = np.where(homes == 1, near[0], near[1])[lived_in]
        neighbors = near.sum(axis=0)[lived_in]
        share = like[neighbors > 0] / neighbors[neighbors > 0]
        return {"like_share": share.mean() if len(share) else 0.0, "happy": np.mean(like >= self.wanted)}


@compiled
def _move(order: Any, random: Any, x: Any, y: Any, vacant: Any, homes: Any, rows: int, columns: int, high: float, wide: float,
          height: float, width: float, radius: int, wanted: int) -> int:
    """Lets all take their turn; returns how many have moved."""
    moves = 0
    for agent in order:
        row, column = int(y[agent] / height * rows), int(x[agent] / width * columns)
        here = row * columns + column
        like = -1
        for across in range(max(row - radius, 0), min(row + radius + 1, rows)):
            for along in range(max(column - radius, 0), min(column + radius + 1, columns)):
                if homes[across * columns + along] == homes[here]:
                    like += 1
        if like >= wanted or len(vacant) == 0:
            continue
        chosen = int(random[agent] * len(vacant))
        there = vacant[chosen]
        vacant[chosen] = here
        x[agent], y[agent] = (there % columns + 0.5) * wide, (there // columns + 0.5) * high
        homes[there], homes[here] = homes[here], 0.0
        moves += 1
    return moves


def _around(radius: int) -> list[tuple[int, int]]:
    """The cells around one, without itself."""
    reach = range(-radius, radius + 1)
    return [(row, column) for row in reach for column in reach if (row, column) != (0, 0)]


def _near(homes: NDArray[np.float64], radius: int, group: int) -> NDArray[np.int64]:
    """How many of a group are around each cell of a city with an empty rim as wide as the radius; the rim gets no numbers."""
    members = (homes == group).astype(np.int64)
    near: NDArray[np.int64] = np.zeros_like(members)
    inner = near[radius:-radius, radius:-radius]
    rows, columns = inner.shape
    for row, column in _around(radius):
        inner += members[radius + row : radius + row + rows, radius + column : radius + column + columns]
    return near


def _centres(cells: NDArray[np.int64], field: NDArray[np.float64], box: gridlock.Box) -> NDArray[np.float64]:
    rows, columns = np.divmod(cells, field.shape[1])
    return np.stack([(columns + 0.5) * (box.width / field.shape[1]), (rows + 0.5) * (box.height / field.shape[0])], axis=1)
