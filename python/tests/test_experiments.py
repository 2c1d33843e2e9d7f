"""Experiments: many runs of one declaration, the time to an event, histograms over seeds, and which settings matter."""

import concurrent.futures
import math
import os
import time

import numpy as np
import pytest

import gridlock
import gridlock.library
from conftest import OBLONG


@gridlock.register_model
class Coins(gridlock.Model):
    """Agents that fall with a fixed chance in each step, and a number that three settings make."""

    name = "test_coins"
    columns = {"fallen": np.uint32}
    count = gridlock.Setting(1, "Agents.", least=1, most=50)
    chance = gridlock.Setting(0.2, "Of falling in a step.", least=0.0, most=1.0)
    x = gridlock.Setting(0.5, "Of Ishigami.", least=-math.pi, most=math.pi)
    y = gridlock.Setting(0.5, "Of Ishigami.", least=-math.pi, most=math.pi)
    z = gridlock.Setting(0.5, "Of Ishigami.", least=-math.pi, most=math.pi)
    free = gridlock.Setting(1.0, "Without bounds.")
    breaks_at = gridlock.Setting(1000, "A step.")

    def start(self, start):
        start.add(positions=start.anywhere(self.count))

    def step(self, world):
        if world.clock.step == self.breaks_at:
            raise ValueError("enough")
        world.fallen[world.uniform() < self.chance] = 1

    def observe(self, world):
        return {"standing": np.count_nonzero(world.fallen == 0), "ishigami": ishigami(self.x, self.y, self.z)}


def ishigami(x, y, z, a=7.0, b=0.1):
    return np.sin(x) + a * np.sin(y) ** 2 + b * z**4 * np.sin(x)


COINS = {"model.kind": "test_coins", "box": OBLONG, "observe.structure_every": 0}


def coin(**more):
    return gridlock.Simulation(COINS, **{"observe.every": 1, "test_coins.count": 6, **more})


def test_the_time_to_an_event_is_that_of_its_law():
    made = gridlock.experiment(COINS, {"test_coins.chance": [0.2, 0.5]}, steps=1000, seeds=150, until="standing == 0", processes=1)
    assert made.table["ended"].all() and made.means["test_coins.chance"].tolist() == [0.2, 0.5] and made.means["runs"].tolist() == [150, 150]
    for row, chance in zip(made.means, (0.2, 0.5)):
        # The step of the first success is geometric: mean 1/p, variance (1 − p)/p².
        error = math.sqrt((1 - chance) / 150) / chance
        assert abs(row["step"] - 1 / chance) < 3.5 * error and 0.7 < row["step_error"] / error < 1.4


def test_a_run_ends_at_the_first_step_at_which_a_condition_is_asked_and_holds():
    whole = coin()
    whole.run(steps=30)
    first = int(whole.series["step"][whole.series["standing"] == 0][0])
    assert first > 3
    made = coin()
    assert gridlock.run_until(made, "standing < 1", steps=30) == made.clock and made.clock.step == first
    made.run(steps=30 - first)
    assert made.state_hash == whole.state_hash
    assert gridlock.run_until(coin(), "standing == 0", steps=30, every=4).step == 4 * math.ceil(first / 4)
    assert gridlock.run_until(coin(), lambda one: one.clock.step >= 3, steps=30).step == 3
    assert gridlock.run_until(coin(), "standing == 0", steps=first - 1) is None
    assert gridlock.run_until(coin(), "standing == 6", steps=0).step == 0


def test_an_experiment_has_the_runs_of_its_values_and_seeds_on_any_number_of_processes():
    values = {"test_coins.count": [3, 8], "test_coins.chance": [0.1, 0.3]}
    made = [gridlock.experiment(COINS, values, steps=4, seeds=[5, 9], processes=processes) for processes in (1, 2)]
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        made.append(gridlock.experiment(COINS, values, steps=4, seeds=[5, 9], executor=executor))
    table = made[0].table
    assert table["test_coins.count"].tolist() == [3] * 4 + [8] * 4 and table["run.seed"].tolist() == [5, 9] * 4
    assert "ended" not in table.dtype.names and set(table["step"]) == {4}
    for other in made[1:]:
        assert other.table.dtype == table.dtype and all(np.array_equal(other.table[name], table[name]) for name in table.dtype.names)
    alone = coin(**{"test_coins.count": 8, "test_coins.chance": 0.1, "run.seed": 9})
    alone.run(steps=4)
    assert table[5]["standing"] == alone.series["standing"][-1]


def test_functions_of_a_prompt_measure_in_other_processes():
    mine = os.getpid()
    made = gridlock.experiment(COINS, [{"test_coins.count": 4}], steps=2, seeds=2, measure=lambda one: {"mine": os.getpid() == mine, "agents": len(one.agents)},
                               until=lambda one: one.clock.step == 1, processes=2)
    assert made.table["agents"].tolist() == [4, 4] and not made.table["mine"].any() and set(made.table["step"]) == {1}


def test_progress_is_told_and_a_table_can_be_a_frame():
    told = []
    made = gridlock.experiment(COINS, {"test_coins.chance": [0.0, 1.0]}, steps=1, seeds=2, processes=1, progress=lambda *done: told.append(done))
    assert told == [(1, 0.25), (2, 0.5), (3, 0.75), (4, 1.0)]
    assert made.means["standing"].tolist() == [1.0, 0.0] and made.means["standing_error"].tolist() == [0.0, 0.0]
    pytest.importorskip("pandas")
    assert made.frame().groupby("test_coins.chance")["standing"].mean().tolist() == [1.0, 0.0]


def test_a_histogram_counts_the_seeds_of_each_combination_in_common_bins():
    made = gridlock.experiment({**COINS, "test_coins.count": 20}, {"test_coins.chance": [0.2, 0.8]}, steps=1, seeds=30, processes=1)
    found = made.histogram("standing", [0, 5, 10, 15, 20.5])
    assert found.dtype.names == ("test_coins.chance", "low", "high", "runs") and found["low"].tolist() == [0, 5, 10, 15] * 2
    for part, chance in zip((found[:4], found[4:]), (0.2, 0.8)):
        standing = made.table["standing"][made.table["test_coins.chance"] == chance]
        assert part["runs"].tolist() == np.histogram(standing, [0, 5, 10, 15, 20.5])[0].tolist() and part["runs"].sum() == 30
    assert made.histogram("standing", 3)["runs"].sum() == 60


REFUSED = {
    "a condition without a number": (lambda: gridlock.run_until(coin(), "standing == none", steps=1), "'standing == none' is no condition"),
    "a condition of nothing": (lambda: gridlock.run_until(coin(), "standing = 1", steps=1), "'standing = 1' is no condition"),
    "a condition that is a number": (lambda: gridlock.run_until(coin(), 3, steps=1), "3 is no condition"),
    "a column that is none": (lambda: gridlock.run_until(coin(), "sitting == 1", steps=1), "asks for sitting, which the series does not have"),
    "steps below 0": (lambda: gridlock.run_until(coin(), "standing == 1", steps=-1), "steps is -1"),
    "a stride of 0": (lambda: gridlock.run_until(coin(), "standing == 9", steps=1, every=0), "every is 0"),
    "no list": (lambda: gridlock.experiment(COINS, {"test_coins.chance": 0.1}, steps=1), "test_coins.chance has no list of values"),
    "a seed twice": (lambda: gridlock.experiment(COINS, steps=1, seeds=[1, 1]), "the seeds are [1, 1]"),
    "no seeds": (lambda: gridlock.experiment(COINS, steps=1, seeds=0), "seeds is 0"),
    "seeds as values": (lambda: gridlock.experiment(COINS, {"run.seed": [1]}, steps=1), "run.seed is listed among the values"),
    "other keys": (lambda: gridlock.experiment(COINS, [{"test_coins.chance": 0.1}, {}], steps=1), "the combinations name different settings"),
    "a value out of bounds": (lambda: gridlock.experiment(COINS, {"test_coins.chance": [1.5]}, steps=1, seeds=2, processes=2),
                              "the run with test_coins.chance = 1.5, run.seed = 1: "),
    "measures without names": (lambda: gridlock.experiment(COINS, steps=1, seeds=1, measure=len, processes=1),
                              "the run with run.seed = 1: TypeError: object of type 'Simulation' has no len()"),
    "a measure of nothing": (lambda: gridlock.experiment(COINS, steps=1, seeds=1, measure=lambda one: None, processes=1), "measure returned NoneType"),
    "other measures": (lambda: gridlock.experiment(COINS, steps=1, seeds=2, measure=lambda one: {f"a{one.state_hash}": 1}, processes=1),
                       "the runs have measured different names"),
    "a histogram of nothing": (lambda: gridlock.experiment(COINS, steps=1, seeds=2, processes=1).histogram("sitting"), "has no column 'sitting'"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_an_experiment_is_refused_for(case):
    run, words = REFUSED[case]
    with pytest.raises((gridlock.Error, gridlock.RunFailure)) as error:
        run()
    assert words in str(error.value)


def test_a_run_that_breaks_is_named():
    with pytest.raises(gridlock.RunFailure) as failure:
        gridlock.experiment(COINS, {"test_coins.breaks_at": [1000, 3]}, steps=5, seeds=2, processes=2)
    assert "the run with test_coins.breaks_at = 3, run.seed = 1: step 3: the model test_coins raised ValueError: enough" in str(failure.value)


def test_sobol_indices_are_those_of_the_function_of_ishigami():
    pytest.importorskip("SALib")
    design = gridlock.SobolDesign(["test_coins.x", "test_coins.y", "test_coins.z"], samples=2048)
    points = np.array([list(point.values()) for point in design.points])
    assert points.shape == (2048 * 5, 3) and points.min() >= -math.pi and points.max() <= math.pi
    found = design.indices(ishigami(*points.T))
    # Ishigami & Homma 1990, doi:10.1109/ISUMA.1990.151285, with a = 7 and b = 0.1.
    of_x, of_y, of_xz = 0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2, 7.0**2 / 8, 0.1**2 * math.pi**8 * (1 / 18 - 1 / 50)
    exact = {"first": np.array([of_x, of_y, 0.0]), "total": np.array([of_x + of_xz, of_y, of_xz])}
    assert found["setting"].tolist() == list(design.bounds)
    for name, shares in exact.items():
        assert 0 < found[f"{name}_error"].max() < 0.04
        assert np.all(np.abs(found[name] - shares / (of_x + of_y + of_xz)) < 3.5 * found[f"{name}_error"])


def test_an_experiment_runs_the_points_of_a_design():
    pytest.importorskip("SALib")
    design = gridlock.SobolDesign({"test_coins.x": (-1.0, 1.0), "test_coins.count": (2, 5)}, samples=8)
    assert {type(point["test_coins.count"]) for point in design.points} == {int}
    assert {point["test_coins.count"] for point in design.points} == {2, 3, 4, 5}
    made = gridlock.experiment(COINS, design.points, steps=0, seeds=1, processes=1)
    assert len(made.means) == len(design.points) == 32
    values = [ishigami(point["test_coins.x"], 0.5, 0.5) for point in design.points]
    assert np.allclose(made.means["ishigami"], values, rtol=1e-12)
    found = design.indices(made.means["ishigami"])
    assert found["total"][1] == 0.0 and found["total"][0] > 0.5


@pytest.mark.parametrize("processes", [1, 2])
def test_ctrl_c_ends_an_experiment_at_once_and_leaves_the_table_of_what_is_done(processes):
    def stop(done, fraction):
        if done == 2:  # while two runs without end go on in other processes
            raise KeyboardInterrupt

    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt, match="2 of 4 runs of the experiment are done") as stopped:
        gridlock.experiment(COINS, {"test_coins.chance": [1.0, 0.0]}, steps=10**9, seeds=2, until="standing == 0",
                            processes=processes, progress=stop)
    found = stopped.value.experiment
    assert time.monotonic() - began < 10 and found.table["run.seed"].tolist() == [1, 2] and found.means["runs"].tolist() == [2]


WRONG = {
    "no settings": (lambda: gridlock.SobolDesign({}), "there are no settings to vary"),
    "a setting without bounds": (lambda: gridlock.SobolDesign(["test_coins.free"]), "test_coins.free has no bounds to take samples from"),
    "a setting of nobody": (lambda: gridlock.SobolDesign(["disks.count"]), "disks.count has no bounds to take samples from"),
    "one bound": (lambda: gridlock.SobolDesign({"a.b": (1.0,)}), "the bounds of a.b are (1.0,)"),
    "bounds the wrong way": (lambda: gridlock.SobolDesign({"a.b": (1.0, 0.5)}), "the bounds of a.b are 1 and 0.5"),
    "no power of 2": (lambda: gridlock.SobolDesign({"a.b": (0.0, 1.0)}, samples=100), "samples is 100"),
    "no bins": (lambda: gridlock.experiment(COINS, steps=0, seeds=1, processes=1).histogram("standing", 0), "bins is 0"),
    "falling edges": (lambda: gridlock.experiment(COINS, steps=0, seeds=1, processes=1).histogram("standing", [2, 1]), "bins is [2, 1]"),
    "other values": (lambda: gridlock.SobolDesign({"a.b": (0.0, 1.0)}, samples=2).indices([1.0]), "the values have shape (1,)"),
    "equal values": (lambda: gridlock.SobolDesign({"a.b": (0.0, 1.0)}, samples=2).indices(np.ones(6)), "all values are 1"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_design_is_refused_for(case):
    pytest.importorskip("SALib")
    make, words = WRONG[case]
    with pytest.raises(gridlock.Error) as error:
        make()
    assert words in str(error.value)
