"""Contacts and moduli of packings against other programs, brute force and what they are defined by."""

import dataclasses
import fractions
import pathlib
import subprocess

import numpy as np
import pytest

import gridlock

PACKINGS = pathlib.Path(__file__).resolve().parents[2] / "tests" / "reference" / "packings"


def known(name):
    frame = gridlock.read_xyz(PACKINGS / f"harmonic64_{name}.xyz")
    return frame.positions, frame.radius, frame.box


@pytest.mark.parametrize("name, disks, count, energy, pressure, bulk, shear", [
    ("over", 64, 145, 1.047687498e-4, 0.5642768998, 27.948968, 4.5018203),
    ("mid", 60, 119, 3.606745549e-8, 9.354789970e-3, 18.622292, 0.47092151),
])
def test_known_packings(name, disks, count, energy, pressure, bulk, shear):
    found = gridlock.contacts(*known(name))
    unit = found.smallest_diameter**2
    assert (found.backbone_disks, found.backbone_contacts) == (disks, count)
    assert found.energy / 64 == pytest.approx(energy, rel=1e-9)
    assert found.pressure / unit == pytest.approx(pressure, rel=1e-9)
    assert found.bulk_modulus / unit == pytest.approx(bulk, rel=1e-6)
    assert found.shear_modulus / unit == pytest.approx(shear, rel=1e-6)
    assert found.is_jammed and found.is_shear_stable == (name == "over")
    assert np.mean(found.shear_moduli) == pytest.approx(found.shear_modulus)


def test_contacts_are_those_of_all_pairs():
    points, radii, box = known("over")
    found = gridlock.contacts(points, radii, box)
    separations = points[None] - points[:, None]
    separations -= np.round(separations)
    distances = np.hypot(separations[..., 0], separations[..., 1])
    sums = radii[:, None] + radii[None]
    i, j = np.nonzero(np.triu(distances < sums, 1))
    assert (found.pairs == np.column_stack([i, j])).all()
    assert np.allclose(found.distances, distances[i, j], rtol=0, atol=1e-15)
    assert np.allclose(found.overlaps, 1 - distances[i, j] / sums[i, j], rtol=0, atol=1e-14)
    assert np.allclose(found.forces, found.overlaps / sums[i, j])
    assert np.allclose(found.normals * found.distances[:, None], separations[i, j], rtol=0, atol=1e-15)
    assert (found.coordination == np.bincount(found.pairs[found.is_of_backbone].ravel(), minlength=64)).all()
    gaps = np.sort((distances / sums - 1)[np.triu((distances >= sums) & (distances < 1.1 * sums), 1)])
    assert np.allclose(found.gaps, gaps, rtol=0, atol=1e-14)
    virial = (found.forces * found.distances)[:, None, None] * found.normals[:, :, None] * found.normals[:, None, :]
    assert np.allclose(found.stress, -found.smallest_diameter**2 * virial.sum(axis=0), rtol=1e-12)


def numbers_of(found):
    """All that does not depend on the order of the disks."""
    return np.array([found.energy, found.pressure, found.bulk_modulus, found.shear_modulus, found.least_shear_modulus, found.softest_mode,
                     found.contact_number, found.mean_coordination, found.excess_contacts, *found.gaps, *found.relative_forces])


@pytest.mark.parametrize("potential", ["harmonic", "hertzian"])
def test_results_do_not_change_with_order_place_image_and_orientation(potential):
    points, radii, box = known("over")
    same = {"potential": potential, "residual": 100.0}
    first = numbers_of(gridlock.contacts(points, radii, box, **same))
    assert np.isfinite(first).all()
    order = np.random.default_rng(1).permutation(64)
    for moved, sizes in [(points[order], radii[order]), (points + [0.3, -0.4], radii), (points + [5.0, 0.0], radii),
                         (np.column_stack([-points[:, 1], points[:, 0]]), radii)]:
        assert np.allclose(numbers_of(gridlock.contacts(moved, sizes, box, **same)), first, rtol=1e-6, atol=1e-12)
    turned = gridlock.contacts(np.column_stack([-points[:, 1], points[:, 0]]), radii, box, **same)
    straight = gridlock.contacts(points, radii, box, **same)
    assert np.allclose(turned.elastic_constants, straight.elastic_constants[[1, 0, 2, 3, 5, 4]] * [1, 1, 1, 1, -1, -1], rtol=1e-7)


def test_hard_disks_have_contacts_within_the_tolerance():
    points, radii, box = known("marginal")
    hard = gridlock.contacts(points, radii * (1 - 1e-6), box)
    assert len(hard.pairs) == 0 and hard.is_rattler.all() and hard.rattler_share == 1.0
    assert np.isnan(hard.contact_number) and np.isnan(hard.bulk_modulus) and hard.is_jammed is False
    near = gridlock.contacts(points, radii * (1 - 1e-6), box, tolerance=2e-6)
    assert near.is_jammed is None
    assert (near.backbone_disks, near.backbone_contacts, near.excess_contacts) == (60, 119, 0)
    assert (near.forces == 0).all() and np.isnan(near.softest_mode) and len(near.relative_forces) == 0


def test_what_is_no_minimum_has_no_moduli():
    points, radii, box = known("over")
    shaken = points + 1e-5 * np.random.default_rng(1).normal(size=points.shape)
    found = gridlock.contacts(shaken, radii, box)
    assert not found.is_converged and not found.is_jammed
    assert np.isnan(found.elastic_constants).all() and np.isnan(found.softest_displacements).all()
    assert gridlock.contacts(shaken, radii, box, residual=100.0).bulk_modulus > 0
    assert np.isnan(gridlock.contacts(points, radii, box, stiffness=False).bulk_modulus)


@pytest.mark.parametrize("overlap", [1e-2, 1e-6, 1e-8])
def test_a_saddle_is_not_jammed_whatever_else_is_asked_for(overlap):
    columns, rows = 8, 6
    points = np.column_stack([axis.ravel() for axis in np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)])
    radius = 0.5 * (1 + overlap)
    assert gridlock.contacts(points, radius, (columns, rows)).is_jammed is False
    assert gridlock.contacts(points, radius, (columns, rows), stiffness=False).is_jammed is None
    assert gridlock.contacts(points, 0.49, (columns, rows), stiffness=False).is_jammed is False
    points, radii, box = known("mid")
    assert gridlock.contacts(points, radii, box).is_jammed is True


def test_a_minimum_by_the_root_mean_square_is_one():
    points, radii, box = known("over")
    shaken = points + 1e-9 * np.random.default_rng(1).normal(size=points.shape)
    found = gridlock.contacts(shaken, radii, box)
    assert not found.is_converged and found.residual_force > 1.3 * found.rms_residual_force > 0
    between = np.sqrt(found.residual_force * found.rms_residual_force)
    assert gridlock.contacts(shaken, radii, box, residual=between).bulk_modulus > 0


@pytest.mark.parametrize("kind", [list, np.float32, np.int32, np.longdouble])
def test_any_numbers_are_read_as_float64(kind):
    points, radii = [[1, 2], [4, 2], [7, 2]], [2, 2, 2]
    expected = gridlock.contacts(np.array(points, dtype=np.float64), 2.0, 16.0)
    for sizes in (radii, 2, fractions.Fraction(2), np.float32(2), np.array(2)):
        arrays = (points, sizes) if kind is list else (np.array(points, dtype=kind), np.asarray(radii, dtype=kind))
        found = gridlock.contacts(*arrays, 16)
        assert found.points.dtype == found.radii.dtype == np.float64 and len(found.pairs) == 2
        assert found.pairs.tolist() == expected.pairs.tolist() and found.forces.tolist() == expected.forces.tolist()


@pytest.mark.parametrize(("points", "tolerance"), [([], 0.0), ([[0.3, 0.3], [0.8, 0.8]], 0.0), ([[0.3, 0.3], [0.4999, 0.3]], 1e-3)])
def test_where_nothing_presses_the_pressure_has_no_sign(points, tolerance):
    found = gridlock.contacts(points, 0.0999, 1.0, tolerance=tolerance)
    assert str(found.pressure) == "0.0" and not np.signbit(found.stress).any()


def test_walls_are_disks_of_their_own():
    found = gridlock.contacts([[0.49, 0.48]], 0.5, gridlock.Box(0.98, 0.96, periodic=False))
    assert found.pairs.tolist() == [[0, 1], [0, 2], [0, 3], [0, 4]]
    assert found.normals.tolist() == [[-1, 0], [1, 0], [0, -1], [0, 1]]
    assert found.excess_contacts == 1 and np.isnan(found.shear_moduli[0]) and found.shear_modulus == found.shear_moduli[1]


def test_the_softest_mode_is_an_eigenvector_of_the_hessian():
    points, radii, box = known("over")
    found = gridlock.contacts(points, radii, box)
    mode = found.softest_displacements

    def forces(places):
        now = gridlock.contacts(places, radii, box, residual=1.0, stiffness=False)
        net = np.zeros((64, 2))
        np.add.at(net, now.pairs[:, 1], now.forces[:, None] * now.normals)
        np.subtract.at(net, now.pairs[:, 0], now.forces[:, None] * now.normals)
        return net

    step = 1e-6
    change = -(forces(points + step * mode) - forces(points - step * mode)) / (2 * step)
    assert np.allclose(change, found.softest_mode / found.smallest_diameter**2 * mode, atol=1e-6)


def test_the_result_cannot_be_assigned_to():
    found = gridlock.contacts([[0.5, 0.5]], 0.1, 1.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.pressure = 1.0


@pytest.fixture
def pyplot():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    return pytest.importorskip("matplotlib.pyplot")


def test_the_picture_has_all_disks_and_forces(pyplot):
    from gridlock.plot import packing

    found = gridlock.contacts(*known("mid"))
    for colour in ("psi6", "coordination", np.arange(64)):
        axes = packing(found, colour)
        disks, rim, hole, halo, lines = axes.collections
        # Disks that an edge cuts are there twice or more.
        assert len(disks.get_offsets()) >= 60 and len(rim.get_offsets()) == len(hole.get_offsets()) >= 4
        assert len(halo.get_paths()) == len(lines.get_paths()) == 2 * len(found.pairs)
        assert disks.get_cmap().name == "viridis"  # as |ψ6| is everywhere
        pyplot.close(axes.figure)
    corners = np.array([path.vertices[:4] for path in axes.collections[4].get_paths()])[: len(found.pairs)]
    widths = np.hypot(*(corners[:, 1] - corners[:, 0]).T)
    assert np.allclose(widths / widths.max(), np.minimum(found.forces / found.forces.mean(), 3.0) / 3.0, rtol=0.05)
    lengths = np.hypot(*(corners[:, 2] - corners[:, 1]).T)
    assert np.allclose(lengths, found.distances)
    # From each of the two disks a line leads to the other or its image.
    every = np.array([path.vertices[:4] for path in axes.collections[4].get_paths()])
    begin, end = (every[:, [a, b]].mean(axis=1) for a, b in ((0, 1), (2, 3)))
    count = len(found.pairs)
    for starts, ends, (one, other) in ((begin[:count], end[:count], (0, 1)), (begin[count:], end[count:], (1, 0))):
        assert np.allclose(starts, found.points[found.pairs[:, one]] % 1.0)
        away = ends - found.points[found.pairs[:, other]]
        assert np.allclose(away, np.round(away), atol=1e-9)


@pytest.mark.parametrize("box", [(6.0, 2.0), (2.0, 6.0)])
def test_disks_outside_an_oblong_box_are_drawn_inside(pyplot, box):
    from gridlock.plot import packing

    inside = np.array([[0.5, 0.5], [1.2, 0.5], [1.0, 1.5]])
    axes = packing(gridlock.contacts(inside + [box[0], -2 * box[1]], 0.4, box), "coordination")
    drawn = np.concatenate([disks.get_offsets() for disks in axes.collections[:2]])
    assert {tuple(np.round(place, 9)) for place in inside.tolist()} <= {tuple(np.round(place, 9)) for place in drawn.tolist()}
    assert np.allclose([axes.get_xlim(), axes.get_ylim()], [(0, box[0]), (0, box[1])])
    starts = np.array([path.vertices[:2].mean(axis=0) for path in axes.collections[4].get_paths()])
    assert len(starts) == 2 and np.allclose(sorted(starts[:, 0]), [0.5, 1.2]) and np.allclose(starts[:, 1], 0.5)
    pyplot.close("all")


def test_the_pictures_of_a_directory(pyplot, program, tmp_path):
    from gridlock.plot import pictures

    for name, options, drawn in [("mid", [], ["packing", "forces", "spectral_density"]),
                                 ("marginal", ["--tolerance", "0.01"], ["packing", "forces", "spectral_density"])]:
        subprocess.run([program, "contacts", PACKINGS / f"harmonic64_{name}.xyz", "-o", tmp_path / name, "--no-pictures", *options],
                       check=True, capture_output=True)
        made = pictures(tmp_path / name, "coordination")
        assert [file.name for file in made.files] == [f"{stem}.{end}" for stem in drawn for end in ("svg", "png")]
        assert made.notes == [] and all(file.stat().st_size > 1000 for file in made.files)
        assert "packing.png" in (tmp_path / name / ".gridlock.files").read_text()


def test_the_picture_of_hard_disks_and_of_nothing(pyplot):
    from gridlock.plot import packing

    points, radii, box = known("marginal")
    hard = gridlock.contacts(points, radii * (1 - 1e-6), box, tolerance=2e-6)
    assert len(packing(hard).collections[-1].get_paths()) == 2 * len(hard.pairs) >= 2 * 119
    assert len(packing(gridlock.contacts(np.empty((0, 2)), [], 1.0)).collections[-1].get_paths()) == 0
    with pytest.raises(gridlock.Error, match='have no "speed"'):
        packing(hard, "speed")
    pyplot.close("all")


@pytest.mark.parametrize("arguments, words", [
    ({"box": None}, "need a box"),
    ({"potential": "lennard-jones"}, "the potential is 'lennard-jones'"),
    ({"stiffness": 1}, "stiffness is 1"),
    ({"tolerance": -1e-3}, "the tolerance is -0.001"),
    ({"tolerance": 1.5}, "the tolerance is 1.5"),
    ({"largest_gap": np.nan}, "the largest gap is nan"),
    ({"radii": [0.1]}, "the radii have shape"),
    ({"radii": [0.1, 0.0]}, "the radius of disk 1 is 0.0"),
    ({"radii": [0.1, -0.1]}, "the radius of disk 1 is -0.1"),
    ({"radii": 0.4}, "could touch two images"),
    ({"radii": 0.2}, "an overlap of 0.75, which is no packing"),
    ({"points": [[0.1, 0.1], [0.1, 1.1]], "box": gridlock.Box(1.0, 1.0, periodic=False)}, "its centre is outside the walls"),
])
def test_bad_input_is_refused(arguments, words):
    good = {"points": [[0.1, 0.1], [0.2, 0.1]], "radii": 0.05, "box": 1.0}
    with pytest.raises(gridlock.Error, match=words):
        gridlock.contacts(**{**good, **arguments})


def test_the_spectral_density_is_that_of_its_sum():
    random = np.random.default_rng(2)
    points, radii, box = random.random((40, 2)) * [1.0, 2.0], random.random(40) * 0.05, gridlock.Box(1.0, 2.0)
    found = gridlock.spectral_density(points, radii, box, largest_q=15.0, bins=4)
    special = pytest.importorskip("scipy.special")
    lengths, powers = [], []
    for m in range(0, 4):
        for n in range(-6, 7):
            q = 2 * np.pi * np.array([m / 1.0, n / 2.0])
            length = np.hypot(*q)
            if 0 < length <= 15.0 and (m > 0 or n > 0):
                areas = 2 * np.pi * radii * special.j1(length * radii) / length
                lengths.append(length)
                powers.append(abs((areas * np.exp(1j * points @ q)).sum()) ** 2 / box.area)
    ring = np.minimum((np.array(lengths) / 15.0 * 4).astype(int), 3)
    assert found.vectors.tolist() == np.bincount(ring).tolist()
    assert np.allclose(found.density, np.bincount(ring, powers) / np.bincount(ring), rtol=1e-10)
    assert np.allclose(found.q, np.bincount(ring, lengths) / np.bincount(ring), rtol=1e-12)
    both = gridlock.spectral_density(points, radii, box, largest_q=15.0, bins=4, threads=3)
    assert (both.density == found.density).all()
