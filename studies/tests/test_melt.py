"""The study of melting: made whole on a toy, continued, refused; its constructions beside what is known exactly."""

import json
import math
import pathlib

import numpy as np
import pytest

import gridlock
from conftest import rows_of
from gridlock_studies import melt
from gridlock_studies.commands.melt import main
from gridlock_studies.melt import figure_1, theory
from gridlock_studies.melt.loop import area_per_disk, density_at_pressure, find_loop, interface_free_energy
from gridlock_studies.melt.points import Point, decay_exponent
from gridlock_studies.melt.runs import CRYSTAL, LIQUID, Outcome
from gridlock_studies.statistics import Estimate, Verdict

#: The whole study on a toy: a few disks, a few starts.
TINY = melt.Extent(
    name="tiny", samples=24, constant_pressure=melt.ConstantPressure(30, (5.0,), 1000, 2),
    systems=(melt.System(30, (0.4, 0.55, 0.65, 0.7), 200.0, 2, 0), melt.System(56, (0.6, 0.74), 200.0, 2, 2),
             melt.System(80, (0.6, 0.74), 200.0, 2, 2)))
PICTURES = {"figure_1", "figure_2_order", "figure_2_susceptibility", "figure_2_distribution", "figure_3", "figure_4_correlation",
            "figure_4_peak", "figure_5", "figure_6", "figure_7"}
TABLES = {*(f"figure_{number}" for number in range(1, 8)), "figure_4_peaks", "runs"}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A study that was never interrupted."""
    directory = tmp_path_factory.mktemp("whole")
    return directory, melt.make(directory, TINY)


def test_every_figure_is_made_with_its_data(whole):
    directory, made = whole
    assert made.notes == []
    names = {path.name for path in pathlib.Path(directory).iterdir() if not path.name.startswith(".")}
    drawn = {f"{name}.{ending}" for name in PICTURES for ending in ("svg", "png")}
    assert names == drawn | {f"{name}.csv" for name in TABLES} | {"report.html"}
    assert {claim.where for claim in made.claims} == {f"Figure {number}" for number in range(1, 8)}
    text = (directory / "report.html").read_text(encoding="utf-8")
    assert all(claim.where in text for claim in made.claims)
    assert "<script" not in text and "http" not in text.replace("http://www.w3.org", "")


def test_the_numbers_are_those_of_single_runs(whole):
    directory, _ = whole
    rows = rows_of(directory / "runs.csv")
    for title in ("30 disks at 0.55 from the liquid", "30 disks at P* = 5.0"):
        row = next(row for row in rows if row["title"].startswith(title))
        simulation = gridlock.Simulation(json.loads(row["settings"]))
        simulation.run()
        assert simulation.state_hash == row["state_hash"]
        assert simulation.results[row["result"]].value == float(row["value"])


def test_every_run_has_the_density_and_about_the_collisions_that_it_claims():
    for kind in (CRYSTAL, LIQUID):
        run = melt.runs.run_of(melt.System(56, (0.7,), 400.0, 1, 0), 0.7, kind, 8, 1)
        simulation = gridlock.Simulation(json.loads(run.settings))
        simulation.run()
        assert simulation.agents.radius[0] == pytest.approx(0.5, rel=1e-9)
        assert 56 * math.pi / 4 / simulation.box.area == pytest.approx(0.7, rel=1e-9)
        assert simulation.series["collision_rate"][1:].mean() * simulation.clock.time == pytest.approx(400.0, rel=0.25)


def test_a_stopped_study_continues_with_the_same_numbers_on_any_threads(tmp_path, whole):
    directory, _ = whole

    def stop(share, what):
        if "simulations" in what:
            raise KeyboardInterrupt

    with pytest.raises(melt.Stopped):
        melt.make(tmp_path, TINY, 7, threads=1, progress=stop)
    melt.make(tmp_path, TINY, 7, threads=1)
    assert (tmp_path / "figure_7.csv").read_text() == (directory / "figure_7.csv").read_text()


def test_equal_areas_are_those_of_a_cubic():
    """P* = 9 − k(x³ − b²x) around an area: the line ends at x = ±b, and either half has the area k b⁴/4."""
    middle, half, steepness = area_per_disk(0.71), 0.01, 2e6
    areas = middle + np.linspace(-0.013, 0.013, 53)
    x = areas - middle
    points = [(math.pi / (4.0 * area), Estimate(float(value), 1e-3)) for area, value in zip(areas, 9.0 - steepness * (x**3 - half**2 * x))]
    loop = find_loop(points, draws=40)
    assert loop.pressure.value == pytest.approx(9.0, abs=1e-3)
    assert area_per_disk(loop.liquid.value) == pytest.approx(middle + half, abs=1e-5)
    assert area_per_disk(loop.solid.value) == pytest.approx(middle - half, abs=1e-5)
    assert loop.barrier.value == pytest.approx(steepness * half**4 / 4.0, rel=5e-3)
    assert 1e-4 < loop.pressure.error < 1e-3
    # In a square of N disks two interfaces are as long as the box.
    side = math.sqrt(1000 * area_per_disk(0.5 * (loop.liquid.value + loop.solid.value)))
    assert interface_free_energy(loop, 1000).value == pytest.approx(1000 * loop.barrier.value / (2.0 * side))


def test_a_pressure_that_only_rises_and_a_loop_within_its_errors_are_no_loops():
    assert find_loop([(density, Estimate(10.0 * density, 1e-3)) for density in (0.66, 0.68, 0.70, 0.72, 0.74)]) is None
    weak = [(0.68, Estimate(8.5, 0.05)), (0.70, Estimate(8.61, 0.05)), (0.71, Estimate(8.6, 0.05)), (0.72, Estimate(8.7, 0.05))]
    assert find_loop(weak) is None


def test_points_of_an_ideal_gas_at_constant_pressure_have_its_density():
    """a^N exp(−N P* a) is a gamma distribution with ⟨1/a⟩ = P*, so ⟨φ⟩ = π P*/4 for any N."""
    points = [(density, Estimate(1.0 / area_per_disk(density), 1e-4)) for density in np.linspace(0.05, 0.6, 60)]
    found = density_at_pressure(points, 0.25, 40, draws=20)
    assert found.value == pytest.approx(math.pi * 0.25 / 4.0, rel=2e-3)
    assert density_at_pressure(points[:20], 0.25, 40, draws=20) is None


def made_up(mean, *, order=0.3, seed=1, scatter=0.05, error=0.005):
    """A run whose samples of Z scatter about a mean."""
    random = np.random.default_rng(seed)
    return Outcome({"compressibility_factor": np.array([mean, error]),
                    "series.compressibility_factor": random.normal(mean, scatter, 200),
                    "series.global_bond_orientation_order": random.normal(order, 0.02, 200)})


def point_of(crystal, liquid, disks=72, density=0.65):
    return Point(disks, density, {CRYSTAL: crystal, LIQUID: liquid})


def test_starts_agree_only_where_pressures_and_order_do():
    same = [made_up(9.0 + 0.004 * seed, seed=seed) for seed in range(4)]
    assert point_of(same[:2], same[2:]).is_equilibrated
    assert point_of(same[:2], [same[2], made_up(9.5, seed=9)]).difference == "blocks of P* do not overlap"
    assert point_of(same[:2], [same[2], made_up(9.0, order=0.5, seed=9)]).difference == "blocks of |Ψ6| do not overlap"
    # Blocks that overlap may have means that do not agree.
    assert "standard errors apart" in point_of(same[:2], [made_up(9.03, seed=seed, scatter=0.2) for seed in (7, 8)]).difference
    assert point_of(same[:2], []).difference == "a start is missing"
    alone = point_of(same[:2], [made_up(9.5, seed=9)])
    assert alone.trusted == same[:2] and alone.note


def test_pressures_beside_published_ones_are_judged_by_their_errors():
    factor = 4.0 * 0.65 / math.pi
    known = theory.SMALL[72][0].pressure.value / factor

    def claim(shift):
        runs = [made_up(known + shift + 0.002 * k, seed=k + 5) for k in range(-2, 3)]
        return figure_1._small_claim({72: [point_of(runs[:2], runs[2:])]})

    assert claim(0.0).verdict is Verdict.AGREES
    assert claim(0.05).verdict is Verdict.DIFFERS
    apart = figure_1._small_claim({72: [point_of([made_up(known)], [made_up(known + 0.5, seed=2)])]})
    assert apart.verdict is Verdict.UNDECIDED and "do not overlap" in apart.measured


def test_the_exponent_of_a_power_law_is_found_and_noise_is_left_out():
    distance = np.arange(29) + 0.5
    curves = np.array([distance**-0.25, np.where(distance < 10.0, np.exp(-distance / 2.0), 0.0)])
    outcome = Outcome({"curves": curves})
    assert decay_exponent(outcome, 0) == pytest.approx(0.25, abs=1e-9)
    assert decay_exponent(outcome, 1) > 2.0
    assert math.isnan(decay_exponent(Outcome({"curves": curves[:, :5]}), 0))


@pytest.mark.parametrize(("arguments", "complaint"), [
    (["--figure", "8"], "--figure must be a whole number, from 1 to 7, but is 8"),
    (["--wrong"], "gridlock melt has no option --wrong"),
])
def test_bad_use_is_refused(capsys, arguments, complaint):
    assert main(arguments) == 2
    assert complaint in capsys.readouterr().err
