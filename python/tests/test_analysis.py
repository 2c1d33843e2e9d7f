"""Analysis of arrays, against direct sums and exact cases."""

import numpy as np
import pytest
import scipy.sparse.csgraph
import scipy.spatial

import gridlock
from conftest import OBLONG


def test_pair_correlation_is_that_of_the_run():
    simulation = gridlock.Simulation(
        disks={"count": 400, "packing_fraction": 0.5}, box=OBLONG, engine={"kind": "exact"},
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


def test_partial_pair_correlations_add_up_to_that_of_all():
    points, kinds = np.random.default_rng(2).random((500, 2)), np.arange(500) % 3
    all_pairs = gridlock.pair_correlation(points, 1.0, range=0.4, bins=20)
    partial = gridlock.pair_correlation(points, 1.0, range=0.4, bins=20, kinds=kinds + 7, threads=2)
    n = np.bincount(kinds)
    weights = (np.outer(n, n) - np.diag(n)) / (500 * 499)
    assert partial.g.shape == (3, 3, 20) and np.array_equal(partial.g, partial.g.transpose(1, 0, 2))
    assert np.allclose(np.einsum("ab,abk->k", weights, partial.g), all_pairs.g, rtol=1e-12)
    own = gridlock.pair_correlation(points[kinds == 1], 1.0, range=0.4, bins=20)
    assert np.allclose(partial.g[1, 1], own.g, rtol=1e-12)


def test_pair_correlation_is_that_of_all_distances():
    points = np.random.default_rng(8).random((80, 2)) * [2.0, 1.0]
    found = gridlock.pair_correlation(points, (2.0, 1.0), range=0.5, bins=11)
    d = points[:, None] - points[None]
    d -= [2.0, 1.0] * np.round(d / [2.0, 1.0])
    counts, edges = np.histogram(np.hypot(*np.moveaxis(d, -1, 0))[np.triu_indices(80, 1)], bins=11, range=(0, 0.5))
    assert np.allclose(found.g, counts * 2.0 / (80 * 79 / 2 * np.pi * np.diff(edges**2)), rtol=1e-12)


@pytest.mark.parametrize("count", [30, 1000])
def test_voronoi_cells_between_walls_are_those_of_scipy(count):
    points = np.random.default_rng(count).random((count, 2)) * [2.0, 1.0]
    found = gridlock.voronoi(points, gridlock.Box(2.0, 1.0, periodic=False))
    # Mirror images behind each wall cut the cells where the walls are.
    x, y = points.T
    mirrored = [np.stack(pair, axis=1) for pair in ((-x, y), (4.0 - x, y), (x, -y), (x, 2.0 - y))]
    diagram = scipy.spatial.Voronoi(np.concatenate([points, *mirrored]))
    expected = {tuple(sorted(pair)) for pair in diagram.ridge_points if max(pair) < count}
    assert {(i, int(j)) for i in range(count) for j in found.neighbors.of(i) if i < j} == expected
    hulls = [scipy.spatial.ConvexHull(diagram.vertices[diagram.regions[diagram.point_region[i]]]) for i in range(count)]
    assert found.areas == pytest.approx([hull.volume for hull in hulls], rel=1e-9)


def test_voronoi_neighbors_in_a_periodic_box_are_those_of_delaunay():
    points = np.random.default_rng(6).random((400, 2))
    found = gridlock.voronoi(points + [3.0, -2.0], 1.0, threads=2)
    images = np.concatenate([points + [a, b] for a in (0, -1, 1) for b in (0, -1, 1)])
    begin, indices = scipy.spatial.Delaunay(images).vertex_neighbor_vertices
    for i in range(400):
        assert sorted(found.neighbors.of(i)) == sorted(indices[begin[i]:begin[i + 1]] % 400)
    assert found.sides.sum() == 6 * 400 and found.areas.sum() == pytest.approx(1.0)


def test_sixfold_order_by_voronoi_neighbors_needs_no_cutoff():
    rows = np.arange(10)
    points = np.array([[x + 0.5 * (y % 2), y * np.sqrt(0.75)] for y in rows for x in rows])
    box = (10.0, 10 * np.sqrt(0.75))
    points += np.random.default_rng(1).normal(size=points.shape) * 0.01
    cells = gridlock.voronoi(points, box)
    assert (cells.sides == 6).all()
    by_cells = gridlock.bond_orientation(points, box=box, neighbors=cells.neighbors)
    assert np.allclose(by_cells, gridlock.bond_orientation(points, 1.3, box)) and (abs(by_cells) > 0.95).all()


@pytest.mark.parametrize("points", [[[0.5, 0.5]], [[0.2, 0.5], [0.8, 0.5]]])
def test_neighbors_of_no_one_direction_are_refused(points):
    cells = gridlock.voronoi(points, 1.0)
    with pytest.raises(gridlock.Error, match="no one direction\n  hint: the box is too small"):
        gridlock.bond_orientation(points, box=1.0, neighbors=cells.neighbors)
    twice = gridlock.Neighbors(np.array([0, 2, 3], np.uint64), np.array([1, 1, 0], np.uint32))
    with pytest.raises(gridlock.Error, match="0 neighbours are the points themselves and 1 stand in a list twice"):
        gridlock.bond_orientation([[0.1, 0.5], [0.2, 0.5]], neighbors=twice)


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


def test_structure_factor_of_a_tall_box_is_that_of_the_wide_one_turned():
    points = np.random.default_rng(9).random((40, 2)) * [5.0, 0.8]
    wide = gridlock.structure_factor(points, (5.0, 0.8), largest_q=25.0, bins=7)
    tall = gridlock.structure_factor(points[:, ::-1], (0.8, 5.0), largest_q=25.0, bins=7)
    assert np.allclose(wide.q, tall.q, rtol=1e-12) and np.allclose(wide.s, tall.s, rtol=1e-9)


@pytest.mark.parametrize("wanted", [
    {"largest_q": 1e6}, {"largest_q": 1e300}, {"largest_q": 20.0, "bins": 2**31 - 1},
    {"largest_q": 20.0, "bins": 10**6, "kinds": np.arange(50)}, {"box": (1e9, 1.0), "largest_q": 20.0},
])
def test_more_wave_vectors_than_fit_are_refused(wanted):
    with pytest.raises(gridlock.Error, match="wave vectors, 50 points, .* GiB of memory; the most is 8\n  hint: use a smaller largest_q"):
        gridlock.structure_factor(np.random.default_rng(1).random((50, 2)), **{"box": 1.0, **wanted})


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


def test_partial_structure_factors_add_up_to_that_of_all():
    points, kinds = np.random.default_rng(5).random((60, 2)), np.arange(60) % 4 // 3
    whole = gridlock.structure_factor(points, 1.0, largest_q=40.0, bins=6)
    partial = gridlock.structure_factor(points, 1.0, largest_q=40.0, bins=6, kinds=kinds)
    n = np.bincount(kinds)
    weights = np.sqrt(np.outer(n, n)) / 60
    assert partial.s.shape == (2, 2, len(whole.q))
    assert np.allclose(np.einsum("ab,abk->k", weights, partial.s), whole.s, rtol=1e-12)
    own = gridlock.structure_factor(points[kinds == 1], 1.0, largest_q=40.0, bins=6)
    assert np.allclose(partial.s[1, 1], own.s) and np.allclose(partial.s[0, 1], partial.s[1, 0])


def observed(settings, **observe):
    """A run that takes one sample that counts, at its end, and its last state."""
    simulation = gridlock.Simulation(**settings, observe={"every": 20, **observe})
    simulation.equilibrate(steps=20)
    simulation.run(steps=20)
    return simulation


SETTINGS = [
    {"disks": {"count": 200, "packing_fraction": 0.4}, "box": OBLONG, "engine": {"kind": "exact"}},
    {"disks": {"count": 150, "packing_fraction": 0.4, "species": [
        {"fraction": 0.5, "size_ratio": 1.0}, {"fraction": 0.5, "size_ratio": 1.4}]}, "box": OBLONG | {"edge": "wall"}},
]


@pytest.mark.parametrize("settings", SETTINGS, ids=["periodic", "mixture between walls"])
def test_clusters_are_those_of_the_run_and_of_scipy(settings):
    simulation = observed(settings, clusters_every=1, cluster_cutoff=1.15)
    centers, radii = simulation.agents.positions, simulation.agents.radius
    found = gridlock.clusters(centers, radii, simulation.box, cutoff=1.15)
    pairs = gridlock.pairs_of_disks(centers, radii, simulation.box, factor=1.15)
    graph = scipy.sparse.coo_array((np.ones(len(pairs)), pairs.T), shape=(len(centers), len(centers)))
    count, labels = scipy.sparse.csgraph.connected_components(graph, directed=False)
    sizes = np.bincount(found)
    assert len(sizes) == count and len(set(zip(found, labels))) == count
    assert (np.diff(sizes) <= 0).all()
    last = simulation.series[-1]
    assert last["largest_cluster_fraction"] == sizes[0] / len(centers)
    assert last["mean_cluster_size"] == len(centers) / len(sizes)
    table = simulation.distributions["cluster_sizes"]
    for row in table:
        assert row["clusters"] == ((sizes >= row["size"]) & (sizes <= row["largest_size"])).sum()


@pytest.mark.parametrize("settings", SETTINGS, ids=["periodic", "mixture between walls"])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_density_profile_is_that_of_the_run(settings, axis):
    simulation = observed(settings, density_profile="both", density_profile_bins=13)
    agents = simulation.agents
    found = gridlock.density_profile(agents.positions, simulation.box, axis=axis, bins=13, radius=agents.radius)
    table = simulation.distributions[f"density_profile_{axis}"]
    assert np.allclose(found.position, table["position"], rtol=1e-14)
    assert np.allclose(found.number_density, table["number_density"], rtol=1e-13)
    assert np.allclose(found.packing_fraction, table["packing_fraction"], rtol=1e-10)
    assert np.isclose(found.packing_fraction.mean(), (np.pi * agents.radius**2).sum() / simulation.box.area)
    assert gridlock.density_profile(agents.positions, simulation.box, axis=axis, bins=13).packing_fraction is None


def test_displacements_from_many_origins_are_those_of_every_frame():
    simulation = gridlock.Simulation(
        disks={"count": 64, "packing_fraction": 0.3}, box=OBLONG, engine={"kind": "exact"},
        observe={"every": 5, "displacement_lag": 12, "displacement_origin_every": 1})
    sides = np.array([OBLONG["width"], OBLONG["height"]])
    places = []
    for steps in [0] + 40 * [5]:
        if steps > 0:
            simulation.run(steps=steps)
        images = np.stack([simulation.agents["image_x"], simulation.agents["image_y"]], axis=1)
        places.append(simulation.agents.positions + sides * images)
    table = simulation.distributions["mean_squared_displacement"]
    first = len(places) - 1 - int(table["origins"][0])  # of the samples at the start, those that are no origin
    assert first in (0, 1)
    expected = gridlock.mean_squared_displacement(np.array(places[first:]))
    assert len(table) == 12
    assert np.allclose(table["mean_squared_displacement"], expected[1:13], rtol=1e-9)
    coefficient = simulation.results["diffusion_coefficient"]
    assert coefficient.value > 0 and coefficient.unit == "length² / time"
