"""Order and defects of crystals, against direct sums and exact cases."""

import numpy as np
import pytest

import gridlock

HEIGHT = np.sqrt(0.75)


def lattice(noise, seed=1, columns=24, rows=28):
    """A triangular lattice of spacing 1 with Gaussian displacements, and its box."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    points = np.stack([(x + 0.5 * (y % 2)).ravel(), (y * HEIGHT).ravel()], axis=1)
    return points + noise * np.random.default_rng(seed).standard_normal(points.shape), (float(columns), rows * HEIGHT)


def test_the_correlation_of_an_order_is_the_mean_over_pairs():
    random = np.random.default_rng(4)
    points, order = random.random((80, 2)), random.random(80) + 1j * random.random(80)
    found = gridlock.order_correlation(points, order, 1.0, range=0.4, bins=4)
    i, j = np.triu_indices(80, 1)
    r = np.hypot(*gridlock.separations(points, i, j, 1.0).T)
    products = (order[i].conj() * order[j]).real
    counts, _ = np.histogram(r, bins=4, range=(0, 0.4))
    sums, _ = np.histogram(r, bins=4, range=(0, 0.4), weights=products)
    assert np.allclose(found.correlation, sums / counts, rtol=1e-12)
    assert np.array_equal(found.g, gridlock.pair_correlation(points, 1.0, range=0.4, bins=4).g)
    assert np.array_equal(gridlock.order_correlation(points, order, 1.0, range=0.4, bins=4, threads=2).correlation, found.correlation)


@pytest.mark.parametrize("noise, hexatic, bragg", [(0.05, 0.83455533, 0.87669623), (0.10, 0.48130294, 0.59074023)])
def test_a_lattice_with_noise_has_the_exact_correlations_and_bragg_peak(noise, hexatic, bragg):
    bonds = gridlock.neighbors(lattice(0.0)[0], 1.2, lattice(0.0)[1])
    values = []
    for seed in range(8):
        points, box = lattice(noise, seed)
        psi = gridlock.bond_orientation(points, box=box, neighbors=bonds)
        peak = gridlock.structure_peak(points, box, near=(0.2, 7.0))
        assert np.allclose(peak.at, [0, 4 * np.pi / np.sqrt(3)])
        g6 = gridlock.order_correlation(points, psi, box, range=12.0, bins=2).correlation[1]
        positional = gridlock.order_correlation(points, np.exp(1j * points @ peak.at), box, range=12.0, bins=2).correlation[1]
        values.append([g6, positional, peak.height])
    means, errors = np.mean(values, axis=0), np.std(values, axis=0, ddof=1) / np.sqrt(8)
    assert np.all(abs(means - [hexatic, bragg, bragg + (1 - bragg) / 672]) < 4.5 * errors)  # Student's t of 7


def test_the_default_peak_is_that_of_the_crystal_however_it_is_turned():
    points, box = lattice(0.05)
    for peak in (gridlock.structure_peak(points, box), gridlock.structure_peak(points[:, ::-1], box[::-1], threads=2)):
        assert np.isclose(np.hypot(*peak.at), 4 * np.pi / np.sqrt(3)) and peak.height > 0.8
        assert peak.s.shape == (len(peak.wave_vectors),)


@pytest.mark.parametrize("turn", [0, 1, 3])
def test_the_default_peak_of_a_square_lattice_is_a_bragg_peak(turn):
    # Sites of a square lattice with the bond (m, n) along x fit into a periodic square of m² + n² rows, with bonds turned by atan(n/m).
    m, n = 4, turn
    side = m * m + n * n
    sites = np.array([[i * m - j * n, i * n + j * m] for i in range(side) for j in range(side)]) % side
    points = np.unique(sites, axis=0) / np.sqrt(side)
    points = points + np.random.default_rng(1).normal(scale=0.03, size=points.shape)
    peak = gridlock.structure_peak(points, side / np.sqrt(side))
    assert np.isclose(np.hypot(*peak.at), 2 * np.pi) and peak.height > 0.9


def test_a_map_along_the_rows_has_its_maxima_at_the_sites():
    points, box = lattice(0.05)
    psi = gridlock.bond_orientation(points, 1.5, box)
    found = gridlock.pair_correlation_map(points, box, half=(3.5, 0.25), bins=(14, 1), angle=np.angle(psi.mean()) / 6, order=psi)
    on_sites = abs(found.x - np.round(found.x)) < 0.3
    assert found.g.shape == found.order_correlation.shape == (1, 14)
    assert found.g[0, on_sites & (abs(found.x) > 0.5)].min() > 1.5
    assert gridlock.pair_correlation_map(points, box, half=(1.0, 1.0), bins=(2, 3)).order_correlation is None


def test_defects_are_the_cells_without_six_sides_in_clusters_without_charge():
    points, box = lattice(0.15)
    found = gridlock.defects(points, box, threads=2)
    sides = gridlock.voronoi(points, box).sides
    assert np.array_equal(found.sides, sides) and np.array_equal(found.cluster >= 0, sides != 6)
    assert found.charge.sum() == 0 and found.size.sum() == (sides != 6).sum()
    assert np.array_equal(np.bincount(found.cluster[found.cluster >= 0], weights=6 - sides[found.cluster >= 0]), found.charge)
    assert found.share() == (sides != 6).mean() > found.share("dislocation_pair") > 0
    with pytest.raises(gridlock.Error, match="the kind is 'vacancy'"):
        found.share("vacancy")


def test_weights_by_edges_are_those_of_the_cells():
    points, box = lattice(0.1)
    cells = gridlock.voronoi(points, box)
    weighted = gridlock.bond_orientation(points, box=box, neighbors=cells.neighbors, weights=cells.edge_lengths)
    r = gridlock.separations(points, cells.neighbors.owners, cells.neighbors.indices, box)
    terms = cells.edge_lengths * np.exp(6j * np.arctan2(r[:, 1], r[:, 0]))
    own = slice(*cells.neighbors.indptr[:2].astype(int))
    assert np.isclose(weighted[0], terms[own].sum() / cells.edge_lengths[own].sum())
    same = gridlock.bond_orientation(points, box=box, neighbors=cells.neighbors, weights=np.full(len(r), 2.5))
    assert np.allclose(same, gridlock.bond_orientation(points, box=box, neighbors=cells.neighbors))
    for refused in ([1.0], -cells.edge_lengths):
        with pytest.raises(gridlock.Error, match="the weights have the shape"):
            gridlock.bond_orientation(points, box=box, neighbors=cells.neighbors, weights=refused)
    with pytest.raises(gridlock.Error, match="the weights have the shape"):
        gridlock.bond_orientation(points, 1.5, box, weights=cells.edge_lengths)


def test_a_run_measures_them_on_request():
    simulation = gridlock.Simulation(
        disks={"count": 400, "packing_fraction": 0.76, "start": "triangular"}, box={"edge": "periodic"}, engine={"kind": "exact"},
        observe={"every": 20, "structure_every": 1, "orientation_correlation": True, "defects_every": 1, "pair_correlation_bins": 20},
    )
    simulation.run(steps=100)
    curve = simulation.distributions["pair_correlation"]
    assert curve["orientation_correlation"][-1] > 0.3 and np.isnan(curve["orientation_correlation"][0])
    results = simulation.results
    parts = ("disclination", "dislocation", "dislocation_pair", "other_defect")
    assert np.isclose(results["defect_fraction"].value, sum(results[f"{part}_fraction"].value for part in parts))
    frame = simulation.agents.positions, simulation.box
    assert simulation.series["defect_fraction"][-1] == gridlock.defects(*frame).share()


@pytest.mark.parametrize("call, message", [
    (lambda: gridlock.order_correlation([[0.1, 0.1]], [1, 2], 1.0, range=0.1), "the orders have the shape"),
    (lambda: gridlock.order_correlation([[0.1, 0.1]], [1], None, range=0.1), "needs a box that is periodic"),
    (lambda: gridlock.structure_peak([[0.1, 0.1]], 1.0, near=[1, 2, 3]), "the middle of the square has the shape"),
    (lambda: gridlock.structure_peak([[0.1, 0.1]], 1.0, near=[1, 2], half_width=0.1), "no wave vector of the box"),
    (lambda: gridlock.defects([[0.1, 0.1]], None), "need a box"),
])
def test_what_cannot_be_measured_is_refused(call, message):
    with pytest.raises(gridlock.Error, match=message):
        call()
