"""Simulations in memory: the bits of the command line, arrays without copies, callbacks, refusals."""

import csv
import gc
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import warnings

import numpy as np
import pytest

import gridlock
from conftest import OBLONG

SMALL = {"disks": {"count": 100, "packing_fraction": 0.5}, "observe": {"every": 10}}


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


SCENES = {
    "paper": {"disks": {"count": 841, "packing_fraction": 0.7}, "run.time": 0.5},
    "triangular": {"disks": {"count": 400, "packing_fraction": 0.8, "start": "triangular"}, "engine.contact": "approaching", "run.time": 1},
    "mixture": {
        "box.edge": "periodic", "velocities.kind": "maxwell", "run.time": 1,
        "disks": {"count": 200, "packing_fraction": 0.4, "start": "random",
                  "species": [{"fraction": 0.5}, {"fraction": 0.5, "size_ratio": 1.4, "mass": 1.96}]},
    },
    "rectangle": {
        "box": {"edge": "periodic", "width": 3.0, "height": 0.7}, "run.time": 1,
        "disks": {"count": 150, "packing_fraction": 0.6, "start": "triangular"}, "engine": {"time_step": 0.3, "substeps": 2},
    },
    "gas": {"disks": {"count": 100, "packing_fraction": 0.02}, "run.time": 10},
    "few": {"box.edge": "periodic", "disks": {"count": 4, "packing_fraction": 0.4}, "run.time": 20},
    "obstacles": {
        "box": {"edge": "periodic", "width": 1.3, "height": 0.8}, "run.time": 0.5,
        "disks": {"count": 300, "packing_fraction": 0.4, "start": "random",
                  "species": [{"fraction": 0.25, "size_ratio": 1.5, "fixed": True}, {"fraction": 0.75}]},
    },
}


CHANNELS = {
    "channel": {
        "box": {"edge_x": "periodic", "edge_y": "wall", "width": 1.4, "height": 0.9}, "velocities.kind": "maxwell", "run.time": 1,
        "disks": {"count": 200, "packing_fraction": 0.4, "start": "random",
                  "species": [{"fraction": 0.5}, {"fraction": 0.5, "size_ratio": 1.4, "mass": 1.96}]},
    },
    "upright_channel": {
        "box": {"edge": "periodic", "edge_x": "wall", "width": 0.9, "height": 1.4}, "run.time": 0.05,
        "disks": {"count": 6000, "packing_fraction": 0.5, "start": "triangular"},
    },
}
OF_EXACT = {
    "brownian": {
        "box": {"edge": "periodic", "width": 1.2}, "run.time": 0.5,
        "disks": {"count": 300, "packing_fraction": 0.4, "start": "random",
                  "species": [{"fraction": 0.5}, {"fraction": 0.5, "size_ratio": 1.4, "mass": 1.96}]},
        "thermostat": {"kind": "brownian", "temperature": 0.5, "interval": 0.004},
    },
    "andersen": {
        "box.width": 1.2, "disks": {"count": 300, "packing_fraction": 0.5, "start": "random"}, "run.time": 0.5,
        "thermostat": {"kind": "andersen", "temperature": 0.5, "rate": 20},
    },
    "inelastic": {
        "box": {"edge": "periodic", "width": 1.2}, "disks": {"count": 300, "packing_fraction": 0.5, "start": "random"}, "run.time": 0.5,
        "collisions.restitution": 0.9,
    },
    "falling": {
        "box.width": 1.2, "run.time": 0.5, "gravity": {"x": 0.3, "y": -2},
        "disks": {"count": 300, "packing_fraction": 0.4, "start": "random",
                  "species": [{"fraction": 0.5}, {"fraction": 0.5, "size_ratio": 1.4, "mass": 1.96}]},
    },
    "grains": {
        "disks": {"count": 100, "packing_fraction": 0.2, "species": [{"fraction": 0.1, "fixed": True}, {"fraction": 0.9}]}, "run.time": 1,
        "collisions": {"restitution": 0.8, "wall_restitution": 0.9, "contact_time": 1e-3}, "gravity.y": -1,
        "walls": [{"from": [0.1, 0.3], "to": [0.5, 0.3]}, {"from": [0.8, 0.2], "to": [0.8, 0.7]}],
    },
    "brownian_active": {
        "box": {"edge": "periodic", "width": 1.2}, "run.time": 0.5,
        "disks": {"count": 300, "packing_fraction": 0.4, "start": "random"},
        "thermostat": {"kind": "brownian", "temperature": 0.5, "interval": 0.004},
        "propulsion": {"speed": 1.5, "rotational_diffusion": 5},
    },
}
ACTIVE = {
    "active": {
        "box": {"edge": "periodic", "width": 1.2}, "run.time": 2,
        "disks": {"count": 300, "packing_fraction": 0.5, "start": "random",
                  "species": [{"fraction": 0.5}, {"fraction": 0.5, "size_ratio": 1.4, "mass": 1.96}]},
        "propulsion": {"speed": 0.5, "rotational_diffusion": 2},
    },
}
SCENES_OF_ENGINES = [
    *((scene, engine) for scene in (*SCENES, *CHANNELS) for engine in ("stepped", "tiled", "exact")),
    *((scene, "exact") for scene in OF_EXACT),
    *((scene, engine) for scene in ACTIVE for engine in ("stepped", "tiled")),
]


@pytest.mark.parametrize(("scene", "engine"), SCENES_OF_ENGINES)
def test_the_golden_hashes_are_those_of_the_table(root, scene, engine):
    with open(root / "tests/golden/hashes.csv", newline="") as file:
        row = next(row for row in csv.DictReader(file) if (row["scene"], row["engine"]) == (scene, engine))
    simulation = gridlock.Simulation({**(SCENES | CHANNELS | OF_EXACT | ACTIVE)[scene], "run.seed": 20}, engine={"kind": engine}, observe={"every": 10**6})
    assert simulation.state_hash == row["start"]
    for _ in range(3):
        simulation.run(steps=7)
        assert simulation.agents.positions.shape[1] == 2
    simulation.run()
    assert simulation.state_hash == row["end"]


def test_the_bits_are_those_of_the_command_line(program, tmp_path):
    for engine in ("stepped", "tiled", "exact"):
        arguments = {"disks.count": 200, "disks.packing_fraction": 0.6, "engine.kind": engine, "run.steps": 300, "observe.every": 50}
        (tmp_path / "run.toml").write_text("")
        sets = [word for key, value in arguments.items() for word in ("--set", f"{key}={value}")]
        subprocess.run([program, "run", "run.toml", "-o", engine, "-q", *sets], cwd=tmp_path, check=True)
        summary = json.loads((tmp_path / engine / "summary.json").read_text())
        simulation = gridlock.Simulation(arguments)
        simulation.run()
        assert simulation.state_hash == summary["state_hash"]
        assert len(simulation.results) > 10
        for name, result in simulation.results.items():
            assert (result.value, result.error) == (summary[name]["value"], summary[name]["error"]), name
        # However a run is cut into calls.
        again = gridlock.Simulation(arguments, threads=2)
        for steps in (1, 49, 77, 173):
            again.run(steps=steps)
        assert again.state_hash == summary["state_hash"]
        assert again.series.tobytes() == simulation.series.tobytes()


def test_models_run_with_the_bits_of_the_command_line(program, tmp_path):
    (tmp_path / "run.toml").write_text("model.kind = 'flocking'\nrun.steps = 50\n")
    subprocess.run([program, "run", "run.toml", "-o", "out", "-q"], cwd=tmp_path, check=True)
    simulation = gridlock.Simulation(tmp_path / "run.toml", threads=2)
    simulation.run()
    assert simulation.state_hash == json.loads((tmp_path / "out/summary.json").read_text())["state_hash"]


def test_a_run_directory_is_that_of_the_command_line(program, tmp_path):
    (tmp_path / "run.toml").write_text("run.steps = 50\n")
    subprocess.run([program, "run", "run.toml", "-o", "a", "-q"], cwd=tmp_path, check=True)
    gridlock.run(tmp_path / "run.toml", tmp_path / "b")
    assert (tmp_path / "a/series.csv").read_text() == (tmp_path / "b/series.csv").read_text()
    assert (tmp_path / "a/final.xyz").read_text() == (tmp_path / "b/final.xyz").read_text()
    with pytest.raises(gridlock.Error, match="holds results"):
        gridlock.run(tmp_path / "run.toml", tmp_path / "b")
    gridlock.run(tmp_path / "run.toml", tmp_path / "b", overwrite=True)


def test_arrays_are_the_memory_of_the_simulation():
    simulation = gridlock.Simulation(SMALL)
    x, positions = simulation.agents.x, simulation.agents.positions
    assert x.shape == (100,) and positions.shape == (100, 2)
    assert x.ctypes.data == simulation.agents.x.ctypes.data == positions.ctypes.data
    assert np.array_equal(positions[:, 1], simulation.agents.y)
    simulation.agents.velocity_x[:] = 0.25
    assert (simulation.agents.velocities[:, 0] == 0.25).all()
    simulation.agents.velocities = np.zeros((100, 2))
    assert (simulation.agents.velocity_x == 0).all()


def test_arrays_that_are_kept_hold_what_they_held():
    simulation = gridlock.Simulation(SMALL)
    kept = simulation.agents.positions
    before = kept.copy()
    simulation.run(steps=20)
    assert np.array_equal(kept, before) and not kept.flags.writeable
    assert not np.array_equal(simulation.agents.positions, before)
    last = simulation.agents.positions
    after = last.copy()
    del simulation
    gc.collect()
    assert np.array_equal(last, after) and np.array_equal(kept, before)


def test_keeping_arrays_changes_no_bit():
    one, other = gridlock.Simulation(SMALL), gridlock.Simulation(SMALL)
    arrays = []
    for _ in range(5):
        one.run(steps=7)
        other.run(steps=7)
        arrays.append(other.agents.positions)
    assert one.state_hash == other.state_hash


@pytest.mark.parametrize("engine", ["stepped", "tiled", "exact"])
def test_what_is_written_is_what_runs(engine):
    simulation = gridlock.Simulation(SMALL, engine={"kind": engine})
    simulation.run(steps=10)
    simulation.agents.velocities = -simulation.agents.velocities
    energy = float((simulation.agents.mass * (simulation.agents.velocities**2).sum(axis=1)).sum())
    simulation.run(steps=10)
    now = float((simulation.agents.mass * (simulation.agents.velocities**2).sum(axis=1)).sum())
    assert now == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize(("column", "value"), [("x", 0.5), ("x", 7.0), ("x", np.nan), ("velocity_x", np.nan), ("radius", 0.3)])
def test_states_that_cannot_go_on_are_refused_when_the_run_goes_on(column, value):
    simulation = gridlock.Simulation(SMALL)
    simulation.agents[column][:2] = value
    if column == "x":
        simulation.agents.y[:2] = 0.5
    with pytest.raises(gridlock.Error):
        simulation.run(steps=1)


def test_columns_that_do_not_exist_and_shapes_that_do_not_fit_are_refused():
    simulation = gridlock.Simulation(SMALL)
    with pytest.raises(gridlock.Error, match="no column charge"):
        simulation.agents["charge"]
    with pytest.raises(AttributeError, match="no column 'charge'"):
        simulation.agents.charge
    with pytest.raises(AttributeError, match="no column"):
        simulation.agents.charge = 3
    with pytest.raises(ValueError):
        simulation.agents.x = np.zeros(99)
    with pytest.raises(ValueError):
        simulation.agents.ids[0] = 3


def test_frames_have_the_headings_of_swimmers_and_stay_as_they_were():
    disks = {"count": 50, "packing_fraction": 0.3}
    propulsion = {"speed": 0.5, "rotational_diffusion": 2.0}
    tiled = gridlock.Simulation(engine={"kind": "tiled"}, disks=disks, propulsion=propulsion)
    tiled.run(steps=20)
    frame = tiled.frame
    assert frame.clock == tiled.clock and frame.box == tiled.box and (frame.ids == tiled.agents.ids).all()
    assert np.allclose(0.5 * frame.heading_x, tiled.agents.velocity_x) and np.allclose(0.5 * frame.heading_y, tiled.agents.velocity_y)
    before = frame.x.copy()
    tiled.run(steps=20)
    assert (frame.x == before).all() and not (tiled.agents.x == before).all()
    exact = gridlock.Simulation(engine={"kind": "exact"}, disks=disks, propulsion=propulsion, thermostat={"kind": "brownian"})
    exact.run(steps=20)
    assert np.allclose(np.hypot(exact.frame.heading_x, exact.frame.heading_y), 1.0)
    assert "heading_x" not in gridlock.Simulation(disks=disks).frame.columns


def test_series_and_results():
    simulation = gridlock.Simulation(SMALL)
    simulation.equilibrate(steps=100)
    simulation.run(steps=400)
    series = simulation.series
    assert series["step"].tolist() == list(range(0, 501, 10))
    counted = series["collision_rate"][series["step"] > 100]
    assert simulation.results["collision_rate"].value == pytest.approx(counted.mean(), rel=1e-12)
    assert simulation.results["collision_rate"].error > 0
    assert {column.name for column in simulation.columns} == set(series.dtype.names)
    with pytest.raises(KeyError, match="there is no result"):
        simulation.results["nothing"]
    assert "pair_correlation" in simulation.distributions


def test_own_observables_and_callbacks():
    simulation = gridlock.Simulation(SMALL)
    simulation.observe(lambda s: np.hypot(*s.agents.velocities.T).max(), "largest_speed", unit="length / time")
    simulation.observe(lambda s: (s.clock.step, len(s.agents)), ["own_step", "own_count"])
    seen = []

    @simulation.on_step(25)
    def look(s):
        seen.append((s.clock.step, float(s.agents.x[0])))

    simulation.run(steps=100)
    assert [step for step, _ in seen] == [0, 25, 50, 75, 100]
    assert simulation.series["own_step"].tolist() == simulation.series["step"].tolist()
    assert simulation.results["own_count"].value == 100
    plain = gridlock.Simulation(SMALL)
    plain.run(steps=100)
    assert plain.state_hash == simulation.state_hash
    with pytest.raises(gridlock.Error, match="before the first step"):
        simulation.observe(lambda s: 1.0, "late")


def test_an_exception_of_a_callback_ends_the_run_there():
    simulation = gridlock.Simulation(SMALL)

    def fail(s):
        if s.clock.step == 30:
            raise LookupError("enough")

    simulation.on_step(10, fail)
    with pytest.raises(LookupError, match="enough"):
        simulation.run(steps=100)
    assert simulation.clock.step == 30


def test_a_callback_cannot_run_the_simulation():
    simulation = gridlock.Simulation(SMALL)
    simulation.on_step(10, lambda s: s.run(steps=1))
    with pytest.raises(RuntimeError, match="cannot run"):
        simulation.run(steps=10)


def test_interrupts_stop_at_a_step_and_keep_the_state():
    simulation = gridlock.Simulation(SMALL)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        simulation.run(steps=10**12)
    step = simulation.clock.step
    assert step > 0
    other = gridlock.Simulation(SMALL)
    other.run(steps=step)
    assert other.state_hash == simulation.state_hash
    simulation.run(steps=10)
    assert simulation.clock.step == step + 10


def test_the_interpreter_goes_on_while_a_simulation_runs_and_no_other_thread_may_touch_it():
    simulation = gridlock.Simulation(disks={"count": 2000, "packing_fraction": 0.6})
    failures = []

    def touch():
        for _ in range(1000):
            try:
                simulation.agents.x.sum()
            except RuntimeError as error:
                failures.append(str(error))
                return

    thread = threading.Thread(target=touch)
    simulation.on_step(10**9, lambda s: thread.start())
    simulation.run(steps=300)
    thread.join()
    assert failures == ["this simulation is running in another thread"]


def test_nothing_that_a_protocol_changes_is_shown_to_other_threads_meanwhile():
    simulation = gridlock.Simulation(disks={"count": 2000, "packing_fraction": 0.5, "start": "uniform"}, box=OBLONG,
                                     protocol=[{"stage": "quench", "packing_fraction": 0.86}])
    failures = []

    def touch():
        for name in ("box", "time_step", "columns"):
            try:
                getattr(simulation, name)
            except RuntimeError as error:
                failures.append(str(error))

    def touch_elsewhere(work, fraction):
        if not failures:
            thread = threading.Thread(target=touch)
            thread.start()
            thread.join()

    simulation.run(progress=touch_elsewhere)
    assert failures == ["this simulation is running in another thread"] * 3


def test_ctrl_c_in_the_last_step_is_heard_after_the_last_sample():
    # Functions of Python that are called in between handle exceptions of their own.
    text = """if True:
        import signal, gridlock
        signal.signal(signal.SIGVTALRM, signal.default_int_handler)
        # A step of many substeps takes 0.3 s of the processor, all else far less than 0.1 s.
        simulation = gridlock.Simulation(disks={"count": 200_000, "packing_fraction": 0.01}, run={"steps": 1},
                                         observe={"every": 1, "structure_every": 0}, engine={"substeps": 2000})
        seen = []

        def look(s):
            try:
                raise LookupError
            except LookupError:
                seen.append(s.clock.step)
            if s.clock.step == 0:
                signal.setitimer(signal.ITIMER_VIRTUAL, 0.1)  # of this process, however busy the machine is
            return 1.0

        simulation.observe(look)
        try:
            simulation.run()
        except KeyboardInterrupt:
            print(seen, simulation.series["look"].tolist())
        """
    process = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
    assert (process.returncode, process.stdout) == (0, "[0, 1] [1.0, 1.0]\n"), process.stderr


def test_two_simulations_run_side_by_side():
    simulations = [gridlock.Simulation(SMALL, run={"seed": seed}) for seed in (1, 2)]
    threads = [threading.Thread(target=s.run, kwargs={"steps": 200}) for s in simulations]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    alone = gridlock.Simulation(SMALL, run={"seed": 2})
    alone.run(steps=200)
    assert simulations[1].state_hash == alone.state_hash


def test_forks_and_pickles_are_refused():
    simulation = gridlock.Simulation(SMALL)
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(simulation)
    child = os.fork()
    if child == 0:
        try:
            simulation.run(steps=1)
        except RuntimeError as error:
            os._exit(0 if "another process" in str(error) else 1)
        os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"disks": {"cuont": 3}}, "did you mean"),
        ({"disks.count": "many"}, "disks.count"),
        ({"disks": {"count": 100, "packing_fraction": 0.99}}, "packing fraction"),
        ({"engine": {"kind": "magic"}}, "magic"),
        ({"engine": {"time_step": float("nan")}}, "engine.time_step"),
        ({"disks": {"count": object()}}, "type object"),
        ({3: 4}, "no name of a setting"),
        ("nowhere.toml", "nowhere.toml"),
        ([1, 2], "settings are a dict"),
    ],
)
def test_bad_settings_are_refused_with_the_texts_of_the_command_line(settings, words):
    with pytest.raises(gridlock.Error, match=words):
        gridlock.Simulation(settings)


def test_errors_have_every_problem():
    with pytest.raises(gridlock.Error) as caught:
        gridlock.Simulation({"disks": {"cuont": 3}, "engine": {"kin": "exact"}})
    assert len(caught.value.problems) == 2
    assert all(problem["hint"] for problem in caught.value.problems)


@pytest.mark.parametrize("steps", [-1, 1.5, "many", True])
def test_bad_numbers_of_steps_are_refused(steps):
    with pytest.raises(gridlock.Error, match="steps"):
        gridlock.Simulation(SMALL).run(steps=steps)


def test_a_simulation_without_an_end_asks_for_steps():
    with pytest.raises(gridlock.Error, match="no end"):
        gridlock.Simulation(SMALL).run()


def test_memory_stays_flat():
    def resident():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def use(count):
        for _ in range(count):
            simulation = gridlock.Simulation({"disks": {"count": 16, "packing_fraction": 0.2}, "observe": {"every": 1}})
            kept = simulation.agents.positions
            # Functions that know their simulation are cycles.
            simulation.on_step(1, lambda s, own=simulation: own.clock)
            simulation.observe(lambda s, own=simulation: own.time_step, "own")
            simulation.run(steps=1)
            assert kept.shape == (16, 2)

    use(500)
    gc.collect()
    before = resident()
    use(4_000)
    gc.collect()
    assert resident() - before < 4e6


@pytest.mark.parametrize("threads", [-1, 1.5, "two", True])
def test_bad_numbers_of_threads_are_refused(threads, tmp_path):
    for call in (
        lambda: gridlock.Simulation(SMALL, threads=threads),
        lambda: gridlock.run(SMALL, tmp_path / "a", threads=threads),
        lambda: gridlock.sweep({"run.steps": 1}, {"run.seed": [1]}, tmp_path / "b", threads=threads),
    ):
        with pytest.raises(gridlock.Error, match="threads"):
            call()


def test_what_has_no_effect_in_memory_is_told():
    with pytest.warns(UserWarning, match=r"\[trajectory\] has no effect on a simulation in memory"):
        gridlock.Simulation(SMALL, trajectory={"every": 10})
    with pytest.warns(UserWarning, match="engine.cells has no effect"):
        gridlock.Simulation(SMALL, engine={"cells": 10})


def test_arrays_of_callbacks_hold_what_they_held():
    simulation = gridlock.Simulation(SMALL)
    kept = []
    simulation.on_step(5, lambda s: kept.append((s.agents.positions, s.agents.positions.copy())))
    simulation.observe(lambda s: kept.append((s.agents.x, s.agents.x.copy())) or 1.0, "keeper")
    simulation.run(steps=60)
    assert len(kept) > 15
    assert all(np.array_equal(held, copy) and not held.flags.writeable for held, copy in kept)


SCATTERED = """if True:
    import bisect
    import numpy as np, gridlock
    blocks, addresses = [], []

    def scatter():
        # Memory whose only holes lie far apart.
        blocks.extend(np.zeros((100, 2)) for _ in range(60_000))
        blocks.sort(key=lambda block: block.ctypes.data)
        addresses.extend(block.ctypes.data for block in blocks)
        for k in range(58_000, 0, -6_000):
            blocks[k] = None

    def check(vectors, x, y):
        # All between the two columns becomes one hole, in which every copy finds room.
        first, last = sorted(bisect.bisect(addresses, column.ctypes.data) for column in (x, y))
        more = [np.zeros((100, 2)) for _ in range(2000)]
        blocks[first:last] = [None] * (last - first)
        assert np.array_equal(vectors.copy(), np.stack([x, y], axis=1)) and vectors.base is not None
        print(abs(vectors.strides[1]) < 10_000)
    """


@pytest.mark.parametrize("text", [
    """
    simulation = gridlock.Simulation(disks={"count": 100, "packing_fraction": 0.3}, observe={"every": 1000})
    kept = simulation.agents.positions
    scatter()
    simulation.run(steps=1)
    check(simulation.agents.positions, simulation.agents.x, simulation.agents.y)
    check(simulation.agents.velocities, simulation.agents.velocity_x, simulation.agents.velocity_y)
    """, """
    scatter()
    simulation = gridlock.Simulation(disks={"count": 100, "packing_fraction": 0.3}, observe={"every": 1000})
    simulation.observe(lambda s: s.agents.x[0], "first")
    simulation.on_step(1, lambda s: check(s.agents.positions, s.agents.x, s.agents.y))
    simulation.run(steps=1)
    """, """
    kept = []
    class Still(gridlock.Model):
        name = "still"
        def start(self, start):
            start.add(positions=start.anywhere(100))
        def step(self, world):
            if world.clock.step == 0:
                kept.append(world.positions)
                scatter()
            else:
                check(world.positions, world.x, world.y)
    gridlock.Simulation(model=Still, box={"width": 1.5, "height": 0.6, "edge": "periodic"}).run(steps=3)
    """])
def test_vectors_can_be_copied_wherever_their_columns_lie(text):
    # NumPy takes a copy that lies between the two for shared with them, and copies again, without end.
    resource = pytest.importorskip("resource")
    process = subprocess.run([sys.executable, "-X", "faulthandler", "-c", SCATTERED + text], capture_output=True, text=True,
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_STACK, (2**20, 2**20)))
    assert (process.returncode, process.stdout) == (0, "True\nTrue\n"), process.stderr


def test_observables_see_vectors_as_copies():
    simulation = gridlock.Simulation(SMALL)
    seen = []
    simulation.observe(lambda s: seen.append((s.agents.positions, s.agents.ids, s.agents.x)) or 0.0, "seen")
    simulation.run(steps=1)
    positions, ids, x = seen[0]
    assert positions.flags.c_contiguous and np.array_equal(positions[:, 0], x) and len(ids) == 100
    assert not any(array.flags.writeable for array in seen[0])


def test_what_a_callback_writes_is_checked():
    simulation = gridlock.Simulation(SMALL)

    def break_it(s):
        if s.clock.step == 10:
            s.agents.x[0] = np.nan

    simulation.on_step(10, break_it)
    with pytest.raises(gridlock.Error):
        simulation.run(steps=50)
    assert simulation.clock.step == 10
    stopped = gridlock.Simulation(SMALL)
    stopped.on_step(10, lambda s: s.agents.velocities.fill(0.0))
    stopped.run(steps=50)
    assert stopped.series["kinetic_energy"][-1] == 0.0


@pytest.mark.parametrize("name", ["step", "kinetic_energy", "", "a,b", [], ["a", "a"], [5], "two words"])
def test_bad_names_of_observables_are_refused(name):
    with pytest.raises(gridlock.Error):
        gridlock.Simulation(SMALL).observe(lambda s: 1.0, name)


@pytest.mark.parametrize("steps", ["100", 2.9, True, -1, None, 2**64])
def test_a_refused_equilibration_changes_nothing(steps):
    simulation = gridlock.Simulation(SMALL)
    with pytest.raises(gridlock.Error, match="steps"):
        simulation.equilibrate(steps)
    simulation.run(steps=50)
    assert len(simulation.results) > 10


def test_reading_arrays_leaves_nothing_behind():
    simulation = gridlock.Simulation(SMALL)
    for _ in range(5000):
        simulation.agents.x
    assert len(simulation._arrays) < 2000


def test_an_equilibration_counts_from_now_on():
    simulation = gridlock.Simulation(SMALL, observe={"every": 10})
    simulation.observe(lambda s: s.clock.step, "step_of_sample")
    simulation.run(steps=100)
    simulation.equilibrate(steps=100)
    simulation.run(steps=200)
    steps = simulation.series["step_of_sample"]
    assert steps.tolist() == list(range(0, 401, 10))
    counted = steps[((0 < steps) & (steps <= 100)) | (steps > 200)]
    assert simulation.results["step_of_sample"].value == pytest.approx(counted.mean(), rel=1e-12)
