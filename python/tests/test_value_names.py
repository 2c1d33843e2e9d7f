"""What a model calls the numbers of a column goes with its files: pictures of them need no model."""

import json
import subprocess

import numpy as np
import pytest

import gridlock
from conftest import OBLONG

NAMES = ["well", "ill", "value"]


@gridlock.register_model
class Ward(gridlock.Model):
    """Some of whom are ill."""

    name = "test_ward"
    columns = {"health": np.uint32, "value": np.uint32, "bed": np.uint32}
    value_names = {"health": NAMES, "value": ("small",)}

    def start(self, start):
        start.add(positions=start.anywhere(30), health=np.arange(30) % 3)

    def step(self, world):
        world.move(0.01 * world.normal(2))

    def observe(self, world):
        return {"ill": np.mean(world.health == 1)}


@pytest.fixture
def run(tmp_path):
    gridlock.run({"model.kind": "test_ward", "box": OBLONG, "run.steps": 20, "trajectory.every": 10}, tmp_path / "run")
    return gridlock.open(tmp_path / "run")


def test_names_of_values_are_in_the_trajectory_and_in_the_summary(run):
    assert run.summary["value_names"] == {"health": NAMES, "value": ["small"]}
    assert list(run.results)[:2] == ["agents", "ill"] and "value_names" not in run.results
    for frame in (run.trajectory[0], run.trajectory[1:][-1], run.final):
        assert frame.value_names == {"health": NAMES, "value": ["small"]}
    without = gridlock.Frame(run.final.box, run.final.clock, run.final.ids, run.final.columns)
    assert without.value_names == {}


def test_a_trajectory_without_a_column_has_no_names_of_it(tmp_path):
    settings = {"model.kind": "test_ward", "box": OBLONG, "run.steps": 1, "trajectory.every": 1}
    gridlock.run(settings, tmp_path / "run", trajectory={"columns": "x y bed"})
    assert gridlock.open(tmp_path / "run").trajectory[0].value_names == {}


def test_disks_have_no_names_of_values(tmp_path):
    gridlock.run({"disks.count": 9, "run.steps": 2, "trajectory.every": 1}, tmp_path / "run")
    run = gridlock.open(tmp_path / "run")
    assert "value_names" not in run.summary and run.trajectory[0].value_names == {} and run.final.value_names == {}


def test_names_of_a_shipped_model_are_in_its_files_too(tmp_path):
    gridlock.run({"model.kind": "epidemic", "epidemic.count": 9, "run.steps": 2, "trajectory.every": 1}, tmp_path / "run")
    run = gridlock.open(tmp_path / "run")
    assert run.trajectory[0].value_names == run.final.value_names == {"health": ["susceptible", "infected", "recovered"]}


def texts_of(axes):
    return [text.get_text() for legend in axes.get_children() if hasattr(legend, "get_texts") for text in legend.get_texts()]


def test_pictures_show_names_and_need_no_model(run):
    plot = pytest.importorskip("gridlock.plot")
    in_memory = gridlock.Simulation(model="test_ward", box=OBLONG)
    for agents in (run, run.trajectory, run.final, in_memory):
        assert texts_of(plot.snapshot(agents, "health")) == NAMES
    assert texts_of(plot.snapshot(run, "health", names=["0", "1", "2"])) == ["0", "1", "2"]


def test_the_program_resumes_no_such_run_but_shows_it(run, program):
    outcome = subprocess.run([program, "info", run.path], capture_output=True, text=True, timeout=60)
    assert outcome.returncode == 0, outcome.stderr
    assert "ill" in outcome.stdout


def test_the_names_are_read_from_the_file_of_any_reader(run):
    h5py = pytest.importorskip("h5py")
    with h5py.File(run.path / "trajectory.h5") as file:
        names = file["particles"]["disks"]["health"].attrs["value_names"]
        assert [name.decode() for name in names] == NAMES
        assert "value_names" not in file["particles"]["disks"]["bed"].attrs
    assert json.loads((run.path / "summary.json").read_text())["value_names"]["value"] == ["small"]
