"""Fields of models in Python: what agents read, leave and take, how fields spread, and where they are kept."""

import numpy as np
import pytest

import gridlock
import gridlock.plot

PERIODIC = {"width": 2.0, "height": 1.0, "edge": "periodic"}


@gridlock.register_model
class Grazers(gridlock.Model):
    """Walkers that eat grass and leave a scent."""

    name = "test_grazers"
    columns = {"food": float}
    fields = {"scent": gridlock.Field((8, 16)), "grass": gridlock.Field("cells", "What there is to eat.")}
    count = gridlock.Setting(300, "Agents.", least=1)
    cells = gridlock.Setting(40, "Columns of the grass.", least=1)
    growth = gridlock.Setting(0.001, "Of grass in a step.", least=0.0)

    def start(self, start):
        start.add(positions=start.anywhere(self.count))
        start.grass = 0.3
        start.grass[0, :] = 5.0

    def step(self, world):
        world.food += world.take("grass", 0.02)
        world.deposit("scent", world.uniform())
        world.spread("scent", diffusion=1e-3, decay=0.1)
        world.grass += self.growth
        world.move(0.02 * world.normal(2, purpose=1))

    def observe(self, world):
        return {"grass": world.grass.mean(), "scent_here": world.at("scent").mean()}


def grazers(**settings):
    return gridlock.Simulation(model=Grazers, box=PERIODIC, observe={"every": 5}, **settings)


class Field(gridlock.Model):
    """One field, and what a test lets its step do."""

    name = "test_field"
    columns = {"got": float}
    fields = {"grass": gridlock.Field(4)}

    def start(self, start):
        start.add(x=[0.1, 0.1, 1.9], y=[0.1, 0.1, 0.9])


def simulation(step, start=None, box=PERIODIC, **body):
    usual = {"step": lambda self, world: step(world)}
    if start is not None:
        usual["start"] = lambda self, given: start(given)
    return gridlock.Simulation(model=type("OneField", (Field,), {**usual, **body}), box=box)


def after(step, **others):
    made = simulation(step, **others)
    made.run(steps=1)
    return made


def test_a_field_has_cells_as_square_as_they_can_be_with_row_0_at_the_bottom():
    def step(world):
        assert world.grass.shape == (2, 4)
        rows, columns = world.cells("grass")
        assert rows.tolist() == [0, 0, 1] and columns.tolist() == [0, 0, 3]
        world.grass[rows, columns] = 7.0

    frame = after(step).frame
    assert frame.fields["grass"].tolist() == [[7.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 7.0]]


def test_agents_deposit_into_their_cells_and_read_them():
    def step(world):
        world.deposit("grass", [1.0, 2.0, 4.0])
        world.got = world.at("grass")
        assert world.at("grass", [[0.3, 0.3], [2.1, -0.9], [1.0, 0.0]]).tolist() == [3.0, 3.0, 0.0]

    assert after(step).agents.got.tolist() == [3.0, 3.0, 4.0]


def test_agents_take_no_more_than_there_is():
    def step(world):
        world.grass[...] = 1.0
        world.got = world.take("grass", [0.75, 0.75, 0.5])

    made = after(step)
    got = made.agents.got.tolist()
    assert sorted(got) == [0.25, 0.5, 0.75] and got[2] == 0.5
    assert made.frame.fields["grass"][0, 0] == 0.0 and made.frame.fields["grass"][1, 3] == 0.5


def test_who_takes_first_is_drawn_anew_in_each_step():
    firsts = []

    def step(world):
        world.grass[...] = 1.0
        firsts.append(int(np.argmax(world.take("grass", 1.0)[np.argsort(world.ids)][:2])))

    simulation(step).run(steps=200)
    assert 60 < sum(firsts) < 140  # 5.6 standard deviations


def test_a_field_spreads_by_the_exact_solution():
    cells = np.arange(64)

    def start(given):
        given.wave[...] = np.cos(2 * np.pi * 3 * cells / 64)

    made = simulation(lambda world: world.spread("wave", diffusion=0.02, decay=0.5), start, fields={"wave": gridlock.Field((32, 64))}, time_step=0.25)
    made.run(steps=4)
    rate = 2 * 0.02 / (2.0 / 64) ** 2 * (1 - np.cos(2 * np.pi * 3 / 64)) + 0.5
    np.testing.assert_allclose(made.frame.fields["wave"], np.exp(-rate) * np.cos(2 * np.pi * 3 * cells / 64) * np.ones((32, 1)), atol=1e-14)


def test_fields_give_the_same_bits_on_any_threads_and_count_in_the_hash():
    runs = [grazers(engine={"threads": threads}) for threads in (1, 2, 5)]
    for run in runs:
        run.run(steps=40)
    assert len({run.state_hash for run in runs}) == 1
    other = grazers(test_grazers={"growth": 0.0011})
    other.run(steps=40)
    assert other.state_hash != runs[0].state_hash


def test_a_run_keeps_its_fields_and_goes_on_with_the_same_bits(tmp_path):
    settings = {"model.kind": "test_grazers", "box": PERIODIC, "observe.every": 10, "trajectory.every": 25}
    gridlock.run({**settings, "run.steps": 100}, tmp_path / "whole")
    gridlock.run({**settings, "run.steps": 60}, tmp_path / "parts")
    parts = gridlock.open(tmp_path / "parts")
    parts.resume(steps=100)
    whole = gridlock.open(tmp_path / "whole")
    assert whole.summary["state_hash"] == gridlock.open(tmp_path / "parts").summary["state_hash"]
    assert whole.series["grass"][-1] == whole.final.fields["grass"].mean()
    assert list(whole.final.fields) == ["grass", "scent"]
    for name, values in whole.final.fields.items():
        assert (values == whole.trajectory[-1].fields[name]).all()
    assert (whole.trajectory[1].fields["scent"] != whole.trajectory[2].fields["scent"]).any()
    assert whole.trajectory[0].fields["grass"][1, 0] == 0.3
    assert gridlock.verify(whole.path).is_verified
    (parts.path / "final_fields.h5").replace(whole.path / "final_fields.h5")
    assert gridlock.verify(whole.path).is_verified


def test_verify_finds_another_value_in_the_last_fields(tmp_path):
    settings = {"model.kind": "test_grazers", "box": PERIODIC, "run.steps": 20}
    for name, growth in (("one", 0.001), ("other", 0.002)):
        gridlock.run({**settings, "test_grazers.growth": growth}, tmp_path / name)
    (tmp_path / "other/final_fields.h5").replace(tmp_path / "one/final_fields.h5")
    found = gridlock.verify(tmp_path / "one")
    assert not found.is_verified and "final_fields.h5 has grass = " in found.text
    (tmp_path / "one/final_fields.h5").write_bytes(b"")
    with pytest.raises(gridlock.Error, match="final_fields.h5: it is empty\n.*\n  hint: put back a copy of the file"):
        gridlock.verify(tmp_path / "one")


def test_an_automaton_needs_no_agents():
    def step(world):
        world.grass[...] = np.roll(world.grass, 1, axis=1)

    def start(given):
        given.grass[0, 3] = 1.0

    made = simulation(step, start)
    made.run(steps=2)
    assert made.frame.fields["grass"].tolist() == [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]


def test_a_step_that_raises_leaves_fields_as_they_were():
    def step(world):
        world.grass += 1.0
        world.deposit("grass", 1.0)
        if world.clock.step == 2:
            raise ValueError("enough")

    made = simulation(step)
    with pytest.raises(gridlock.RunFailure, match="step 2: .*enough"):
        made.run(steps=5)
    assert made.frame.fields["grass"].sum() == 2 * (8 + 3)


def test_a_step_that_raises_restores_fields_that_only_some_steps_change():
    def step(world):
        if world.clock.step != 1:
            world.grass += 1.0
        if world.clock.step > 1:
            world.wave[...] = 7.0
        if world.clock.step == 3:
            world.add(x=5.0, y=0.5)

    made = simulation(step, fields={"grass": gridlock.Field((2, 4)), "wave": gridlock.Field(3)})
    with pytest.raises(gridlock.RunFailure, match="step 3: .*newborn"):
        made.run(steps=9)
    assert made.clock.step == 3 and (made.frame.fields["grass"] == 2.0).all() and (made.frame.fields["wave"] == 7.0).all()
    with pytest.raises(gridlock.RunFailure, match="step 3: .*newborn"):
        made.run(steps=9)
    assert (made.frame.fields["grass"] == 2.0).all()


def test_arrays_that_are_kept_do_not_change_the_fields():
    kept = []

    def step(world):
        kept.append(world.grass)
        world.deposit("grass", 1.0)

    made = simulation(step)
    made.run(steps=3)
    assert [int(array.sum()) for array in kept] == [3, 6, 9]
    with pytest.raises(ValueError, match="read-only"):
        kept[0][0, 0] = 1.0


REFUSED = {
    "a name that is none": (lambda world: world.take("gras", 1.0), "the model has no field gras (test_fields.py, line"),
    "amounts of another length": (lambda world: world.deposit("grass", [1.0, 2.0]), "there are 2 amounts for 3 agents"),
    "amounts that are no numbers": (lambda world: world.deposit("grass", [1.0, np.nan, 1.0]), "the amounts have the value nan"),
    "to take less than nothing": (lambda world: world.take("grass", [0.0, -1.0, 0.0]), "the agent of row 1 is to take -1"),
    "a diffusion below 0": (lambda world: world.spread("grass", diffusion=-1.0), "the diffusion of the field grass is -1.0"),
    "a decay without end": (lambda world: world.spread("grass", decay=np.inf), "the decay of the field grass is inf"),
    "an overflow": (lambda world: world.deposit("grass", [1e308, 1e308, 0.0]), "the field grass has the value inf in row 0, column 0"),
    "no number": (lambda world: world.grass.__setitem__((1, 2), np.nan), "the field grass has the value nan in row 1, column 2"),
    "another shape": (lambda world: setattr(world, "grass", np.zeros((3, 3))), "grass: the values have shape (3, 3)"),
    "another attribute": (lambda world: world.hay, "there is no column 'hay'; there are x, y, got, grass"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_step_is_told_what_is_wrong_with(case):
    step, words = REFUSED[case]
    with pytest.raises(gridlock.RunFailure) as failure:
        after(step)
    assert words in str(failure.value)


def test_places_beyond_a_wall_have_no_cell():
    with pytest.raises(gridlock.RunFailure, match=r"point 0 is at \(2.5, 0.5\), outside the box of 2 × 1"):
        after(lambda world: world.at("grass", [[2.5, 0.5]]), box={"width": 2.0, "height": 1.0, "edge": "wall"})


WRONG = {
    "no cells": (lambda: gridlock.Field(0), "the number of cells of a field is 0"),
    "half a cell": (lambda: gridlock.Field(0.5), "the number of cells of a field is 0.5"),
    "a single number in brackets": (lambda: gridlock.Field((4,)), "a field has the cells (4,)"),
    "a start of another shape": (lambda: simulation(None, lambda start: setattr(start, "grass", np.zeros((3, 3)))), "grass: the values have shape (3, 3)"),
    "three numbers": (lambda: gridlock.Field((1, 2, 3)), "a field has the cells"),
    "no field": (lambda: simulation(None, fields={"grass": 4}), "the field grass of the model OneField is 4"),
    "the name of a column": (lambda: simulation(None, fields={"got": gridlock.Field(4)}), "has a field 'got'"),
    "the name of a method": (lambda: simulation(None, fields={"move": gridlock.Field(4)}), "has a field 'move'"),
    "a setting that is none": (lambda: simulation(None, fields={"grass": gridlock.Field("side")}), "as many cells as the setting 'side'"),
    "beyond memory": (lambda: simulation(None, fields={"grass": gridlock.Field((10**6, 10**6))}), "the field grass of 1000000 × 1000000 cells"),
    "a start of nan": (lambda: simulation(None, lambda start: start.grass.fill(np.nan)), "the field grass has the value nan"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_model_is_refused_for(case):
    make, words = WRONG[case]
    with pytest.raises((gridlock.Error, gridlock.RunFailure)) as error:
        make()
    assert words in str(error.value)


def test_a_number_of_the_world_is_a_field_of_one_cell_which_is_not_drawn():
    def step(world):
        world.price[...] += 1.5 * len(world)

    made = simulation(step, fields={"price": gridlock.Field((1, 1)), "rain": gridlock.Field(3)})
    made.run(steps=2)
    assert made.frame.fields["price"].item() == 9.0
    assert gridlock.plot.snapshot(made).get_images()[0].get_array().shape == (2, 3)


def test_a_snapshot_has_the_field_beneath_the_agents():
    made = grazers()
    made.run(steps=5)
    axes = gridlock.plot.snapshot(made)
    (image,) = axes.get_images()
    assert (image.get_array() == made.frame.fields["grass"]).all() and image.get_extent() == [0.0, 2.0, 0.0, 1.0]
    assert gridlock.plot.snapshot(made, field="scent").get_images()[0].get_array().shape == (8, 16)
    assert not gridlock.plot.snapshot(made, field="").get_images()
    with pytest.raises(gridlock.Error, match="no field 'hay' to draw"):
        gridlock.plot.snapshot(made, field="hay")
