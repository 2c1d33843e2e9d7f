"""Charts: what is drawn is what the data say, and mistakes are refused."""

import subprocess
import sys
import warnings

import matplotlib
import numpy as np
import pytest

import gridlock
import gridlock.plot
from gridlock.plot.agents import neighbourhood_colours, values_of
from gridlock.plot.style import LINE_COLOURS, colour_circle

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


def frame(x, y, *, periodic=False, **columns):
    """Agents in a box of 2 × 1."""
    columns = {"x": np.array(x, float), "y": np.array(y, float), **{name: np.asarray(values) for name, values in columns.items()}}
    return gridlock.Frame(gridlock.Box(2.0, 1.0, periodic), gridlock.Clock(0, 0.0), np.arange(len(x), dtype=np.uint64), columns)


def pixels(figure, dpi=100):
    """What is drawn, shape (height, width, 3), from the bottom up."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[::-1, :, :3]


def test_a_snapshot_has_every_disk_at_its_size(simulation, tmp_path):
    axes = gridlock.plot.snapshot(simulation, np.arange(100), label="row")
    disks = axes.collections[0]
    assert np.array_equal(disks.get_offsets(), simulation.agents.positions)
    assert np.allclose(2 * disks._widths, 2 * simulation.agents.radius)
    assert disks.get_array().tolist() == list(range(100))
    axes.figure.savefig(tmp_path / "a.png")
    axes.figure.savefig(tmp_path / "a.pdf")
    points = gridlock.plot.snapshot(gridlock.Simulation({"model.kind": "flocking"}), "direction")
    assert len(points.collections[0].get_offsets()) > 0


def test_a_disk_cut_by_a_periodic_edge_shows_on_both_sides():
    at_edges = frame([0.05, 1.0, 1.95, 1.0], [0.5, 0.5, 0.02, 0.97], periodic=True, radius=[0.1, 0.1, 0.1, 0.1])
    offsets = gridlock.plot.snapshot(at_edges).collections[0].get_offsets()
    expected = {(0.05, 0.5), (2.05, 0.5), (1.0, 0.5), (1.95, 0.02), (-0.05, 0.02), (1.95, 1.02), (-0.05, 1.02), (1.0, 0.97), (1.0, -0.03)}
    assert {(round(x, 9), round(y, 9)) for x, y in offsets.tolist()} == expected
    walled = gridlock.plot.snapshot(frame([0.05], [0.5], radius=[0.05])).collections[0]
    assert walled.get_offsets().tolist() == [[0.05, 0.5]]


@pytest.mark.parametrize("sizes", [[0.001], [0.001, 0.0014]])
def test_small_disks_of_an_image_are_where_the_others_are(sizes, monkeypatch):
    """The quick way to draw them colours as much, at the same places to half a pixel, in the same colours."""
    import gridlock.plot.disks as disks

    random = np.random.default_rng(1)
    many = frame(random.random(12_000) * 2, random.random(12_000), radius=random.choice(sizes, 12_000))
    values = (many.x > 1).astype(float)

    def drawn():
        axes = gridlock.plot.snapshot(many, values, axes=matplotlib.figure.Figure((6, 3)).add_axes((0, 0, 1, 1)))
        return 1.0 - pixels(axes.figure, 200) / 255.0

    quick = drawn()
    monkeypatch.setattr(disks, "SMALL", 0.0)
    slow = drawn()
    assert not np.array_equal(quick, slow)
    for part in (np.s_[:, :600], np.s_[:, 600:]):
        assert np.allclose(quick[part].mean(axis=(0, 1)), slow[part].mean(axis=(0, 1)), rtol=0.1)
    coarse = [image.reshape(60, 10, 120, 10, 3).mean(axis=(1, 3)) for image in (quick, slow)]
    assert np.corrcoef(coarse[0].ravel(), coarse[1].ravel())[0, 1] > 0.95


@pytest.mark.parametrize("small", [0.0, 4.0])
def test_many_small_disks_have_the_mean_of_their_colours(small, monkeypatch):
    monkeypatch.setattr("gridlock.plot.disks.SMALL", small)
    x, y = np.meshgrid((np.arange(300) + 0.5) / 150, (np.arange(150) + 0.5) / 150)
    crowd = frame(x.ravel(), y.ravel(), radius=np.full(45_000, 0.003))
    figure = matplotlib.figure.Figure((6, 3))
    gridlock.plot.snapshot(crowd, np.uint32(1) * (crowd.x > 1), axes=figure.add_axes((0, 0, 1, 1)))
    figure.axes[1].remove()  # the bar of colours
    image = pixels(figure, 100) / 255
    width, share = image.shape[1], 45_000 * np.pi * 0.003**2 / 2
    box = image[(image < 1).all(axis=2).any(axis=1)][:, (image < 1).all(axis=2).any(axis=0)]
    half = box.shape[1] // 2
    for side, colour in ((box[5:-5, 5 : half - 5], "#440154"), (box[5:-5, half + 5 : -5], "#fde725")):
        expected = 1 - share * (1 - np.array(matplotlib.colors.to_rgb(colour)))
        assert np.allclose(side.mean(axis=(0, 1)), expected, atol=0.1), width


def test_a_picture_of_many_disks_is_small(tmp_path):
    random = np.random.default_rng(1)
    for count, limit in ((5_000, 1_500_000), (40_000, 2_500_000)):
        axes = gridlock.plot.snapshot(frame(random.random(count) * 2, random.random(count), radius=np.full(count, 0.002)))
        axes.figure.savefig(tmp_path / "a.svg")
        assert (tmp_path / "a.svg").stat().st_size < limit
        assert ("<image" in (tmp_path / "a.svg").read_text()) == (count > 10_000)


def test_colours_by_name_are_what_they_say(simulation):
    moving = frame([0.2, 0.6, 1.0], [0.5] * 3, velocity_x=[3.0, 0.0, -1.0], velocity_y=[4.0, 2.0, 0.0], species=np.array([0, 2, 1], np.uint32))
    assert values_of(moving, "speed").tolist() == [5.0, 2.0, 1.0]
    assert np.allclose(values_of(moving, "direction"), [np.arctan2(4, 3), np.pi / 2, np.pi])
    axes = gridlock.plot.snapshot(moving, "species", names=["small", "large"])
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["small", "large", "2"]
    colours = axes.collections[0].get_facecolor()
    assert len(np.unique(colours, axis=0)) == 3
    with pytest.raises(gridlock.Error, match="no column \"smell\"\n  hint: .*psi6, neighbourhood, radius, speed, direction, x"):
        gridlock.plot.snapshot(moving, "smell")
    order = values_of(gridlock.plot.agents.frame_of(simulation), "psi6")
    measured = gridlock.Simulation(disks={"count": 100, "packing_fraction": 0.5}, observe={"every": 10, "structure_every": 1})
    measured.run(steps=300)
    assert order.mean() == pytest.approx(measured.series["local_bond_orientation_order"][-1], rel=1e-9)


def test_walls_inside_the_box_are_drawn_where_the_settings_are_known(tmp_path):
    settings = {"box.edge": "wall", "disks": {"count": 9, "packing_fraction": 0.1}, "engine.kind": "exact", "trajectory.every": 5,
                "walls": [{"from": [0.0, 0.5], "to": [0.05, 0.5]}], "run.steps": 5}
    gridlock.run(settings, tmp_path / "run")
    made = gridlock.open(tmp_path / "run")

    def walls_in(agents, **more):
        return [line.get_xydata().tolist() for line in gridlock.plot.snapshot(agents, **more).lines]

    expected = [[[0.0, 0.5], [0.05, 0.5]]]
    for agents in (gridlock.Simulation(settings), made, made.trajectory):
        assert walls_in(agents) == expected
    assert walls_in(made.final) == []
    assert walls_in(made.final, walls=made.settings["walls"]) == expected
    assert walls_in(made, walls=()) == []


def test_the_lines_of_a_grid_are_those_of_its_columns_and_rows():
    axes = gridlock.plot.snapshot(frame([1.0], [0.5], radius=[0.1]), grid=(5, 2))
    upright, level = ([[point.tolist() for point in line] for line in lines.get_segments()] for lines in axes.collections[-2:])
    assert np.allclose(upright, [[[x, 0], [x, 1]] for x in (0.4, 0.8, 1.2, 1.6)])
    assert np.allclose(level, [[[0, 0.5], [2, 0.5]]])


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("cells", [(4, 4), (5, 3), (1, 7), (6, 2)])
def test_neighbouring_cells_differ_in_colour(cells, periodic):
    columns, rows = cells
    x, y = np.meshgrid((np.arange(columns) + 0.5) * 2 / columns, (np.arange(rows) + 0.5) / rows, indexing="ij")
    colours = neighbourhood_colours(frame(x.ravel(), y.ravel(), periodic=periodic), columns, rows).reshape(cells)
    assert colours.min() >= 0 and colours.max() < 9
    for i in range(columns):
        for j in range(rows):
            for other in {(i + di, j + dj) for di in (-1, 0, 1) for dj in (-1, 0, 1)}:
                place = (other[0] % columns, other[1] % rows) if periodic else other
                if 0 <= place[0] < columns and 0 <= place[1] < rows and place != (i, j):
                    assert colours[i, j] != colours[place]


def test_colours_can_be_told_apart_by_colour_blind_readers():
    """Differences of lines after a simulation of the three kinds of colour blindness, in units of just noticeable ones in CIELAB."""
    blindness = {  # G. M. Machado et al. (2009), doi:10.1109/TVCG.2009.113, severity 1
        "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    }

    def lab(linear):
        xyz = np.clip(linear, 0, 1) @ np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]).T
        f = np.cbrt(np.maximum(xyz / [0.9505, 1.0, 1.089], 0.008856))
        return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])

    def linear(colour):
        rgb = np.array(matplotlib.colors.to_rgb(colour))
        return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)

    for matrix in [np.eye(3), *map(np.array, blindness.values())]:
        seen = [lab(matrix @ linear(colour)) for colour in LINE_COLOURS]
        for i in range(len(seen)):
            assert seen[i][0] < 90, "it shows on white"
            for j in range(i):
                assert np.linalg.norm(seen[i] - seen[j]) > 10, (LINE_COLOURS[i], LINE_COLOURS[j])


def test_the_circle_of_colours_closes_and_has_no_jumps():
    circle = colour_circle(100)
    steps = np.linalg.norm(np.diff(circle, axis=0, append=circle[:1]), axis=1)
    assert steps.max() < 0.06
    assert np.linalg.norm(circle - np.roll(circle, 50, axis=0), axis=1).min() > 0.3


def test_series_and_curves_are_those_of_the_run(simulation):
    axes = gridlock.plot.series(simulation, ["mean_displacement", "halted_fraction"])
    assert np.array_equal(axes.lines[0].get_ydata(), simulation.series["mean_displacement"])
    assert axes.get_legend() is not None
    curve = gridlock.plot.curve(simulation, "pair_correlation")
    diameter = 2 * simulation.agents.radius[0]
    assert np.allclose(curve.lines[0].get_xdata() * diameter, simulation.distributions["pair_correlation"]["distance"], rtol=1e-12)
    assert curve.get_xlabel() == "distance r / diameter σ"
    assert np.array_equal(curve.lines[0].get_ydata(), simulation.distributions["pair_correlation"]["pair_correlation"])
    assert len(curve.collections) == 1
    denser = gridlock.Simulation(disks={"count": 100, "packing_fraction": 0.65}, observe={"every": 10, "structure_every": 1})
    denser.run(steps=300)
    gridlock.plot.curve(denser, "pair_correlation", axes=curve)
    assert curve.get_ylim()[0] == 0 and curve.get_ylim()[1] > denser.distributions["pair_correlation"]["pair_correlation"].max()
    speeds = gridlock.plot.curve(simulation, "speed_distribution")
    assert np.array_equal(speeds.patches[0].get_data().values, simulation.distributions["speed_distribution"]["density"])
    assert [text.get_text() for text in speeds.get_legend().get_texts()] == ["measured", "Maxwell"]


def test_curves_of_dynamics_are_drawn_against_the_logarithm_of_the_lag():
    walk = np.random.default_rng(1).uniform(0, 9, (12, 2)) + np.random.default_rng(2).normal(size=(20, 12, 2)).cumsum(axis=0)
    kinds = np.arange(12) % 2
    found = gridlock.dynamics(walk, kinds=kinds, overlap_length=1.5)
    axes = gridlock.plot.dynamics(found, "susceptibility", labels=["small", "large"])
    assert [line.get_label() for line in axes.lines] == ["small", "large"] and axes.get_xscale() == "log"
    assert axes.lines[1].get_ydata()[:5] == pytest.approx(found.susceptibility[1, :5])
    waves = gridlock.collective_scattering(walk, box=9.0, q=1.0, kinds=kinds)
    drawn = gridlock.plot.dynamics(waves, "scattering").lines
    assert drawn[1].get_ydata() == pytest.approx(waves.scattering[1, 1, 1:]) and drawn[0].get_xdata()[0] == 1.0
    with pytest.raises(gridlock.Error, match="no curve scattering"):
        gridlock.plot.dynamics(found, "scattering")


def test_errors_are_as_wide_as_they_are():
    from matplotlib.figure import Figure

    axes = Figure().subplots()
    gridlock.plot.line(axes, [0, 1, 2, 3], [1, 2, np.nan, 4], [0.5, np.nan, 1, 0.25])
    assert axes.lines[0].get_ydata().tolist() == [1, 2, 4]
    band = axes.collections[0].get_paths()[0].vertices
    assert {tuple(point) for point in band.tolist()} >= {(0, 0.5), (0, 1.5), (1, 2), (3, 3.75), (3, 4.25)}
    gridlock.plot.points(axes, [0, 1], [1, 2], [0.5, 0.25], label="b")
    (bars,) = axes.containers[0].lines[2]
    assert [segment[:, 1].tolist() for segment in bars.get_segments()] == [[0.5, 1.5], [1.75, 2.25]]
    gridlock.plot.histogram(axes, [0.5, 1.5], [3, 1], [1, 1])
    assert axes.patches[0].get_data().edges.tolist() == [0, 1, 2]
    axes.set_yscale("log")
    pixels(axes.figure)


def test_sweeps_have_a_line_for_each_combination(tmp_path):
    made = gridlock.sweep({"run.steps": 50, "disks.count": 30, "observe.every": 10},
                          {"disks.packing_fraction": [0.2, 0.3, 0.4], "engine.kind": ["stepped", "exact"]}, tmp_path / "a")
    axes = gridlock.plot.sweep(made, "collision_rate")
    assert len(axes.containers) == 2 and axes.get_xlabel() == "packing fraction φ"
    legend = axes.figure.legends[0]
    assert legend.get_title().get_text() == "engine" and [text.get_text() for text in legend.get_texts()] == ["exact", "stepped"]
    exact = made.means[made.means["engine.kind"] == "exact"]
    assert axes.containers[0].lines[0].get_ydata().tolist() == exact["collision_rate"].tolist()
    assert len(gridlock.plot.snapshot(made.runs[0]).collections[0].get_offsets()) == 30
    with pytest.raises(gridlock.Error, match="no result nothing"):
        gridlock.plot.sweep(made, "nothing")
    with pytest.raises(gridlock.Error, match="no numbers engine.kind"):
        gridlock.plot.sweep(made, "collision_rate", against="engine.kind")


@pytest.mark.parametrize("draw", [
    lambda s: gridlock.plot.snapshot(s, [1.0, 2.0]),
    lambda s: gridlock.plot.snapshot(s, np.arange(100) * 1j),
    lambda s: gridlock.plot.snapshot(s, ["red"] * 100),
    lambda s: gridlock.plot.snapshot(s, np.ma.masked_less(np.arange(100), 50)),
    lambda s: gridlock.plot.snapshot(s, "speed", limits=(1, 0)),
    lambda s: gridlock.plot.snapshot(s, "speed", limits=(1, 1)),
    lambda s: gridlock.plot.snapshot(s, "speed", limits=(0, 1, 2)),
    lambda s: gridlock.plot.snapshot(s, "speed", limits=(0, np.nan)),
    lambda s: gridlock.plot.snapshot("nothing"),
    lambda s: gridlock.plot.series(s, "nothing"),
    lambda s: gridlock.plot.curve(s, "nothing"),
    lambda s: gridlock.plot.dynamics(gridlock.dynamics(np.zeros((3, 2, 2))), 3),
])
def test_mistakes_are_refused(simulation, draw):
    with pytest.raises(gridlock.Error):
        draw(simulation)


def test_a_trajectory_without_frames_cannot_be_drawn(tmp_path):
    gridlock.run({"disks": {"count": 9, "packing_fraction": 0.3}, "run.steps": 10, "trajectory.every": 5}, tmp_path / "out")
    trajectory = gridlock.open(tmp_path / "out").trajectory
    assert len(gridlock.plot.snapshot(trajectory, "psi6", limits=(0, 0.5)).collections[0].get_offsets()) == 9
    with pytest.raises(gridlock.Error, match="no frames\n  hint: its 3 frames are those of steps 0 to 10"):
        gridlock.plot.snapshot(trajectory[:0])


def test_no_agents_at_all_are_an_empty_box():
    for colour in (None, "psi6", "neighbourhood", "radius", "x"):
        pixels(gridlock.plot.snapshot(frame([], [], radius=[]), colour).figure)


def test_the_style_is_one_column_wide_and_gone_afterwards():
    before = dict(matplotlib.rcParams)
    with gridlock.plot.style():
        assert matplotlib.rcParams["font.size"] == 8
    assert dict(matplotlib.rcParams) == before


def test_without_matplotlib_the_error_says_what_to_install(tmp_path):
    (tmp_path / "matplotlib.py").write_text("raise ImportError('none here')")
    program = (f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n"
               "from gridlock.commands.plot import main\nsys.exit(main(['.']))")
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert ended.returncode == 2
    assert ended.stderr == "error: drawing needs matplotlib, which is not installed\n  hint: pip install matplotlib\n"
