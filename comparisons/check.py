#!/usr/bin/env python3
"""Compares what our entries in the public comparison expect with what its own programs in Mesa do: means over seeds, and their difference in
standard errors.

    PYTHONPATH=$PWD/build/python comparisons/check.py comparison_with_gridlock --seeds 40

The folder is the copy that run.py makes. The forest fire begins with the same trees in both, so that every tree has to burn in the same step. What
the programs of Mesa do otherwise than the declarations, and Gridlock, is changed in them here: their wolves and sheep walk to four cells, not to eight, none
of them stays where it is at an edge, their grass grows a step later, a twentieth of the bare cells has grass at first, and nobody runs their simulator;
their birds have any speed below √2 at first.
"""

import argparse
import importlib
import math
import pathlib
import sys
import warnings

import numpy as np

import gridlock
from gridlock.library import Boids, ForestFire, Schelling, WolfSheep

WALLS = {"box.edge": "wall"}


def ours(settings, steps, seeds, measure):
    found = []
    for seed in range(1, seeds + 1):
        simulation = gridlock.Simulation({**settings, "engine.threads": 1, "observe.every": steps, "run.seed": seed})
        simulation.run(steps=steps)
        found.append(measure(simulation))
    return np.array(found).T


def theirs(make, step, steps, seeds, measure):
    found = []
    for seed in range(1, seeds + 1):
        model = make(seed)
        for _ in range(steps):
            step(model)
        found.append(measure(model))
    return np.array(found).T


def spread(places, side):
    gaps = places[:, None] - places[None]
    return ((gaps - side * np.rint(gaps / side)) ** 2).mean()


def schelling(seeds):
    def like_share(model):
        shares = []
        for agent in model.agents:
            near = list(agent.cell.get_neighborhood(radius=1).agents)
            if near:
                shares.append(sum(one.type == agent.type for one in near) / len(near))
        return [np.mean(shares)]

    make = importlib.import_module("Schelling").SchellingModel
    for steps in (1, 5):
        yield (f"Schelling-small, share of like neighbours after {steps} steps",
               ours({"model": Schelling(), **WALLS}, steps, seeds, lambda one: [one.series["like_share"][-1]])[0],
               theirs(lambda seed: make(seed, 40, 40, 3, 1, 0.625), lambda model: model.step(), steps, seeds, like_share)[0])


def wolf_sheep(seeds):
    module, agents, grids = (importlib.import_module(name) for name in ("WolfSheep", "agents", "mesa.discrete_space"))
    module.OrthogonalVonNeumannGrid = grids.OrthogonalMooreGrid
    side, regrowth = 25, 20
    cells = {}
    published = grids.Cell.neighborhood

    class Around:
        """The eight cells around one; those beyond an edge are the nearest within."""

        def __init__(self, cell):
            self.cell = cell

        def select_random_cell(self):
            hop = self.cell.random.choice([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)])
            return cells[tuple(min(max(at + by, 0), side - 1) for at, by in zip(self.cell.coordinate, hop))]

    def patch(model, _, __, cell):
        countdown = 0 if model.random.random() < 0.5 else 1 + model.random.randrange(regrowth)
        return agents.GrassPatch(model, countdown, regrowth - 1, cell)

    def begin(seed):
        model = module.WolfSheep(seed, side, side, 60, 40, 0.2, 0.1, regrowth)
        cells.update({cell.coordinate: cell for cell in model.grid.all_cells})
        return model

    module.GrassPatch = patch
    def count(model):
        grass = [patch.fully_grown for patch in model.agents_by_type[agents.GrassPatch]]
        return [len(model.agents_by_type[agents.Sheep]), len(model.agents_by_type[agents.Wolf]), np.mean(grass)]

    names = ("sheep", "wolves", "grass")
    for steps in (10, 30):
        mine = ours({"model": WolfSheep(), **WALLS}, steps, seeds, lambda one: [one.series[name][-1] for name in names])
        grids.Cell.neighborhood = property(Around)
        mesa = theirs(begin, lambda model: model.simulator.run_for(1), steps, seeds, count)
        grids.Cell.neighborhood = published
        for name, one, other in zip(names, mine, mesa):
            yield f"WolfSheep-small, {name} after {steps} steps", one, other


def flocking(seeds):
    make = importlib.import_module("Flocking").BoidFlockers

    def begin(seed):
        model = make(seed, 200, 100, 100, 5)
        for bird in model.agents:
            bird.direction /= np.linalg.norm(bird.direction)
        return model

    def order(model):
        return [math.hypot(*np.mean([bird.direction for bird in model.agents], axis=0)), spread(np.array([bird.position for bird in model.agents]), 100)]

    sky = {"box": {"width": 100.0, "height": 100.0, "edge": "periodic"}}
    mine = ours({"model": Boids(), **sky}, 30, seeds, lambda one: [one.series["order"][-1], spread(one.frame.positions, 100)])
    mesa = theirs(begin, lambda model: model.step(), 30, seeds, order)
    for name, one, other in zip(("order", "mean square distance"), mine, mesa):
        yield f"Flocking-small, {name} after 30 steps", one, other


def forest_fire(seeds):
    make = importlib.import_module("ForestFire").ForestFire
    settings = {"model": ForestFire(side=100, density=0.7)}
    yield ("ForestFire-small, burnt trees after 100 steps", ours(settings, 100, seeds, lambda one: [np.count_nonzero(one.frame.fields["forest"] == 3)])[0],
           theirs(lambda seed: make(seed, 100, 100, 0.7), lambda model: model.step(), 100, seeds, lambda model: [sum(row.count(3) for row in model.trees)])[0])
    for seed in range(1, 4):
        fire, model = gridlock.Simulation({**settings, "run.seed": seed}), make(seed, 100, 100, 0.7)
        # Mesa's first index is x.
        model.trees = fire.frame.fields["forest"].T.astype(int).tolist()
        model.burning_tree_coordinates = {(0, y) for y in range(100) if model.trees[0][y] == 2}
        for _ in range(100):
            fire.run(steps=1)
            model.step()
            if not np.array_equal(fire.frame.fields["forest"].T, model.trees):
                sys.exit(f"the forest of seed {seed} burns otherwise in step {fire.clock.step}")
    print("ForestFire-small: from the same trees the same forests in each of 100 steps, three seeds")


CHECKS = {"Schelling": schelling, "WolfSheep": wolf_sheep, "Flocking": flocking, "ForestFire": forest_fire}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("comparison", type=pathlib.Path, help="the copy that run.py has made")
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--models", nargs="+", choices=CHECKS, default=CHECKS, help="some models only")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    worst = 0.0
    for folder in options.models:
        sys.path.insert(0, str(options.comparison / folder / "Mesa"))
        for what, one, other in CHECKS[folder](options.seeds):
            error = math.sqrt((np.var(one, ddof=1) + np.var(other, ddof=1)) / options.seeds)
            worst = max(worst, abs(one.mean() - other.mean()) / error)
            print(f"{what}: {one.mean():.5g} in Gridlock, {other.mean():.5g} in Mesa, {(one.mean() - other.mean()) / error:+.1f} standard errors", flush=True)
    sys.exit(int(worst > 4))


main()
