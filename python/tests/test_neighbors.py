"""Pairs and neighbours of points, against brute force and SciPy."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import gridlock


def brute_force(points, cutoff, box):
    i, j = np.triu_indices(len(points), k=1)
    difference = points[j] - points[i]
    for axis, name in enumerate("xy"):
        if box is not None and getattr(box, f"periodic_{name}"):
            difference[:, axis] -= box[axis] * np.round(difference[:, axis] / box[axis])
    return {(a, b) for a, b in zip(i[near], j[near])} if (near := np.hypot(*difference.T) < cutoff).any() else set()


def as_set(pairs):
    found = {(min(a, b), max(a, b)) for a, b in pairs.tolist()}
    assert len(found) == len(pairs), "a pair is listed twice"
    return found


BOXES = [None, gridlock.Box(1.0, 1.0), gridlock.Box(2.0, 0.7), gridlock.Box(1.0, 1.0, periodic=False), gridlock.Box(0.3, 3.0),
         gridlock.Box(2.0, 0.7, (True, False)), gridlock.Box(2.0, 0.7, (False, True))]


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("count", [0, 1, 2, 3, 17, 200])
@pytest.mark.parametrize("share", [0.01, 0.2, 0.5])
@pytest.mark.parametrize("threads", [1, 2])
def test_pairs_are_those_of_brute_force(box, count, share, threads):
    random = np.random.default_rng(count)
    sides = (1.0, 1.0) if box is None else box[:2]
    # A third of the points lie outside the box, or exactly on its edges.
    points = random.random((count, 2)) * sides
    points[: count // 6] += np.array(sides) * random.integers(-2, 3, (count // 6, 2))
    points[count // 6 : count // 4] = np.round(points[count // 6 : count // 4] / sides) * sides
    cutoff = share * min(sides)
    expected = brute_force(points, cutoff, box)
    assert as_set(gridlock.pairs(points, cutoff, box, threads=threads)) == expected
    found = gridlock.neighbors(points, cutoff, box, threads=threads)
    assert len(found.indptr) == count + 1
    for i in range(count):
        others = sorted({b for a, b in expected if a == i} | {a for a, b in expected if b == i})
        assert sorted(found.of(i).tolist()) == others


@pytest.mark.parametrize("box", [1.0, None])
def test_pairs_are_those_of_scipy(box):
    points = np.random.default_rng(5).random((20_000, 2))
    cutoff = 0.012
    expected = cKDTree(points, boxsize=box).query_pairs(cutoff, output_type="ndarray")
    assert as_set(gridlock.pairs(points, cutoff, box)) == {(a, b) for a, b in expected.tolist()}


@pytest.mark.parametrize("sides", [(1.0, 1.0), (2.0, 0.7)])
def test_pairs_are_those_of_freud(sides):
    freud = pytest.importorskip("freud")
    points = np.random.default_rng(6).random((20_000, 2)) * sides
    cutoff = 0.012
    # freud counts with single precision around the middle of the box: what lies at the cutoff itself may be on either side.
    centred = np.column_stack([points - np.array(sides) / 2, np.zeros(len(points))])
    query = freud.locality.AABBQuery(freud.box.Box(*sides, is2D=True), centred)
    i, j = query.query(centred, {"r_max": cutoff, "exclude_ii": True}).toNeighborList()[:].T
    theirs = {(a, b) for a, b in zip(i.tolist(), j.tolist()) if a < b}
    ours = as_set(gridlock.pairs(points, cutoff, sides))
    away = gridlock.separations(points, *np.array(sorted(ours ^ theirs), dtype=np.int64).reshape(-1, 2).T, sides)
    assert len(ours) > 10_000 and np.all(np.abs(np.hypot(*away.T) - cutoff) < 1e-6)


def test_the_order_does_not_depend_on_the_number_of_threads():
    points = np.random.default_rng(2).random((5000, 2))
    one = gridlock.pairs(points, 0.03, box=1.0)
    for threads in (2, 3, 8, 0):
        assert np.array_equal(one, gridlock.pairs(points, 0.03, box=1.0, threads=threads))
        assert all(np.array_equal(a, b) for a, b in zip(
            gridlock.neighbors(points, 0.03, box=1.0), gridlock.neighbors(points, 0.03, box=1.0, threads=threads)))


def test_points_far_from_zero_and_on_a_line_are_searched():
    line = np.stack([1e6 + np.arange(1000) * 0.5, np.full(1000, -3e5)], axis=1)
    assert len(gridlock.pairs(line, 0.6)) == 999
    same = np.ones((50, 2))
    assert len(gridlock.pairs(same, 0.1)) == 50 * 49 / 2


def test_other_types_and_strides_are_read():
    points = np.random.default_rng(3).random((100, 3))
    expected = as_set(gridlock.pairs(np.ascontiguousarray(points[:, :2]), 0.2, box=1.0))
    assert as_set(gridlock.pairs(points[:, :2], 0.2, box=1.0)) == expected
    assert as_set(gridlock.pairs(points[::-1, :2][::-1], 0.2, box=1.0)) == expected
    assert as_set(gridlock.pairs(points[:, :2].tolist(), 0.2, box=1.0)) == expected
    assert len(gridlock.pairs(points[:, :2].astype(np.float32), 0.2, box=1.0)) > 0


@pytest.mark.parametrize(
    ("points", "cutoff", "box", "words"),
    [
        ([[0.1, np.nan]], 0.1, 1.0, "point 0 is at"),
        ([[0.1, 0.2], [np.inf, 0.2]], 0.1, None, "point 1 is at"),
        ([[0.1, 0.2, 0.3]], 0.1, 1.0, "shape (1, 3)"),
        ([0.1, 0.2, 0.3], 0.1, 1.0, "shape (3,)"),
        ([["a", "b"]], 0.1, 1.0, "no array of numbers"),
        ([[0.1, 0.2]], -0.1, 1.0, "the cutoff is -0.1"),
        ([[0.1, 0.2]], np.nan, 1.0, "the cutoff"),
        ([[0.1, 0.2]], 0.6, 1.0, "more than half a side"),
        ([[0.1, 0.2]], 0.1, (1.0, -1.0), "box"),
        ([[0.1, 0.2]], 0.1, (1.0,), "is no box"),
        ([[0.1, 0.2]], 0.1, "square", "is no box"),
        ([[1e70, 0.0], [0.0, 0.0]], 0.1, None, "span"),
    ],
)
def test_bad_input_is_refused(points, cutoff, box, words):
    with pytest.raises(gridlock.Error, match=words.replace("(", r"\(").replace(")", r"\)")):
        gridlock.pairs(points, cutoff, box)
    with pytest.raises(gridlock.Error):
        gridlock.neighbors(points, cutoff, box)


@pytest.mark.parametrize("threads", [-1, 1.5, True, "two"])
def test_bad_numbers_of_threads_are_refused(threads):
    with pytest.raises(gridlock.Error, match="threads"):
        gridlock.pairs([[0.1, 0.2]], 0.1, threads=threads)


@pytest.mark.parametrize("box", BOXES[1:])
@pytest.mark.parametrize("count", [0, 1, 500])
def test_a_device_finds_what_the_cores_find(box, count):
    points = np.random.default_rng(3).uniform(-1.0, 2.0, (count, 2))
    try:
        found = gridlock.pairs(points, 0.05, box, device="gpu")
    except gridlock.Error as error:
        assert "graphics processor" in str(error)  # a package that was built for none, or a machine that has none
        return
    assert np.array_equal(found, gridlock.pairs(points, 0.05, box))
    lists = gridlock.neighbors(points, 0.05, box, device="gpu")
    assert all(np.array_equal(a, b) for a, b in zip(lists, gridlock.neighbors(points, 0.05, box)))


def test_bad_devices_are_refused():
    with pytest.raises(gridlock.Error, match="the device is 'tpu'"):
        gridlock.pairs([[0.1, 0.2]], 0.1, box=1.0, device="tpu")
    with pytest.raises(gridlock.Error, match="there is none"):
        gridlock.neighbors([[0.1, 0.2]], 0.1, device="gpu")


def test_arrays_outlive_the_search():
    found = [gridlock.pairs(np.random.default_rng(k).random((100, 2)), 0.1, box=1.0) for k in range(100)]
    again = [gridlock.pairs(np.random.default_rng(k).random((100, 2)), 0.1, box=1.0) for k in range(100)]
    assert all(np.array_equal(a, b) for a, b in zip(found, again))


@pytest.mark.parametrize("box", [box for box in BOXES if box is not None])
@pytest.mark.parametrize("ratio", [1.0, 3.0, 20.0])
@pytest.mark.parametrize("reach", [{}, {"factor": 1.5}, {"gap": 0.01}])
def test_pairs_of_disks_are_those_of_brute_force(box, ratio, reach):
    random = np.random.default_rng(5)
    points = random.random((300, 2)) * box[:2]
    radius = np.where(random.random(300) < 0.1, 1.0, 1.0 / ratio) * 0.05 * min(box[:2])
    contact = reach.get("factor", 1.0) * (radius[:, None] + radius) + reach.get("gap", 0.0)
    difference = points[:, None] - points
    periods = np.where([box.periodic_x, box.periodic_y], box[:2], np.inf)
    difference -= np.array(box[:2]) * np.round(difference / periods)
    near = np.argwhere(np.triu(np.hypot(difference[..., 0], difference[..., 1]) < contact, k=1))
    assert len(near) > 0
    for threads in (1, 2):
        assert as_set(gridlock.pairs_of_disks(points, radius, box, threads=threads, **reach)) == {(i, j) for i, j in near.tolist()}


def test_pairs_of_disks_take_one_radius_for_all_and_refuse_what_is_none():
    points = [[0.1, 0.1], [0.2, 0.1]]
    assert gridlock.pairs_of_disks(points, 0.06, 1.0).tolist() == [[0, 1]]
    assert gridlock.pairs_of_disks(points, 0.04, 1.0).tolist() == []
    assert gridlock.pairs_of_disks(np.empty((0, 2)), [], 1.0).shape == (0, 2)
    for radius in ([0.1], [0.1, -0.1], [0.1, 0.0], [0.1, np.nan], "x", [[0.1, 0.1]], 0.0, None):
        with pytest.raises(gridlock.Error):
            gridlock.pairs_of_disks(points, radius, 1.0)
    for wrong in ({"factor": 0.0}, {"factor": np.inf}, {"gap": -0.1}, {"gap": np.nan}, {"factor": 20.0}):
        with pytest.raises(gridlock.Error):
            gridlock.pairs_of_disks(points, 0.06, 1.0, **wrong)
    with pytest.raises(gridlock.Error, match="there is no box"):
        gridlock.pairs_of_disks(points, 0.06, None)
