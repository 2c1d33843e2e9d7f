"""Means with errors, what they can tell, and how they are written."""

from __future__ import annotations

import dataclasses
import enum
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Verdict(enum.Enum):
    """What the measurements say about a claim."""

    AGREES = "agrees"
    DIFFERS = "differs"
    UNDECIDED = "not decided"


class Estimate(NamedTuple):
    """A number with one standard error, ``None`` where the data cannot tell.

    >>> print(Estimate(0.51812, 0.00118))
    0.5181 ± 0.0012
    >>> print(Estimate(0.51812))
    0.5181
    """

    value: float
    error: float | None = None

    @property
    def known_error(self) -> float:
        """The error, 0 where there is none."""
        return self.error or 0.0

    @property
    def cells(self) -> tuple[float, float]:
        """Both numbers for a table, nan for an error that is not known."""
        return self.value, math.nan if self.error is None else self.error

    def __str__(self) -> str:
        sign = "−" if self.value < 0.0 else ""
        if not self.known_error > 0.0:
            return f"{sign}{abs(self.value):.4g}"
        decimals = min(max(1 - math.floor(math.log10(self.known_error)), 0), 12)
        return f"{sign}{abs(self.value):.{decimals}f} ± {self.known_error:.{decimals}f}"


def plain(number: float) -> str:
    """The shortest digits that are this number, and no more.

    >>> plain(0.7), plain(150.0)
    ('0.7', '150')
    """
    text = repr(float(number))
    return text[:-2] if text.endswith(".0") else text


def total(values: ArrayLike) -> float:
    """The sum from the first to the last, so that its bits do not depend on how NumPy groups them.

    >>> total([0.1, 0.2, 0.3]) == 0.1 + 0.2 + 0.3
    True
    """
    sums = np.cumsum(np.asarray(values, dtype=np.float64))
    return float(sums[-1]) if len(sums) else 0.0


def mean_over_runs(values: Sequence[float]) -> Estimate:
    """The mean of runs that are equally good, with its standard error from their scatter; a single run has none."""
    count = float(len(values))
    mean = total(values) / count
    if len(values) < 2:
        return Estimate(mean)
    return Estimate(mean, math.sqrt(total((np.asarray(values) - mean) ** 2) / (count * count - count)))


def three_sigma(degrees_of_freedom: int) -> float:
    """How many standard errors chance alone exceeds in 0.27 % of all cases, as three do of a well-known error: Student's t.

    >>> [round(three_sigma(n), 3) for n in (1, 2, 8)]
    [235.801, 19.207, 4.277]
    """
    from scipy.special import ndtr, stdtrit  # type: ignore[import-untyped]

    return float(-stdtrit(degrees_of_freedom, ndtr(-3.0)))


def verdict_within(difference: float, error: float, bound: float) -> Verdict:
    """Whether a difference is smaller than a bound, where its error can tell.

    >>> verdict_within(0.05, 0.01, 0.1).value, verdict_within(-0.2, 0.01, 0.1).value, verdict_within(0.1, 0.3, 0.1).value
    ('agrees', 'differs', 'not decided')
    """
    if math.isnan(difference) or abs(abs(difference) - bound) < error:
        return Verdict.UNDECIDED
    return Verdict.AGREES if abs(difference) < bound else Verdict.DIFFERS


def joint_deviation(deviations: Sequence[float], degrees_of_freedom: Sequence[int]) -> float:
    """How far several differences are from nothing together, in standard deviations of a normal distribution.

    Each deviation, in standard errors that are known with so many degrees of freedom, is turned into the normal deviation that chance
    exceeds as often; their sum over √n is normal too where there is no difference. Signs count, so many small differences in one
    direction show. Source: S. A. Stouffer et al., The American Soldier (1949), volume 1.

    >>> round(joint_deviation([1.0] * 16, [1000] * 16), 2)
    4.0
    """
    from scipy.special import ndtri, stdtr

    tails = stdtr(np.asarray(degrees_of_freedom, dtype=np.float64), -np.abs(np.asarray(deviations, dtype=np.float64)))
    normal = -np.sign(deviations) * ndtri(np.maximum(tails, 1e-300))
    return float(total(normal) / math.sqrt(len(deviations)))


class PowerLaw(NamedTuple):
    """y = prefactor · x_1^p_1 · x_2^p_2 …"""

    prefactor: float
    exponents: tuple[Estimate, ...]


def fit_power_law(x: ArrayLike, y: ArrayLike) -> PowerLaw | None:
    """The power law nearest to the points by least squares of ln y; x has shape (points, exponents).

    Errors come from the scatter of the points about the law, so that there are none where there are no more points than
    parameters. None where the points do not fix all exponents.

    >>> law = fit_power_law([[1.0], [2.0], [4.0]], [3.0, 12.0, 48.0])
    >>> round(law.prefactor, 9), round(law.exponents[0].value, 9)
    (3.0, 2.0)
    """
    logarithms = np.log(np.asarray(x, dtype=np.float64))
    heights = np.log(np.asarray(y, dtype=np.float64))
    if logarithms.ndim != 2 or len(heights) < logarithms.shape[1] + 1:
        return None
    # Centred, the constant needs no equation of its own.
    middle, height = logarithms.mean(axis=0), heights.mean()
    centred = logarithms - middle
    if np.linalg.matrix_rank(centred, tol=1e-9 * max(1.0, float(np.abs(centred).max()))) < centred.shape[1]:
        return None
    exponents: NDArray[np.float64] = np.linalg.lstsq(centred, heights - height, rcond=None)[0]
    freedom = len(heights) - centred.shape[1] - 1
    errors: list[float | None] = [None] * len(exponents)
    if freedom > 0:
        misfit = heights - height - centred @ exponents
        covariance = np.linalg.inv(centred.T @ centred) * (misfit @ misfit / freedom)
        errors = [math.sqrt(variance) for variance in np.diag(covariance)]
    prefactor = math.exp(height - float(exponents @ middle))
    return PowerLaw(prefactor, tuple(Estimate(float(p), error) for p, error in zip(exponents, errors)))


@dataclasses.dataclass(frozen=True)
class Crossing:
    """The first interval in which a curve falls from a level or above to below it; or why there is none."""

    missing: str = ""  #: in words; empty where the curve crosses
    last_above: float = 0.0  #: x of the two points around it
    first_below: float = 0.0
    x: float = 0.0  #: where the straight line between them in (x, ln y) meets the level
    statistical: float = 0.0  #: standard error of x from those of the two points, 0 where they have none
    interpolation: float = 0.0  #: how far away a straight line in (x, y) would put it
    comes_back: bool = False  #: whether a later point lies more than two standard errors above the level again

    @property
    def is_crossed(self) -> bool:
        return not self.missing

    @property
    def error(self) -> float:
        """Both errors together."""
        return math.hypot(self.statistical, self.interpolation)

    def __str__(self) -> str:
        if self.missing:
            return self.missing
        again = "; a denser point lies above it again" if self.comes_back else ""
        return f"{Estimate(self.x, self.error)} (between {plain(self.last_above)} and {plain(self.first_below)}{again})"

    def moved_from(self, other: Crossing) -> Estimate:
        """How far it is from another, with both errors."""
        return Estimate(self.x - other.x, math.hypot(self.error, other.error))


NOT_MEASURED = "not measured"


def find_crossing(points: Sequence[tuple[float, Estimate]], level: float) -> Crossing:
    """Looks along points in rising x.

        x = x_1 + (x_2 − x_1) s,   s = ln(y_1/level) / ln(y_1/y_2)

    The displacement of dense disks falls by a factor rather than a difference from one density to the next, hence the logarithm.
    """
    percent = plain(100.0 * level)
    if not points:
        return Crossing(NOT_MEASURED)
    below = next((k for k, (_, y) in enumerate(points) if y.value < level), None)
    if below is None:
        return Crossing(f"no crossing: above {percent} % everywhere")
    if below == 0:
        return Crossing(f"no crossing: below {percent} % from the lowest density on")
    (x1, y1), (x2, y2) = points[below - 1], points[below]
    width, fall = x2 - x1, math.log(y1.value / y2.value)
    share = math.log(y1.value / level) / fall
    x = x1 + width * share
    # ∂s/∂ln y1 = (1 − s)/fall and ∂s/∂ln y2 = s/fall.
    relative = math.hypot((1.0 - share) * y1.known_error / y1.value, share * y2.known_error / y2.value)
    straight = x1 + width * (y1.value - level) / (y1.value - y2.value)
    comes_back = any(y.value > level + 2.0 * y.known_error for _, y in points[below + 1:])
    return Crossing("", x1, x2, x, width / fall * relative, abs(straight - x), comes_back)


class MeanOfRuns(NamedTuple):
    """A mean over runs that differ in the seed alone; its error is the one over seeds."""

    mean: Estimate
    runs: int

    @property
    def has_error(self) -> bool:
        return self.mean.error is not None and self.runs > 1

    def exceeds(self, other: MeanOfRuns) -> bool:
        """Whether it is larger, and chance explains that in less than 0.3 % of all cases."""
        if not (self.has_error and other.has_error):
            return False
        error = math.hypot(self.mean.known_error, other.mean.known_error)
        return self.mean.value - other.mean.value > three_sigma(self.runs + other.runs - 2) * error


def verdict_on_fall(values: Sequence[MeanOfRuns], level: float) -> Verdict:
    """Whether values fall from the first to the last and end below a level, as far as their errors can tell.

    Differs where a later value exceeds an earlier one, neighbours or not, or the last exceeds the level. Agrees where neither
    does, the first exceeds the last and the level exceeds the last. Undecided otherwise, always where no value has an error.
    """
    if any(later.exceeds(earlier) for k, later in enumerate(values) for earlier in values[:k]):
        return Verdict.DIFFERS
    if len(values) < 2 or not values[-1].has_error:
        return Verdict.UNDECIDED
    last = values[-1]
    allowed = three_sigma(last.runs - 1) * last.mean.known_error
    if last.mean.value - level > allowed:
        return Verdict.DIFFERS
    is_below = level - last.mean.value > allowed
    return Verdict.AGREES if is_below and values[0].exceeds(last) else Verdict.UNDECIDED


def tail_mean(values: NDArray[Any], share: float) -> float:
    """The mean of the last ``share`` of the samples, at least one; the first is the start and does not count."""
    count = max(1, math.floor(share * float(len(values) - 1)))
    return total(values[-count:]) / count


def span_text(values: Iterable[float]) -> str:
    """The least and the most of some ratios: "0.8 to 1.2"."""
    listed = list(values)
    low, high = f"{min(listed):.2g}", f"{max(listed):.2g}"
    return low if low == high else f"{low} to {high}"
