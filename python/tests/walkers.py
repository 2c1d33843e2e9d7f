"""A model that has all that models in Python can have, for several files of tests."""

import numpy as np

import gridlock
from conftest import OBLONG


@gridlock.register_model
class Walkers(gridlock.Model):
    """Points that walk at random, die, and have children."""

    name = "test_walkers"
    columns = {"age": np.uint32, "charge": np.int32, "mark": np.uint64}
    events = ("births", "deaths")
    value_names = {"charge": ("none", "one")}
    observations = {"mean_age": "Mean age in steps."}
    count = gridlock.Setting(200, "Agents.", least=1)
    length = gridlock.Setting(0.01, "Of a step.", unit="length", least=0.0, most=0.4)
    turnover = gridlock.Setting(0.02, "Deaths and births of each agent in a step.", least=0.0, most=1.0)
    kind = gridlock.Setting("normal", "Of the steps.", choices=["normal", "uniform"])
    is_charged = gridlock.Setting(False, "Whether agents have a charge.")
    time_step = 0.5

    def start(self, start):
        start.add(positions=start.anywhere(self.count), charge=int(self.is_charged), mark=np.arange(self.count, dtype=np.uint64))

    def step(self, world):
        world.age += 1
        steps = world.normal(2) if self.kind == "normal" else 2 * world.uniform(2) - 1
        world.move(self.length * np.clip(steps, -3, 3))
        dead = world.uniform(purpose=1) < self.turnover
        world.remove(dead)
        world.count("deaths", dead.sum())
        parents = world.uniform(purpose=2) < self.turnover
        world.add(positions=world.positions[parents], mark=world.ids[parents])
        world.count("births", parents.sum())

    def observe(self, world):
        return {"mean_age": world.age.mean()}


SETTINGS = {"model.kind": "test_walkers", "box": OBLONG, "observe.every": 10, "run.seed": 5}


def made(**more):
    return gridlock.Simulation(SETTINGS, **more)
