"""Dynamics of trajectories, against direct sums, exact limits and a run's own values."""

import numpy as np
import pytest
from scipy.special import j0

import gridlock


def walk(frames, agents, seed=1):
    return np.random.default_rng(seed).normal(size=(frames, agents, 2)).cumsum(axis=0)


def direct(positions, times, lag, q, length):
    """The definitions, over all pairs of frames with this lag."""
    moved = [positions[j] - positions[i] for i in range(len(times)) for j in range(i + 1, len(times))
             if abs(times[j] - times[i] - lag) < 1e-9]
    square = (np.array(moved) ** 2).sum(axis=2)
    return (len(moved), square.mean(), (square**2).mean() / (2 * square.mean() ** 2) - 1, j0(q * np.sqrt(square)).mean(),
            (square <= length**2).mean())


@pytest.mark.parametrize("times", [
    np.arange(20) * 0.25,
    np.array([block * 100 + step for block in range(5) for step in (0, 1, 2, 4, 8, 16, 32, 64)]) * 0.1,
    np.sort(np.random.default_rng(3).random(15)),
])
def test_dynamics_is_that_of_the_definitions(times):
    positions = walk(len(times), 7)
    found = gridlock.dynamics(positions, times, q=0.8, overlap_length=2.0)
    assert found.origins.sum() == len(times) * (len(times) - 1) // 2
    for k, lag in enumerate(found.lag):
        count, *curves = direct(positions, times, lag, 0.8, 2.0)
        assert found.origins[k] == count
        measured = [found.msd[k], found.non_gaussian[k], found.scattering[k], found.overlap[k]]
        assert measured == pytest.approx(curves, rel=1e-8, abs=1e-8)


def test_msd_is_that_by_fourier_transforms():
    positions = walk(50, 9)
    for drift in (True, False):
        fast = gridlock.mean_squared_displacement(positions, drift=drift)
        assert gridlock.dynamics(positions, drift=drift).msd == pytest.approx(fast[1:], rel=1e-9)


def test_every_kind_has_curves_of_its_own():
    positions = walk(30, 10)
    kinds = np.array([5, 2] * 5)
    found = gridlock.dynamics(positions, kinds=kinds, q=1.0)
    assert found.msd.shape == found.scattering_error.shape == (2, 29)
    for row, kind in enumerate((2, 5)):
        alone = gridlock.dynamics(positions[:, kinds == kind], q=1.0)
        assert found.msd[row] == pytest.approx(alone.msd) and found.scattering[row] == pytest.approx(alone.scattering)


def test_brownian_motion_has_its_known_curves():
    positions = walk(400, 300)  # D = 1/2 in units of a frame
    found = gridlock.dynamics(positions, q=0.3, lags=6)
    for value, error, exact in (
        (found.msd, found.msd_error, 2 * found.lag),
        (found.scattering, found.scattering_error, np.exp(-0.045 * found.lag)),
        (found.non_gaussian, found.non_gaussian_error, 0 * found.lag),
    ):
        known = np.isfinite(error)
        assert known[:-1].all() and not known[-1]
        assert (abs(value - exact)[known] < 5 * error[known]).all()


def test_ballistic_motion_has_its_known_curves():
    # All agents with one speed: the displacement after t is v t, in every direction.
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    velocities = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    times = np.array([0.0, 1.0, 10.0])
    found = gridlock.dynamics(times[:, None, None] * velocities, times, q=2.0, overlap_length=2.0)
    assert found.lag.tolist() == [1.0, 9.0, 10.0]
    assert found.msd == pytest.approx(0.25 * found.lag**2)
    assert found.non_gaussian == pytest.approx(-0.5)
    assert found.scattering == pytest.approx(j0(found.lag))
    assert found.overlap.tolist() == [1.0, 0.0, 0.0]


def test_errors_are_those_of_many_seeds():
    # z = (value − exact) / error has a spread near 1; errors of overlapping origins would be far too small.
    z = []
    for seed in range(100):
        found = gridlock.dynamics(walk(200, 10, seed), lags=5)
        z.append(((found.msd - 2 * found.lag) / found.msd_error)[:3])
    assert (0.6 < np.std(z, axis=0)).all() and (np.std(z, axis=0) < 1.4).all()


def test_lags_are_even_in_the_logarithm_and_threads_change_nothing():
    positions = walk(1001, 5)
    found = gridlock.dynamics(positions, lags=4, threads=2)
    assert found.lag.tolist() == [1, 10, 100, 1000]
    assert found.independent_origins.tolist() == [1000, 100, 10, 1]
    for one, two in zip(found, gridlock.dynamics(positions, lags=4)):
        assert (one is None and two is None) or np.array_equal(one, two, equal_nan=True)


def test_diffusion_coefficient_of_brownian_motion_with_its_error():
    z = []
    for seed in range(60):
        found = gridlock.dynamics(walk(300, 20, seed), lags=20)
        result = gridlock.diffusion_coefficient(found.lag, found.msd, found.msd_error, start=1, end=30)
        z.append((result.value - 0.5) / result.error)
    assert 0.5 < np.std(z) < 1.4
    assert abs(np.mean(z)) < 0.5


def test_diffusion_coefficient_of_a_line():
    lag = np.arange(1.0, 10.0)
    result = gridlock.diffusion_coefficient(lag, 3.0 + 4 * 0.7 * lag, 0.1 * lag, start=2, end=8)
    assert result.value == pytest.approx(0.7)
    assert result.error == pytest.approx(0.1 / 4) and result.unit == "length² / time"


def test_points_of_a_diffusion_coefficient_count_by_their_errors():
    random = np.random.default_rng(5)
    lag = np.arange(1.0, 9.0)
    error = 0.1 * lag**2
    msd = 2.8 * lag + error * random.standard_normal(8)
    result = gridlock.diffusion_coefficient(lag, msd, error)
    slope = np.polyfit(lag, msd, 1, w=1 / error)[0]
    assert result.value == pytest.approx(slope / 4, rel=1e-9)
    assert gridlock.diffusion_coefficient(lag, msd).value == pytest.approx(np.polyfit(lag, msd, 1)[0] / 4, rel=1e-9)


def noisy_stress(count, length, rate, seed):
    """Stresses of variance 1 that forget themselves at a rate, exactly, at times 0.1 apart."""
    random = np.random.default_rng(seed)
    keeps = np.exp(-0.1 * rate)
    stress = random.normal(size=(length, count))
    for k in range(1, length):
        stress[k] = keeps * stress[k - 1] + np.sqrt(1 - keeps**2) * stress[k]
    return stress.T


def test_viscosity_is_the_integral_of_the_correlation_of_the_stress():
    # η = A/kT ∫ ⟨σ(0)σ(t)⟩ dt = A/(kT rate); straight lines between samples miss (rate · 0.1)²/12 of it.
    z = []
    for seed in range(30):
        stress = noisy_stress(2, 4000, 2.0, seed)
        found = gridlock.shear_viscosity(0.1 * np.arange(4000), stress, area=3.0, temperature=0.5, start=2.5, end=15.0, lags=30)
        z.append((found.value - 3.0) / found.error)
    assert 0.4 < np.std(z) < 1.4 and abs(np.mean(z)) < 0.5
    one = gridlock.shear_viscosity(0.1 * np.arange(4000), stress[0], area=3.0, temperature=0.5, start=2.5, end=15.0, lags=30)
    two = gridlock.shear_viscosity(0.1 * np.arange(4000), stress[1], area=3.0, temperature=0.5, start=2.5, end=15.0, lags=30)
    assert found.value == pytest.approx(0.5 * (one.value + two.value), rel=0.05) and found.unit == "mass / time"


@pytest.mark.parametrize("call", [
    lambda: gridlock.shear_viscosity([0.0, 1.0], [[1.0]], area=1.0, temperature=1.0, start=0.1),
    lambda: gridlock.shear_viscosity([0.0], [1.0], area=1.0, temperature=1.0, start=0.1),
    lambda: gridlock.shear_viscosity(np.arange(9.0), np.ones(9), area=0.0, temperature=1.0, start=0.1),
    lambda: gridlock.shear_viscosity(np.arange(9.0), np.ones(9), area=1.0, temperature=1.0, start=8.0),
    lambda: gridlock.dynamics([[1.0, 2.0]]),
    lambda: gridlock.dynamics(np.zeros((1, 3, 2))),
    lambda: gridlock.dynamics(np.zeros((3, 0, 2))),
    lambda: gridlock.dynamics(np.full((3, 2, 2), np.nan)),
    lambda: gridlock.dynamics(walk(3, 2), [0.0, 1.0]),
    lambda: gridlock.dynamics(walk(3, 2), [0.0, 1.0, 1.0]),
    lambda: gridlock.dynamics(walk(3, 2), [0.0, 1.0, np.inf]),
    lambda: gridlock.dynamics(walk(3, 2), q=-1.0),
    lambda: gridlock.dynamics(walk(3, 2), q="2"),
    lambda: gridlock.dynamics(walk(3, 2), overlap_length=0),
    lambda: gridlock.dynamics(walk(3, 2), lags=0),
    lambda: gridlock.dynamics(walk(3, 2), kinds=[0]),
    lambda: gridlock.dynamics(walk(3, 2), kinds=["a", "b"]),
    lambda: gridlock.dynamics(walk(3, 2), threads=-1),
    lambda: gridlock.diffusion_coefficient([1.0, 2.0], [1.0]),
    lambda: gridlock.diffusion_coefficient([1.0, 2.0], [1.0, 2.0], [0.1, np.nan]),
    lambda: gridlock.diffusion_coefficient([1.0, 2.0], [1.0, 2.0], start=1.5),
    lambda: gridlock.diffusion_coefficient([1.0, 2.0], [1.0, np.nan]),
])
def test_bad_input_is_refused(call):
    with pytest.raises(gridlock.Error, match="hint"):
        call()


def test_seeds_are_combined_with_the_errors_of_both_kinds():
    curves = [gridlock.dynamics(walk(60, 8, seed), lags=6) for seed in range(4)]
    values = np.array([curve.msd for curve in curves])
    errors = np.array([curve.msd_error for curve in curves])
    both = gridlock.combine([(curve.msd, curve.msd_error) for curve in curves])
    assert both.runs == 4 and np.allclose(both.value, values.mean(axis=0))
    assert np.allclose(both.error_by_scatter, values.std(axis=0, ddof=1) / 2)
    assert np.allclose(both.error_by_runs, np.sqrt((errors**2).sum(axis=0)) / 4, equal_nan=True)
    assert np.array_equal(both.error, np.fmax(both.error_by_scatter, both.error_by_runs))
    again = gridlock.combine([gridlock.combine([gridlock.Result(v, 0.1, "length")]) for v in (1.0, 1.4)])
    assert again.unit == "length" and again.value == pytest.approx(1.2)
    chi = (((values - values.mean(axis=0)) / errors) ** 2).sum(axis=0)
    assert np.allclose(both.chi_squared, chi, equal_nan=True)


def test_results_of_runs_are_combined_by_their_names_as_a_sweep_does(tmp_path):
    base = {"disks": {"count": 49, "packing_fraction": 0.4}, "engine.kind": "exact", "run.steps": 300, "observe.every": 10}
    made = gridlock.sweep(base, {"run.seed": [1, 2, 3]}, tmp_path / "sweep")
    both = gridlock.combine([run.results for run in made.runs])
    assert len(both) > 5
    for name, combined in both.items():
        assert combined.runs == 3 and combined.unit == made.runs[0].results[name].unit
        assert combined.value == pytest.approx(made.means[name][0], rel=1e-9)
        assert combined.error == pytest.approx(made.means[name + "_error"][0], rel=1e-9, nan_ok=True)


@pytest.mark.parametrize("runs", [
    [], ["ab"], [1.0], [(1.0, -0.1)], [(1.0, "x")], [([1.0, 2.0], [0.1, 0.1]), ([1.0], [0.1])], [{"a": (1.0, 0.1)}, (1.0, 0.1)],
    [(1.0,)], [(1.0, 0.1, 2.0)], [{"a": (1.0, 0.1)}, {"b": (1.0, 0.1)}], [{}],
    [gridlock.Result(1.0, 0.1, "length"), gridlock.Result(1.0, 0.1, "time")],
    [{"a": gridlock.Result(1.0, 0.1, "length")}, {"a": gridlock.Result(1.0, 0.1, "")}],
])
def test_what_cannot_be_combined_is_refused(runs):
    with pytest.raises(gridlock.Error, match="hint"):
        gridlock.combine(runs)


def test_a_stress_of_a_flow_has_no_viscosity_of_fluctuations():
    stress = 0.5 + np.random.default_rng(1).normal(size=1000)
    with pytest.raises(gridlock.Error, match=r"the stress has the mean 0\.\d+ ± 0\.0\d+, as in a flow"):
        gridlock.shear_viscosity(np.arange(1000.0), stress, area=1.0, temperature=1.0, start=5.0)
