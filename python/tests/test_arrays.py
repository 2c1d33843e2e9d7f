"""Every function of arrays refuses what it cannot use: what, the number, and a hint; never an error of the binding."""

import numpy as np
import pytest

import gridlock
from gridlock.arrays import as_count

GOOD = np.random.default_rng(1).random((20, 2))
WALK = np.random.default_rng(1).random((5, 4, 2))

BAD_POINTS = {
    "masked": np.ma.masked_greater(GOOD, 0.9),
    "complex": GOOD + 0j,
    "objects": np.array([[object(), 1.0]]),
    "none": None,
    "texts": [["0.1", "0.2"]],
    "text": "points",
    "booleans": GOOD > 0.5,
    "dates": np.array([["2026-01-01", "2026-01-02"]], dtype="datetime64[D]"),
    "ragged": [[0.1, 0.2], [0.3]],
    "not a number": [[0.1, np.nan]],
    "infinite": [[0.1, np.inf]],
    "three columns": np.zeros((4, 3)),
    "one column": np.zeros(4),
    "number": 3.0,
    "dictionary": {"x": [1.0], "y": [1.0]},
}

FUNCTIONS = {
    "pairs": lambda points: gridlock.pairs(points, 0.1, 1.0),
    "neighbors": lambda points: gridlock.neighbors(points, 0.1),
    "pair_correlation": lambda points: gridlock.pair_correlation(points, 1.0, range=0.1),
    "voronoi": lambda points: gridlock.voronoi(points, 1.0),
    "bond_orientation": lambda points: gridlock.bond_orientation(points, 0.1, 1.0),
    "structure_factor": lambda points: gridlock.structure_factor(points, 1.0, largest_q=20.0),
    "clusters": lambda points: gridlock.clusters(points, 0.01, 1.0),
    "density_profile": lambda points: gridlock.density_profile(points, 1.0),
    "contacts": lambda points: gridlock.contacts(points, 0.001, 1.0),
    "spectral_density": lambda points: gridlock.spectral_density(points, 0.001, 1.0, largest_q=20.0),
    "dynamics": lambda points: gridlock.dynamics(points),
    "mean_squared_displacement": lambda points: gridlock.mean_squared_displacement(points),
}


@pytest.mark.parametrize("points", BAD_POINTS.values(), ids=BAD_POINTS)
@pytest.mark.parametrize("function", FUNCTIONS.values(), ids=FUNCTIONS)
def test_bad_points_are_refused(function, points):
    with pytest.raises(gridlock.Error, match="hint"):
        function(points)


BAD_NUMBERS = ["x", None, -0.1, 0, np.nan, np.inf, 1j, True, [0.1], object(), np.array([0.1])]
NUMBERS = {
    "pairs": lambda value: gridlock.pairs(GOOD, value, 1.0),
    "neighbors": lambda value: gridlock.neighbors(GOOD, value),
    "pair_correlation": lambda value: gridlock.pair_correlation(GOOD, 1.0, range=value),
    "bond_orientation": lambda value: gridlock.bond_orientation(GOOD, value, 1.0),
    "structure_factor": lambda value: gridlock.structure_factor(GOOD, 1.0, largest_q=value),
    "cutoff of clusters": lambda value: gridlock.clusters(GOOD, 0.001, 1.0, cutoff=value),
    "box of a profile": lambda value: gridlock.density_profile(GOOD, value),
    "radius": lambda value: gridlock.contacts(GOOD, value, 1.0),
    "residual": lambda value: gridlock.contacts(GOOD, 0.001, 1.0, residual=value),
    "radius of a spectrum": lambda value: gridlock.spectral_density(GOOD, value, 1.0, largest_q=20.0),
    "largest_q": lambda value: gridlock.spectral_density(GOOD, 0.001, 1.0, largest_q=value),
    "q": lambda value: gridlock.dynamics(WALK, q=value) if value is not None else gridlock.dynamics(WALK, q="x"),
    "box": lambda value: gridlock.voronoi(GOOD, value),
    "side": lambda value: gridlock.voronoi(GOOD, (1.0, value)),
    "width": lambda value: gridlock.pairs(GOOD, 0.1, gridlock.Box(value, 1.0)),
}


@pytest.mark.parametrize("value", BAD_NUMBERS, ids=repr)
@pytest.mark.parametrize("function", NUMBERS.values(), ids=NUMBERS)
def test_bad_numbers_are_refused(function, value):
    with pytest.raises(gridlock.Error, match="hint"):
        function(value)


BAD_COUNTS = ["5", 0, -1, 2.5, True, np.nan, [5], 2**40]
COUNTS = {
    "bins of g(r)": lambda value: gridlock.pair_correlation(GOOD, 1.0, range=0.1, bins=value),
    "bins of S(q)": lambda value: gridlock.structure_factor(GOOD, 1.0, largest_q=20.0, bins=value),
    "bins of χ(q)": lambda value: gridlock.spectral_density(GOOD, 0.001, 1.0, largest_q=20.0, bins=value),
    "bins of a profile": lambda value: gridlock.density_profile(GOOD, 1.0, bins=value),
    "lags": lambda value: gridlock.dynamics(WALK, lags=value),
    "k": lambda value: gridlock.bond_orientation(GOOD, 0.2, 1.0, k=value),
}


@pytest.mark.parametrize("value", BAD_COUNTS, ids=repr)
@pytest.mark.parametrize("function", COUNTS.values(), ids=COUNTS)
def test_bad_counts_are_refused(function, value):
    with pytest.raises(gridlock.Error, match="hint"):
        function(value)


@pytest.mark.parametrize("call", [
    lambda: gridlock.pair_correlation(GOOD, None, range=0.1),
    lambda: gridlock.pair_correlation(GOOD, gridlock.Box(1, 1, False), range=0.1),
    lambda: gridlock.pair_correlation(GOOD, 1.0, range=0.9),
    lambda: gridlock.pair_correlation(GOOD, 1.0, range=0.1, kinds=[0, 1]),
    lambda: gridlock.pair_correlation(GOOD, 1.0, range=0.1, kinds=GOOD[:, 0]),
    lambda: gridlock.pair_correlation(np.zeros((5000, 2)), 1.0, range=0.1, kinds=np.arange(5000)),
    lambda: gridlock.clusters(GOOD, [0.001], 1.0),
    lambda: gridlock.density_profile(GOOD, 1.0, axis="z"),
    lambda: gridlock.density_profile(GOOD, 1.0, radius=2.0),
    lambda: gridlock.density_profile([[0.1, 1.1]], gridlock.Box(1, 1, False)),
    lambda: gridlock.structure_factor(GOOD, None, largest_q=10.0),
    lambda: gridlock.voronoi(GOOD, None),
    lambda: gridlock.voronoi([[0.1, 0.1], [0.1, 0.1]], 1.0),
    lambda: gridlock.voronoi([[0.1, 1.1]], gridlock.Box(1, 1, False)),
    lambda: gridlock.voronoi(GOOD, "box"),
    lambda: gridlock.voronoi(GOOD, (1, 2, 3)),
    lambda: gridlock.voronoi(GOOD, gridlock.Box(1.0, 1.0, "no")),
    lambda: gridlock.pairs(GOOD, 0.1, threads=1.5),
    lambda: gridlock.bond_orientation(GOOD, box=1.0),
    lambda: gridlock.bond_orientation(GOOD, 0.1, 1.0, neighbors=gridlock.neighbors(GOOD, 0.1)),
    lambda: gridlock.bond_orientation(GOOD, box=1.0, neighbors="all"),
    lambda: gridlock.bond_orientation(GOOD, box=1.0, neighbors=gridlock.neighbors(GOOD[:5], 0.1)),
    lambda: gridlock.bond_orientation(GOOD[:2], box=1.0, neighbors=([0, 1, 2], [1, 7])),
])
def test_what_does_not_fit_together_is_refused(call):
    with pytest.raises(gridlock.Error, match="hint"):
        call()


@pytest.mark.parametrize(("i", "j"), [(1, 2), ([1], 2), ([1, 2], [3]), ([[1]], [[2]]), ([1.0], [2.0]), ([True], [False])])
def test_indices_are_two_lists_of_one_length(i, j):
    with pytest.raises(gridlock.Error, match="hint: use two arrays of whole numbers of one length"):
        gridlock.separations(GOOD, i, j)
    assert gridlock.separations(GOOD, [], []).shape == (0, 2)


def test_a_bad_number_is_told_with_its_place():
    with pytest.raises(gridlock.Error, match=r"the times have the value nan at \(2,\)"):
        gridlock.dynamics(WALK, [0.0, 1.0, np.nan, 3.0, 4.0])
    with pytest.raises(gridlock.Error, match="an array with 2 masked values"):
        gridlock.pairs(np.ma.masked_array(GOOD, mask=np.arange(40).reshape(20, 2) < 2), 0.1)


def test_any_array_of_numbers_is_read():
    expected = gridlock.pairs(GOOD, 0.3, 1.0)
    for same in (GOOD.tolist(), np.asfortranarray(GOOD), np.repeat(GOOD, 2, axis=0)[::2], np.ma.array(GOOD)):
        assert np.array_equal(gridlock.pairs(same, np.float32(0.25) + 0.05, np.array(1.0)), expected)
    assert len(gridlock.pairs(np.arange(6, dtype=np.uint8).reshape(3, 2), 3)) == 2
    assert gridlock.pairs([], 0.1).shape == (0, 2) and len(gridlock.voronoi([], 1.0).areas) == 0


def test_a_count_may_be_the_least_and_the_largest_one():
    for least, most in ((1, 2**31 - 1), (0, 5), (7, 7)):
        assert as_count(least, "k", least=least, most=most) == least
        assert as_count(most, "k", least=least, most=most) == most
        for beyond in (least - 1, most + 1):
            with pytest.raises(gridlock.Error, match=f"k is {beyond}"):
                as_count(beyond, "k", least=least, most=most)
    assert as_count(2**31 - 1, "k") == 2**31 - 1


@pytest.mark.parametrize("call", [lambda number: gridlock.pairs(GOOD, number, 1.0), lambda number: gridlock.pairs(GOOD, 0.1, (number, 1.0)),
                                  lambda number: gridlock.pairs(GOOD, 0.1, 1.0, threads=number), lambda number: gridlock.Simulation(threads=number)])
def test_whole_numbers_beyond_all_others_are_refused_in_the_usual_words(call):
    for number in (10**400, 10**5000):
        with pytest.raises(gridlock.Error, match="hint"):
            call(number)


@pytest.mark.parametrize("threads", [2**64, 2**63, -1, True, 1.5, "all"])
def test_threads_are_a_count(threads):
    with pytest.raises(gridlock.Error, match="threads is .*\n  hint: use a whole number, 0 for all cores"):
        gridlock.pairs(GOOD, 0.1, 1.0, threads=threads)
