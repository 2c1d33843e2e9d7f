"""Analysis of arrays, against direct sums and exact cases."""

import numpy as np
import pytest

import gridlock


def test_pair_correlation_is_that_of_the_run():
    simulation = gridlock.Simulation(
        disks={"count": 400, "packing_fraction": 0.5}, box={"edge": "periodic"}, engine={"kind": "exact"},
        observe={"every": 100, "structure_every": 1, "pair_correlation_bins": 50},
    )
    simulation.equilibrate(steps=200)
    sums = []
    curve = None
    for _ in range(3):
        simulation.run(steps=100)
        curve = simulation.distributions["pair_correlation"]
        width = curve["distance"][1] - curve["distance"][0]
        sums.append(gridlock.pair_correlation(
            simulation.agents.positions, simulation.box, range=width * len(curve), bins=len(curve)).g)
    assert np.allclose(np.mean(sums, axis=0), curve["pair_correlation"], rtol=0, atol=1e-9)


def test_sixfold_order_is_that_of_a_triangular_lattice():
    rows = np.arange(10)
    points = np.array([[x + 0.5 * (y % 2), y * np.sqrt(0.75)] for y in rows for x in rows])
    psi = gridlock.bond_orientation(points, 1.2, box=(10.0, 10 * np.sqrt(0.75)))
    assert np.allclose(psi, psi[0]) and np.allclose(abs(psi), 1)
    assert (gridlock.bond_orientation([[0.0, 0.0]], 1.0) == 0).all()


@pytest.mark.parametrize("drift", [True, False])
def test_mean_squared_displacement_is_that_of_the_definition(drift):
    positions = np.random.default_rng(1).normal(size=(30, 5, 2)).cumsum(axis=0) + 100
    moved = positions if drift else positions - positions.mean(axis=1, keepdims=True)
    expected = [np.mean(((moved[lag:] - moved[: 30 - lag]) ** 2).sum(axis=2)) for lag in range(30)]
    assert np.allclose(gridlock.mean_squared_displacement(positions, drift=drift), expected, rtol=1e-9, atol=1e-9)


def test_structure_factor_is_that_of_the_definition():
    points = np.random.default_rng(4).random((50, 2)) * [2.0, 1.0]
    found = gridlock.structure_factor(points, (2.0, 1.0), largest_q=12.0, bins=1)
    vectors = [(i, j) for i in range(-20, 21) for j in range(-20, 21) if (i, j) != (0, 0)]
    q = 2 * np.pi * np.array([(i / 2.0, j / 1.0) for i, j in vectors])
    q = q[np.hypot(*q.T) <= 12.0]
    direct = np.abs(np.exp(1j * points @ q.T).sum(axis=0)) ** 2 / 50
    assert found.s[0] == pytest.approx(direct.mean(), rel=1e-12)


def test_rings_have_the_vectors_at_their_end():
    points = np.random.default_rng(3).random((50, 2))
    for k in (11, 15, 22, 30):
        found = gridlock.structure_factor(points, 1.0, largest_q=2 * np.pi * k, bins=1)
        n = np.arange(-k, k + 1)
        i, j = (grid.ravel() for grid in np.meshgrid(n, n))
        wanted = (i**2 + j**2 <= k * k) & ((i != 0) | (j != 0))
        q = 2 * np.pi * np.stack([i, j], axis=1)[wanted]
        direct = np.abs(np.exp(1j * points @ q.T).sum(axis=0)) ** 2 / 50
        assert found.s[0] == pytest.approx(direct.mean(), rel=1e-9), k


@pytest.mark.parametrize("call", [
    lambda: gridlock.structure_factor([[np.nan, 0.1]], 1.0, largest_q=10.0),
    lambda: gridlock.structure_factor([[0.1, 0.1]], 1.0, largest_q=-1.0),
    lambda: gridlock.pair_correlation([[0.1, 0.1]], None, range=0.1),
    lambda: gridlock.pair_correlation([[0.1, 0.1]], gridlock.Box(1, 1, False), range=0.1),
    lambda: gridlock.pair_correlation([[0.1, 0.1]], 1.0, range=0.9),
    lambda: gridlock.structure_factor([[0.1, 0.1]], None, largest_q=10.0),
    lambda: gridlock.mean_squared_displacement([[1.0, 2.0]]),
    lambda: gridlock.mean_squared_displacement(np.full((3, 2, 2), np.nan)),
])
def test_bad_input_is_refused(call):
    with pytest.raises(gridlock.Error):
        call()
