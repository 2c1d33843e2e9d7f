"""Charts: what is drawn is what the data say, and mistakes are refused."""

import warnings

import matplotlib
import numpy as np
import pytest

import gridlock
import gridlock.plot

matplotlib.use("Agg")


@pytest.fixture(autouse=True)
def tidy():
    from matplotlib import pyplot

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def simulation():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        made = gridlock.Simulation(disks={"count": 100, "packing_fraction": 0.5}, observe={"every": 10})
        made.run(steps=300)
        return made


def test_a_snapshot_has_every_disk_at_its_size(simulation, tmp_path):
    axes = gridlock.plot.snapshot(simulation, np.arange(100), label="row")
    disks = axes.collections[0]
    assert np.array_equal(disks.get_offsets(), simulation.agents.positions)
    assert np.allclose(disks.get_widths() if hasattr(disks, "get_widths") else 2 * disks._widths, 2 * simulation.agents.radius)
    assert disks.get_array().tolist() == list(range(100))
    axes.figure.savefig(tmp_path / "a.png")
    axes.figure.savefig(tmp_path / "a.pdf")
    points = gridlock.plot.snapshot(gridlock.Simulation({"model.kind": "flocking"}))
    assert len(points.collections[0].get_offsets()) > 0


def test_series_and_curves_are_those_of_the_run(simulation):
    axes = gridlock.plot.series(simulation, ["mean_displacement", "halted_fraction"])
    assert np.array_equal(axes.lines[0].get_ydata(), simulation.series["mean_displacement"])
    assert axes.get_legend() is not None
    curve = gridlock.plot.curve(simulation, "pair_correlation")
    assert np.array_equal(curve.lines[0].get_ydata(), simulation.distributions["pair_correlation"]["pair_correlation"])
    assert len(curve.collections) == 1


def test_sweeps_have_a_line_for_each_combination(tmp_path):
    made = gridlock.sweep({"run.steps": 50, "disks.count": 30, "observe.every": 10},
                          {"disks.packing_fraction": [0.2, 0.3, 0.4], "engine.kind": ["stepped", "exact"]}, tmp_path / "a")
    axes = gridlock.plot.sweep(made, "collision_rate")
    assert len(axes.containers) == 2 and axes.get_xlabel() == "packing fraction"
    assert len(gridlock.plot.snapshot(made.runs[0]).collections[0].get_offsets()) == 30
    with pytest.raises(gridlock.Error, match="no result nothing"):
        gridlock.plot.sweep(made, "nothing")
    with pytest.raises(gridlock.Error, match="no numbers engine.kind"):
        gridlock.plot.sweep(made, "collision_rate", against="engine.kind")


@pytest.mark.parametrize("draw", [
    lambda s: gridlock.plot.snapshot(s, [1.0, 2.0]),
    lambda s: gridlock.plot.snapshot("nothing"),
    lambda s: gridlock.plot.series(s, "nothing"),
    lambda s: gridlock.plot.curve(s, "nothing"),
])
def test_mistakes_are_refused(simulation, draw):
    with pytest.raises(gridlock.Error):
        draw(simulation)
