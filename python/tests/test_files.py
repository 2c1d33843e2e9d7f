"""Readers of run directories, trajectories and states; sweeps on executors."""

import concurrent.futures
import json
import os
import signal
import subprocess
import warnings

import numpy as np
import pytest

import gridlock
from conftest import OBLONG

RUN = {
    "disks": {"count": 64, "packing_fraction": 0.4, "species": [
        {"fraction": 0.5, "size_ratio": 1.0}, {"fraction": 0.5, "size_ratio": 1.4}]},
    "box": OBLONG, "engine": {"kind": "exact"}, "run": {"steps": 2000}, "observe": {"every": 100},
    "trajectory": {"every": 500},
}


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    directory = tmp_path_factory.mktemp("run") / "out"
    gridlock.run(RUN, directory)
    return gridlock.open(directory)


def test_a_run_directory_has_what_the_simulation_had(made):
    simulation = gridlock.Simulation({**RUN, "trajectory": None})
    simulation.run()
    assert made.state_hash == simulation.state_hash
    assert made.series.tobytes() == simulation.series.tobytes()
    assert len(made.results) > 10
    assert dict(made.results) == dict(simulation.results)
    assert made.table("pair_correlation").tobytes() == simulation.distributions["pair_correlation"].tobytes()
    assert made.settings["disks"]["count"] == 64
    by_id = np.argsort(simulation.agents.ids)
    assert np.array_equal(made.final.positions, simulation.agents.positions[by_id])


def test_frames_are_unwrapped_and_know_kinds(made):
    trajectory = made.trajectory
    assert trajectory.steps.tolist() == [0, 500, 1000, 1500, 2000]
    assert len(list(trajectory)) == 5 and trajectory[-1].clock.step == 2000
    positions = trajectory.positions()
    assert positions.shape == (5, 64, 2)
    square = ((positions[-1] - positions[0]) ** 2).sum(axis=1).mean()
    assert square == pytest.approx(made.series["mean_squared_displacement"][-1], rel=1e-9)
    assert square > ((trajectory.positions(unwrapped=False)[-1] - positions[0]) ** 2).sum(axis=1).mean()
    kinds = trajectory[0].kinds
    assert np.bincount(kinds).tolist() == [32, 32]
    assert trajectory[0].radius[kinds == 1].min() > trajectory[0].radius[kinds == 0].max()
    with pytest.raises(IndexError, match="no frame 5"):
        trajectory[5]
    with pytest.raises(AttributeError, match="no column 'charge'"):
        trajectory[0].charge


def test_a_part_of_a_trajectory_is_a_trajectory(made):
    trajectory = made.trajectory
    part = trajectory.since(600)
    assert part.steps.tolist() == [1000, 1500, 2000] and len(part) == 3
    assert np.array_equal(part.times, trajectory.times[2:])
    assert np.array_equal(part.positions(), trajectory.positions()[2:])
    assert trajectory[1::2].steps.tolist() == [500, 1500] and part[-1].clock.step == 2000
    assert part[1:][0].clock.step == 1500 and len(trajectory[7:]) == 0
    assert trajectory.since(2**63 - 1).steps.tolist() == [] and trajectory.since(1000).steps[0] == 1000
    for call in (lambda: trajectory[::-1], lambda: trajectory.since(-1), lambda: trajectory.since("1"), lambda: trajectory.since(2**63)):
        with pytest.raises(gridlock.Error, match="hint"):
            call()


def test_a_part_without_frames_says_which_there_are(made, tmp_path):
    for empty in (made.trajectory[:0], made.trajectory.since(2001)):
        assert list(empty) == [] and empty.steps.shape == empty.times.shape == (0,) and empty.to_ase() == []
        for call in (empty.positions, lambda: empty.kinds, lambda: empty.diameter, empty.to_mdanalysis, lambda: empty.to_gsd(tmp_path / "a.gsd")):
            with pytest.raises(gridlock.Error, match="no frames\n  hint: its 5 frames are those of steps 0 to 2000"):
                call()
    assert not (tmp_path / "a.gsd").exists()


class Succession(gridlock.Model):
    """In every step the first agent dies and another one is born."""

    name = "test_succession"
    time_step = 1.0

    def start(self, start):
        start.add(positions=start.anywhere(10))

    def step(self, world):
        world.remove(np.arange(len(world)) == 0)
        world.add(x=0.5, y=0.5)


def test_positions_of_other_agents_are_refused_though_they_are_as_many(tmp_path):
    gridlock.register_model(Succession)
    gridlock.run({"model.kind": "test_succession", "run.steps": 4, "trajectory.every": 2}, tmp_path / "out")
    trajectory = gridlock.open(tmp_path / "out").trajectory
    assert [len(frame) for frame in trajectory] == [10, 10, 10]
    for call in (trajectory.positions, lambda: gridlock.dynamics(trajectory.positions())):
        with pytest.raises(gridlock.Error, match="the agents of step 2 are not those of step 0: 2 are new and 2 are gone\n  hint: take"):
            call()
    assert trajectory[1:2].positions(unwrapped=False).shape == (1, 10, 2)


def test_agents_that_no_column_tells_apart_have_no_kinds(tmp_path):
    gridlock.run({**RUN, "run.steps": 100, "trajectory": {"every": 100, "columns": "x y"}}, tmp_path / "out")
    disks = gridlock.open(tmp_path / "out").trajectory
    gridlock.Simulation({"model.kind": "epidemic", "epidemic.count": 20}).write(tmp_path / "a.xyz")
    walkers = gridlock.read_xyz(tmp_path / "a.xyz")
    for call in (lambda: disks.kinds, lambda: disks[0].kinds, lambda: walkers.kinds):
        with pytest.raises(gridlock.Error, match="no kinds\n  hint: keep the column radius or species in trajectory.columns"):
            call()
    pytest.importorskip("ase")
    assert walkers.to_ase().arrays["kind"].tolist() == [0] * 20


def test_a_frame_of_an_xyz_file_is_chosen_by_its_number(tmp_path):
    frame = '1\nLattice="2 0 0 0 1 0 0 0 1" Properties=pos:R:2:masses:R:1:momenta:R:3 pbc=[T, T, F] step={}\n-0.5 0.25 2 3 1 0\n'
    (tmp_path / "two.xyz").write_text(frame.format(10) + frame.format(20))
    assert [gridlock.read_xyz(tmp_path / "two.xyz", frame=k).clock.step for k in (0, 1, -1, -2)] == [10, 20, 20, 10]
    read = gridlock.read_xyz(tmp_path / "two.xyz", frame=0)
    assert (read.box.width, read.box.height, read.box.periodic) == (2, 1, True)
    assert read.positions.tolist() == [[1.5, 0.25]] and read.unwrapped.tolist() == [[-0.5, 0.25]]
    assert read.columns["velocity_x"].tolist() == [1.5] and read.columns["velocity_y"].tolist() == [0.5]
    with pytest.raises(gridlock.Error, match="it holds 2 frames\n(.*\n)*  hint: choose one: frame from 0 to 1"):
        gridlock.read_xyz(tmp_path / "two.xyz")
    with pytest.raises(gridlock.Error, match="the file has 2 frames, and no frame 2"):
        gridlock.read_xyz(tmp_path / "two.xyz", frame=2)


def test_lengths_are_in_diameters_on_request(made, tmp_path):
    frame = made.trajectory[2]
    reduced = frame.in_diameters()
    assert reduced.diameter == pytest.approx(1.0) and frame.diameter == pytest.approx(2 * frame.radius.mean())
    assert made.diameter == made.trajectory.diameter == frame.diameter
    assert np.allclose(reduced.positions * frame.diameter, frame.positions)
    assert reduced.box.width == pytest.approx(frame.box.width / frame.diameter) and reduced.box.periodic
    assert np.allclose(reduced.unwrapped * frame.diameter, frame.unwrapped)
    assert np.array_equal(reduced.mass, frame.mass)
    for name in ("x", "y", "radius", "velocity_x", "velocity_y"):
        assert np.allclose(reduced.columns[name] * frame.diameter, frame.columns[name]), name
    assert frame.in_diameters(0.5).box.width == 2 * frame.box.width
    with pytest.raises(gridlock.Error, match="the diameter is 0"):
        frame.in_diameters(0)
    gridlock.run({**RUN, "run.steps": 100, "trajectory": {"every": 100, "columns": "x y"}}, tmp_path / "out")
    with pytest.raises(gridlock.Error, match="no radii"):
        gridlock.open(tmp_path / "out").trajectory.diameter


def test_a_frame_without_images_cannot_be_unwrapped(tmp_path):
    gridlock.run({**RUN, "run.steps": 100, "trajectory": {"every": 100, "columns": "x y"}}, tmp_path / "out")
    frame = gridlock.open(tmp_path / "out").trajectory[0]
    with pytest.raises(gridlock.Error, match="crossed the edges\n  hint: of disks, keep the columns image_x and image_y .* a model of your own needs such columns"):
        frame.unwrapped


def test_what_is_missing_or_damaged_is_refused(tmp_path, made):
    with pytest.raises(gridlock.Error, match="neither a run nor a sweep"):
        gridlock.open(tmp_path)
    with pytest.raises(gridlock.Error):
        gridlock.open(tmp_path / "nowhere.h5").steps
    (tmp_path / "bad.h5").write_bytes(b"nothing")
    with pytest.raises(gridlock.Error, match="bad.h5"):
        gridlock.open(tmp_path / "bad.h5")
    (tmp_path / "bad.xyz").write_text("3\nnothing\n")
    with pytest.raises(gridlock.Error, match="bad.xyz"):
        gridlock.open(tmp_path / "bad.xyz")
    with pytest.raises(gridlock.Error, match="nowhere.csv"):
        made.table("nowhere")


@pytest.mark.parametrize("text", ["nothing", "[1, 2]", '{"state_hash": 12}'])
def test_an_edited_summary_is_refused_by_name(tmp_path, text):
    gridlock.run({"disks": {"count": 4}, "run": {"steps": 10}}, tmp_path / "out")
    (tmp_path / "out" / "summary.json").write_text(text)
    with pytest.raises(gridlock.Error, match=r"summary.json is damaged: it is not the summary of a run\n  hint"):
        gridlock.open(tmp_path / "out").state_hash


def test_interrupted_runs_are_continued(tmp_path):
    shorter = tmp_path / "out"
    gridlock.run({**RUN, "trajectory": None}, shorter)
    gridlock.open(shorter).resume(steps=3000)
    longer = gridlock.Simulation({**RUN, "trajectory": None, "run.steps": 3000})
    longer.run()
    assert gridlock.open(shorter).state_hash == longer.state_hash
    for steps in (-1, 0, "4000", True, 1.5, 2**63):
        with pytest.raises(gridlock.Error, match=f"steps is {steps!r}\n  hint"):
            gridlock.open(shorter).resume(steps=steps)


SWEEP = ({"run.steps": 200, "disks.count": 30, "observe.every": 20},
         {"disks.packing_fraction": [0.2, 0.4], "run.seed": [1, 2, 3]})


def expect_same(one, other):
    """Everything but the time that the runs took."""
    for here, there in ((one.table, other.table), (one.means, other.means)):
        assert here.dtype.names == there.dtype.names
        for name in set(here.dtype.names) - {"seconds"}:
            assert here[name].tolist() == there[name].tolist() or np.array_equal(here[name], there[name], equal_nan=True), name


def test_a_sweep_is_that_of_the_command_line(program, tmp_path):
    made = gridlock.sweep(*SWEEP, tmp_path / "a", threads=2)
    (tmp_path / "sweep.toml").write_text(
        "run.steps = 200\ndisks.count = 30\nobserve.every = 20\n"
        "[sweep]\n'disks.packing_fraction' = [0.2, 0.4]\n'run.seed' = [1, 2, 3]\n")
    subprocess.run([program, "sweep", "sweep.toml", "-o", "b", "-q"], cwd=tmp_path, check=True)
    expect_same(made, gridlock.open(tmp_path / "b"))
    assert made.means["runs"].tolist() == [3, 3]
    assert len(made.runs) == 6 and made.runs[0].state_hash == made.table["state_hash"][0]
    pytest.importorskip("pandas")
    assert made.frame()["state_hash"].tolist() == made.table["state_hash"].tolist()


@pytest.mark.parametrize("kind", [concurrent.futures.ThreadPoolExecutor, concurrent.futures.ProcessPoolExecutor])
def test_executors_make_the_same_tables(kind, tmp_path):
    here = gridlock.sweep(*SWEEP, tmp_path / "a")
    with kind(2) as executor:
        there = gridlock.sweep(*SWEEP, tmp_path / "b", executor=executor)
    expect_same(here, there)


def test_a_worker_that_dies_is_told_and_the_same_call_continues(tmp_path):
    settings = {"run.steps": 100_000, "disks.count": 200, "observe.every": 1000, "checkpoint.every_steps": 2000}
    values = {"disks.packing_fraction": [0.5, 0.6], "run.seed": [1, 2]}
    with concurrent.futures.ProcessPoolExecutor(1) as executor, concurrent.futures.ThreadPoolExecutor(1) as beside:
        victim = executor.submit(os.getpid).result()
        killer = beside.submit(lambda: (_wait_for(tmp_path / "a/runs"), os.kill(victim, signal.SIGKILL)))
        with pytest.raises(gridlock.RunFailure, match="a worker of the executor died: .*\n  hint: the same call"):
            gridlock.sweep(settings, values, tmp_path / "a", executor=executor)
        killer.result()
    assert len(gridlock.open(tmp_path / "a").table) == 4
    with concurrent.futures.ProcessPoolExecutor(2) as executor:
        made = gridlock.sweep(settings, values, tmp_path / "a", executor=executor)
    assert set(made.table["status"]) == {"finished"}


def test_ctrl_c_takes_back_the_runs_that_have_not_begun(tmp_path):
    def stop(number, share):
        raise KeyboardInterrupt

    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        with pytest.raises(KeyboardInterrupt):
            gridlock.sweep({**SWEEP[0], "run.steps": 20_000}, SWEEP[1], tmp_path / "a", executor=executor, progress=stop)
    assert 1 <= len(list((tmp_path / "a/runs").iterdir())) < 6


def test_a_sweep_is_resumed(tmp_path):
    settings, values = SWEEP
    gridlock.sweep(settings, {**values, "run.seed": [1]}, tmp_path / "a")
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "a/runs").glob("*seed=1*/summary.json")}
    made = gridlock.sweep(settings, values, tmp_path / "a")
    assert len(before) == 2 and all(path.stat().st_mtime_ns == time for path, time in before.items())
    assert len(made.table) == 6
    with pytest.raises(gridlock.Error):
        gridlock.sweep({**settings, "disks.count": 31}, values, tmp_path / "a")


def test_a_cluster_of_dask_loses_a_worker_and_no_run(tmp_path):
    distributed = pytest.importorskip("distributed")
    settings = {"run.steps": 60_000, "disks.count": 200, "observe.every": 1000, "checkpoint.every_steps": 2000}
    values = {"disks.packing_fraction": [0.5, 0.6], "run.seed": [1, 2]}
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            victim = client.submit(os.getpid, pure=False, workers=[next(iter(client.scheduler_info()["workers"]))]).result()
            killer = concurrent.futures.ThreadPoolExecutor(1).submit(lambda: (_wait_for(tmp_path / "b/runs"), os.kill(victim, signal.SIGKILL)))
            made = gridlock.sweep(settings, values, tmp_path / "b", executor=client.get_executor())
            killer.result()
    here = gridlock.sweep(settings, values, tmp_path / "a")
    assert here.table["state_hash"].tolist() == made.table["state_hash"].tolist()
    assert set(made.table["status"]) == {"finished"}


def _wait_for(path):
    import time

    for _ in range(600):
        if path.exists() and any(path.iterdir()):
            break
        time.sleep(0.05)
    time.sleep(0.3)


@pytest.mark.parametrize(("values", "words"), [
    ({}, "no values"), ({"run.seed": 3}, "no list"), ({"run.seed": "123"}, "no list"), ({"run.sede": [1]}, "run.sede"),
    ({"run.seed": []}, "run.seed"), ({"run.seed": [1, 1]}, "twice"),
])
def test_bad_lists_are_refused(values, words, tmp_path):
    with pytest.raises(gridlock.Error, match=words):
        gridlock.sweep({"run.steps": 10}, values, tmp_path / "a")
    assert not (tmp_path / "a").exists()


def test_runs_that_fail_are_told_and_the_others_finish(tmp_path):
    with pytest.raises(gridlock.RunFailure, match="1 runs failed"):
        gridlock.sweep({"run.steps": 20, "disks.count": 30}, {"disks.packing_fraction": [0.2, 0.95]}, tmp_path / "a")
    assert sorted(gridlock.open(tmp_path / "a").table["status"].tolist()) == ["failed", "finished"]
    assert json.loads(next((tmp_path / "a/runs").glob("*0.2/summary.json")).read_text())["status"] == "finished"


def test_a_state_has_the_columns_of_its_file_and_no_others(tmp_path):
    walkers = gridlock.Simulation({"model.kind": "epidemic", "epidemic.count": 20, "box": OBLONG})
    walkers.write(tmp_path / "a.xyz")
    read = gridlock.read_xyz(tmp_path / "a.xyz")
    assert list(read.columns) == ["x", "y", "velocity_x", "velocity_y", "health"]
    assert read.health.dtype == np.uint32
    with pytest.raises(gridlock.Error, match="how often an agent has crossed the edges"):
        read.unwrapped  # noqa: B018
    disks = gridlock.Simulation(disks={"count": 4, "packing_fraction": 0.2})
    disks.write(tmp_path / "b.xyz")
    assert set(gridlock.read_xyz(tmp_path / "b.xyz").columns) == set(disks.agents.names)
