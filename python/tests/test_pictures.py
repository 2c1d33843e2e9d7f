"""The pictures of a directory: protocols, packings, models and sweeps over seeds show what the files say."""

import warnings

import matplotlib
import numpy as np
import pytest

import gridlock
import gridlock.plot
from conftest import OBLONG
from matplotlib.figure import Figure

matplotlib.use("Agg")

MIXTURE = [{"fraction": 0.5}, {"fraction": 0.5, "size_ratio": 1.4}]
SOFT = {"box": OBLONG, "disks": {"count": 40, "packing_fraction": 0.5, "start": "uniform", "species": MIXTURE},
        "protocol": [{"stage": "quench", "packing_fraction": 0.86}, {"stage": "decompress", "until_pressure": 1e-5}]}
GROWN = {"box": OBLONG, "disks": {"count": 40, "packing_fraction": 0.3, "start": "random", "species": MIXTURE}, "engine": {"kind": "exact"},
         "protocol": [{"stage": "grow", "rate": 0.02, "until_packing_fraction": 0.7}], "run": {"collisions_per_disk": 20.0}}


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


@pytest.fixture
def drawn(monkeypatch):
    """The axes of every picture, by its name; what ``draw(directory)`` returns."""
    def draw(directory, colour=""):
        axes = {}
        original = gridlock.plot.pictures.__globals__["_Artist"].draw

        def spy(self, name, size, function):
            axes[name] = Figure(figsize=size, layout="constrained").subplots()
            function(axes[name])

        monkeypatch.setattr(gridlock.plot.pictures.__globals__["_Artist"], "draw", spy)
        gridlock.plot.pictures(directory, colour)
        monkeypatch.setattr(gridlock.plot.pictures.__globals__["_Artist"], "draw", original)
        return axes

    return draw


def test_displacements_after_a_protocol_count_from_its_end(tmp_path, drawn):
    gridlock.run(GROWN, tmp_path / "kept", trajectory={"every": 50})
    run = gridlock.open(tmp_path / "kept")
    axes = drawn(run.path)
    assert axes["final"].collections[0].get_array()[:40].mean() == pytest.approx(run.series["mean_displacement"][-1], rel=1e-9)
    assert axes["final"].figure.axes[1].get_ylabel() == "displacement / side"
    assert axes["start"].get_title() == "start of the protocol, φ = 0.3"


def test_where_no_frame_of_the_end_of_a_protocol_is_kept_no_displacement_is_drawn(tmp_path, drawn):
    gridlock.run(GROWN, tmp_path / "out")
    axes = drawn(tmp_path / "out")
    assert axes["final"].figure.axes[1].get_ylabel() == "|ψ6|"
    assert axes["final"].get_title().startswith("φ = 0.7, step ")
    with pytest.raises(gridlock.Error, match="where its disks were after the protocol.*\n  hint: .*trajectory.every"):
        drawn(tmp_path / "out", "displacement")


def test_a_packing_is_drawn_with_its_contacts_and_named_by_density_and_pressure(tmp_path, drawn):
    gridlock.run(SOFT, tmp_path / "out")
    run = gridlock.open(tmp_path / "out")
    axes = drawn(run.path)
    assert set(axes) == {"final", "forces", "start", "levels"}
    pairs = run.table("contacts")
    assert len(axes["final"].collections[-1].get_paths()) == 2 * len(pairs) > 80
    assert axes["final"].get_title() == f"φ = {run.summary['packing_fraction']:.5g}, P D²/ε = {run.results['pressure'].value:.3g}"
    assert axes["final"].figure.axes[1].get_ylabel() == "|ψ6|"
    assert drawn(run.path, "coordination")["final"].figure.axes[1].get_ylabel() == "contacts of a disk"
    assert drawn(run.path, "radius")["final"].get_legend() is not None
    with pytest.raises(gridlock.Error, match="displacements count"):
        drawn(run.path, "displacement")


def test_the_motions_in_the_largest_drop_of_a_shear_are_drawn(tmp_path, drawn):
    shear = {"stage": "shear", "until_strain": 0.1, "min_drop": 1e-5}
    gridlock.run({**SOFT, "protocol": [SOFT["protocol"][0], shear]}, tmp_path / "out")
    run = gridlock.open(tmp_path / "out")
    events, motions = run.table("shear_events"), run.table("shear_motions")
    largest = np.argmax(events["stress_drop"])
    axes = drawn(run.path)
    arrows = axes["shear_event"].collections[0]
    assert arrows.get_offsets() == pytest.approx(np.column_stack([motions[name][motions["event"] == largest + 1] for name in ("x", "y")]))
    assert f"γ = {events['strain'][largest]:.5g}" in axes["shear_event"].get_title()
    assert len(axes["shear"].lines) == 1 + len(events) > 1


def test_the_motions_in_a_drop_are_drawn_in_the_box_of_the_drop(tmp_path, drawn):
    quench = {**SOFT["protocol"][0], "packing_fraction": 0.9}
    strain = {"stage": "shear", "deformation": "pure_shear", "strain_step": 0.005, "min_drop": 1e-5}
    gridlock.run({**SOFT, "protocol": [quench, {**strain, "until_strain": 0.1}, {**strain, "until_strain": -0.05}]}, tmp_path / "out")
    run = gridlock.open(tmp_path / "out")
    events = run.table("shear_events")
    event = events[np.argmax(events["stress_drop"])]
    stretch = np.exp(0.5 * (event["strain"] + (0.1 if event["stage"] == 3 else 0.0)))
    axes = drawn(run.path)["shear_event"]
    assert axes.get_xlim()[1] == pytest.approx(OBLONG["width"] * stretch, rel=1e-9)
    assert axes.get_ylim()[1] == pytest.approx(OBLONG["height"] / stretch, rel=1e-9)


def test_no_level_of_a_stage_hides_that_of_another(tmp_path, drawn):
    gridlock.run(SOFT, tmp_path / "out")
    first, second = drawn(tmp_path / "out")["levels"].lines
    assert (first.get_label(), second.get_label()) == ("stage 1 quench", "stage 2 decompress")
    assert first.get_xdata()[-1] == second.get_xdata()[0]
    assert first.get_markerfacecolor() == "none" and first.get_markersize() > second.get_markersize()


def test_the_density_at_a_pressure_is_drawn_over_the_sweeps_and_kept_by_later_stages(tmp_path, drawn):
    stages = [{"stage": "monte_carlo", "sweeps": 200, "pressure": 2.6}, {"stage": "monte_carlo", "sweeps": 20}]
    gridlock.run({"box": {"edge": "periodic"}, "disks": {"count": 16, "packing_fraction": 0.5}, "protocol": stages}, tmp_path / "out")
    run = gridlock.open(tmp_path / "out")
    (drawn_line,) = drawn(tmp_path / "out")["swap_density"].lines
    assert np.array_equal(drawn_line.get_xydata(), np.column_stack([run.table("swap_density")[name] for name in ("sweeps_done", "packing_fraction")]))
    assert 0.3 < run.results["packing_fraction_at_pressure"].value < 0.7 and run.results["area_acceptance"].value > 0


def test_radii_are_told_by_their_ratio(tmp_path, drawn):
    gridlock.run(SOFT, tmp_path / "out")
    legend = drawn(tmp_path / "out")["start"].get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["R", "1.4 R"]
    assert legend.get_title().get_text().startswith("R = 0.0")


def test_the_peaks_of_a_mixture_are_named(tmp_path, drawn):
    gridlock.run(GROWN, tmp_path / "out")
    axes = drawn(tmp_path / "out")["pair_correlation"]
    assert {text.get_text(): round(text.xy[0], 6) for text in axes.texts} == {
        "AA": round(2 / 2.4, 6), "AB": 1.0, "BB": round(2.8 / 2.4, 6)}
    assert axes.get_xlabel() == "distance r / mean diameter"


def test_a_sweep_over_seeds_alone_is_a_histogram_and_yes_or_no_is_no_curve(tmp_path, drawn):
    made = gridlock.sweep(SOFT, {"run.seed": [1, 2, 3, 4, 5]}, tmp_path / "seeds")
    axes = drawn(made.path)
    assert "jamming_packing_fraction" in axes and not any(name.startswith("is_") for name in axes)
    found = axes["jamming_packing_fraction"]
    assert found.patches[0].get_data().values.sum() == 5
    assert found.get_title().startswith(f"5 runs: {made.table['jamming_packing_fraction'].mean():.4g} ± ")
    swept = gridlock.sweep(SOFT, {"disks.count": [30, 40]}, tmp_path / "counts")
    axes = drawn(swept.path)
    assert "contact_number" in axes and not any(name.startswith("is_") for name in axes)


def test_the_share_that_is_jammed_is_a_curve(tmp_path, drawn):
    quench = {**SOFT, "protocol": [{"stage": "quench"}]}
    made = gridlock.sweep(quench, {"disks.packing_fraction": [0.8, 0.835, 0.9], "run.seed": list(range(1, 9))}, tmp_path / "out")
    assert 0.0 < made.means["is_jammed"][1] < 1.0
    chart = drawn(made.path)["is_jammed"]
    assert chart.get_ylabel() == "share that is jammed"
    assert chart.containers[0].lines[0].get_ydata().tolist() == made.means["is_jammed"].tolist()


def test_agents_of_each_kind_are_counted_in_one_chart(tmp_path, drawn):
    gridlock.run({"model.kind": "epidemic", "epidemic.count": 60, "run.steps": 20, "observe.every": 5}, tmp_path / "out")
    series = gridlock.open(tmp_path / "out").series
    chart = drawn(tmp_path / "out")["health"]
    assert [line.get_label() for line in chart.lines] == ["susceptible", "infected", "recovered"]
    assert np.array_equal(sum(line.get_ydata() for line in chart.lines), series["agents"])


def test_the_mean_displacement_has_logarithmic_axes_and_its_error(tmp_path, drawn):
    gridlock.run({"disks": {"count": 36, "packing_fraction": 0.4}, "box": OBLONG, "run.steps": 60, "observe.every": 10}, tmp_path / "out")
    axes, result = drawn(tmp_path / "out")["displacement"], gridlock.open(tmp_path / "out").results["mean_displacement"]
    assert axes.get_xscale() == axes.get_yscale() == "log" and axes.lines[0].get_marker() == "o"
    ((low, high),) = [segment[:, 1] for segment in axes.containers[0].lines[2][0].get_segments()]
    assert (high - low) / 2 == pytest.approx(result.error) and result.error > 0
    assert axes.get_xlabel() == "time t / (length / speed)"


def test_growth_of_stresses_and_free_flights_are_drawn_as_they_were_measured(tmp_path, drawn):
    gridlock.run(
        {"box": {"edge": "periodic"}, "disks": {"count": 60, "packing_fraction": 0.3}, "engine": {"kind": "exact"}, "run": {"steps": 1200},
         "observe": {"every": 2, "structure_every": 0, "viscosity_lag": 6, "free_flights": True}},
        tmp_path / "out")
    run = gridlock.open(tmp_path / "out")
    axes = drawn(run.path)
    growth = run.table("stress_growth")
    for line, part in zip(axes["stress_growth"].lines, ("shear", "bulk")):
        assert np.array_equal(line.get_ydata(), growth[f"{part}_growth"] / growth["lag"])
    for name in ("free_time", "free_path"):
        flights = run.table(f"{name}_distribution")
        assert np.array_equal(axes[f"{name}_distribution"].lines[0].get_ydata(), flights["density"][flights["flights"] > 0])


def test_curves_on_request_are_drawn_as_they_were_measured(tmp_path, drawn):
    gridlock.run(
        {"box": OBLONG, "disks": {"count": 80, "packing_fraction": 0.4}, "engine": {"kind": "exact"}, "run": {"steps": 400},
         "observe": {"every": 5, "density_profile": "both", "displacement_lag": 12, "local_density_every": 2, "clusters_every": 2,
                     "orientation_correlation": True}},
        tmp_path / "out")
    run = gridlock.open(tmp_path / "out")
    axes = drawn(run.path)
    for name, x, y in [("density_profile_x", "position", "number_density"), ("density_profile_y", "position", "number_density"),
                       ("mean_squared_displacement", "lag", "mean_squared_displacement"),
                       ("local_density", "agents_in_cell", "share_of_cells")]:
        assert np.array_equal(axes[name].lines[0].get_xdata(), run.table(name)[x])
        assert np.array_equal(axes[name].lines[0].get_ydata(), run.table(name)[y])
    assert axes["density_profile_x"].get_xlabel() == "x / length"
    correlations = run.table("pair_correlation")
    positive = correlations["orientation_correlation"] > 0
    assert np.array_equal(axes["orientation_correlation"].lines[0].get_ydata(), correlations["orientation_correlation"][positive])
    sizes = run.table("cluster_sizes")
    assert np.allclose(axes["cluster_sizes"].lines[0].get_ydata() * (sizes["largest_size"] - sizes["size"] + 1), sizes["clusters"])
