"""Models in Python in directories: continued, killed and resumed, swept on threads and processes, with the same bits."""

import concurrent.futures
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import gridlock
from walkers import SETTINGS


def test_a_run_in_a_directory_is_continued_with_the_same_bits(tmp_path):
    settings = {**SETTINGS, "trajectory.every": 10, "run.steps": 40}
    gridlock.run(settings, tmp_path / "short")
    gridlock.open(tmp_path / "short").resume(steps=100)
    gridlock.run({**settings, "run.steps": 100}, tmp_path / "long")
    short, long = gridlock.open(tmp_path / "short"), gridlock.open(tmp_path / "long")
    assert short.state_hash == long.state_hash
    assert short.final.columns.keys() == {"x", "y", "age", "charge", "mark"}
    assert np.array_equal(short.series["mean_age"], long.series["mean_age"])
    frames = [long.trajectory[k] for k in range(len(long.trajectory))]
    assert [frame.clock.step for frame in frames] == list(range(0, 101, 10))
    assert frames[3].age.dtype == np.uint32
    assert np.array_equal(frames[-1].ids, long.final.ids) and np.array_equal(frames[-1].x, long.final.x)
    in_memory = gridlock.Simulation(SETTINGS)
    in_memory.run(steps=100)
    assert in_memory.state_hash == long.state_hash


def test_a_killed_run_is_resumed_with_the_same_bits(tmp_path):
    script = tmp_path / "model.py"
    script.write_text(textwrap.dedent("""
        import os, signal, sys
        import gridlock

        @gridlock.register_model
        class Killed(gridlock.Model):
            name = "killed"
            def start(self, start):
                start.add(positions=start.anywhere(100))
            def step(self, world):
                if sys.argv[2] == "kill" and world.clock.step == 57:
                    os.kill(os.getpid(), signal.SIGKILL)
                world.move(0.01 * world.uniform(2))

        directory = sys.argv[1]
        settings = {"model.kind": "killed", "run.steps": 100, "box": {"edge": "periodic", "width": 1.5, "height": 0.6},
                    "checkpoint.every_steps": 10, "observe.every": 10}
        if sys.argv[2] == "resume":
            gridlock.open(directory).resume()
        else:
            gridlock.run(settings, directory)
    """))
    run = lambda directory, what: subprocess.run(  # noqa: E731
        [sys.executable, script, directory, what], env=os.environ, capture_output=True, text=True, timeout=120
    )
    assert run(tmp_path / "a", "kill").returncode == -signal.SIGKILL
    outcome = run(tmp_path / "a", "resume")
    assert outcome.returncode == 0, outcome.stderr
    assert run(tmp_path / "b", "run").returncode == 0
    assert gridlock.open(tmp_path / "a").state_hash == gridlock.open(tmp_path / "b").state_hash


def test_the_program_says_who_can_resume(tmp_path, program):
    gridlock.run({**SETTINGS, "run.steps": 20}, tmp_path / "run")
    outcome = subprocess.run([program, "resume", tmp_path / "run", "--steps", "10"], capture_output=True, text=True, timeout=60)
    assert outcome.returncode == 2
    assert 'there is no model "test_walkers"' in outcome.stderr and "gridlock.open(DIR).resume()" in outcome.stderr
    assert "own_model_python.md" in outcome.stderr


@pytest.mark.parametrize("workers", [None, 2])
def test_sweeps_run_models_on_threads_and_processes(tmp_path, workers):
    executor = None if workers is None else concurrent.futures.ProcessPoolExecutor(workers)
    made = gridlock.sweep(
        {**SETTINGS, "run.steps": 30}, {"test_walkers.length": [0.01, 0.02], "run.seed": [1, 2]}, tmp_path / "sweep", executor=executor
    )
    for row in made.table:
        alone = gridlock.Simulation({**SETTINGS, "test_walkers.length": row["test_walkers.length"], "run.seed": int(row["run.seed"])})
        alone.run(steps=30)
        assert row["state_hash"] == alone.state_hash
    assert "mean_age" in made.means.dtype.names
