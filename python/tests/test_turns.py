"""Turns of single agents: the same bits with Numba and without, and the same rule as a step over arrays."""

import functools
import sys

import numpy as np
import pytest

import gridlock
from conftest import OBLONG
from gridlock import turns


@gridlock.register_model
class Contagion(gridlock.Model):
    """A disease among walkers and their dogs, agent by agent."""

    name = "test_contagion"
    columns = {"health": np.uint32}
    kinds = {"walker": {"days_ill": np.uint32}, "dog": {}}
    events = ("infections", "deaths")
    count = gridlock.Setting(300)
    cutoff = gridlock.Setting(0.05)
    chance = gridlock.Setting(0.2)
    random_numbers = 4

    def start(self, start):
        start.walker.add(positions=start.walker.anywhere(self.count - 20), health=np.arange(self.count - 20) < 10)
        start.dog.add(positions=start.dog.anywhere(20))

    @staticmethod
    def turn(row, neighbors, separations, now, next, settings, random, events):
        for place, k in enumerate(neighbors):
            near = separations[place, 0] ** 2 + separations[place, 1] ** 2 < settings.cutoff**2
            if near and now.health[row] == 0 and now.health[k] == 1 and random[0] < settings.chance:
                next.health[row] = 1
                events[0] += 1
                break
        next.dx[row] = 0.02 * (random[1] - 0.5)
        next.dy[row] = 0.02 * (random[2] - 0.5)
        if now.health[row] == 1 and now.kind[row] == 0:
            next.days_ill[row] = now.days_ill[row] + 1
        if now.health[row] == 1 and random[3] < 0.01:
            next.dies[row] = True
            events[1] += 1


def test_turns_give_the_same_bits_with_numba_and_without(monkeypatch):
    pytest.importorskip("numba")
    settings = {"model.kind": "test_contagion", "box": OBLONG, "run.seed": 3}
    compiled = gridlock.Simulation(settings)
    compiled.run(steps=40)
    monkeypatch.setattr(turns, "_compiled", turns._all_turns)
    plain = gridlock.Simulation(settings)
    plain.run(steps=40)
    assert compiled.state_hash == plain.state_hash and compiled.counts == plain.counts
    sick = int((plain.agents.health == 1).sum())
    assert plain.counts["infections"] == sick - 10 + plain.counts["deaths"] and plain.counts["deaths"] > 0
    assert plain.agents.days_ill.max() == 40 and len(plain.agents.days_ill) == (plain.agents.kind == 0).sum()
    assert len(plain.agents) == 300 - plain.counts["deaths"]


def test_turns_see_a_setting_that_has_changed(monkeypatch):
    monkeypatch.setattr(turns, "_compiled", turns._all_turns)
    simulation = gridlock.Simulation({"model.kind": "test_contagion", "box": OBLONG, "run.seed": 3})
    simulation.run(steps=5)
    before = simulation.counts["infections"]
    simulation.change(test_contagion={"chance": 0.0})
    simulation.run(steps=20)
    assert simulation.counts["infections"] == before > 0


def test_a_private_cached_property_sees_a_setting_that_has_changed():
    class Growing(gridlock.Model):
        name = "test_growing"
        columns = {"size": float}
        rate = gridlock.Setting(1.0)

        @functools.cached_property
        def _twice(self):
            return 2 * self.rate

        def start(self, start):
            start.add(x=0.5, y=0.5)

        def step(self, world):
            world.size += self._twice

    simulation = gridlock.Simulation(model=Growing, box=OBLONG)
    simulation.run(steps=3)
    simulation.change(test_growing={"rate": 5.0})
    simulation.run(steps=1)
    assert simulation.agents.size == [16.0]


def test_turns_that_cannot_be_are_refused():
    class NoStatic(gridlock.Model):
        name = "test_no_static"
        cutoff = 0.1

        def start(self, start):
            start.add(x=0.5, y=0.5)

        def turn(self, row):
            pass

    with pytest.raises(gridlock.Error, match="no function of a turn"):
        gridlock.register_model(NoStatic)

    class NoCutoff(gridlock.Model):
        name = "test_no_cutoff"
        start = NoStatic.start
        turn = Contagion.__dict__["turn"]

    with pytest.raises(gridlock.Error, match="no cutoff"):
        gridlock.register_model(NoCutoff)


def test_turns_beyond_an_array_end_the_run():
    pytest.importorskip("numba")

    def turn(row, neighbors, separations, now, next, settings, random, events):
        events[7] += 1

    model = type("Beyond", (Contagion,), {"name": "test_beyond", "turn": staticmethod(turn)})
    with pytest.raises(gridlock.RunFailure, match="IndexError"):
        gridlock.Simulation(model=model, box=OBLONG).run(steps=1)


@pytest.mark.parametrize("edge", ["periodic", "wall"])
@pytest.mark.parametrize("sides", [(1.5, 0.6), (0.6, 1.5)])
def test_separations_of_turns_are_those_of_steps(edge, sides, monkeypatch):
    class Steps(gridlock.Model):
        name = "test_by_steps"
        columns = {"pull_x": float, "pull_y": float}
        cutoff = 0.25

        def start(self, start):
            start.add(positions=start.anywhere(200))

        def step(self, world):
            found = world.neighbors(self.cutoff)
            apart = world.separations(found.owners, found.indices)
            pull = np.zeros((len(world), 2))
            np.add.at(pull, found.owners, apart)
            world.pull_x, world.pull_y = pull.T

    class Turns(gridlock.Model):
        name = "test_by_turns"
        columns = Steps.columns
        cutoff = Steps.cutoff
        start = Steps.start

        @staticmethod
        def turn(row, neighbors, separations, now, next, settings, random, events):
            for place in range(len(neighbors)):
                next.pull_x[row] += separations[place, 0]
                next.pull_y[row] += separations[place, 1]

    monkeypatch.setattr(turns, "_compiled", turns._all_turns)
    box = {"width": sides[0], "height": sides[1], "edge": edge}
    by_steps, by_turns = (gridlock.Simulation(model=model, box=box, run={"seed": 3}) for model in (Steps, Turns))
    for made in (by_steps, by_turns):
        made.run(steps=1)
    assert np.array_equal(by_steps.agents.ids, by_turns.agents.ids)
    for name in ("pull_x", "pull_y"):
        assert np.allclose(by_steps.agents[name], by_turns.agents[name], rtol=0, atol=1e-12)
        assert abs(by_turns.agents[name]).max() > 0.1


@turns.compiled
def pass_on(order, share, money):
    """Each gives a share to its neighbour on a ring, one after the other; returns how much in all."""
    given = 0.0
    for row in order:
        gift = share * money[row]
        money[row] -= gift
        money[row - 1] += gift
        given += gift
    return given


def test_a_compiled_loop_has_the_same_bits_without_numba(monkeypatch):
    pytest.importorskip("numba")
    order, money = np.array([3, 0, 2, 1]), np.array([0.1, 0.7, 1 / 3, 2.9])
    ends = []
    for is_there in (True, False):
        turns._by_numba.cache_clear()
        if not is_there:
            monkeypatch.setitem(sys.modules, "numba", None)
        own = money.copy()
        ends.append((pass_on(order, 0.3, own), own.tolist()))
    turns._by_numba.cache_clear()
    assert ends[0] == ends[1] and not np.array_equal(own, money)
    assert abs(own.sum() - money.sum()) < 1e-14


def test_a_compiled_loop_leaves_arrays_that_are_read_only(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    turns._by_numba.cache_clear()
    order = np.array([1, 0])
    order.flags.writeable = False
    money = np.array([4.0, 2.0])
    assert pass_on(order, 0.5, money) == 3.5 and money.tolist() == [2.5, 3.5]
    turns._by_numba.cache_clear()


def test_a_compiled_loop_refuses_an_index_beyond_the_end():
    @turns.compiled
    def give(order, money):
        for row in order:
            money[row + 1] += 1.0

    with pytest.raises(IndexError):
        give(np.arange(3), np.zeros(3))
