"""What the study concludes from numbers: statistics and theory against exact cases, texts against made-up evidence."""

import dataclasses
import math

import numpy as np
import pytest

from gridlock_studies import report, style
from gridlock_studies.chapter import Table
from gridlock_studies.paper import figure_5, physics_or_step, step_cost, turn_order
from gridlock_studies.paper.theory import enskog_diffusion, mean_distance, mean_distance_after_diffusion, mean_distance_in_square
from gridlock_studies.statistics import (Crossing, Estimate, MeanOfRuns, Verdict, find_crossing, fit_power_law, joint_deviation,
                                       mean_over_runs, tail_mean, three_sigma, verdict_on_fall)


def test_means_over_runs_have_the_textbook_error():
    assert mean_over_runs([1.1, 0.9]) == (1.0, pytest.approx(0.1))
    values = [3.0, 5.0, 4.0, 8.0]
    assert mean_over_runs(values) == (5.0, pytest.approx(np.std(values, ddof=1) / 2.0))
    assert mean_over_runs([2.0]) == (2.0, None)


def test_the_mean_of_a_tail_leaves_out_the_start():
    series = np.array([90.0, 1.0, 2.0, 3.0, 4.0, 5.0])  # a start and five samples
    assert tail_mean(series, 0.5) == 4.5  # of two
    assert tail_mean(series, 0.6) == 4.0
    assert tail_mean(series, 1.0) == 3.0
    assert tail_mean(series, 0.01) == tail_mean(series[-2:], 0.2) == 5.0  # at least one


@pytest.mark.parametrize("estimate, text", [
    (Estimate(0.51812, 0.00118), "0.5181 ± 0.0012"), (Estimate(0.51812), "0.5181"), (Estimate(-1.234, 0.06), "−1.234 ± 0.060"),
    (Estimate(123.4, 56.7), "123 ± 57"), (Estimate(0.0, 0.0), "0"),
])
def test_estimates_are_written_to_the_second_digit_of_their_error(estimate, text):
    assert str(estimate) == text


def test_three_sigma_is_exceeded_by_chance_as_often_as_three_standard_deviations():
    """Student's |t| beyond x by the midpoint rule in the angle atan(t/√n), where the density is cosⁿ⁻¹."""
    for n in range(1, 61):
        scale = math.exp(math.lgamma(0.5 * (n + 1)) - math.lgamma(0.5 * n)) / math.sqrt(math.pi)
        start = math.atan(three_sigma(n) / math.sqrt(n))
        angles = start + (0.5 * math.pi - start) * (np.arange(20_000) + 0.5) / 20_000
        chance = 2.0 * scale * np.mean(np.cos(angles) ** (n - 1)) * (0.5 * math.pi - start)
        assert chance == pytest.approx(math.erfc(3.0 / math.sqrt(2.0)), rel=1e-5)


def law(noise, seed):
    random = np.random.default_rng(seed)
    x = np.array([(n, k) for n in (100.0, 200.0, 400.0, 700.0, 1100.0) for k in (10.0, 15.0, 20.0)])
    return x, 3.0 * x[:, 0] ** 1.7 * x[:, 1] ** -2.2 * np.exp(noise * random.standard_normal(len(x)))


def test_a_power_law_is_found_exactly_where_there_is_one():
    fit = fit_power_law(*law(0.0, 1))
    assert fit.prefactor == pytest.approx(3.0, abs=1e-9)
    assert [one.value for one in fit.exponents] == pytest.approx([1.7, -2.2], abs=1e-12)
    assert fit.exponents[0].error < 1e-12


def test_errors_of_a_power_law_are_the_scatter_of_fits():
    fits = [fit_power_law(*law(0.1, seed)).exponents for seed in range(2000)]
    for which, truth in ((0, 1.7), (1, -2.2)):
        deviations = np.mean([(fit[which].value - truth) ** 2 for fit in fits])
        # A variance from 2000 deviations is known to √(2/2000) = 3.2 %.
        assert np.mean([fit[which].error ** 2 for fit in fits]) == pytest.approx(deviations, rel=0.13)


def test_a_power_law_is_none_where_points_do_not_fix_it():
    assert fit_power_law([[1.0], [2.0]], [5.0, 40.0]).exponents[0] == (pytest.approx(3.0), None)
    assert fit_power_law([], []) is None
    assert fit_power_law([[2.0]], [1.0]) is None
    assert fit_power_law([[1.0, 10.0], [2.0, 10.0], [3.0, 10.0]], [1.0, 4.0, 9.0]) is None  # k never changes


def exponential(xs, error=None):
    return [(x, Estimate(y := math.exp(-10.0 * (x - 0.5)), None if error is None else error * y)) for x in xs]


def test_a_crossing_of_an_exponential_is_exact_wherever_the_points_lie():
    for xs in ((0.1, 0.9), (0.1, 0.6, 0.75, 0.8), (0.0, 0.2, 0.73, 0.9)):
        crossing = find_crossing(exponential(xs), 0.1)
        assert crossing.is_crossed and not crossing.comes_back
        assert crossing.x == pytest.approx(0.5 + math.log(10.0) / 10.0, abs=1e-12)
        assert crossing.statistical == 0.0
    crossing = find_crossing(exponential((0.1, 0.6, 0.75, 0.8)), 0.1)
    assert (crossing.last_above, crossing.first_below) == (0.6, 0.75)


def test_a_crossing_says_how_far_away_a_straight_line_would_put_it():
    # The level is met at ½ on the logarithmic line and at 0.9/0.99 on the straight one.
    crossing = find_crossing([(0.0, Estimate(1.0)), (1.0, Estimate(0.01))], 0.1)
    assert crossing.x == pytest.approx(0.5)
    assert crossing.error == crossing.interpolation == pytest.approx(0.9 / 0.99 - 0.5)


def test_the_error_of_a_crossing_is_the_scatter_of_crossings_of_noisy_curves():
    random = np.random.default_rng(11)
    xs = (0.1, 0.7, 0.8, 0.9)
    found = [find_crossing([(x, Estimate(y.value * math.exp(0.02 * random.standard_normal()))) for x, y in exponential(xs)], 0.1).x
             for _ in range(4000)]
    # The scatter of 4000 curves is itself known to 1/√8000 = 1.1 %.
    assert find_crossing(exponential(xs, 0.02), 0.1).statistical == pytest.approx(np.std(found), rel=0.05)


def test_the_nearer_point_counts_more_in_the_error_of_a_crossing():
    # ln y falls by 4 over the interval and meets the level after a quarter of it: δx = (1 − ¼) e_1/4 or ¼ e_2/4.
    def crossing(first, second):
        level = 0.1
        return find_crossing([(0.0, Estimate(level * math.e, first * level * math.e)),
                              (1.0, Estimate(level * math.exp(-3.0), second * level * math.exp(-3.0)))], level)

    assert crossing(0.02, 0.0).x == pytest.approx(0.25)
    assert crossing(0.02, 0.0).statistical == pytest.approx(0.75 * 0.02 / 4.0)
    assert crossing(0.0, 0.02).statistical == pytest.approx(0.25 * 0.02 / 4.0)


def test_a_curve_that_does_not_cross_is_said_not_to():
    assert str(find_crossing(exponential((0.1, 0.2)), 0.1)) == "no crossing: above 10 % everywhere"
    # Touching the level is not falling below it.
    assert not find_crossing([(0.0, Estimate(1.0)), (1.0, Estimate(0.1))], 0.1).is_crossed
    assert str(find_crossing(exponential((0.8, 0.9)), 0.1)) == "no crossing: below 10 % from the lowest density on"
    assert str(find_crossing([], 0.1)) == "not measured"


def test_a_curve_that_comes_back_is_noticed():
    def curve(error):
        return find_crossing([(0.0, Estimate(1.0)), (1.0, Estimate(0.05)), (2.0, Estimate(0.2, error))], 0.1)

    assert curve(0.04).comes_back and "a denser point lies above it again" in str(curve(0.04))
    assert not curve(0.06).comes_back


def verdict(*means, runs=3):
    return verdict_on_fall([MeanOfRuns(Estimate(*mean), runs) for mean in means], 0.1)


def test_verdicts_on_a_fall():
    assert verdict((0.5, 0.01), (0.3, 0.01), (0.05, 0.001)) is Verdict.AGREES
    # A plateau whose points differ by what their errors say.
    assert verdict((0.516, 0.004), (0.524, 0.006), (0.515, 0.004), (0.05, 0.001)) is Verdict.AGREES
    assert verdict((0.5, 0.004), (0.6, 0.004), (0.05, 0.001)) is Verdict.DIFFERS
    # Each step is within its error, 6.6 · √2 · 0.004 = 0.037, and the way from the first to the fourth is not.
    assert verdict((0.50, 0.004), (0.52, 0.004), (0.54, 0.004), (0.56, 0.004), (0.05, 0.001)) is Verdict.DIFFERS
    assert verdict((0.5, 0.001), (0.3, 0.001)) is Verdict.DIFFERS
    for undecided in ([(0.516,), (0.524,), (0.05,)], [(0.5,), (0.3,), (0.05,)], []):
        assert verdict(*undecided, runs=1) is Verdict.UNDECIDED
    assert verdict((0.09, 0.01), (0.05, 0.01)) is Verdict.UNDECIDED
    assert verdict((0.5, 0.001), (0.09, 0.001)) is Verdict.UNDECIDED


@pytest.mark.parametrize("truths, scatter, runs, wanted, least, most", [
    # Six pairs on the plateau, each mistaken in 0.14 % of all cases; the scatter of single runs is the one measured there.
    ((0.52, 0.52, 0.52, 0.52, 0.14, 0.01), 0.02, 3, Verdict.DIFFERS, 0, 20),
    ((0.52, 0.52, 0.33, 0.14, 0.01), 0.05, 4, Verdict.AGREES, 950, 1000),
    ((0.30, 0.52, 0.33, 0.14, 0.01), 0.05, 4, Verdict.DIFFERS, 950, 1000),
])
def test_verdicts_in_a_thousand_made_up_studies(truths, scatter, runs, wanted, least, most):
    random = np.random.default_rng(29)
    count = 0
    for _ in range(1000):
        values = [MeanOfRuns(mean_over_runs((truth * (1.0 + scatter * random.standard_normal(runs))).tolist()), runs) for truth in truths]
        count += verdict_on_fall(values, 0.1) is wanted
    assert least <= count <= most


def square_sites(rows):
    along = (np.arange(rows) + 0.5) / rows
    return np.array([(x, y) for y in along for x in along])


def test_mean_distances_are_the_textbook_values():
    assert mean_distance(np.array([[0.5, 0.5]]), 0.0, 1.0) == pytest.approx((math.sqrt(2.0) + math.asinh(1.0)) / 6.0, abs=1e-15)
    assert mean_distance(np.array([[0.0, 0.0]]), 0.0, 1.0) == pytest.approx((math.sqrt(2.0) + math.asinh(1.0)) / 3.0, abs=1e-15)
    # The mean over sites that fill the square evenly is that of two random points; midpoints leave 1/(24 n²) of curvature.
    assert mean_distance(square_sites(300), 0.0, 1.0) == pytest.approx(mean_distance_in_square(1.0), abs=2e-6)


@pytest.mark.parametrize("packing_fraction, plateau", [(0.1, 0.51806), (0.3, 0.51574), (0.5, 0.51416), (0.7, 0.51287)])
def test_the_plateau_is_that_of_the_physics_reference(packing_fraction, plateau):
    # Computed once by an independent program for 29² sites and centres uniform in [R, 1 − R]².
    radius = math.sqrt(packing_fraction / (841 * math.pi))
    assert mean_distance(square_sites(29), radius, 1.0 - radius) == pytest.approx(plateau, abs=6e-6)


def test_diffusion_grows_from_the_plane_to_the_plateau():
    sites, lower, upper = square_sites(9), 0.01, 0.99
    assert mean_distance_after_diffusion(sites, lower, upper, 0.0) == 0.0
    assert mean_distance_after_diffusion(sites, lower, upper, 1e-6) == pytest.approx(math.sqrt(math.pi * 1e-6), rel=1e-12)
    assert mean_distance_after_diffusion(sites, lower, upper, 100.0) == pytest.approx(mean_distance(sites, lower, upper), abs=2e-4)
    curve = [mean_distance_after_diffusion(sites, lower, upper, 1e-6 * 1.6**n) for n in range(34)]
    assert all(later > 0.999 * earlier for earlier, later in zip(curve, curve[1:]))


@pytest.mark.parametrize("diffused", [0.005, 0.03, 0.2])
def test_diffusion_is_that_of_reflected_random_walks(diffused):
    sites, lower, upper = np.array([[0.15, 0.5], [0.6, 0.25], [0.8, 0.75]]), 0.1, 0.9
    starts = np.repeat(sites, 20_000, axis=0)
    # Between reflecting walls one normal step, folded back, is distributed as the whole walk.
    moved = starts - lower + math.sqrt(2.0 * diffused) * np.random.default_rng(3).standard_normal(starts.shape)
    inside = np.mod(moved, 2.0 * (upper - lower))
    ends = lower + np.minimum(inside, 2.0 * (upper - lower) - inside)
    distances = np.hypot(*(ends - starts).T)
    error = np.std(distances) / math.sqrt(len(distances))
    found = mean_distance_after_diffusion(sites, lower, upper, diffused)
    assert found == pytest.approx(np.mean(distances), abs=4.0 * error + 1e-3 * found)


@pytest.mark.parametrize("packing_fraction, diffusion, tolerance", [
    (0.05, 4.088225, 1e-3), (0.1, 1.876457, 1e-3), (0.3, 0.416750, 2e-3), (0.5, 0.142647, 1e-2), (0.6, 0.081226, 2e-2)])
def test_enskog_diffusion_is_that_of_the_physics_reference(packing_fraction, diffusion, tolerance):
    unit = 2.0 * 0.02 * math.sqrt(0.25)
    assert enskog_diffusion(packing_fraction, 0.02, 0.25) / unit == pytest.approx(diffusion, rel=tolerance)


def test_distances_of_a_look():
    assert step_cost.paper_checks(1000, 10) == step_cost.paper_checks(2000, 20) == 90_000.0
    random = np.random.default_rng(1)
    for k in (1, 3, 10):
        counts = [step_cost.checks_of_one_look(random.random((50, 2)), k) for _ in range(400)]
        error = np.std(counts) / math.sqrt(len(counts))
        assert step_cost.uniform_checks(50, k) == pytest.approx(np.mean(counts), abs=4.0 * error + 1e-9)


def crossing(x):
    return Crossing("", x - 0.01, x + 0.01, x, 0.002)


NO_CROSSING = Crossing("no crossing: above 10 % everywhere")


def evidence(**changes):
    """Made up: a rule that is like exact disks in everything."""
    starts = ("square", "triangular")
    points = [physics_or_step.Point(start, 0.5, Estimate(0.40, 0.01), Estimate(0.41, 0.01), 4) for start in starts]
    lines = [physics_or_step.Line(start, (crossing(0.60), crossing(0.70)), (crossing(0.60), crossing(0.701))) for start in starts]
    contacts = [physics_or_step.Contacts(start, 0.8, 0.1, outcome(0, 0.01, 400.0), outcome(0, 0.01, 390.0), outcome(0, 0.01, 410.0))
                for start in starts]
    return {"steps": 10_000, "points": points, "lines": lines, "contacts": contacts, **changes}


def outcome(arrested, displacement, collision_rate):
    return physics_or_step.Outcomes(arrested, 5, Estimate(displacement), collision_rate)


def conclusions(made_up):
    return "\n".join(physics_or_step.chapter_from(**made_up).conclusions)


def test_a_rule_that_agrees_with_exact_disks_is_said_to():
    text = conclusions(evidence())
    for part in ("At 2 of 2 points no difference shows at one point alone", "the rule is behind the exact disks at 2 of 2",
                 "all deviations together are -0.9 standard errors: chance explains", "is within three standard errors",
                 "that it is crossed is physics", "that it moves with the length of the run is physics",
                 'With contact = "approaching" none of 10 runs came to rest', 'With contact = "always" none of 10 runs came to rest'):
        assert part in text
    assert "every standstill is the rule's" not in text


def test_points_that_differ_are_named():
    made_up = evidence()
    made_up["points"][1] = dataclasses.replace(made_up["points"][1], packing_fraction=0.8, rule=Estimate(0.82, 0.01))
    text = conclusions(made_up)
    for part in ("At 1 of 2 points the rule and the exact dynamics differ", "φ = 0.8 triangular (2.00 times as far as exact disks)",
                 "At 1 of 2 points no difference shows at one point alone"):
        assert part in text
    assert "agree as far as the errors tell" not in text


def test_many_points_that_lag_a_little_differ_together_though_none_does_alone():
    point = physics_or_step.Point("square", 0.6, Estimate(0.29, 0.006), Estimate(0.31, 0.006), 3)
    assert not point.differs and point.resolution > 0.15
    text = conclusions(evidence(points=[point] * 12))
    assert "differ by more than chance" not in text
    assert "behind the exact disks at 12 of 12" in text and "So the rule is behind here, too." in text
    ahead = dataclasses.replace(point, rule=point.exact, exact=point.rule)
    assert "So the rule is ahead here, too." in conclusions(evidence(points=[ahead] * 12))
    assert "chance explains that in more than" in conclusions(evidence(points=[point, ahead] * 6))


def test_deviations_together_exceed_three_as_often_as_normal_ones():
    random = np.random.default_rng(1)
    for runs in (2, 3, 8):
        freedom = 2 * (runs - 1)
        samples = random.standard_t(freedom, size=(20_000, 19))
        joint = [joint_deviation(row, [freedom] * 19) for row in samples[:4_000]]
        assert np.mean(joint) == pytest.approx(0.0, abs=0.06) and np.std(joint) == pytest.approx(1.0, abs=0.05)


def cost(disks, k, times, checks):
    return step_cost.StepCost(disks, k, 0.0003 * disks, checks, checks * 1.1, 0.1, times)


@pytest.mark.parametrize(("small", "large", "verdict", "words"), [
    ([100, 101, 102], [100, 102, 101], Verdict.AGREES, "The repeats do not tell which takes longer."),
    ([100, 101, 102], [130, 131, 133], Verdict.DIFFERS, "The 2000 disks take longer: 0.94 times as many distances are checked"),
    ([137, 138, 139], [110, 111, 112], Verdict.DIFFERS, "The 2000 disks take less: 0.94 times as many distances are checked"),
    ([137, 110, 150], [123, 140, 120], Verdict.UNDECIDED, "The repeats do not tell which takes longer."),
    ([100], [100], Verdict.UNDECIDED, "One repeat has no error."),
])
def test_whether_1000_and_2000_disks_cost_the_same_follows_from_the_repeats(small, large, verdict, words):
    claims = figure_5._equal_cost_claims([cost(1000, 10, [1e-3 * t for t in small], 38e6), cost(2000, 20, [1e-3 * t for t in large], 35.6e6)])
    assert claims[1].verdict is verdict and words in claims[1].measured
    assert claims[0].verdict is Verdict.AGREES


def lines(**changes):
    return [dataclasses.replace(line, **changes) for line in evidence()["lines"]]


def test_a_crossing_that_one_side_does_not_make_is_blamed_on_the_step():
    text = conclusions(evidence(lines=lines(exact=(NO_CROSSING, NO_CROSSING))))
    assert "Exact disks do not cross it: that it is crossed under the rule is the time step" in text
    assert "whether it moves without a step cannot be told" in text and "that it is crossed is physics" not in text
    one = [lines(exact=(crossing(0.6), NO_CROSSING))[0], evidence()["lines"][1]]
    assert "The rule crosses it from 2 and exact disks from 1 of 2 starts" in conclusions(evidence(lines=one))
    assert "that it is not crossed is the time step" in conclusions(evidence(lines=lines(rule=(NO_CROSSING, NO_CROSSING))))


def test_a_crossing_elsewhere_or_at_rest_is_said_to_be():
    elsewhere = lines(exact=(crossing(0.75), crossing(0.751)))
    text = conclusions(evidence(lines=elsewhere))
    assert "is beyond three standard errors" in text and "that it moves without a step does not show" in text
    assert "length of the run is physics" not in text
    elsewhere[0] = dataclasses.replace(elsewhere[0], exact=(crossing(0.60), crossing(0.751)))
    assert "from 1 of 2 starts" in conclusions(evidence(lines=elsewhere))


def test_standstills_are_put_beside_exact_runs():
    made_up = evidence()
    made_up["contacts"][1] = dataclasses.replace(made_up["contacts"][1], approaching=outcome(3, 0.04, 41.0))
    text = conclusions(made_up)
    assert ('With contact = "approaching" 3 of 10 runs came to rest: φ = 0.8 triangular with steps of 0.1 (3 of 5). There the disks '
            "collide 0.1 times as often as exact ones at the same density and have moved 4 times as far") in text
    assert "An exact run cannot come to rest, by construction" in text and "every standstill is the rule's" in text
    for table in physics_or_step.chapter_from(**made_up).tables:
        assert {len(row) for row in table.rows} == {len(table.header)}
    made_up["contacts"][1] = dataclasses.replace(made_up["contacts"][1], exact=None)
    assert "as often as exact ones" not in conclusions(made_up)
    assert "Too few runs to tell" in conclusions(evidence(points=[], lines=[], contacts=[]))


def quantity(tiled):
    """A quantity of value 1 in stepped, with errors of 1 % over 8 starts and of 0.1 % from start to start."""
    return turn_order.Comparison(Estimate(1.0, 0.01), Estimate(tiled, 0.01), Estimate(1.25, 0.01), Estimate(tiled - 1.0, 0.001), 8)


def row(time_step, tiled, **changes):
    rates = [(column, name, quantity(tiled if column == "collision_rate" else 1.0)) for column, name in turn_order.QUANTITIES]
    settings = {"times": [128.0], "displacements": [quantity(1.0)], "centres": [quantity(1.0)], "whole": quantity(1.0), "rates": rates}
    return turn_order.Row("square", changes.pop("edge", "wall"), 0.6, time_step, **{**settings, **changes})


def text_of(rows, steps):
    return "\n".join(turn_order.conclusions_from(rows, steps))


def test_orders_that_do_not_differ_are_said_not_to_and_how_much_would_show():
    text = text_of([row(0.1, 1.0), row(0.025, 1.0)], [0.1, 0.025])
    # Student's t of 7 degrees of freedom: 4.53 errors.
    for part in ("no difference shows with steps of 0.1 or 0.025", "4 of 4 comparisons", "from 0.45 % on"):
        assert part in text
    assert "finite time step" not in text


def test_pressures_and_collisions_are_compared_start_by_start():
    # 1.2 %: less than an error of two independent means, and 12 of the difference.
    text = text_of([row(0.1, 1.012), row(0.025, 1.0)], [0.1, 0.025])
    for part in ("3 of 4 comparisons", "collisions per disk and time at φ = 0.6 square (+1.2 %, +12.0 standard errors)",
                 "So it is an effect of the finite time step",
                 "differ by at most 1.2 % with steps of 0.1, which themselves shift them by up to 20 %"):
        assert part in text


def test_what_a_shorter_step_does_not_take_away_is_not_called_the_time_step():
    text = text_of([row(0.1, 1.02), row(0.025, 1.02)], [0.1, 0.025])
    assert "1 of 4 comparisons differ with steps of 0.1, and 1 of 4 with steps of 0.025" in text
    assert "the shorter step does not take it away" in text and "effect of the finite time step" not in text
    assert "with steps of 0.1 the order of the turns changes what is measured" in text_of([row(0.1, 1.02)], [0.1])


def test_the_way_of_the_centre_in_a_periodic_box_is_told():
    def periodic(by_id, by_tile):
        centre = dataclasses.replace(quantity(by_tile), by_id=Estimate(by_id, 0.01), reference=Estimate(1e-15))
        return row(0.1, 1.0, edge="periodic", centres=[centre], rates=row(0.1, 1.0).rates[1:])

    text = text_of([periodic(4.0, 0.5)], [0.1])
    for part in ("4 of the side in stepped and 0.5 in tiled at φ = 0.6 with steps of 0.1", "3 of 3 comparisons",
                 "up to 4 times the root mean square displacement about the centre"):
        assert part in text
    assert "It does not matter" in text_of([periodic(0.001, 0.001)], [0.1])
    assert "periodic box" not in text_of([row(0.1, 1.0)], [0.1])


def test_numbers_are_typeset_where_a_report_is_read():
    cases = {"v_max": "v<sub>max</sub>", "φ_J = 0.84": "φ<sub>J</sub> = 0.84", "N^a k^b": "N<sup>a</sup> k<sup>b</sup>",
             "N^(1.59 ± 0.06)": "N<sup>1.59 ± 0.06</sup>", "Δφ^(α−1)": "Δφ<sup>α−1</sup>", "Δφ^0.49 a": "Δφ<sup>0.49</sup> a",
             "figure_7.csv": "figure_7.csv", "packing_fraction": "packing_fraction", "a < b": "a &lt; b"}
    assert {text: str(report.typeset(text)) for text in cases} == cases


def test_a_column_without_a_value_is_left_out_of_a_report():
    table = report._with_values(Table(["start", "always", "exact"], "", [["square", "–", "1"], ["triangular", "–", "–"]]))
    assert table.header == ["start", "exact"] and table.rows == [["square", "1"], ["triangular", "–"]]


def test_ticks_of_a_logarithmic_axis_are_numbers_or_powers_and_never_alone():
    from matplotlib.figure import Figure

    def labels(low, high):
        axes = Figure().subplots()
        axes.plot([low, high], [low, high])
        axes.set_xlim(low, high)
        style.logarithmic(axes, "x")
        axes.figure.draw_without_rendering()
        ticks = [*axes.xaxis.get_major_ticks(), *axes.xaxis.get_minor_ticks()]
        return {tick.label1.get_text() for tick in ticks if low <= tick.get_loc() <= high} - {""}

    assert labels(0.008, 0.15) == {"0.01", "0.02", "0.05", "0.1"}
    assert {"10,000", "100"} <= labels(50, 20_000) and not any("e" in text for text in labels(1e-8, 1))
    assert "10⁻⁶" in labels(1e-8, 1)
