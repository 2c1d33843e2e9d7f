"""Kinds of agents in one model of Python, each with columns of its own."""

import sys

import numpy as np
import pytest

import gridlock
from conftest import OBLONG


@gridlock.register_model
class Pasture(gridlock.Model):
    """Wolves that eat sheep that eat grass, and dogs that watch."""

    name = "test_pasture"
    columns = {"energy": float}
    kinds = {"wolf": {}, "sheep": {"wool": float, "born": np.uint32}, "dog": {"born": np.uint32}}
    fields = {"grass": gridlock.Field(60)}
    events = ("eaten",)
    wolves = gridlock.Setting(30, "At the start.")

    def start(self, start):
        start.grass = 1.0
        start.wolf.add(positions=start.wolf.anywhere(self.wolves), energy=9)
        start.sheep.add(positions=start.sheep.anywhere(200), wool=start.sheep.uniform(200), energy=2)
        start.dog.add(positions=start.dog.anywhere(5))

    def step(self, world):
        wolf, sheep = world.wolf, world.sheep
        found = wolf.neighbors(0.02, of=sheep)
        eaten = np.zeros(len(sheep), dtype=bool)
        eaten[found.indices] = True
        sheep.remove(eaten)
        world.count("eaten", eaten.sum())
        wolf.energy += 8 * (found.counts > 0) - 1
        wolf.remove(wolf.energy <= 0)
        wolf.add(positions=wolf.positions[wolf.uniform() < 0.06], energy=5)
        sheep.energy += 2 * sheep.take("grass", 1) - 1
        sheep.remove(sheep.energy <= 0)
        mothers = (sheep.uniform(purpose=1) < 0.08) & ~eaten
        sheep.add(positions=sheep.positions[mothers], wool=-sheep.ids[mothers].astype(float), energy=2, born=world.clock.step + 1)
        world.grass[...] = (world.grass + 0.1).clip(0, 1)
        sheep.move(0.02 * sheep.normal(2, purpose=2))
        wolf.move(0.02 * wolf.normal(2, purpose=2))

    def observe(self, world):
        return {"wolves": len(world.wolf), "wool": world.sheep.wool.sum(), "born": world.dog.born.sum()}


SETTINGS = {"model.kind": "test_pasture", "box": OBLONG, "observe.every": 10, "run.seed": 5}


def stepped(step, columns=None, kinds=None, steps=1, **more):
    """Runs a model of two kinds with this step; returns the simulation."""

    class Two(gridlock.Model):
        name = "test_two_kinds"

        def start(self, start):
            start.wolf.add(positions=start.wolf.anywhere(40))
            start.sheep.add(positions=start.sheep.anywhere(90), wool=np.arange(90))

    Two.columns = columns or {}
    Two.kinds = kinds or {"wolf": {"hunger": np.int32}, "sheep": {"wool": float}}
    Two.step = lambda self, world: step(world)
    simulation = gridlock.Simulation(model=Two, box=more.pop("box", OBLONG), **more)
    simulation.run(steps=steps)
    return simulation


def test_columns_of_a_kind_have_a_row_for_each_of_its_agents_alone():
    simulation = gridlock.Simulation(SETTINGS)
    sheep = int((simulation.agents.kind == 1).sum())
    assert (len(simulation.agents), sheep, len(simulation.agents.wool), len(simulation.agents.born)) == (235, 200, 200, 205)
    assert simulation.agents.names == ["x", "y", "kind", "energy", "wool", "born"]


def test_agents_keep_their_values_through_births_deaths_and_sorting():
    wool, born = {}, {}

    def check(simulation):
        frame = simulation.frame.of_kind("sheep")
        for name, seen in (("wool", wool), ("born", born)):
            for agent, value in zip(frame.ids.tolist(), frame.columns[name].tolist()):
                assert seen.setdefault(agent, value) == value

    simulation = gridlock.Simulation(SETTINGS)
    check(simulation)
    for _ in range(20):
        simulation.run(steps=5)
        check(simulation)
        assert (np.diff(simulation.agents.kind.astype(int)) >= 0).all()
        assert len(simulation.agents.wool) == (simulation.agents.kind == 1).sum()
    assert len(wool) > 400 and simulation.counts["eaten"] > 50 and set(simulation.agents.kind) == {0, 1, 2}
    assert sum(value < 0 for value in wool.values()) > 200  # newborn sheep keep the Ids of their mothers in their wool


def test_a_run_with_kinds_is_continued_with_the_same_bits_and_its_files_name_the_kinds(tmp_path):
    settings = {**SETTINGS, "trajectory.every": 20, "run.steps": 40}
    gridlock.run(settings, tmp_path / "short")
    gridlock.open(tmp_path / "short").resume(steps=80)
    gridlock.run({**settings, "run.steps": 80}, tmp_path / "long")
    short, long = gridlock.open(tmp_path / "short"), gridlock.open(tmp_path / "long")
    in_memory = gridlock.Simulation(SETTINGS, engine={"threads": 3})
    in_memory.run(steps=80)
    assert short.state_hash == long.state_hash == in_memory.state_hash
    last = long.trajectory[-1]
    assert last.value_names["kind"] == ["wolf", "sheep", "dog"]
    sheep = last.of_kind("sheep")
    assert np.array_equal(sheep.wool, in_memory.frame.of_kind("sheep").wool) and (sheep.kinds == 0).all()
    assert (last.wool[last.kind != 1] == 0).all() and len(last.of_kind("dog")) == 5
    with pytest.raises(gridlock.Error, match="the frame has no kind 'cow'\n  hint: it has wolf, sheep, dog"):
        last.of_kind("cow")
    assert gridlock.verify(tmp_path / "long").is_verified


def test_neighbors_among_another_kind_are_those_of_brute_force():
    seen = []

    def step(world):
        wolf, sheep = world.wolf, world.sheep
        found = wolf.neighbors(0.1, of=sheep)
        i, j = np.divmod(np.arange(len(wolf) * len(sheep)), len(sheep))
        vectors = wolf.separations(i, j, of=sheep)
        near = (np.hypot(*vectors.T) < 0.1).reshape(len(wolf), len(sheep))
        assert np.array_equal(found.counts, near.sum(axis=1)) and found.counts.sum() > 50
        assert all(set(found.of(k)) == set(np.flatnonzero(near[k])) for k in range(len(wolf)))
        assert np.allclose(found.sum(sheep.wool), near @ sheep.wool)
        assert np.allclose(found.mean(sheep.positions)[near.any(axis=1)],
                           ((near @ sheep.positions) / near.sum(axis=1)[:, None])[near.any(axis=1)])
        own = gridlock.neighbors(sheep.positions, 0.1, world.box)
        assert np.array_equal(sheep.neighbors(0.1).indices, own.indices) and len(sheep.pairs(0.1)) == len(own.indices) // 2
        everybody = wolf.neighbors(0.1, of=world)
        assert np.array_equal(everybody.counts, world.neighbors(0.1).counts[: len(wolf)])
        seen.append(found.counts.sum())

    stepped(step)
    assert seen


def test_what_one_kind_does_leaves_the_others_alone():
    shorn = []

    def step(world):
        before = world.positions.copy()
        world.sheep.move(np.full((len(world.sheep), 2), 0.01))
        assert np.array_equal(world.positions[world.kind == 0], before[world.kind == 0])
        assert not np.any(world.positions[world.kind == 1] == before[world.kind == 1])
        assert np.array_equal(world.uniform(2)[world.kind == 1], world.sheep.uniform(2))
        world.sheep.wool *= 2
        world.wolf.hunger[:3] = -7
        world.sheep.remove([0, 5])
        shorn.extend(world.sheep.wool[[0, 5]] / 2)
        world.wolf.add(positions=world.sheep.positions[:1], hunger=4)

    simulation = stepped(step)
    frame = simulation.frame
    assert np.array_equal(np.sort(frame.of_kind("sheep").wool), np.delete(2.0 * np.arange(90), np.int64(shorn)))
    assert sorted(frame.of_kind("wolf").hunger) == [-7] * 3 + [0] * 37 + [4]


def test_places_at_the_start_differ_between_kinds():
    frame = gridlock.Simulation(SETTINGS).frame
    assert len(np.unique(frame.positions, axis=0)) == len(frame)


def test_a_step_that_raises_leaves_agents_of_all_kinds_as_they_were():
    def step(world):
        world.sheep.wool = -1
        world.wolf.move(np.full((40, 2), 0.01))
        world.wolf.hunger = 8
        raise ValueError("no")

    class Broken(gridlock.Model):
        name = "test_broken_kinds"
        kinds = {"wolf": {"hunger": np.int32}, "sheep": {"wool": float}}

        def start(self, start):
            start.wolf.add(positions=start.wolf.anywhere(40))
            start.sheep.add(positions=start.sheep.anywhere(9), wool=np.arange(9))

        def step(self, world):
            step(world)

    simulation = gridlock.Simulation(model=Broken)
    before = simulation.state_hash
    with pytest.raises(gridlock.RunFailure, match="ValueError: no"):
        simulation.run(steps=1)
    assert simulation.state_hash == before and simulation.agents.hunger.sum() == 0


@pytest.mark.parametrize("kinds, columns, message", [
    ({"wolf": {}}, {}, "one kind"),
    (["wolf", "sheep"], {}, "has the kinds"),
    ({"wolf": {}, "sheep": {"wool": float}}, {"wool": float}, "a column of other agents"),
    ({"wolf": {"wool": np.int32}, "sheep": {"wool": float}}, {}, "a column of other agents"),
    ({"wolf": {}, "sheep": {}}, {"kind": np.uint32}, "has kinds and a column kind"),
    ({"wolf": {}, "move": {}}, {}, "has a kind 'move'"),
    ({"wolf": {}, "sheep": {"radius": float}}, {}, "is one of some kinds"),
])
def test_kinds_that_cannot_be_are_refused(kinds, columns, message):
    model = type("Refused", (gridlock.Model,), {"name": "test_refused_kinds", "kinds": kinds, "columns": columns,
                                                "start": lambda self, start: None, "step": lambda self, world: None})
    with pytest.raises(gridlock.Error, match=message):
        gridlock.register_model(model)


@pytest.mark.parametrize("step, message", [
    (lambda world: world.add(x=0.1, y=0.1), "new agents have no kind\n  hint: .* has wolf, sheep: add them to one, as in world.wolf.add"),
    (lambda world: world["wool"], "wool is a column of sheep alone\n  hint: use world.sheep.wool"),
    (lambda world: world.wolf["wool"], "wool is a column of sheep alone"),
    (lambda world: world.wolf.wool, "no column 'wool'; there are x, y, kind, hunger"),
    (lambda world: world.wolf.add(x=0.1, y=0.1, wool=1), "new agents have a column 'wool'"),
    (lambda world: world.kind.fill(1), "read-only"),
    (lambda world: world.wolf.remove([40]), "there is no agent in row 40 among 40"),
])
def test_what_kinds_cannot_do_is_refused(step, message):
    with pytest.raises(gridlock.RunFailure) as failure:
        stepped(step)
    assert failure.match(message.replace("\n", "(?s:.*)"))


@pytest.mark.filterwarnings("ignore:turns are slow without Numba")
def test_turns_see_the_kind_of_an_agent_and_write_columns_of_its_kind_alone(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)  # which needs seconds to compile

    class Turns(gridlock.Model):
        name = "test_kinds_in_turns"
        columns = {"seen": np.uint32}
        kinds = {"wolf": {"hunger": float}, "sheep": {"wool": np.int32}, "dog": {"hunger": float}}
        cutoff = 0.1
        shears = gridlock.Setting(False)

        def start(self, start):
            start.sheep.add(positions=start.sheep.anywhere(40))
            start.wolf.add(positions=start.wolf.anywhere(10), hunger=np.arange(10))
            start.dog.add(positions=start.dog.anywhere(5), hunger=-1)

        @staticmethod
        def turn(row, neighbors, separations, now, next, settings, random, events):
            for k in neighbors:
                next.seen[row] += now.kind[k]
                if now.kind[row] == 1 and now.kind[k] != 1:
                    next.wool[row] += now.hunger[k]
            if now.kind[row] != 1:
                next.hunger[row] = 100 + now.hunger[row]
            elif settings.shears:
                next.hunger[row] = 1

    simulation = gridlock.Simulation(model=Turns, box=OBLONG)
    simulation.run(steps=1)
    frame = simulation.frame
    near = gridlock.neighbors(frame.positions, 0.1, frame.box)
    assert np.array_equal(frame.seen, near.sum(frame.kind)) and frame.seen.sum() > 20
    hunger = np.where(frame.kind == 0, frame.hunger - 100, np.where(frame.kind == 2, -1, 0))
    assert np.array_equal(frame.of_kind("sheep").wool, near.sum(hunger)[frame.kind == 1]) and frame.wool.sum() > 5
    assert sorted(frame.of_kind("wolf").hunger) == list(range(100, 110)) and (frame.of_kind("dog").hunger == 99).all()
    with pytest.raises(gridlock.RunFailure, match="a turn has written hunger for the agent of row 10, whose kind does not have it"):
        gridlock.Simulation(model=Turns(shears=True), box=OBLONG).run(steps=1)
    Turns.kinds = {"wolf": {"dx": float}, "sheep": {}}
    with pytest.raises(gridlock.Error, match="has a column dx, a name of turns"):
        gridlock.register_model(Turns)


def test_agents_do_not_change_their_kind():
    simulation = gridlock.Simulation(SETTINGS)
    simulation.agents.kind[0] = 2
    with pytest.raises(gridlock.Error, match="the column kind was changed\n  hint: an agent keeps its kind for its whole life"):
        simulation.run(steps=1)


def test_networks_join_the_agents_of_each_kind_that_are_meant():
    class Herd(gridlock.Model):
        name = "test_herd"
        kinds = {"wolf": {}, "sheep": {}}
        networks = {"near": gridlock.Network(), "herd": gridlock.Network()}

        def start(self, start):
            first = start.sheep.add(x=[0.1, 0.2], y=0.5)
            wolves = start.wolf.add(x=[0.32, 0.9], y=0.5)
            start.herd.connect([first[0], wolves[0]], [first[1], wolves[1]])
            assert start.herd.edges.tolist() == [[0, 1], [2, 3]] and start.herd.has(1, 0).all()
            start.near.connect_within(0.15)

        def step(self, world):
            born = world.sheep.add(x=[0.6, 0.7], y=0.5)
            wolf = world.wolf.add(x=0.8, y=0.5)
            world.herd.connect(born, [wolf[0], wolf[0]])

    simulation = gridlock.Simulation(model=Herd, box=OBLONG)
    pairs_of = lambda network: {frozenset(np.round(frame.x[np.isin(frame.ids, pair)], 2).tolist()) for pair in frame.networks[network].ids}  # noqa: E731
    frame = simulation.frame
    assert pairs_of("near") == {frozenset({0.1, 0.2}), frozenset({0.2, 0.32})}
    assert pairs_of("herd") == {frozenset({0.1, 0.2}), frozenset({0.32, 0.9})}
    simulation.run(steps=1)
    frame = simulation.frame
    assert pairs_of("herd") == {frozenset({0.1, 0.2}), frozenset({0.32, 0.9}), frozenset({0.6, 0.8}), frozenset({0.7, 0.8})}


def test_whole_numbers_that_look_like_a_mask_remove_nobody():
    with pytest.raises(gridlock.RunFailure, match=r"is it a mask\? remove\(world.dead == 1\)"):
        stepped(lambda world: world.remove((world.kind == 1).astype(int)))
