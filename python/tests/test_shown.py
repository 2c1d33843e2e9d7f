"""What is shown at a prompt and in a notebook: short for every public object, and tables that can be read."""

import inspect
import pickle

import numpy as np
import pytest

import gridlock
from conftest import OBLONG
from gridlock.tables import structured


class Crowd(gridlock.Model):
    """Agents that stand."""

    name = "test_crowd"
    networks = {"friends": gridlock.Network()}
    count = gridlock.Setting(5000, "Agents.")

    def start(self, start):
        shown.append(start)
        start.add(positions=start.anywhere(self.count))
        start.friends.connect_small_world(6, 0.1)
        shown.extend([start.friends, start.friends.neighbors()])

    def step(self, world):
        shown.append(world)
        self.seen = repr(world)


shown = []


@pytest.fixture
def public(tmp_path):
    """An object of every public class, with many agents, points, contacts and rows."""
    settings = {"disks": {"count": 5000, "packing_fraction": 0.5}, "box": OBLONG, "run.steps": 200, "observe.every": 1, "trajectory.every": 100}
    made = gridlock.sweep(settings, {"run.seed": [1, 2]}, tmp_path / "sweep")
    run = made.runs[0]
    points, box = run.final.positions, run.final.box
    series = run.trajectory.positions()
    crowd = gridlock.Simulation(model=Crowd, box=OBLONG)
    with pytest.raises(gridlock.RunFailure):
        crowd.run(steps=1)
    simulation = gridlock.Simulation(settings)
    (tmp_path / "index.html").touch()
    shown_page = gridlock.Shown(lambda overrides: gridlock.Simulation(settings), tmp_path)
    shown_page.close()
    return [
        made, made.table, made.means, run, run.trajectory, run.trajectory.contacts, run.final, run.series, run.results, run.results["mean_speed"], box,
        gridlock.neighbors(points, 0.05, box), gridlock.voronoi(points, box), gridlock.pair_correlation(points, box, range=0.1),
        gridlock.structure_factor(points, box, largest_q=50.0), gridlock.dynamics(series), gridlock.contacts(points, 0.004, box, stiffness=False),
        gridlock.spectral_density(points, 0.004, box, largest_q=50.0), gridlock.density_profile(points, box, bins=2000), gridlock.combine([(points, points), (points, points)]),
        gridlock.order_correlation(points, np.ones(len(points)), box, range=0.1), gridlock.defects(points, box),
        gridlock.pair_correlation_map(points, box, half=(0.1, 0.1), bins=(60, 60)), gridlock.structure_peak(points, box),
        gridlock.FrameContacts(run.final.clock, np.zeros((9000, 2), dtype=np.uint64), np.zeros(9000)),
        gridlock.collective_scattering(series, box=box, q=30.0), gridlock.van_hove(series, lags=1.0, range=0.1),
        gridlock.string_lengths(series, lags=1.0, distance=0.01), gridlock.verify(run.path),
        simulation, simulation.agents, simulation.clock, simulation.columns[0], Crowd(), Crowd.count, gridlock.Field(10), shown_page, *shown,
        gridlock.Change(3, "test_crowd.count", 5, 7), gridlock.Network(), crowd.frame.networks["friends"],
        gridlock.Halts(np.zeros((9000, 2), dtype=bool), np.zeros(9000, dtype=np.int64)),
        gridlock.experiment(settings, {"disks.packing_fraction": [0.1, 0.2]}, steps=0, seeds=1, processes=1), gridlock.SobolDesign({"a.b": (0.0, 1.0)}, samples=256), gridlock.Error("wrong"),
    ]


def test_every_public_object_is_shown_in_short(public):
    classes = {type(one) for one in public}
    for name in gridlock.__all__:
        kind = getattr(gridlock, name)
        has_objects = inspect.isclass(kind) and kind not in (gridlock.Problem, gridlock.RunFailure, gridlock.ExperimentStopped)
        assert not has_objects or any(issubclass(one, kind) for one in classes), f"no {name} here"
    for one in public:
        assert len(repr(one)) < 2500, repr(one)[:200]
        assert " object at 0x" not in repr(one)
        assert len(repr(one).splitlines()) <= 30


def test_a_table_has_lines_and_columns():
    table = structured({"step": np.arange(100), "energy": np.arange(100) / 3, "name": [f"run {k}" for k in range(100)]})
    lines = repr(table).splitlines()
    assert lines[0].split() == ["step", "energy", "name"] and lines[1].split() == ["0", "0", "run", "0"]
    assert lines[-2].split() == ["99", "33", "run", "99"] and lines[-1] == "100 rows, 3 columns"
    assert len(lines) <= 14 and any("…" in line for line in lines)
    assert str(table) == repr(table)


def test_columns_that_find_no_room_are_named():
    table = structured({f"a_column_with_a_long_name_{k}": [k] for k in range(9)})
    lines = repr(table).splitlines()
    assert max(map(len, lines[:-1])) <= 110
    assert lines[-1].startswith("1 rows, 9 columns; not shown: a_column_with_a_long_name_") and lines[-1].endswith("_8")


def test_a_table_is_an_array():
    table = structured({"step": [1, 2, 3], "x": [0.5, 1.5, 2.5]})
    assert isinstance(table, np.ndarray) and table.dtype.names == ("step", "x")
    assert type(table["x"]) is np.ndarray and table["x"].tolist() == [0.5, 1.5, 2.5]
    assert table[1]["step"] == 2 and repr(table[1:]).splitlines()[-1] == "2 rows, 2 columns"
    assert table[["x"]].dtype.names == ("x",)
    assert np.array_equal(pickle.loads(pickle.dumps(table)), table)
    assert repr(table == table) == repr(np.array([True, True, True]))
    assert repr(structured({})).endswith("0 rows, 2 columns")
    pandas = pytest.importorskip("pandas")
    assert pandas.DataFrame(table)["x"].sum() == 4.5
