"""χ₄, displacements relative to cages, collective F(q, t), van Hove functions and strings, against direct sums and exact limits."""

import numpy as np
import pytest

import gridlock


def walk(frames, agents, seed=1):
    """Independent walkers, D = 1/2, that start anywhere in a box of side 20."""
    random = np.random.default_rng(seed)
    return random.uniform(0, 20, (agents, 2)) + random.normal(size=(frames, agents, 2)).cumsum(axis=0)


def relative_to(neighbors, positions, lag):
    """The displacements of all origins relative to the mean of the neighbours at the origin, shape (origins, N, 2)."""
    moved = positions[lag:] - positions[:-lag]
    return np.array([move - np.nan_to_num(found.mean(move)) for move, found in zip(moved, neighbors)])


def test_displacements_are_relative_to_the_neighbours_at_the_origin():
    positions = walk(8, 60)
    for choice, lists in (
        (3.0, [gridlock.neighbors(frame, 3.0, 20.0) for frame in positions]),
        ("voronoi", [gridlock.voronoi(np.mod(frame, 20.0), 20.0).neighbors for frame in positions]),
    ):
        found = gridlock.dynamics(positions, overlap_length=1.2, neighbors=choice, box=20.0)
        given = gridlock.dynamics(positions, overlap_length=1.2, neighbors=lists)
        for lag in (1, 4):
            square = (relative_to(lists, positions, lag) ** 2).sum(axis=2)
            assert found.msd[lag - 1] == given.msd[lag - 1] == pytest.approx(square.mean())
            assert found.overlap[lag - 1] == given.overlap[lag - 1] == pytest.approx((square <= 1.44).mean())


def test_one_list_of_neighbours_is_for_all_frames_and_without_a_box_there_are_no_images():
    positions = walk(8, 60)
    bonds = gridlock.neighbors(positions[0], 2.0)
    found = gridlock.dynamics(positions, neighbors=bonds)
    assert found.msd[2] == pytest.approx((relative_to([bonds] * 8, positions, 3) ** 2).sum(axis=2).mean())
    searched = [gridlock.neighbors(frame, 2.0) for frame in positions]
    open_plane = gridlock.dynamics(positions, neighbors=2.0)
    assert open_plane.msd[2] == pytest.approx((relative_to(searched, positions, 3) ** 2).sum(axis=2).mean())


def test_susceptibility_is_the_variance_of_the_overlap_of_origins_that_do_not_meet():
    positions = walk(30, 40)
    kinds = np.arange(40) % 2
    found = gridlock.dynamics(positions, kinds=kinds, overlap_length=1.5)
    for lag in (1, 5):
        near = ((positions[lag:] - positions[:-lag]) ** 2).sum(axis=2) <= 2.25
        for q, n, value in [(near.mean(axis=1), 40, found.total_susceptibility[lag - 1])] + [
                (near[:, kinds == kind].mean(axis=1), 20, found.susceptibility[kind, lag - 1]) for kind in (0, 1)]:
            apart = [(q[a] - q[b]) ** 2 for a in range(len(q)) for b in range(a + lag, len(q))]
            assert value == pytest.approx(0.5 * n * np.mean(apart))
    alone = gridlock.dynamics(positions, overlap_length=1.5)
    assert np.array_equal(alone.susceptibility, found.total_susceptibility, equal_nan=True)
    assert found.susceptibility.shape == (2, 29) and np.isnan(found.susceptibility[:, 20:]).all()
    assert gridlock.dynamics(positions).susceptibility is None


def test_collective_scattering_is_that_of_the_structure_factor_and_of_independent_walkers():
    positions = walk(200, 80)
    kinds = np.arange(80) % 2
    found = gridlock.collective_scattering(positions, box=20.0, q=1.0, width=0.3, kinds=kinds, lags=8)
    assert found.lag[0] == 0 and found.scattering.shape == (2, 2, len(found.lag)) and found.origins[0] == 200
    known = found.independent_origins > 20
    exact = np.eye(2)[:, :, None] * np.exp(-0.5 * found.q**2 * found.lag)
    assert (abs(found.scattering - exact) < 4.5 * found.scattering_error)[:, :, known].all()
    still = gridlock.collective_scattering(positions[:1].repeat(2, axis=0), box=20.0, q=2 * np.pi / 20, width=1e-6)
    direct = [abs(np.exp(2j * np.pi / 20 * positions[0, :, axis]).sum()) ** 2 / 80 for axis in (0, 1)]
    assert still.vectors == 2 and still.scattering == pytest.approx([np.mean(direct)] * 2)


def test_van_hove_functions_of_one_frame_are_the_pair_correlation():
    positions = walk(3, 200)
    found = gridlock.van_hove(positions, lags=[0.0, 1.0], range=6.0, bins=6, box=20.0)
    g = np.mean([gridlock.pair_correlation(frame, 20.0, range=6.0, bins=6).g for frame in positions], axis=0)
    assert found.distinct_part[0] == pytest.approx(g)
    assert found.lag.tolist() == [0.0, 1.0] and found.self_part.shape == found.distinct_error.shape == (2, 6)
    moved = np.sqrt(((positions[1:] - positions[:-1]) ** 2).sum(axis=2))
    counts = np.histogram(moved, bins=6, range=(0, 6))[0] / moved.size
    assert found.self_part[1] == pytest.approx(counts / (np.pi * np.diff(np.arange(7.0) ** 2)))
    mixture = gridlock.van_hove(positions, lags=1.0, range=6.0, bins=6, kinds=np.arange(200) % 2, origins=1)
    assert mixture.self_part.shape == (1, 2, 6) and mixture.distinct_part is None and mixture.origins.tolist() == [1]
    assert np.isnan(mixture.self_error).all()


def test_strings_are_those_of_a_drawing():
    # Two agents follow one another, one moves alone, three stay.
    before = np.array([[1.0, 1.0], [2.0, 1.0], [5.0, 5.0], [8.0, 8.0], [8.0, 2.0], [2.0, 8.0]])
    after = before + [[1.1, 0.0], [1.0, 0.1], [0.0, 1.2], [0.0, 0.0], [0.1, 0.0], [0.0, 0.0]]
    found = gridlock.string_lengths([before, after], lags=[1.0, 0.7], distance=0.3, mobile=0.5, box=10.0)
    assert found.mobile_agents == 3 and found.strings.tolist() == [[1.0, 1.0]] * 2
    assert found.mean_length == pytest.approx(1.5) and found.weighted_length == pytest.approx(5 / 3)
    assert found.lag.tolist() == [1.0, 1.0] and np.isnan(found.mean_length_error).all()


@pytest.mark.parametrize("call", [
    lambda: gridlock.dynamics(walk(3, 5), neighbors="voronoi"),
    lambda: gridlock.dynamics(walk(3, 5), neighbors="cage", box=20.0),
    lambda: gridlock.dynamics(walk(3, 5), neighbors=0.0, box=20.0),
    lambda: gridlock.dynamics(walk(3, 5), neighbors=11.0, box=20.0),
    lambda: gridlock.dynamics(walk(3, 5), box=20.0),
    lambda: gridlock.dynamics(walk(3, 5), neighbors=[gridlock.neighbors(walk(1, 5)[0], 2.0)]),
    lambda: gridlock.dynamics(walk(3, 5), neighbors=gridlock.neighbors(walk(1, 6)[0], 2.0)),
    lambda: gridlock.collective_scattering(walk(3, 5), box=20.0, q=0.01, width=0.001),
    lambda: gridlock.collective_scattering(walk(3, 5), box=None, q=1.0),
    lambda: gridlock.collective_scattering(walk(3, 5), box=gridlock.Box(20.0, 20.0, periodic=False), q=1.0),
    lambda: gridlock.van_hove(walk(3, 5), lags=-1.0, range=2.0),
    lambda: gridlock.van_hove(walk(3, 5), lags=1.0, range=12.0, box=20.0),
    lambda: gridlock.van_hove(walk(3, 5), lags=1.0, range=12.0, bins=0),
    lambda: gridlock.van_hove(walk(3, 5), lags="a", range=12.0),
    lambda: gridlock.van_hove(walk(3, 5), lags=[1.0, 2.1], range=2.0),
    lambda: gridlock.string_lengths(walk(3, 5), lags=1.0, distance=0.0),
    lambda: gridlock.string_lengths(walk(3, 5), lags=1.0, distance=0.5, mobile=1.5),
    lambda: gridlock.string_lengths(walk(3, 5), lags=3.0, distance=0.5),
])
def test_bad_input_is_refused(call):
    with pytest.raises(gridlock.Error, match="hint"):
        call()
