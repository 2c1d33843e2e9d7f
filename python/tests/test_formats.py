"""Files of other programs: trajectories in H5MD, GSD and dumps of LAMMPS, and formats that are named and refused."""

import gc
import gzip
import json
import os
import re
import subprocess
import sys
import warnings

import gsd.hoomd
import h5py
import numpy as np
import pytest

import gridlock
import gridlock.plot

WIDTH, HEIGHT, COUNT = 3.0, 2.0, 5


def positions(frames=3, dimensions=2):
    """Random points of an oblong box about its lower left corner, shape (frames, COUNT, dimensions)."""
    points = np.random.default_rng(3).uniform(0.0, 1.0, (frames, COUNT, dimensions))
    points[..., 0] *= WIDTH
    points[..., 1] *= HEIGHT
    if dimensions == 3:
        points[..., 2] = 0.25
    return points


def write_h5md(path, points, *, edges="fixed vector", clock="explicit", boundary=("periodic", "periodic"), group="all", libver="earliest"):
    """A file as other writers make it; h5py keeps no order of creation, and texts of any length."""
    frames, _, d = points.shape
    sides = np.array([WIDTH, HEIGHT, 1.5])[:d]
    with h5py.File(path, "w", libver=libver) as file:
        root = file.create_group("h5md")
        root.attrs["version"] = [1, 1]
        root.create_group("creator").attrs.update({"name": "a writer", "version": "7"})
        root.create_group("author").attrs["name"] = "A. Nonymous"
        agents = file.create_group(f"particles/{group}")
        agents["position/value"] = points
        if clock == "explicit":
            agents["position/step"] = np.arange(frames) * 10 + 5
            agents["position/time"] = np.arange(frames) * 0.5
        elif clock == "linear":
            agents["position/step"] = 10
            agents["position/step"].attrs["offset"] = 5
            agents["position/time"] = 0.5
        elif clock == "steps":
            agents["position/step"] = np.arange(frames, dtype=np.int32) * 10 + 5
        box = agents.create_group("box")
        box.attrs["dimension"] = d
        box.attrs["boundary"] = [*boundary, "none"][:d]
        if edges == "fixed vector":
            box["edges"] = sides
        elif edges == "fixed matrix":
            box["edges"] = np.diag(sides)
        elif edges == "attribute":
            box.attrs["edges"] = sides
        elif edges == "vector of each frame":
            box["edges/value"] = np.tile(sides, (frames, 1))
            box["edges/step"] = agents["position"].get("step", np.arange(frames))
        elif edges == "matrix of each frame":
            box["edges/value"] = np.tile(np.diag(sides), (frames, 1, 1))
        elif edges == "sheared":
            box["edges"] = np.diag(sides) + np.eye(d, k=1)
        elif edges == "oblique":
            box["edges"] = np.diag(sides) + 0.5 * np.eye(d, k=-1)
        return file.filename


@pytest.mark.parametrize("d", [2, 3])
def test_h5md_of_an_oblique_box_has_its_tilt_and_positions_inside(tmp_path, d):
    points = np.array([[0.1, 0.2, 0.0], [0.3, 2.5, 0.0], [-0.2, -0.5, 0.0]])[None, :, :d]
    write_h5md(tmp_path / "x.h5", points, edges="oblique")
    frame = gridlock.open(tmp_path / "x.h5")[0]
    assert frame.box == gridlock.Box(WIDTH, HEIGHT, tilt=0.5 / HEIGHT)
    # Above the upper edge a point comes in 0.5 farther to the left, below the lower one to the right.
    np.testing.assert_allclose(frame.positions, [[0.1, 0.2], [2.8, 0.5], [0.3, 1.5]], atol=1e-12)


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("edges", ["fixed vector", "fixed matrix", "attribute", "vector of each frame", "matrix of each frame"])
@pytest.mark.parametrize("clock", ["explicit", "linear", "steps", "none"])
@pytest.mark.parametrize("boundary", [("periodic", "periodic"), ("none", "none"), ("periodic", "none"), ("none", "periodic")])
def test_h5md_of_other_writers_has_its_frames(tmp_path, dimensions, edges, clock, boundary):
    points = positions(dimensions=dimensions)
    found = gridlock.open(write_h5md(tmp_path / "x.h5md", points, edges=edges, clock=clock, boundary=boundary))
    steps = [0, 1, 2] if clock == "none" else [5, 15, 25]
    assert found.steps.tolist() == steps
    assert found.times.tolist() == {"explicit": [0, 0.5, 1], "linear": [0, 0.5, 1]}.get(clock, steps)
    for frame, expected in zip(found, points):
        assert (frame.box.width, frame.box.height) == (WIDTH, HEIGHT)
        assert (frame.box.periodic_x, frame.box.periodic_y) == tuple(axis == "periodic" for axis in boundary)
        assert np.array_equal(frame.positions, expected[:, :2]) and frame.ids.tolist() == list(range(COUNT))


@pytest.mark.parametrize("libver", ["earliest", "latest"])
def test_h5md_of_other_writers_has_its_columns_in_the_order_of_its_ids(tmp_path, libver):
    points = positions()
    path = write_h5md(tmp_path / "x.h5", points, libver=libver)
    ids = np.array([[4, 2, 9, -1, 0], [0, 2, 4, 9, 7], [9, 7, 4, 2, 0]])
    velocities = np.random.default_rng(5).normal(size=points.shape).astype(np.float32)
    images = np.arange(ids.size * 2, dtype=np.int32).reshape(*ids.shape, 2)
    with h5py.File(path, "a") as file:
        agents = file["particles/all"]
        agents["id/value"] = ids
        agents["velocity/value"] = velocities
        agents["velocity/step"] = agents["position/step"]
        agents["image/value"] = images
        agents["diameter"] = np.linspace(0.1, 0.3, COUNT)
        agents["species"] = np.arange(COUNT) % 2
        agents["charge/value"] = np.ones((1, COUNT))
        file["observables/temperature/value"] = [1.0, 2.0, 3.0]
    found = gridlock.open(path)
    for frame, given, rows in zip(found, range(3), (np.array([4, 1, 0, 2]), np.array([0, 1, 2, 4, 3]), np.array([4, 3, 2, 1, 0]))):
        assert frame.ids.tolist() == ids[given, rows].tolist()
        assert np.array_equal(frame.positions, points[given, rows])
        assert np.array_equal(frame.velocity_y, velocities[given, rows, 1].astype(float))
        assert np.array_equal(frame.image_x, images[given, rows, 0])
        assert np.array_equal(frame.radius, np.linspace(0.05, 0.15, COUNT)[rows])
        assert np.array_equal(frame.kinds, (np.arange(COUNT) % 2)[rows])
        assert "charge" not in frame.columns


@pytest.mark.parametrize("boundary", ["periodic", "none"])
def test_boxes_about_the_origin_are_counted_from_their_corner(tmp_path, boundary):
    points = positions()
    path = write_h5md(tmp_path / "x.h5", points - [0.5 * WIDTH, 0.5 * HEIGHT], boundary=(boundary, boundary))
    for frame, expected in zip(gridlock.open(path), points):
        shifted = expected if boundary == "none" else (expected - [0.5 * WIDTH, 0.5 * HEIGHT]) % [WIDTH, HEIGHT]
        assert np.allclose(frame.positions, shifted, rtol=0, atol=1e-15)


def test_positions_that_do_not_jump_stay_where_they_are_with_images(tmp_path):
    points = positions() + np.arange(3)[:, None, None] * [2.5, -3.25]
    path = write_h5md(tmp_path / "x.h5", points)
    with h5py.File(path, "a") as file:
        file["particles/all/image/value"] = np.zeros(points.shape, dtype=np.int32)
    for frame, expected in zip(gridlock.open(path), points):
        assert np.allclose(frame.unwrapped, expected, rtol=0, atol=1e-14)
        assert frame.positions.min() >= 0.0 and (frame.positions < [WIDTH, HEIGHT]).all()


def test_a_box_without_edges_is_the_rectangle_around_all_frames(tmp_path):
    points = positions() * 2.0 - 7.0
    found = gridlock.open(write_h5md(tmp_path / "x.h5", points, edges="none at all", boundary=("none", "none")))
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    for frame, expected in zip(found, points):
        assert (frame.box.width, frame.box.height) == tuple(high - low)
        assert np.array_equal(frame.positions, expected - low)


def test_the_group_with_positions_is_found_among_others(tmp_path):
    path = write_h5md(tmp_path / "x.h5", positions(), group="the solvent")
    with h5py.File(path, "a") as file:
        file.create_group("particles/a group of names")
    assert len(gridlock.open(path)) == 3


@pytest.mark.parametrize(("change", "message"), [
    ({"edges": "sheared"}, "the first edge of its box is"),
])
def test_boxes_that_do_not_fit_are_refused_in_words(tmp_path, change, message):
    path = write_h5md(tmp_path / "x.h5", positions(), **change)
    with pytest.raises(gridlock.Error, match=message):
        gridlock.open(path)[0]


def test_agents_in_space_and_walls_that_are_crossed_are_refused_with_numbers(tmp_path):
    points = positions(dimensions=3)
    points[1, 2, 2] = 0.75
    found = gridlock.open(write_h5md(tmp_path / "space.h5", points))
    assert len(found[0]) == COUNT
    with pytest.raises(gridlock.Error, match=r"z from 0\.25 to 0\.75 in frame 1"):
        found[1]
    points = positions()
    points[2, 0, 1] = 2.5
    with pytest.raises(gridlock.Error, match=r"at 2\.5, outside the walls at 0 and 2"):
        gridlock.open(write_h5md(tmp_path / "walls.h5", points, boundary=("none", "none")))[2]


@pytest.mark.parametrize(("attributes", "name"), [({}, "HDF5"), ({"_NCProperties": "version=2,netcdf=4.9"}, "netCDF")])
def test_hdf5_that_is_no_trajectory_says_so(tmp_path, attributes, name):
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file["numbers"] = [1, 2, 3]
        file.attrs.update(attributes)
    for read in (gridlock.open, gridlock.read_xyz):
        with pytest.raises(gridlock.Error, match=f"it is {name}, but no H5MD"):
            read(tmp_path / "x.h5")


def test_a_link_to_another_file_is_not_followed(tmp_path):
    write_h5md(tmp_path / "secret.h5", positions())
    path = write_h5md(tmp_path / "x.h5", positions())
    with h5py.File(path, "a") as file:
        del file["particles/all/position/value"]
        file["particles/all/position/value"] = h5py.ExternalLink("secret.h5", "/particles/all/position/value")
    with pytest.raises(gridlock.Error, match="is a link to another file"):
        gridlock.open(path)


def test_numbers_packed_by_a_filter_that_is_no_part_of_hdf5_are_refused_by_name(tmp_path):
    path = write_h5md(tmp_path / "x.h5", positions())
    with h5py.File(path, "a") as file:
        del file["particles/all/position/value"]
        file["particles/all/position"].create_dataset("value", data=positions(), compression="lzf")
    with pytest.raises(gridlock.Error, match=r"packed by a filter of HDF5 \(number 32000\)"):
        gridlock.open(path)


MDANALYSIS = f"""
import MDAnalysis, numpy
universe = MDAnalysis.Universe.empty({COUNT}, trajectory=True)
universe.load_new(numpy.load("solid.npy"), dimensions=numpy.tile([{WIDTH}, {HEIGHT}, 1, 90, 90, 90], (3, 1)), dt=0.25)
with MDAnalysis.Writer("x.h5md", {COUNT}, convert_units=False) as writer:
    for _ in universe.trajectory:
        writer.write(universe)
"""


def test_what_mdanalysis_writes_is_read(tmp_path):
    points = positions().astype(np.float32)
    np.save(tmp_path / "solid.npy", np.concatenate([points, np.zeros((3, COUNT, 1), np.float32)], axis=2))
    # A process of its own closes the file.
    ended = subprocess.run([sys.executable, "-W", "ignore", "-c", MDANALYSIS], cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    for frame, expected in zip(gridlock.open(tmp_path / "x.h5md"), points):
        assert np.array_equal(frame.positions, expected.astype(float))
        assert (frame.box.width, frame.box.height, frame.box.periodic) == (WIDTH, HEIGHT, True)


def test_what_is_left_out_of_h5md_is_named(program, tmp_path):
    path = write_h5md(tmp_path / "x.h5md", positions()[:1], group="beads")
    with h5py.File(path, "a") as file:
        file["particles/walls/position/value"] = positions()[:1]
        file["particles/beads/radius"] = np.full(COUNT, 0.01)
        file["particles/beads/name"] = [b"a"] * COUNT
    (tmp_path / "run.toml").write_text('disks.file = "x.h5md"\nrun.steps = 5\n')
    for command in (["export", "x.h5md", "--to", "csv"], ["movie", "x.h5md", "-q", "--width", "64"], ["contacts", "x.h5md"], ["check", "run.toml"]):
        told = ran(program, *command, folder=tmp_path)
        assert "/particles/walls" in told.stderr and "/particles/beads/name" in told.stderr, (command, told.stdout, told.stderr)
    for read in (gridlock.open, gridlock.read_xyz):
        with pytest.warns(UserWarning, match="not read of .*: /particles/walls, /particles/beads/name; of several groups of agents") as told:
            read(path)
        assert [warning.filename for warning in told] == [__file__]


def ran(program, *words, folder):
    return subprocess.run([program, *map(str, words)], cwd=folder, capture_output=True, text=True)


def test_the_program_tells_exports_and_draws_h5md_of_other_writers(program, tmp_path):
    points = positions()
    path = write_h5md(tmp_path / "x.h5md", points)
    with h5py.File(path, "a") as file:
        file["particles/all/name"] = [b"a"] * COUNT
    told = ran(program, "info", "x.h5md", folder=tmp_path)
    assert told.returncode == 0, told.stderr
    for words in ("3 frames of all", "periodic box 3 × 2", "written by a writer 7", "not read: /particles/all/name"):
        assert words in told.stdout
    assert "state_hash" not in told.stdout
    assert ran(program, "export", "x.h5md", "--to", "xyz", "-o", "x.xyz", folder=tmp_path).returncode == 0
    assert ran(program, "export", "x.h5md", "--to", "csv", "-o", "x.csv", folder=tmp_path).returncode == 0
    exported = np.genfromtxt(tmp_path / "x.csv", delimiter=",", names=True)
    assert np.array_equal(np.stack([exported["x"], exported["y"]], axis=1), points.reshape(-1, 2))
    drawn = ran(program, "movie", "x.h5md", "-o", "x.gif", "--width", "64", "-q", folder=tmp_path)
    assert drawn.returncode == 0 or "ffmpeg" in drawn.stderr, drawn.stderr


def test_one_frame_of_h5md_is_a_packing_and_a_start(program, tmp_path):
    points = np.array([[[0.5, 0.5], [1.1, 0.5], [1.7, 0.5], [2.3, 0.5], [0.5, 1.1]]])
    path = write_h5md(tmp_path / "x.h5md", points)
    with h5py.File(path, "a") as file:
        file["particles/all/radius"] = np.full(COUNT, 0.305)
    told = ran(program, "contacts", "x.h5md", "--json", folder=tmp_path)
    assert told.returncode == 0, told.stderr
    assert json.loads(told.stdout)["packing_fraction"] == pytest.approx(COUNT * np.pi * 0.305**2 / (WIDTH * HEIGHT))
    with h5py.File(path, "a") as file:
        file["particles/all/radius"][...] = 0.2
    (tmp_path / "run.toml").write_text('disks.file = "x.h5md"\nrun.steps = 5\nvelocities = { kind = "maxwell" }\n')
    ended = ran(program, "run", "run.toml", "-o", "out", "-q", folder=tmp_path)
    assert ended.returncode == 0, ended.stderr
    start = gridlock.read_xyz(tmp_path / "out/start.xyz")
    assert np.array_equal(start.positions, points[0]) and (start.box.width, start.box.height) == (WIDTH, HEIGHT)


DUMP = """ITEM: TIMESTEP
10
ITEM: TIME
0.5
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS {} pp
-1 3
-1 1
-0.5 0.5
ITEM: ATOMS {}
"""


def test_a_dump_of_lammps_has_its_time_before_its_step(tmp_path):
    head = "ITEM: UNITS\nlj\nITEM: TIME\n{}\nITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 3\n0 2\n0 1\n"
    rows = "ITEM: ATOMS id x y\n1 0.5 {}\n"
    (tmp_path / "a.lammpstrj").write_text(head.format(0.25, 10) + rows.format(1) + head.format(0.75, 20) + rows.format("nan"))
    trajectory = gridlock.open(tmp_path / "a.lammpstrj")
    assert trajectory.steps.tolist() == [10, 20] and trajectory.times.tolist() == [0.25, 0.75]
    assert trajectory[0].positions.tolist() == [[0.5, 1.0]]
    with pytest.raises(gridlock.Error, match="step 20: an agent is at nan"):
        trajectory[1]


@pytest.mark.parametrize("name", ["x.lammpstrj", "x.lammpstrj.gz", "cut.lammpstrj", "x.gsd", "x.h5md"])
def test_no_file_is_left_open(tmp_path, name):
    text = DUMP.format("pp pp", "id x y") + "1 0 0\n2 1 0\n"
    (tmp_path / "x.lammpstrj").write_text(text)
    (tmp_path / "x.lammpstrj.gz").write_bytes(gzip.compress(text.encode()))
    (tmp_path / "cut.lammpstrj").write_text(text[:-6])
    with gsd.hoomd.open(tmp_path / "x.gsd", "w") as file:
        frame = gsd.hoomd.Frame()
        frame.configuration.box = [WIDTH, HEIGHT, 0, 0, 0, 0]
        frame.particles.N = 2
        frame.particles.position = [[-1, 0, 0], [1, 0.5, 0]]
        file.append(frame)
    write_h5md(tmp_path / "x.h5md", positions())
    opened = set(os.listdir("/proc/self/fd"))
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            trajectory = gridlock.open(tmp_path / name)
            assert len(trajectory[0]) > 0 and trajectory[0].box.width > 0
            del trajectory
        except gridlock.Error as error:
            assert name.startswith("cut") and "is cut off" in str(error)
        gc.collect()
    assert [str(warning.message) for warning in told if warning.category is ResourceWarning] == []
    assert set(os.listdir("/proc/self/fd")) == opened


def test_no_trajectory_is_written_over_the_file_it_is_read_from(tmp_path):
    pytest.importorskip("gsd")
    gridlock.run({"disks.count": 9, "trajectory.every": 1, "run.steps": 2}, tmp_path / "run")
    gridlock.open(tmp_path / "run").trajectory.to_gsd(tmp_path / "a.gsd")
    before = (tmp_path / "a.gsd").read_bytes()
    (tmp_path / "link.gsd").symlink_to("a.gsd")
    for name in ("a.gsd", "link.gsd"):
        with pytest.raises(gridlock.Error, match="is read here, and would be replaced"):
            gridlock.open(tmp_path / "a.gsd").to_gsd(tmp_path / name, overwrite=True)
    assert (tmp_path / "a.gsd").read_bytes() == before


def test_a_dump_of_lammps_has_its_frames(tmp_path):
    first = DUMP.format("pp pp", "id type xs ys z ix iy vx vy vz diameter element")
    text = first + "7 2 0.999 0.5 0 1 0 0.25 1 0 0.5 Ar\n3 1 0.25 0.25 0 0 -1 -1 2 0 0.4 He\n"
    text += first.replace("10", "20", 1).replace("0.5\n", "0.75\n", 1) + "7 2 1.125 -0.25 0 0 0 0 0 0 0.5 Ar\n3 1 0 1 0 0 0 0 0 0 0.4 He\n"
    (tmp_path / "x.lammpstrj").write_text(text)
    (tmp_path / "packed.dump.gz").write_bytes(gzip.compress(text.encode()))
    for name in ("x.lammpstrj", "packed.dump.gz"):
        found = gridlock.open(tmp_path / name)
        assert found.steps.tolist() == [10, 20] and found.times.tolist() == [0.5, 0.75]
        frame = found[0]
        assert (frame.box.width, frame.box.height, frame.box.periodic) == (4, 2, True)
        assert frame.ids.tolist() == [3, 7] and frame.kinds.tolist() == [0, 1]
        assert np.allclose(frame.positions, [[1, 0.5], [3.996, 1]]) and frame.radius.tolist() == [0.2, 0.25]
        assert frame.velocity_x.tolist() == [-1, 0.25] and frame.velocity_y.tolist() == [2, 1]
        assert np.allclose(frame.unwrapped, [[1, -1.5], [7.996, 1]])
        assert np.allclose(found[1].unwrapped, [[0, 2], [4.5, -0.5]])
        assert "element" not in frame.columns


def test_a_position_that_rounds_to_the_far_edge_lies_on_the_near_one():
    inside, boxes = gridlock.formats.Side(-1.0, 4.0, True).put_inside(np.array([-1.0 - 1e-16, -1.0, 3.0, 2.5, 7.5]), "here")
    assert inside.tolist() == [0.0, 0.0, 0.0, 3.5, 0.5] and boxes.tolist()[1:] == [0, 1, 0, 2]
    inside, _ = gridlock.formats.Side(0.0, 4.0, True).put_inside(np.array([-1e-20]), "here")
    assert inside.tolist() == [0.0]


def test_unwrapped_positions_of_lammps_have_images(tmp_path):
    (tmp_path / "x.dump").write_text(DUMP.format("pp pp", "id xu yu") + "1 -1.5 2.5\n2 3 0\n")
    frame = gridlock.open(tmp_path / "x.dump")[0]
    assert frame.image_x.tolist() == [-1, 1] and frame.image_y.tolist() == [1, 0]
    assert np.allclose(frame.unwrapped, [[-0.5, 3.5], [4, 1]])


def test_a_dump_of_a_channel_is_periodic_along_it_alone(tmp_path):
    (tmp_path / "x.dump").write_text(DUMP.format("pp ff", "id x y") + "1 -3 0\n2 1 0.5\n")
    frame = gridlock.open(tmp_path / "x.dump")[0]
    assert (frame.box.periodic_x, frame.box.periodic_y, frame.box.edge_x, frame.box.edge_y) == (True, False, "periodic", "wall")
    assert ((frame.x >= 0) & (frame.x < frame.box.width)).all() and frame.y.tolist() == [1, 1.5]


@pytest.mark.parametrize(("flags", "columns", "rows", "message"), [
    ("pp pp", "id x y z", "1 0 0 0\n2 1 0 0.25\n", r"z from 0 to 0\.25"),
    ("ff ff", "id x y", "1 0 0\n2 1 1.25\n", r"an agent is at 1\.25, outside the walls at -1 and 1"),
    ("pp pp", "id x y", "1 0 0\n1 1 0\n", "two agents have one id"),
    ("pp pp", "id vx vy", "1 0 0\n2 1 0\n", "there is no column x, xs, xu or xsu"),
    ("pp pp", "id x y", "1 0 0\n", "is cut off"),
    ("pp pp", "id x y", "1 0 0\n2 1\n", "another number of columns"),
])
def test_dumps_of_lammps_that_do_not_fit_are_refused(tmp_path, flags, columns, rows, message):
    (tmp_path / "x.lammpstrj").write_text(DUMP.format(flags, columns) + rows)
    with pytest.raises(gridlock.Error, match=message):
        gridlock.open(tmp_path / "x.lammpstrj")[0]


def test_gsd_has_its_frames_and_nothing_that_it_does_not_say(tmp_path):
    with gsd.hoomd.open(tmp_path / "x.gsd", "w") as file:
        for k in range(2):
            frame = gsd.hoomd.Frame()
            frame.configuration.step = 5 + k
            frame.configuration.dimensions = 2
            frame.configuration.box = [4, 2, 0, 0, 0, 0]
            frame.particles.N = 2
            frame.particles.position = [[-2, 0, 0], [1.5, 0.75, 0]]
            frame.particles.image = [[1, 0, 0], [k, 0, 0]]
            frame.particles.diameter = [0.5, 0.25]
            file.append(frame)
    found = gridlock.open(tmp_path / "x.gsd")
    assert found.steps.tolist() == [5, 6] and found.times.tolist() == [5, 6]
    assert (found[1].box.width, found[1].box.height, found[1].box.periodic) == (4, 2, True)
    assert found[1].positions.tolist() == [[0, 1], [3.5, 1.75]] and found[1].radius.tolist() == [0.25, 0.125]
    assert found[1].unwrapped.tolist() == [[4, 1], [7.5, 1.75]]
    assert "mass" not in found[0].columns and "velocity_x" not in found[0].columns


def test_what_is_written_as_gsd_is_read_back(tmp_path):
    gridlock.run({"disks": {"count": 30, "packing_fraction": 0.3}, "box": {"edge": "periodic", "width": 3.0, "height": 2.0}, "run.steps": 200,
                  "trajectory.every": 100}, tmp_path / "out")
    written = gridlock.open(tmp_path / "out").trajectory
    written.to_gsd(tmp_path / "x.gsd")
    for frame, expected in zip(gridlock.open(tmp_path / "x.gsd"), written):
        assert np.allclose(frame.unwrapped, expected.unwrapped, atol=1e-5)
        assert np.allclose(frame.radius, expected.radius) and frame.clock == expected.clock
        for name in ("velocity_x", "velocity_y"):
            assert np.allclose(frame.columns[name], expected.columns[name], atol=1e-6), name
        assert np.allclose(frame.positions, expected.positions, atol=1e-5) and np.array_equal(frame.kinds, expected.kinds)


def test_gsd_without_its_library_says_what_to_install(tmp_path, monkeypatch):
    with gsd.hoomd.open(tmp_path / "x.gsd", "w") as file:
        file.append(gsd.hoomd.Frame())
    monkeypatch.setitem(sys.modules, "gsd.hoomd", None)
    with pytest.raises(gridlock.Error, match="gsd is not installed\n  hint: pip install gsd"):
        gridlock.open(tmp_path / "x.gsd")


OTHERS = {
    "x.nc": (b"CDF\x01" + bytes(60), "a netCDF file"), "y.nc": (b"CDF\x02" + bytes(60), "a netCDF file"),
    "x.dcd": (b"T\x00\x00\x00CORD" + bytes(80), "a DCD trajectory"), "x.xtc": (b"\x00\x00\x07\xcb" + bytes(80), "an XTC trajectory"),
    "x.npy": (b"\x93NUMPY\x01\x00" + bytes(80), "an array of NumPy"), "x.gsd": (b"\xdf\x65" * 4 + bytes(300), "a GSD file"),
    "x.lammpstrj": (b"ITEM: TIMESTEP\n0\n", "a dump of LAMMPS"), "x.bz2": (b"BZh91AY" + bytes(20), "a file that bzip2 packed"),
    "x.h5": (b"\x89HDF\r\n\x1a\n" + bytes(100), "cannot read|an HDF5 file"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_every_reader_names_the_format_of_a_file_that_is_none_of_its(program, tmp_path, name):
    content, words = OTHERS[name]
    (tmp_path / name).write_bytes(content)
    (tmp_path / "run.toml").write_text(f'disks.file = "{name}"\nrun.steps = 1\n')
    is_trajectory = name.endswith(("gsd", "lammpstrj", "h5"))
    with pytest.raises(gridlock.Error, match=words):
        gridlock.read_xyz(tmp_path / name)
    if not is_trajectory:
        with pytest.raises(gridlock.Error, match=words):
            gridlock.open(tmp_path / name)
    commands = [["contacts", name], ["run", name], ["run", "run.toml", "-q"], ["check", "run.toml"]]
    if not name.endswith("h5"):
        commands += [["info", name], ["export", name, "--to", "csv"], ["movie", name]]
    for command in commands:
        ended = ran(program, *command, folder=tmp_path)
        assert ended.returncode == 2, command
        assert re.search(words, ended.stderr) and "hint:" in ended.stderr, (command, ended.stderr)


TEXTS = {
    "x.xyz": (b'1\nLattice="3 0 0 0 2 0 0 0 1" Properties=pos:R:2\n0.5 0.5\n', "is extended XYZ"),
    "x.toml": (b"disks.count = 9\nrun.steps = 5\n", "is a text file"), "notes": ("überlegt\n".encode(), "is a text file"),
    "latin.txt": (b"\xfcberlegt\r\n", "is a text file"), "x.txt.gz": (gzip.compress(b"words"), "is a file that gzip packed"),
    "bytes.h5": (bytes(range(64)), "it is no HDF5 file"), "zeros.h5": (bytes(4096), "it is no HDF5 file"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_file_that_is_no_trajectory_is_named_by_what_it_is(program, tmp_path, name):
    content, words = TEXTS[name]
    (tmp_path / name).write_bytes(content)
    for command in (["export", name, "--to", "csv"], ["movie", name, "-o", "x.mp4"]):
        ended = ran(program, *command, folder=tmp_path)
        assert ended.returncode == 2 and words in ended.stderr and "hint:" in ended.stderr, ended.stderr
        assert "cannot open" not in ended.stderr and "signature" not in ended.stderr


def test_no_line_is_quoted_from_a_file_without_lines(program, tmp_path):
    write_h5md(tmp_path / "x.h5md", positions())
    (tmp_path / "run.toml").write_text('disks.file = "x.h5md"\nrun.steps = 5\n')
    for command, choice in ((["contacts", "x.h5md"], "--frame"), (["check", "run.toml"], "disks.frame")):
        ended = ran(program, *command, folder=tmp_path)
        assert ended.returncode == 2 and "it holds 3 frames" in ended.stderr and f"choose one: {choice} from 0 to 2" in ended.stderr
        assert "x.h5md:" not in ended.stderr and "Lattice" not in ended.stderr, ended.stderr
    with pytest.raises(gridlock.Error, match="it holds 3 frames") as refused:
        gridlock.read_xyz(tmp_path / "x.h5md")
    assert "Lattice" not in str(refused.value)


@pytest.mark.parametrize("ending", [".extxyz", ".exyz", ".xyz", ".xyz.gz"])
def test_extended_xyz_has_every_ending_that_it_is_given(program, tmp_path, ending):
    gridlock.Simulation(disks={"count": 9, "packing_fraction": 0.3}).write(tmp_path / "x.xyz")
    content = (tmp_path / "x.xyz").read_bytes()
    path = tmp_path / f"y{ending}"
    path.write_bytes(gzip.compress(content) if ending.endswith("gz") else content)
    assert len(gridlock.open(path)) == 9
    assert "9 disks in" in ran(program, "info", path, folder=tmp_path).stdout


def user_file(path):
    path.write_text("mine")
    return path


@pytest.mark.parametrize("name", ["final.xyz", "series.csv", "trajectory.h5", "summary.json", "start.xyz"])
def test_a_run_from_python_replaces_no_file_of_the_user(tmp_path, name):
    mine = user_file(tmp_path / name)
    settings = {"disks": {"count": 9, "packing_fraction": 0.3}, "run.steps": 5}
    with pytest.raises(gridlock.Error, match=r"in Python overwrite=True"):
        gridlock.run(settings, tmp_path)
    assert mine.read_text() == "mine"
    (tmp_path / "notes.txt").write_text("mine")
    gridlock.run(settings, tmp_path, overwrite=True)
    assert not mine.exists() or mine.read_bytes() != b"mine"
    assert (tmp_path / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("name", ["sweep.csv", "means.csv", "plan.json", "runs/seed=1/final.xyz"])
def test_a_sweep_from_python_replaces_no_file_of_the_user(tmp_path, name):
    (tmp_path / "runs/seed=1").mkdir(parents=True)
    mine = user_file(tmp_path / name)
    settings, seeds = {"disks": {"count": 9, "packing_fraction": 0.3}, "run.steps": 5}, {"run.seed": [1, 2]}
    with pytest.raises(gridlock.Error, match=r"in Python overwrite=True"):
        gridlock.sweep(settings, seeds, tmp_path)
    assert mine.read_text() == "mine"
    gridlock.sweep(settings, seeds, tmp_path, overwrite=True)
    assert mine.read_bytes() != b"mine"


def test_no_simulation_is_written_over_what_it_was_made_from(tmp_path):
    gridlock.Simulation(disks={"count": 9, "packing_fraction": 0.3}, box={"width": 1.5, "height": 0.6}).write(tmp_path / "start.xyz")
    (tmp_path / "run.toml").write_text('disks.file = "start.xyz"\nrun.steps = 5\n')
    (tmp_path / "link.xyz").symlink_to("start.xyz")
    before = (tmp_path / "start.xyz").read_bytes()
    simulation = gridlock.Simulation(tmp_path / "run.toml")
    for name in ("start.xyz", "link.xyz", "run.toml"):
        with pytest.raises(gridlock.Error, match="is read here, and would be replaced"):
            simulation.write(tmp_path / name, overwrite=True)
    assert (tmp_path / "start.xyz").read_bytes() == before
    simulation.write(tmp_path / "end.xyz")
    assert len(gridlock.read_xyz(tmp_path / "end.xyz")) == 9


def test_a_directory_in_the_way_is_to_be_moved_and_not_overwritten(program, tmp_path):
    settings = {"disks": {"count": 9, "packing_fraction": 0.3}, "run.steps": 5}
    (tmp_path / "out/final.xyz").mkdir(parents=True)
    for overwrite in (False, True):
        with pytest.raises(gridlock.Error, match="final.xyz is a directory") as refused:
            gridlock.run(settings, tmp_path / "out", overwrite=overwrite)
        assert "move that directory away" in str(refused.value) and "overwrite" not in str(refused.value)
    gridlock.run(settings | {"trajectory.every": 5}, tmp_path / "run")
    (tmp_path / "x.csv").mkdir()
    for words in ([], ["--overwrite"]):
        ended = ran(program, "export", "run", "--to", "csv", "-o", "x.csv", *words, folder=tmp_path)
        assert ended.returncode == 2 and "move that directory away" in ended.stderr and "overwrite" not in ended.stderr


def test_functions_that_write_one_file_replace_none_without_the_word(tmp_path):
    gridlock.run({"disks": {"count": 9, "packing_fraction": 0.3}, "run.steps": 5, "trajectory.every": 5}, tmp_path / "out")
    trajectory = gridlock.open(tmp_path / "out").trajectory
    simulation = gridlock.Simulation(disks={"count": 9, "packing_fraction": 0.3})
    mine = user_file(tmp_path / "mine")
    for write in (simulation.write, trajectory.to_gsd, trajectory[0].to_gsd):
        with pytest.raises(gridlock.Error, match="overwrite=True"):
            write(mine)
        assert mine.read_text() == "mine"
        # Results of a run are not theirs to replace.
        for result in ("final.xyz", "trajectory.h5"):
            before = (tmp_path / "out" / result).read_bytes()
            for overwrite in (False, True):
                with pytest.raises(gridlock.Error):
                    write(tmp_path / "out" / result, overwrite=overwrite)
            assert (tmp_path / "out" / result).read_bytes() == before
    simulation.write(mine, overwrite=True)
    assert len(gridlock.read_xyz(mine)) == 9


def test_pictures_replace_no_file_of_the_user(tmp_path):
    gridlock.run({"disks": {"count": 9, "packing_fraction": 0.3}, "run.steps": 20, "observe.every": 5}, tmp_path)
    mine = [user_file(tmp_path / name) for name in ("start.svg", "final.png")]
    made = gridlock.plot.pictures(tmp_path)
    assert all(file.read_text() == "mine" for file in mine)
    assert any("start.svg would be replaced" in note for note in made.notes) and (tmp_path / "displacement.svg").exists()
    assert gridlock.plot.pictures(tmp_path, overwrite=True).notes == []
    assert all(file.read_bytes() != b"mine" for file in mine)
