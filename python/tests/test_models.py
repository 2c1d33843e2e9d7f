"""Agent models in Python: the same bits as those in C++, and what a step may keep and change."""

import gc
import threading

import numpy as np
import pytest

import gridlock
from conftest import OBLONG
from walkers import SETTINGS, Walkers, made


@gridlock.register_model
class Flock(gridlock.Model):
    """Vicsek's flock."""

    name = "test_flock"
    columns = {"heading_x": float, "heading_y": float}
    count = gridlock.Setting(300, least=1)
    radius = gridlock.Setting(1.0, least=0.0)
    noise = gridlock.Setting(1.0, least=0.0)

    def start(self, start):
        angle = 2 * np.pi * start.uniform(self.count)
        start.add(positions=start.anywhere(self.count), heading_x=np.cos(angle), heading_y=np.sin(angle))

    def step(self, world):
        heading = np.stack([world.heading_x, world.heading_y], axis=1)
        mean = heading + world.neighbors(self.radius).sum(heading)
        angle = np.arctan2(mean[:, 1], mean[:, 0]) + self.noise * (world.uniform() - 0.5)
        world.move(0.03 * heading)
        world.heading_x = np.cos(angle)
        world["heading_y"] = np.sin(angle)

    def observe(self, world):
        return {"order": np.hypot(world.heading_x.mean(), world.heading_y.mean())}


def test_the_state_hash_is_that_of_a_model_in_cpp_with_the_same_columns():
    shipped = gridlock.Simulation(model="epidemic", epidemic={"count": 50}, box=OBLONG, run={"seed": 9})
    columns = {name: np.array(shipped.agents[name]) for name in shipped.agents.names}

    class Copy(gridlock.Model):
        name = "test_copy"
        columns = {"velocity_x": float, "velocity_y": float, "health": np.uint32}

        def start(self, start):
            start.add(**data)

        def step(self, world):
            pass

    data = columns
    copy = gridlock.Simulation(model=Copy, box=OBLONG, run={"seed": 9})
    assert copy.state_hash == shipped.state_hash
    copy.run(steps=1)
    assert copy.state_hash != shipped.state_hash


def test_random_numbers_and_moves_are_those_of_cpp():
    shipped = gridlock.Simulation(model="epidemic", epidemic={"count": 50}, box=OBLONG, run={"seed": 9})

    class Anywhere(gridlock.Model):
        name = "test_anywhere"

        def start(self, start):
            start.add(positions=start.anywhere(50))

        def step(self, world):
            pass

    copy = gridlock.Simulation(model=Anywhere, box=OBLONG, run={"seed": 9})
    assert np.array_equal(copy.agents.positions, shipped.agents.positions)


@pytest.mark.parametrize("edge", ["periodic", "wall"])
def test_chunks_and_threads_do_not_change_the_bits(edge):
    settings = {**SETTINGS, "box.edge": edge, "test_walkers.count": 400}
    whole = gridlock.Simulation(settings)
    whole.run(steps=70)
    parts = gridlock.Simulation(settings)
    for steps in (1, 31, 1, 20, 17):
        parts.run(steps=steps)
    assert parts.state_hash == whole.state_hash
    flock = {"model.kind": "test_flock", "box": {"width": 16, "height": 9, "edge": edge}, "test_flock.count": 600}
    hashes = set()
    for threads in (1, 2, 3):
        simulation = gridlock.Simulation(flock, threads=threads)
        simulation.run(steps=40)
        hashes.add(simulation.state_hash)
    assert len(hashes) == 1


def test_births_and_deaths_keep_ids_and_counts():
    simulation = made(test_walkers={"turnover": 0.1})
    alive = set(simulation.agents.ids.tolist())
    ever = set(alive)
    for _ in range(60):
        before = {int(k): int(age) for k, age in zip(simulation.agents.ids, simulation.agents.age)}
        simulation.step()
        ids = simulation.agents.ids.tolist()
        ages = simulation.agents.age
        assert len(set(ids)) == len(ids)
        newborn = set(ids) - before.keys()
        assert not newborn & ever
        ever |= newborn
        for k, age in zip(ids, ages):
            assert age == (0 if k in newborn else before[k] + 1)
    counts = simulation.counts
    assert counts["births"] - counts["deaths"] == len(simulation.agents) - 200
    assert counts["births"] > 500


def test_walkers_spread_as_they_must():
    simulation = made(test_walkers={"count": 4000, "turnover": 0.0}, box={"width": 60.0, "height": 40.0})
    start = {int(k): p for k, p in zip(simulation.agents.ids, np.array(simulation.agents.positions))}
    simulation.run(steps=100)
    away = np.array([p - start[int(k)] for k, p in zip(simulation.agents.ids, simulation.agents.positions)])
    away -= [60.0, 40.0] * np.rint(away / [60.0, 40.0])
    squared = (away**2).sum(axis=1)
    # Variance of a standard normal number cut at ±3, by its density.
    z = np.linspace(-8, 8, 400_001)
    expected = 2 * 100 * 0.01**2 * float((np.clip(z, -3, 3) ** 2 * np.exp(-z * z / 2)).sum() / np.exp(-z * z / 2).sum())
    assert abs(squared.mean() - expected) < 4 * squared.std() / np.sqrt(len(squared))


def test_images_are_counted_so_that_trajectories_unwrap(tmp_path):
    class Drift(gridlock.Model):
        name = "test_drift"
        columns = {"image_x": np.int32, "image_y": np.int32}

        def start(self, start):
            start.add(positions=start.anywhere(20))

        def step(self, world):
            world.move(np.tile([0.1, -0.07], (len(world), 1)))

    gridlock.register_model(Drift)
    gridlock.run({"model.kind": "test_drift", "box": OBLONG, "run.steps": 100, "trajectory.every": 50}, tmp_path / "run")
    positions = gridlock.open(tmp_path / "run").trajectory.positions()
    assert np.allclose(positions[-1] - positions[0], [10.0, -7.0])


def test_the_flock_orders_as_that_in_cpp():
    def order(kind, seed):
        simulation = gridlock.Simulation(
            {"model.kind": kind, f"{kind}.count": 300, f"{kind}.noise": 2.0, "run.seed": seed, "observe.every": 5},
            box={"width": 9.8, "height": 5.0, "edge": "periodic"},
        )
        simulation.equilibrate(steps=200)
        simulation.run(steps=300)
        return simulation.results["order"].value

    here = np.array([order("test_flock", seed) for seed in range(1, 7)])
    there = np.array([order("flocking", seed) for seed in range(11, 17)])
    error = np.sqrt(here.var(ddof=1) / 6 + there.var(ddof=1) / 6)
    assert abs(here.mean() - there.mean()) < 4 * error
    assert 0.5 < here.mean() < 0.99


def test_settings_are_those_of_every_model():
    assert "Of a step." in gridlock.explain("test_walkers.length")
    with pytest.raises(gridlock.Error, match="test_walkers.length"):
        made(test_walkers={"length": 0.5})
    with pytest.raises(gridlock.Error, match="test_walkers.count"):
        made(test_walkers={"count": 0})
    with pytest.raises(gridlock.Error, match="step_size"):
        made(test_walkers={"step_size": 0.1})
    with pytest.raises(gridlock.Error, match="kind"):
        made(test_walkers={"kind": "sideways"})
    by_object = gridlock.Simulation(SETTINGS, model=Walkers(count=30, kind="uniform", is_charged=True))
    assert len(by_object.agents) == 30 and set(by_object.agents.charge) == {1}
    by_names = made(test_walkers={"count": 30, "kind": "uniform", "is_charged": True})
    assert by_object.state_hash == by_names.state_hash
    assert by_object.time_step == 0.5
    with pytest.raises(gridlock.Error, match="no setting"):
        Walkers(size=3)
    with pytest.raises(gridlock.Error, match="is no model"):
        gridlock.Simulation(model=3)


def test_arrays_taken_while_a_run_is_in_a_step_are_copies():
    class Grows(gridlock.Model):
        name = "test_grows"
        columns = {"height": float}

        def start(self, start):
            start.add(positions=start.anywhere(500), height=1.0)

        def step(self, world):
            kept.append(simulation.agents.height)
            with pytest.raises(ValueError, match="read-only"):
                simulation.agents.x[:] = 0.25
            world.add(positions=world.positions, height=1.0)

        def observe(self, world):
            if simulation is not None:
                with pytest.raises(ValueError, match="read-only"):
                    simulation.agents.x[:] = 0.25
            return {"plants": len(world)}

    kept = []
    simulation = None
    simulation = gridlock.Simulation(model=Grows, box=OBLONG, observe={"every": 1})
    simulation.run(steps=6, progress=lambda steps, fraction: kept.append(simulation.agents.height))
    assert len(kept) > 6 and all((heights == 1.0).all() and not heights.flags.writeable for heights in kept)
    simulation.agents.height[:] = 2.0
    assert simulation.agents.height.sum() == 2.0 * 500 * 2**6


def test_an_observation_changes_nothing():
    class Meddler(gridlock.Model):
        name = "test_meddler"
        columns = {"age": float}

        def start(self, start):
            start.add(x=0.5, y=0.5)

        def step(self, world):
            world.age += 1

        def observe(self, world):
            for act in (lambda: world.move(np.zeros((1, 2))), lambda: world.add(x=0.1, y=0.1), lambda: world.remove([0])):
                with pytest.raises(gridlock.Error, match="an observation cannot"):
                    act()
            with pytest.raises(ValueError, match="read-only"):
                world.age[0] = 7.0
            return {"age": world.age[0]}

    simulation = gridlock.Simulation(model=Meddler, observe={"every": 1})
    simulation.run(steps=5)
    assert simulation.series["age"].tolist() == [0, 1, 2, 3, 4, 5]


def test_settings_without_effect_are_told_of():
    with pytest.warns(UserWarning, match="verify_every has no effect"):
        made(model={"verify_every": 10})
    with pytest.warns(UserWarning, match="engine.kind has no effect"):
        made(engine={"kind": "exact"})


def test_what_is_kept_of_a_step_is_dead():
    kept = {}

    class Keeper(gridlock.Model):
        name = "test_keeper"
        columns = {"age": float}

        def start(self, start):
            kept.setdefault("start", start)
            start.add(positions=start.anywhere(100))

        def step(self, world):
            if "world" not in kept:
                kept.update(world=world, age=world.age, part=world.x[:50])
            world.age += 1
            world.move(np.full((len(world), 2), 0.01))
            world.add(positions=np.full((1000, 2), 0.5))

    simulation = gridlock.Simulation(model=Keeper, box=OBLONG)
    simulation.step()
    ages, part = np.array(kept["age"]), np.array(kept["part"])
    simulation.run(steps=40)
    assert np.array_equal(kept["age"], ages) and np.array_equal(kept["part"], part)
    with pytest.raises(ValueError, match="read-only"):
        kept["age"][0] = 5
    for act in (lambda: kept["world"].x, lambda: len(kept["world"]), lambda: kept["start"].box):
        with pytest.raises(RuntimeError, match="the step of this world is over"):
            act()
    with pytest.raises(gridlock.Error, match="cannot keep 'memory'"):
        Keeper().memory = 3
    with pytest.raises(gridlock.Error, match="cannot keep 'count'"):
        Walkers().count = 3


def test_a_setting_has_one_name():
    # Python before 3.12 wraps what __set_name__ raises.
    with pytest.raises((gridlock.Error, RuntimeError)) as caught:
        type("Twice", (gridlock.Model,), {"cutoff": Walkers.__dict__["turnover"]})
    assert "gets the name cutoff too" in f"{caught.value}{caught.value.__cause__}"
    assert "turnover" in Walkers().settings and "cutoff" not in Walkers().settings


def test_a_class_of_the_same_name_replaces_the_former_one():
    def made(length):
        class Again(gridlock.Model):
            name = "test_again"

            def start(self, start):
                start.add(x=0.5, y=0.5)

            def step(self, world):
                world.move(np.array([[length, 0.0]]))

        return gridlock.register_model(Again)

    made(0.1)
    first = gridlock.Simulation(model="test_again")
    made(0.2)
    second = gridlock.Simulation(model="test_again")
    for simulation in (first, second):
        simulation.run(steps=1)
    assert (first.agents.x[0], second.agents.x[0]) == (0.6, 0.7)


def test_agents_are_written_between_steps_and_checked():
    simulation = made()
    simulation.agents.age[:] = 100
    simulation.run(steps=1)
    assert set(simulation.agents.age[np.isin(simulation.agents.ids, np.arange(200))]) == {101}
    simulation.agents.x[0] = 5.0
    with pytest.raises(gridlock.Error, match="outside the box"):
        simulation.run(steps=1)
    simulation.agents.x[0] = 0.5
    simulation.run(steps=1)


def test_memory_does_not_grow():
    import resource

    def made():
        simulation = gridlock.Simulation(SETTINGS, test_walkers={"count": 2000})
        simulation.run(steps=2)

    for _ in range(50):
        made()
    gc.collect()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(500):
        made()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 10_000


def test_neighbor_sums_are_those_of_numpy():
    random = np.random.default_rng(3)
    points = random.random((500, 2))
    found = gridlock.neighbors(points, 0.07, box=1.0)
    for shape in ((500,), (500, 1), (500, 2), (500, 3)):
        values = random.random(shape)
        expected = np.zeros(shape)
        np.add.at(expected, found.owners, values[found.indices])
        assert np.allclose(found.sum(values), expected)
        mean = found.mean(values)
        some = found.counts > 0
        assert np.allclose(mean[some], (expected.T / np.maximum(found.counts, 1)).T[some]) and np.all(np.isnan(mean[~some]))
    nobody = gridlock.neighbors(np.empty((0, 2)), 0.1, box=1.0)
    assert nobody.sum(np.empty(0)).shape == (0,)
    near = found.sum(np.arange(500) < 250)
    assert near.max() > 0 and np.array_equal(near, found.sum((np.arange(500) < 250).astype(float)))
    for wrong in (np.zeros(3), np.zeros(500, dtype=complex), ["a"] * 500, np.ma.masked_array(np.zeros(500), mask=points[:, 0] < 0.5)):
        with pytest.raises(gridlock.Error):
            found.sum(wrong)
    for ends in (found.indptr * 10**9, found.indptr[::-1].copy(), found.indptr + 1):
        with pytest.raises(gridlock.Error, match="begin"):
            gridlock.Neighbors(ends, found.indices).sum(np.ones(500))


def test_a_search_that_outlives_its_step_sees_the_agents_of_that_step():
    searches, threads = [], []

    @gridlock.register_model
    class Growing(gridlock.Model):
        name = "test_growing"

        def start(self, start):
            start.add(positions=start.anywhere(400_000))

        def step(self, world):
            begun, points = threading.Event(), world.positions.copy()
            world.add(positions=points[:1000])  # after the step, into other memory
            threads.append(threading.Thread(target=lambda: (begun.set(), searches.append((points, world.pairs(0.001))))))
            threads[-1].start()
            begun.wait()

    gridlock.Simulation(model="test_growing", box=OBLONG).run(steps=5)
    for thread in threads:
        thread.join()
    assert len(searches) == 5
    assert all(np.array_equal(pairs, gridlock.pairs(points, 0.001, (1.5, 0.6))) for points, pairs in searches)


def test_changed_settings_hold_from_the_next_step_on_and_are_recorded():
    one = made()
    one.on_step(4, lambda simulation: simulation.change(test_walkers={"turnover": 0.5}) if simulation.clock.step == 8 else None)
    one.run(steps=8)
    one.change({"test_walkers.length": 0.0})
    assert [str(change) for change in one.changes] == ["step 8: test_walkers.turnover was 0.02 and is 0.5",
                                                       "step 8: test_walkers.length was 0.01 and is 0.0"]
    before = one.frame
    one.run(steps=1)
    other = made()
    other.run(steps=8)
    assert np.array_equal(before.x, other.frame.x) and one.counts["deaths"] > other.counts["deaths"] + 20
    after = one.frame
    assert np.array_equal(after.x[np.isin(after.ids, before.ids)], before.x[np.isin(before.ids, after.ids)])
    assert "turnover = 0.02" in one.settings  # those of the start


@pytest.mark.parametrize("key, value, words", [
    ("test_walkers.count", 3, "its start, its fields or its time step"), ("run.seed", 3, "no setting of a model"), ("test_walkers.none", 3, "no setting of a model"),
    ("test_walkers.length", 0.5, "at most 0.4"), ("test_walkers.kind", "round", "uniform"), ("test_walkers.is_charged", True, "its start")])
def test_settings_that_cannot_change_are_refused_and_nothing_is_changed(key, value, words):
    simulation = made()
    with pytest.raises(gridlock.Error, match=words):
        simulation.change({"test_walkers.turnover": 0.3, key: value})
    assert simulation.changes == [] and simulation._model.turnover == 0.02
    with pytest.raises(gridlock.Error, match="no setting of a model"):
        gridlock.Simulation(disks={"count": 4, "packing_fraction": 0.1}).change({"disks.count": 5})


def test_a_setting_says_whether_a_change_of_it_restarts_but_not_those_of_fields_and_the_time_step():
    class Meadow(gridlock.Model):
        name = "test_changing_meadow"
        fields = {"grass": gridlock.Field("side")}
        side = gridlock.Setting(4, restarts=False)
        pace = gridlock.Setting(0.5, restarts=False)
        hunger = gridlock.Setting(1.0, restarts=False)
        stays = gridlock.Setting(1.0, restarts=True)
        time_step = property(lambda self: self.pace)

        def start(self, start):
            start.add(x=0.5, y=0.5 * self.hunger)

        def step(self, world):
            world.grass += self.hunger

    meadow = gridlock.Simulation(model=Meadow)
    meadow.change({"test_changing_meadow.hunger": 2})
    meadow.run(steps=1)
    assert meadow.frame.fields["grass"].tolist() == [[2.0] * 4] * 4 and meadow._model.hunger == 2.0
    for key in ("side", "pace", "stays"):
        with pytest.raises(gridlock.Error, match="cannot change"):
            meadow.change({f"test_changing_meadow.{key}": 3})


def test_each_call_for_places_of_a_start_draws_its_own():
    drawn = []

    class Two(gridlock.Model):
        name = "test_two_calls"
        kinds = {"one": {}, "other": {}}

        def start(self, start):
            drawn.append([start.one.anywhere(50), start.one.anywhere(50), start.other.anywhere(50), start.one.anywhere(50, radius=0.01)])
            start.one.add(positions=drawn[-1][0])

        def step(self, world):
            pass

    gridlock.Simulation(model=Two)
    gridlock.Simulation(model=Two)
    assert len({places.tobytes() for places in drawn[0]}) == 4
    assert all(np.array_equal(*both) for both in zip(*drawn))
