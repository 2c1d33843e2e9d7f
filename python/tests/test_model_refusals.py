"""What models in Python are refused for, and in which words: nothing is dropped, cut or passed over in silence."""

import inspect
import re

import numpy as np
import pytest

import gridlock
from conftest import OBLONG
from gridlock import _core
from gridlock.models import registered_models


def model(**body):
    """A class of a model of three agents that does nothing, but for what `body` says."""
    usual = {"name": "test_refusals", "columns": {"kind": np.uint32, "charge": np.int32, "mark": np.uint64, "mass": float},
             "start": lambda self, start: start.add(x=[0.1, 0.2, 0.3], y=0.5), "step": lambda self, world: None}
    return type("Refusals", (gridlock.Model,), {**usual, **body})


def simulation(**body):
    return gridlock.Simulation(model=model(**body), box=OBLONG, observe={"every": 1})


@pytest.mark.parametrize("kind", [1, 1.0, True, np.int8(1), np.float32(1.0), [1, 1, 1], np.ones(3), np.ones(3, dtype=np.int64), [True] * 3,
                                  np.array([1, 1, 1], dtype=object)], ids=repr)
def test_numbers_that_fit_a_column_are_cast(kind):
    made = simulation(start=lambda self, start: start.add(x=[0.1, 0.2, 0.3], y=0.5, kind=kind),
                      step=lambda self, world: world.add(x=[0.4, 0.5, 0.6], y=0.1, kind=kind))
    made.run(steps=1)
    assert made.agents.kind.tolist() == [1] * 6


def test_the_ends_of_every_type_are_cast():
    for name, kind in {"kind": np.uint32, "charge": np.int32, "mark": np.uint64}.items():
        limits = np.iinfo(kind)
        for value in (limits.min, limits.max):
            made = simulation(start=lambda self, start: start.add(x=0.5, y=0.5, **{name: value}))
            assert int(made.agents[name][0]) == value


UNFIT = {
    "a fraction": (("kind", 0.5), "column kind: 0.5 is no whole number"),
    "a fraction among whole numbers": (("kind", [0, 1, 0.5]), "column kind: 0.5 is no whole number, at 2"),
    "below": (("kind", -1), "column kind: -1 is below 0"),
    "below among others": (("kind", np.arange(3) - 1), "column kind: -1 is below 0, at 0"),
    "above": (("kind", 2**32), "column kind: 4294967296 is above 4294967295"),
    "above as a float": (("mark", 2.0**64), "column mark: 1.84467.* is above 18446744073709551615"),
    "far above": (("charge", 10**400), r"column charge: 10000.* \(401 characters\) is above 2147483647"),
    "too large": (("mass", 10**400), "column mass: 1000.* is too large"),
    "not a number": (("kind", np.nan), "column kind: nan is no whole number"),
    "infinite": (("charge", [0, 1, -np.inf]), "column charge: -inf is no whole number, at 2"),
    "a text": (("mass", "heavy"), "column mass: 'heavy' is no number"),
    "nothing": (("mass", None), "column mass: None is no number"),
    "complex": (("mass", 1j), "column mass: 1j is no number"),
    "masked": (("mass", np.ma.masked_greater([1.0, 2.0, 3.0], 1.5)), "column mass: the values are an array with 2 masked values"),
    "masked places": (("x", np.ma.masked_greater([0.1, 0.2, 0.3], 0.15)), "column x: the values are an array with 2 masked values"),
    "another length": (("kind", [0, 1]), r"column kind: the values of new agents have shape \(2,\)"),
    "a table": (("kind", np.zeros((3, 1), dtype=int)), r"column kind: the values of new agents have shape \(3, 1\)"),
}


@pytest.mark.parametrize("what", UNFIT)
def test_what_does_not_fit_is_refused_with_its_column_its_value_and_the_line(what):
    (name, value), words = UNFIT[what]

    def start(self, start):
        start.add(**{"x": [0.1, 0.2, 0.3], "y": 0.5, name: value})

    def step(self, world):
        world.add(**{"x": [0.1, 0.2, 0.3], "y": 0.5, name: value})

    def place_in(function):
        return rf" \(test_model_refusals.py, line {inspect.getsourcelines(function)[1] + 1}\)"

    with pytest.raises(gridlock.Error, match=words + place_in(start)):
        simulation(start=start)
    with pytest.raises(gridlock.RunFailure, match=words + place_in(step)):
        simulation(step=step).run(steps=1)


@pytest.mark.parametrize("places", [np.ma.masked_less(np.full((2, 2), 0.1), 0.2), np.zeros((2, 3)), [["a", "b"]], 3.0, [[0.1, 0.2j]]])
def test_positions_that_are_none_are_refused_with_the_line(places):
    with pytest.raises(gridlock.Error, match=r"(?s)the positions of new agents.*\(test_model_refusals.py, line \d+\)"):
        simulation(start=lambda self, start: start.add(positions=places))


def test_what_a_start_refuses_by_itself_is_told_in_its_own_words():
    def start(self, start):
        raise gridlock.Error("there is no room for so many\n  hint: use fewer")

    with pytest.raises(gridlock.Error) as caught:
        simulation(start=start)
    assert caught.value.problems[0]["what"] == "there is no room for so many" and caught.value.problems[0]["hint"] == "use fewer"


def test_a_column_as_a_whole_takes_what_fits_alone():
    def step(self, world):
        world.kind = [0, 1.0, True]
        world["charge"] = np.arange(3) - 1
        with pytest.raises(gridlock.Error, match="column kind: 0.5 is no whole number"):
            world.kind = 0.5
        with pytest.raises(gridlock.Error, match="column mark: -1 is below 0"):
            world["mark"] = -1
        with pytest.raises(gridlock.Error, match="column positions: the values are an array with 6 masked values"):
            world.positions = np.ma.masked_less(np.zeros((3, 2)), 1.0)

    made = simulation(step=step)
    made.run(steps=1)
    assert sorted(made.agents.kind) == [0, 1, 1] and sorted(made.agents.charge) == [-1, 0, 1]
    for change in (lambda: setattr(made.agents, "kind", 0.5), lambda: made.agents.__setitem__("kind", [-1, 0, 0])):
        with pytest.raises(gridlock.Error, match="column kind: "):
            change()
    with pytest.raises(gridlock.Error, match="masked"):
        made.agents.positions = np.ma.masked_less(np.zeros((3, 2)), 1.0)
    made.agents.kind = 7
    assert made.agents.kind.tolist() == [7, 7, 7]


def test_masked_rows_remove_nobody():
    with pytest.raises(gridlock.RunFailure, match="the rows to remove are an array with 1 masked values"):
        simulation(step=lambda self, world: world.remove(np.ma.masked_equal([0, 1], 1))).run(steps=1)


@pytest.mark.parametrize("seen, words", [(None, "returned nothing"), ({"order": None}, "order returned nothing"), ({"order": "high"}, "order returned 'high'"),
                                         ({"order": np.ma.masked}, "order returned an array with 1 masked"), ([], "returned list"),
                                         ({"order": 1j}, "order returned 1j"), ({"order": np.array([0.5, 0.25])}, "order returned 2 numbers"),
                                         ({"order": [1.0, 2.0, 3.0]}, "order returned 3 numbers"), ({"order": ()}, "order returned 0 numbers")])
def test_an_observation_returns_numbers_by_name(seen, words):
    with pytest.raises((gridlock.Error, gridlock.RunFailure), match=rf"observe\(\) of the model test_refusals:? {words}"):
        simulation(observe=lambda self, world: seen).run(steps=1)


@pytest.mark.parametrize("seen, words", [(None, "returned nothing"), ("high", "returned 'high'"), (np.ma.masked_equal([1.0], 1.0), "returned an array with 1 masked"),
                                         (np.zeros((2, 2)), "returned array"), (10**400, "returned 1000")])
def test_an_observable_returns_numbers(seen, words):
    made = simulation()
    made.observe(lambda s: seen, "order")
    with pytest.raises(gridlock.Error, match=f"the observable order {words}"):
        made.run(steps=1)


def test_an_observation_that_writes_into_the_world_is_refused_in_words_of_the_model():
    def into_field(self, world):
        world.g[0, 0] = 7
        return {"mass": 1.0}

    def into_column(self, world):
        world.x += 0.5
        return {"mass": 1.0}

    def wrong(self, world):
        raise ValueError("no such order")

    for observe, words in ((into_field, r"observe\(\) of the model test_refusals cannot change the world: .*\n  hint: do it in step\(\)"),
                           (into_column, r"cannot change the world|an observation cannot change x"), (wrong, "no such order")):
        with pytest.raises((gridlock.Error, gridlock.RunFailure, ValueError), match=words):
            simulation(fields={"g": gridlock.Field(4)}, observe=observe).run(steps=1)


def test_no_array_of_an_observation_can_be_made_writable():
    refusals = []

    def observe(self, world):
        for array in (world.mass, world["kind"], world.x, world.ids):
            with pytest.raises(ValueError):
                array.setflags(write=True)
            refusals.append(array.flags.writeable)
        return {"mass": world.mass.sum()}

    made = simulation(observe=observe)
    made.run(steps=3)
    assert len(refusals) >= 16 and not any(refusals)


def test_edges_that_cannot_be_counted_end_the_run():
    for name in ("image_x", "image_y"):
        for image, way in ((2**31 - 1, 0.4), (-(2**31), -0.4)):
            made = simulation(columns={"image_x": np.int32, "image_y": np.int32},
                              start=lambda self, start: start.add(x=0.75, y=0.3, **{name: image}),
                              step=lambda self, world: world.move(np.full((1, 2), way)))
            with pytest.raises(gridlock.RunFailure, match=f"an agent crosses more edges than the column {name} can count"):
                made.run(steps=10)
            assert made.agents[name].tolist() == [image]


def test_a_time_beyond_all_numbers_ends_the_run():
    made = simulation(time_step=1e308)
    with pytest.raises(gridlock.RunFailure, match=r"step 2: the time is beyond all numbers, with a time step of 1e\+?308"):
        made.run(steps=5)


def test_a_class_has_either_a_step_or_turns():
    turn = staticmethod(lambda row, neighbors, separations, now, next, settings, random, events: None)
    with pytest.raises(gridlock.Error, match="has both step and turn"):
        gridlock.register_model(model(turn=turn, cutoff=0.1))
    steps = model()
    with pytest.raises(gridlock.Error, match="has both step and turn"):
        gridlock.register_model(type("Turns", (steps,), {"turn": turn, "cutoff": 0.1}))
    turns = type("Turns", (gridlock.Model,), {"name": "test_refusals", "start": steps.start, "turn": turn, "cutoff": 0.1})
    # A step that takes the turns and does more.
    gridlock.register_model(type("More", (turns,), {"step": lambda self, world: gridlock.Model.step(self, world)}))


def test_no_model_takes_the_name_of_a_table():
    own = {kind.name for kind in registered_models()}
    tables = {re.split(r"[.\[]", key)[0] for key in _core.setting_keys()} - own
    assert tables >= {"box", "disks", "protocol", "soft", "flocking"}
    for name in [*tables, "sweep"]:
        with pytest.raises(gridlock.Error, match=f"a model is called {name}, as a table of the settings is|there is a model {name} already"):
            gridlock.register_model(model(name=name))
    assert len(gridlock.Simulation(disks={"count": 4, "packing_fraction": 0.1}, protocol=[{"stage": "grow", "until_packing_fraction": 0.2}]).agents) == 4


@pytest.mark.parametrize("given, hint", [({"engine": "exact"}, 'engine={"kind": "exact"}'), ({"box": "periodic"}, 'box={"edge": "periodic"}'),
                                         ({"disks": 100}, 'disks={"count": …}')])
def test_a_word_in_the_place_of_a_table_is_refused_with_what_to_write_in_python(given, hint):
    with pytest.raises(gridlock.Error, match=re.escape(f"must be a table\n  hint: write {hint}")):
        gridlock.Simulation(**given)


@pytest.mark.parametrize("wrong", [{"default": 2**64}, {"default": 10**400}, {"default": 1, "most": 10**400}, {"default": 1.0, "least": "low"}])
def test_settings_beyond_all_numbers_are_refused(wrong):
    with pytest.raises(gridlock.Error, match="a setting has the"):
        gridlock.Setting(**wrong)


@pytest.mark.parametrize("name", ["a" * 101, 3, "", ["a"] * 2])
def test_names_of_values_are_short_texts(name):
    with pytest.raises(gridlock.Error, match="of the column kind"):
        gridlock.register_model(model(value_names={"kind": ["well", name]}))
    with pytest.raises(gridlock.Error, match="65 values of the column kind"):
        gridlock.register_model(model(value_names={"kind": ["well"] * 65}))


def test_numbers_that_are_none_are_refused_in_a_start_in_arrays_and_in_columns_of_a_kind():
    with pytest.raises(gridlock.Error, match="column mass: agent 0 of the new ones has the value nan"):
        simulation(start=lambda self, start: start.add(x=0.5, y=0.5, mass=np.nan))
    made = simulation()
    made.agents.mass[1] = np.inf
    with pytest.raises(gridlock.Error, match=f"agent {made.agents.ids[1]} has the value inf in the column mass"):
        made.run(steps=1)

    def start(self, start):
        start.wolf.add(x=[0.1, 0.2], y=0.5)
        start.sheep.add(x=[0.3, 0.4], y=0.5)

    flock = simulation(columns={}, kinds={"wolf": {}, "sheep": {"wool": float}}, start=start,
                       step=lambda self, world: world.sheep.wool.__setitem__(1, np.nan))
    with pytest.raises(gridlock.RunFailure, match="step 0: agent 3 has the value nan in the column wool"):
        flock.run(steps=1)


@pytest.mark.parametrize("name", ["id", "position", "pos", "velo", "image"])
def test_no_column_is_called_as_files_call_something_else(name):
    with pytest.raises(gridlock.Error, match=f"has a column '{name}'\n  hint: choose another name"):
        gridlock.register_model(model(columns={name: float}))


STEPS = {
    "positions outside": (lambda world: world.x.__setitem__(0, 7.0), "outside the box"),
    "not a number": (lambda world: world.y.__setitem__(0, np.nan), "outside the box"),
    "long displacements": (lambda world: world.move(np.full((len(world), 2), 3.0)), "displacement"),
    "infinite displacements": (lambda world: world.move(np.full((len(world), 2), np.inf)), "displacement"),
    "shape of displacements": (lambda world: world.move(np.zeros(len(world))), "shape"),
    "text displacements": (lambda world: world.move([["a", "b"]] * len(world)), "no array of numbers"),
    "birth outside": (lambda world: world.add(x=1.6, y=0.5), "newborn"),
    "birth without a place": (lambda world: world.add(age=1), "no place"),
    "birth with another column": (lambda world: world.add(x=0.5, y=0.5, size=3), "size"),
    "birth of many lengths": (lambda world: world.add(x=[0.1, 0.2, 0.3], y=[0.5, 0.1]), r"column y: .* shape \(2,\)"),
    "birth with no number": (lambda world: world.add(x=[0.5, 0.5], y=0.5, health=[0.5, np.inf]), "health: agent 1 of the new ones has the value inf"),
    "a column of no number": (lambda world: world.health.__setitem__(world.ids == 7, np.nan), "step 0: agent 7 has the value nan in the column health"),
    "an infinite column": (lambda world: setattr(world, "health", -np.inf), "has the value -inf in the column health"),
    "birth of another type": (lambda world: world.add(x=0.5, y=0.5, age="old"), "column age: 'old' is no number"),
    "birth with a fraction of age": (lambda world: world.add(x=0.5, y=0.5, age=0.5), "column age: 0.5 is no whole number"),
    "death of nobody": (lambda world: world.remove([99]), "no agent in row 99"),
    "death below": (lambda world: world.remove([-1]), "mask or by rows"),
    "death by another mask": (lambda world: world.remove(np.zeros(3, dtype=bool)), "mask"),
    "death by fractions": (lambda world: world.remove([0.5]), "mask or by rows"),
    "unknown event": (lambda world: world.count("meetings"), "no event 'meetings'"),
    "events of the past": (lambda world: world.count("births", -1), "whole number"),
    "long cutoff": (lambda world: world.neighbors(0.7), "cutoff"),
    "no cutoff": (lambda world: world.neighbors(float("nan")), "cutoff"),
    "column that is not there": (lambda world: world.size, "no column 'size'"),
    "assigned column that is not there": (lambda world: setattr(world, "size", 3), "no column 'size'"),
    "purpose below": (lambda world: world.uniform(purpose=-1), "purpose"),
    "complex displacements": (lambda world: world.move(np.zeros((len(world), 2), dtype=complex)), "complex"),
    "shape of a column": (lambda world: setattr(world, "age", np.zeros(3)), "age: the values have shape"),
}


@pytest.mark.parametrize("what", STEPS)
def test_mistakes_of_a_step_are_failures_with_reasons(what):
    act, words = STEPS[what]

    class Mistaken(gridlock.Model):
        name = "test_mistaken"
        columns = {"age": np.uint32, "health": float}
        events = ("births",)

        def start(self, start):
            start.add(positions=start.anywhere(10))

        def step(self, world):
            act(world)

    simulation = gridlock.Simulation(model=Mistaken, box=OBLONG)
    before = simulation.state_hash
    with pytest.raises(gridlock.RunFailure, match=words):
        simulation.run(steps=1)
    assert simulation.state_hash == before
    assert simulation.clock.step == 0


REFUSED = {
    "no name": ({"name": ""}, "has the name"),
    "a shipped model": ({"name": "flocking"}, "there is a model flocking already"),
    "no start": ({"start": gridlock.Model.start}, "no start"),
    "no step": ({"step": gridlock.Model.step}, "no step"),
    "a type": ({"columns": {"age": np.float32}}, "type float32"),
    "a column of the world": ({"columns": {"ids": float}}, "column 'ids'"),
    "a column that is a word": ({"columns": {"class": float}}, "column 'class'"),
    "a column of another type": ({"columns": {"velocity_x": np.int32}}, "observables take it for float64"),
    "an event that is a column": ({"events": ("step",)}, "events"),
    "events twice": ({"events": ("a", "a")}, "events"),
    "values of nothing": ({"value_names": {"state": ("a", "b")}}, "names the values"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_models_that_cannot_be_are_refused(what):
    changes, words = REFUSED[what]
    body = {"name": "test_refused", "start": lambda self, start: None, "step": lambda self, world: None, **changes}
    with pytest.raises(gridlock.Error, match=words):
        gridlock.register_model(type("Refused", (gridlock.Model,), body))


def test_starts_that_cannot_be_are_refused():
    def simulation(start, **more):
        body = {"name": "test_start", "start": start, "step": lambda self, world: None, **more}
        return gridlock.Simulation(model=type("Starts", (gridlock.Model,), body))

    with pytest.raises(gridlock.Error, match="outside the box"):
        simulation(lambda self, start: start.add(x=3.0, y=0.5))
    with pytest.raises(gridlock.Error, match="time step 0.0"):
        simulation(lambda self, start: start.add(x=0.5, y=0.5), time_step=0.0)
    with pytest.raises(ZeroDivisionError):
        simulation(lambda self, start: 1 / 0)

    def refuses(self, box):
        raise gridlock.Error("the box is too small\n  hint: use a larger one")

    with pytest.raises(gridlock.Error, match="test_start.*\n?.*the box is too small|the box is too small") as caught:
        simulation(lambda self, start: start.add(x=0.5, y=0.5), check=refuses)
    assert caught.value.problems[0]["hint"] == "use a larger one"
    with pytest.warns(UserWarning, match="the start of the model test_start has no agents"):
        nobody = simulation(lambda self, start: None)
    nobody.run(steps=40)
    assert len(nobody.agents) == 0


@pytest.mark.parametrize("wrong", [{"default": 5.0, "least": 10.0}, {"default": float("nan")}, {"default": None}, {"default": ["a"]}, {"default": -1},
                                   {"default": "a", "choices": ["b"]}])
def test_settings_that_cannot_be_are_refused(wrong):
    with pytest.raises(gridlock.Error, match="default"):
        gridlock.Setting(**wrong)


@pytest.mark.parametrize("seen, words", [(0.5, "returned float"), ({"step": 1.0}, "name 'step'"), ({"a b": 1.0}, "name 'a b'")])
def test_observations_that_cannot_be_are_refused(seen, words):
    body = {"name": "test_observes", "start": lambda self, start: start.add(x=0.5, y=0.5), "step": lambda self, world: None,
            "observe": lambda self, world: seen}
    with pytest.raises(gridlock.Error, match=words):
        gridlock.Simulation(model=type("Observes", (gridlock.Model,), body))
