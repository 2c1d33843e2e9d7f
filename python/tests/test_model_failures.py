"""How runs of models in Python end that break or are interrupted: with a cause, a whole state and a record."""

import signal

import numpy as np
import pytest

import gridlock
from conftest import OBLONG


def test_an_exception_is_the_cause_of_the_failure_and_the_state_is_whole():
    class Raises(gridlock.Model):
        name = "test_raises"
        columns = {"age": float}

        def start(self, start):
            start.add(x=[0.5, 0.2], y=0.5)

        def step(self, world):
            world.age += 1
            world.positions += 0.01
            if world.clock.step == 3:
                raise KeyError("nothing")

    simulation = gridlock.Simulation(model=Raises, box=OBLONG)
    words = r"step 3: the model test_raises raised KeyError: 'nothing' \(test_model_failures.py, line \d+\)"
    with pytest.raises(gridlock.RunFailure, match=words) as caught:
        simulation.run(steps=10)
    assert isinstance(caught.value.__cause__, KeyError)
    assert simulation.clock.step == 3
    assert set(simulation.agents.age) == {3.0}
    assert np.allclose(np.sort(simulation.agents.x), [0.23, 0.53])


def test_a_failure_is_recorded_in_the_directory(tmp_path):
    class Fails(gridlock.Model):
        name = "test_fails"

        def start(self, start):
            start.add(x=0.5, y=0.5)

        def step(self, world):
            raise ValueError("no")

    gridlock.register_model(Fails)
    with pytest.raises(gridlock.RunFailure, match="ValueError: no"):
        gridlock.run({"model.kind": "test_fails", "run.steps": 5}, tmp_path / "run")
    assert gridlock.open(tmp_path / "run").summary["status"] == "failed"
    with pytest.raises(gridlock.RunFailure, match="2 runs failed"):
        gridlock.sweep({"model.kind": "test_fails", "run.steps": 5}, {"run.seed": [1, 2]}, tmp_path / "sweep")


def test_ctrl_c_within_a_step_is_heard_after_it():
    class Interrupted(gridlock.Model):
        name = "test_interrupted"
        columns = {"age": float}

        def start(self, start):
            start.add(x=[0.5, 0.2], y=0.5)

        def step(self, world):
            world.age += 1
            if world.clock.step == 5 and not heard:
                heard.append(1)
                signal.raise_signal(signal.SIGINT)

    heard = []
    simulation = gridlock.Simulation(model=Interrupted, box=OBLONG)
    with pytest.raises(KeyboardInterrupt):
        simulation.run(steps=5_000_000)
    assert 6 <= simulation.clock.step < 5_000_000
    assert set(simulation.agents.age) == {simulation.clock.step}
    simulation.run(steps=2)


def test_a_step_that_raises_ctrl_c_by_itself_ends_the_run():
    class Raises(gridlock.Model):
        name = "test_raises_ctrl_c"
        columns = {"age": float}

        def start(self, start):
            start.add(x=0.5, y=0.5)

        def step(self, world):
            world.age += 1
            if world.clock.step == 2:
                raise KeyboardInterrupt

    simulation = gridlock.Simulation(model=Raises)
    with pytest.raises(KeyboardInterrupt):
        simulation.run(steps=5)
    assert simulation.clock.step == 2 and simulation.agents.age[0] == 2.0
