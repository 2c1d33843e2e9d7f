"""Wolves, sheep and grass, by the rules of the public comparison of agent frameworks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

import gridlock
from gridlock.turns import compiled

SHEEP, WOLF = range(2)
LAMB, PUP = 1, 2


@gridlock.register_model
class WolfSheep(gridlock.Model):
    """Sheep that eat grass and wolves that eat sheep, on the cells of a meadow.

    In a step all sheep take their turn, in a random order; then all wolves; then the grass. An animal goes to one of the 8 cells around it
    (walls keep it in its row or column), loses 1 of its energy, and eats what is in its cell: a sheep grown grass, for ``sheep_gain``, a wolf one of
    the sheep, for ``wolf_gain``. With less than 0 it dies; otherwise it bears young with a probability, and they share its energy. Eaten
    grass is grown again after ``regrowth`` steps.

    The turns of a step are drawn at once: of the sheep in a cell the first one eats, and as many sheep as wolves are in a cell are eaten there.
    That is the same law, since no animal looks where it goes. The defaults are the small model of the public comparison
    (doi:10.5281/zenodo.8016506); its large one has ``side`` 100, 1000 ``sheep``, 500 ``wolves``, ``regrowth`` 10,
    ``sheep_birth`` 0.4, ``wolf_birth`` 0.2. Without wolves the flock becomes as large as its food allows: the energy eaten in a step is that
    which walking costs, ``sheep_gain`` · meals = sheep, but for what the dead take with them, less than 1 each.

    Cost: about 0.2 ms a step and 0.2 µs an animal, far more without Numba. Source: U. Wilensky (1997), ccl.northwestern.edu/netlogo/models/WolfSheepPredation.
    """

    name = "wolf_sheep"
    columns = {"kind": np.uint32, "energy": float}
    value_names = {"kind": ("sheep", "wolf")}
    fields = {"bare": gridlock.Field("side", "Steps until the grass is grown; 0 where it is.")}
    events = ("meals_of_sheep", "meals_of_wolves", "lambs", "pups", "starved_sheep", "starved_wolves")
    observations = {"sheep": "Animals.", "wolves": "Animals.", "grass": "Share of cells with grown grass.", "energy_of_sheep": "Of all of them."}
    charts = {"Animals": ("sheep", "wolves")}

    side = gridlock.Setting(25, "Cells along x.", least=2, most=5000)
    sheep = gridlock.Setting(60, "At the start.", least=0)
    wolves = gridlock.Setting(40, "At the start.", least=0)
    regrowth = gridlock.Setting(20, "Until eaten grass is grown.", unit="steps", least=1, restarts=False)
    sheep_gain = gridlock.Setting(5.0, "Energy in the grass of a cell.", least=0.0, most=1000.0, restarts=False)
    wolf_gain = gridlock.Setting(13.0, "Energy in a sheep.", least=0.0, most=1000.0, restarts=False)
    sheep_birth = gridlock.Setting(0.2, "Probability that a sheep bears a lamb in a step.", least=0.0, most=1.0)
    wolf_birth = gridlock.Setting(0.1, "Probability that a wolf bears a pup in a step.", least=0.0, most=1.0)

    def start(self, start: gridlock.Start) -> None:
        kind = np.repeat([SHEEP, WOLF], [self.sheep, self.wolves])
        random = start.uniform(len(kind), 3)
        rows, columns = start.bare.shape
        cells = np.floor(random[:, :2] * [columns, rows]) + 0.5
        energy = np.floor(random[:, 2] * 2 * np.where(kind == WOLF, self.wolf_gain, self.sheep_gain))
        start.add(positions=cells * [start.box.width / columns, start.box.height / rows], kind=kind, energy=energy)
        grass = start.uniform(start.bare.size, 2, purpose=2)
        start.bare = np.where(grass[:, 0] < 0.5, 0.0, 1 + np.floor(grass[:, 1] * self.regrowth)).reshape(rows, columns)

    def step(self, world: gridlock.World) -> None:
        random, box = world.uniform(5).ravel(), world.box
        rows, columns = world.bare.shape
        moves = np.empty((len(world), 2))
        _hop(random, moves.ravel(), box.width / columns, box.height / rows)
        world.move(moves)
        dies, young = np.zeros(len(world), dtype=np.bool_), np.zeros(len(world), dtype=np.int64)
        times = _live(
            world.kind, world.energy, world.x, world.y, random, world.bare.reshape(-1), dies, young, rows, columns, box.height, box.width,
            self.regrowth, self.sheep_gain, self.wolf_gain, self.sheep_birth, self.wolf_birth,
        )
        world.remove(dies)
        parents = np.concatenate([np.flatnonzero(young == LAMB), np.flatnonzero(young == PUP)])
        world.add(x=world.x[parents], y=world.y[parents], kind=world.kind[parents], energy=world.energy[parents])
        for event, count in zip(self.events, times):
            world.count(event, count)

    def observe(self, world: gridlock.World) -> Mapping[str, float]:
        is_sheep = world.kind == SHEEP
        sheep = np.count_nonzero(is_sheep)
        return {"sheep": sheep, "wolves": len(world) - sheep, "grass": np.mean(world.bare == 0), "energy_of_sheep": world.energy[is_sheep].sum()}


@compiled
def _hop(random: Any, moves: Any, wide: float, high: float) -> None:
    """Draws one of the 8 cells around each animal."""
    for animal in range(len(moves) // 2):
        cell = int(8 * random[5 * animal])
        if cell >= 4:
            cell += 1
        moves[2 * animal], moves[2 * animal + 1] = (cell // 3 - 1) * wide, (cell % 3 - 1) * high


@compiled
def _live(kind: Any, energy: Any, x: Any, y: Any, random: Any, bare: Any, dies: Any, young: Any, rows: int, columns: int, height: float,
          width: float, regrowth: int, sheep_gain: float, wolf_gain: float, sheep_birth: float, wolf_birth: float) -> tuple[int, ...]:
    """Lets all animals eat, die and bear young, and the grass grow; returns how often what happened, in the order of the events."""
    count = len(kind)
    cell, first = [0] * count, [-1] * (rows * columns)
    for animal in range(count):
        energy[animal] -= 1
        own = cell[animal] = int(y[animal] / height * rows) * columns + int(x[animal] / width * columns)
        if kind[animal] == SHEEP and (first[own] < 0 or random[5 * animal + 1] < random[5 * first[own] + 1]):
            first[own] = animal
    meals_of_sheep = meals_of_wolves = lambs = pups = starved_sheep = starved_wolves = 0
    for own in range(rows * columns):
        if first[own] >= 0 and bare[own] == 0:
            energy[first[own]] += sheep_gain
            bare[own] = regrowth
            meals_of_sheep += 1
        bare[own] = max(bare[own] - 1, 0.0)
    for animal in range(count):
        if kind[animal] == SHEEP and energy[animal] < 0:
            dies[animal] = True
            starved_sheep += 1
        elif kind[animal] == SHEEP and random[5 * animal + 2] < sheep_birth:
            energy[animal] /= 2
            young[animal] = LAMB
            lambs += 1

    # Lambs of this step may be eaten, as those that are older: that of an animal has the number of the animal plus the count. Each of them
    # gets its place among the prey of its cell, and each wolf among the wolves, in an order by random numbers.
    number, last = [0] * (2 * rows * columns), [-1] * (2 * rows * columns)
    place, before, chance = [0] * (2 * count), [-1] * (2 * count), [0.0] * (2 * count)
    for one in range(2 * count):
        animal = one % count
        if (dies[animal] if one < count else young[animal] != LAMB):
            continue
        chance[one] = random[5 * animal + (4 if one >= count else 1 if kind[animal] == WOLF else 3)]
        group = 2 * cell[animal] + kind[animal]
        number[group] += 1
        other = before[one] = last[group]
        last[group] = one
        while other >= 0:
            place[one if chance[other] <= chance[one] else other] += 1
            other = before[other]
    for animal in range(count):
        foes = number[2 * cell[animal] + 1 - kind[animal]]
        if kind[animal] == SHEEP:
            dies[animal] = dies[animal] or place[animal] < foes
            if young[animal] == LAMB and place[count + animal] < foes:
                young[animal] = 0
            continue
        if place[animal] < foes:
            energy[animal] += wolf_gain
            meals_of_wolves += 1
        if energy[animal] < 0:
            dies[animal] = True
            starved_wolves += 1
        elif random[5 * animal + 2] < wolf_birth:
            energy[animal] /= 2
            young[animal] = PUP
            pups += 1
    return meals_of_sheep, meals_of_wolves, lambs, pups, starved_sheep, starved_wolves
