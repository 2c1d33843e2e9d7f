"""Frames in ASE, MDAnalysis and GSD say what the run says."""

import sys
import warnings

import gsd.hoomd
import MDAnalysis
import MDAnalysis.analysis.msd
import numpy as np
import pytest

import gridlock
from conftest import OBLONG

RUN = {
    "disks": {"count": 40, "packing_fraction": 0.3, "species": [
        {"fraction": 0.25, "size_ratio": 1.0}, {"fraction": 0.75, "size_ratio": 1.4, "mass": 2.0}]},
    "box": OBLONG, "engine": {"kind": "exact"}, "run": {"steps": 4000}, "observe": {"every": 100},
    "trajectory": {"every": 1000, "steps": [10]},
}


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory):
    directory = tmp_path_factory.mktemp("run") / "out"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        gridlock.run(RUN, directory)
    return gridlock.open(directory).trajectory


@pytest.fixture(scope="module")
def walls():
    simulation = gridlock.Simulation(disks={"count": 9, "packing_fraction": 0.2}, box={"edge": "wall"})
    return simulation


def test_ase_has_positions_velocities_kinds_and_times(trajectory):
    made = trajectory.to_ase()
    assert len(made) == len(trajectory) == 6
    for atoms, frame in zip(made, trajectory):
        assert np.array_equal(atoms.positions[:, :2], frame.unwrapped) and (atoms.positions[:, 2] == 0).all()
        assert np.allclose(atoms.get_velocities()[:, 0], frame.velocity_x)
        assert np.array_equal(atoms.get_masses(), frame.mass)
        assert np.array_equal(atoms.arrays["kind"], frame.kinds) and np.array_equal(atoms.arrays["radius"], frame.radius)
        assert np.array_equal(atoms.arrays["id"], frame.ids)
        assert atoms.info == {"step": frame.clock.step, "time": frame.clock.time}
        assert atoms.cell.lengths() == pytest.approx([frame.box.width, frame.box.height, 1.0])
    assert made[0].pbc.tolist() == [True, True, False]
    inside = trajectory[-1].to_ase(unwrapped=False)
    assert np.array_equal(inside.positions[:, :2], trajectory[-1].positions)
    assert np.abs(inside.get_distance(0, 1, mic=True) - made[-1].get_distance(0, 1, mic=True)) < 1e-12


def test_mdanalysis_has_the_frames_with_their_uneven_times(trajectory):
    universe = trajectory.to_mdanalysis()
    assert [step.time for step in universe.trajectory] == trajectory.times.tolist()
    assert universe.trajectory[3].time == trajectory.times[3]
    assert universe.copy().trajectory[2].time == trajectory.times[2]
    frame = trajectory[3]
    universe.trajectory[3]
    assert np.allclose(universe.atoms.positions[:, :2], frame.unwrapped, atol=1e-5)
    assert np.allclose(universe.atoms.velocities[:, 1], frame.velocity_y, atol=1e-6)
    assert universe.dimensions == pytest.approx([frame.box.width, frame.box.height, 1, 90, 90, 90])
    assert universe.atoms.types.tolist() == ["AB"[kind] for kind in frame.kinds]
    assert np.allclose(universe.atoms.masses, frame.mass) and np.allclose(universe.atoms.radii, frame.radius)
    assert np.array_equal(universe.atoms.ids, frame.ids)


def test_the_displacements_of_mdanalysis_are_those_of_the_run(trajectory):
    run = gridlock.open(trajectory.path.parent)
    universe = trajectory.to_mdanalysis()
    moved = MDAnalysis.analysis.msd.EinsteinMSD(universe, msd_type="xy", fft=False).run().results.timeseries
    assert moved[-1] == pytest.approx(run.series["mean_squared_displacement"][-1], rel=1e-4)
    assert moved[-1] == pytest.approx(gridlock.dynamics(trajectory.positions(), trajectory.times).msd[-1], rel=1e-4)


def test_gsd_has_the_frames_in_two_dimensions(trajectory, tmp_path):
    trajectory.to_gsd(tmp_path / "run.gsd")
    with gsd.hoomd.open(tmp_path / "run.gsd") as file:
        assert [frame.configuration.step for frame in file] == trajectory.steps.tolist()
        for written, frame in zip(file, trajectory):
            sides = np.array([frame.box.width, frame.box.height])
            assert written.configuration.dimensions == 2
            assert written.configuration.box == pytest.approx([*sides, 0, 0, 0, 0])
            inside = written.particles.position[:, :2] + 0.5 * sides
            assert np.allclose(inside, frame.positions, atol=1e-6)
            assert np.allclose(inside + written.particles.image[:, :2] * sides, frame.unwrapped, atol=1e-5)
            assert np.allclose(written.particles.velocity[:, 0], frame.velocity_x, atol=1e-6)
            assert np.allclose(written.particles.diameter, 2 * frame.radius) and np.allclose(written.particles.mass, frame.mass)
            assert np.array_equal(written.particles.typeid, frame.kinds) and written.particles.types == ["A", "B"]
            assert written.log["time"][0] == frame.clock.time


def test_one_frame_between_walls_is_not_periodic(walls, tmp_path):
    walls.write(tmp_path / "state.xyz")
    frame = gridlock.open(tmp_path / "state.xyz")
    assert not frame.to_ase().pbc.any()
    assert frame.to_mdanalysis().dimensions is None
    frame.to_gsd(tmp_path / "state.gsd")
    with gsd.hoomd.open(tmp_path / "state.gsd") as file:
        assert len(file) == 1 and file[0].particles.N == 9


@pytest.mark.parametrize(("name", "method"), [("ase", "to_ase"), ("MDAnalysis", "to_mdanalysis"), ("gsd.hoomd", "to_gsd")])
def test_a_missing_library_is_told_with_what_to_install(trajectory, tmp_path, monkeypatch, name, method):
    monkeypatch.setitem(sys.modules, name, None)
    arguments = [tmp_path / "x.gsd"] if method == "to_gsd" else []
    package = name.partition(".")[0]
    for owner in (trajectory, trajectory[0]):
        with pytest.raises(gridlock.Error, match=f"{package} is not installed\n  hint: pip install {package}"):
            getattr(owner, method)(*arguments)


def test_what_cannot_be_unwrapped_or_has_no_frames_is_refused(tmp_path):
    gridlock.run({**RUN, "run.steps": 100, "trajectory": {"every": 100, "columns": "x y"}}, tmp_path / "out")
    bare = gridlock.open(tmp_path / "out").trajectory
    with pytest.raises(gridlock.Error, match="how often an agent has crossed the edges"):
        bare.to_mdanalysis()
    universe = bare.to_mdanalysis(unwrapped=False)
    assert np.allclose(universe.atoms.positions[:, 0], bare[0].x, atol=1e-6)
    with pytest.raises(gridlock.Error, match="without frames"):
        gridlock.converters.to_mdanalysis([])
