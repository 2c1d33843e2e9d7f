"""Agents of models in Python that stand still, and agents that move apart."""

import sys

import numpy as np
import pytest

import gridlock
from conftest import OBLONG


def stepped(step, start=None, steps=1, box=OBLONG, **more):
    """Runs a model with this step; returns the simulation."""

    class Stepped(gridlock.Model):
        name = "test_standing"
        columns = {"mark": np.uint32, "image_x": np.int32, "image_y": np.int32}

        def start(self, begin):
            (start or (lambda begin: begin.add(positions=begin.anywhere(120))))(begin)

        def step(self, world):
            step(world)

    simulation = gridlock.Simulation(model=Stepped, box=box, **more)
    simulation.run(steps=steps)
    return simulation


def place_of(array):
    return array.__array_interface__["data"][0]


def test_neighbors_are_kept_while_nobody_moves():
    places, pairs = [], []

    def step(world):
        places.append(place_of(world.neighbors(0.1).indices))
        assert place_of(world.neighbors(0.1).indices) == places[-1] != place_of(world.neighbors(0.12).indices)
        pairs.append(place_of(world.pairs(0.1)))
        world.mark += 1

    stepped(step, steps=40)
    assert len(set(places)) == len(set(pairs)) == 1 and len(places) == 40


@pytest.mark.parametrize("change", [
    lambda world: world.move(np.full((len(world), 2), 0.01)),
    lambda world: world.x.__iadd__(0.001 * (world.x < 0.5)),
    lambda world: (world.remove([3]), world.add(x=0.1, y=0.1)),
    lambda world: world.remove([3]),
])
def test_neighbors_are_found_again_after_every_change(change):
    def step(world):
        for _ in range(2):
            found = world.neighbors(0.1)
            right = gridlock.neighbors(world.positions, 0.1, world.box)
            assert np.array_equal(found.indices, right.indices) and np.array_equal(found.indptr, right.indptr)
            if world.clock.step % 3 == 1:
                change(world)

    stepped(step, steps=6)


def test_neighbors_are_found_again_after_agents_were_moved_between_runs():
    seen = []
    simulation = stepped(lambda world: seen.append(world.neighbors(0.1).counts.sum()))
    simulation.agents.positions[...] = [0.3, 0.3]
    simulation.run(steps=1)
    assert seen[1] == 120 * 119 != seen[0]


def test_a_list_that_is_kept_cannot_be_written():
    with pytest.raises(gridlock.RunFailure, match="read-only"):
        stepped(lambda world: world.neighbors(0.1).indices.fill(0))


def test_random_numbers_of_some_rows_are_those_of_the_same_agents():
    def step(world):
        mask = world.uniform() < 0.3
        assert np.array_equal(world.uniform(3, purpose=2, rows=mask), world.uniform(3, purpose=2)[mask])
        assert np.array_equal(world.normal(rows=[5, 1]), world.normal()[[5, 1]])

    stepped(step)


@pytest.mark.filterwarnings("ignore:turns are slow without Numba")
def test_agents_that_sleep_take_no_turn(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)  # which needs seconds to compile
    class Awake(gridlock.Model):
        name = "test_awake"
        columns = {"turns": np.uint32, "number": float}
        cutoff = 0.05

        def start(self, start):
            start.add(positions=start.anywhere(50))

        def awake(self, world):
            return world.ids % 3 == world.clock.step % 3

        @staticmethod
        def turn(row, neighbors, separations, now, next, settings, random, events):
            next.turns[row] += 1
            next.number[row] = random[0]
            next.dx[row] = 0.001

    simulation = gridlock.Simulation(model=Awake, box=OBLONG)
    before = simulation.frame.x
    simulation.run(steps=1)
    frame = simulation.frame
    assert np.array_equal(frame.turns, frame.ids % 3 == 0) and np.array_equal(frame.number > 0, frame.ids % 3 == 0)
    assert np.array_equal(frame.x != before, frame.ids % 3 == 0)
    simulation.run(steps=2)
    assert (simulation.agents.turns == 1).all()


def lattice(start):
    row, column = np.divmod(np.arange(96), 12)
    start.add(x=(column + 0.5) * OBLONG["width"] / 12, y=(row + 0.5) * OBLONG["height"] / 8)


def smallest_gap(world, radius):
    i, j = np.triu_indices(len(world), 1)
    return (np.hypot(*world.separations(i, j).T) - radius[i] - radius[j]).min()


@pytest.mark.parametrize("shuffled", [False, True])
@pytest.mark.parametrize("edge", [{"edge": "periodic"}, {"edge": "wall"}, {"edge": "periodic", "edge_y": "wall"}])
def test_no_two_agents_that_move_apart_overlap(edge, shuffled):
    halted, walls = [], []

    def step(world):
        radius = 0.02 + 0.015 * (world.ids % 2)
        halts = world.move(0.05 * world.normal(2).clip(-1, 1), radius=radius, shuffled=shuffled)
        halted.append((halts.partners >= 0).sum())
        assert smallest_gap(world, radius) >= -1e-15
        sides = world.box.width, world.box.height
        for axis, side in enumerate(sides):
            if not (world.box.periodic_x, world.box.periodic_y)[axis]:
                assert (world.positions[:, axis] >= radius).all() and (world.positions[:, axis] <= side - radius).all()
        walls.append(halts.walls.any(axis=0))

    stepped(step, lattice, steps=25, box={**OBLONG, **edge})
    assert min(halted) > 5
    assert np.any(walls, axis=0).tolist() == [edge["edge"] == "wall", edge != {"edge": "periodic"}]


@pytest.mark.parametrize("edge", ["periodic", "wall"])
def test_agents_can_start_anywhere_without_overlap(edge):
    radius = np.where(np.arange(150) % 3 == 0, 0.03, 0.02)

    def start(begin):
        places = begin.anywhere(150, radius=radius)
        assert not np.array_equal(places, begin.anywhere(150, radius=radius))  # which are as good as any
        begin.add(positions=places)

    def step(world):
        of_rows = radius[world.ids.astype(int)]
        assert smallest_gap(world, of_rows) >= 0
        if edge == "wall":
            assert np.all((world.positions.T >= of_rows) & (world.positions.T <= np.array([[1.5], [0.6]]) - of_rows))

    stepped(step, start, box={**OBLONG, "edge": edge})


def test_agents_that_find_no_place_are_refused():
    with pytest.raises(gridlock.Error, match="of 200 agents find no place without overlap"):
        stepped(lambda world: None, lambda start: start.add(positions=start.anywhere(200, radius=0.04)))


def test_an_agent_halts_before_the_part_that_would_overlap():
    def start(begin):
        begin.add(x=[0.1, 0.35, 0.2], y=[0.2, 0.2, 0.5])

    def step(world):
        order = np.argsort(world.ids)
        moves = np.zeros((3, 2))
        moves[order[0], 0], moves[order[2], 0] = 0.1, -0.15
        halts = world.move(moves, radius=0.1, parts=5)
        # The gap of 0.05 takes two parts of 0.02, the room of 0.1 before the wall three parts of 0.03.
        assert np.allclose(world.x[order], [0.14, 0.35, 0.11])
        assert list(halts.partners[order]) == [order[1], -1, -1] and halts.walls[order].tolist() == [[False] * 2] * 2 + [[True, False]]

    stepped(step, start, box={"width": 1.0, "height": 1.0, "edge": "wall"})


@pytest.mark.filterwarnings("ignore:self-propelled disks whose headings never turn")
def test_agents_in_the_order_of_their_ids_move_as_disks_of_the_rule_of_the_paper():
    # Self-propelled disks keep their velocities where they halt: what is left of the rule is how they move.
    settings = {"disks": {"count": 60, "packing_fraction": 0.4}, "box": {"edge": "periodic"}, "run": {"seed": 3},
                "engine": {"kind": "stepped", "time_step": 0.1, "substeps": 4}, "propulsion": {"speed": 1.0}}
    disks = gridlock.Simulation(settings)
    disks.run(steps=1)  # gives the disks their speed
    first = disks.frame
    velocity = np.stack([first.velocity_x, first.velocity_y], axis=1)

    class Swimmers(gridlock.Model):
        name = "test_swimmers"

        def start(self, start):
            start.add(positions=first.positions)

        def step(self, world):
            world.move(disks.time_step * velocity[world.ids.astype(int)], radius=first.radius[world.ids.astype(int)], parts=4)

    box = {"width": first.box.width, "height": first.box.height, "edge": "periodic"}
    agents = gridlock.Simulation(model=Swimmers, box=box)
    for simulation in (disks, agents):
        simulation.run(steps=200)
    assert np.array_equal(disks.frame.positions, agents.frame.positions)
    assert disks.counts["halted_moves"] > 1000 and np.abs(agents.frame.positions - first.positions).max() > 0.2


def test_agents_that_overlap_at_first_can_only_move_away_from_each_other():
    gaps = []

    def step(world):
        apart = np.sign(world.x - world.x.mean())
        gaps.append(np.ptp(world.x))
        towards_or_away = -1 if world.clock.step % 2 else 1
        world.move(np.stack([0.01 * towards_or_away * apart, np.zeros(2)], axis=1), radius=0.1)

    stepped(step, lambda start: start.add(x=[0.4, 0.5], y=0.3), steps=8)
    assert np.allclose(np.diff(gaps), [0.02, 0.0] * 3 + [0.02])


@pytest.mark.parametrize("arguments, message", [
    ({"radius": -1.0}, "the radius is -1.0"),
    ({"radius": 0.01, "parts": 0}, "0 parts"),
    ({"radius": 0.01, "parts": 10**8}, "use 1 to 1000 parts"),
    ({"radius": 0.2}, "at most a quarter of the shorter side"),
    ({"radius": 0.001, "parts": 1}, "could jump over another"),
    ({"radius": [0.1]}, "shape"),
])
def test_moves_apart_that_cannot_be_are_refused(arguments, message):
    with pytest.raises(gridlock.RunFailure, match=message):
        stepped(lambda world: world.move(np.full((120, 2), 0.05), **arguments))
