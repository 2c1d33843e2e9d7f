"""Which settings matter: Sobol indices of a model, by SALib."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import as_count, as_number, as_numbers, in_short
from .converters import library
from .errors import Error
from .models import registered_models, settings_of
from .tables import structured

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class SobolDesign:
    """Samples of settings within their bounds, for the first-order and total Sobol indices of what a model gives.

    S_k = Var(E[Y | x_k]) / Var(Y) is the share of the variance that the setting k makes by itself, T_k = 1 − Var(E[Y | all but x_k]) / Var(Y) that
    in which it has any part; x_k are independent and uniform within their bounds. Needs SALib.

    :param bounds: ``{"schelling.wanted": (1, 6), "forest_fire.density": (0.4, 0.8)}``, two whole numbers for whole numbers, both included; or a
        list of settings of models in Python that have bounds, ``least`` and ``most``, themselves.
    :param samples: a power of 2; there are samples · (settings + 2) combinations.
    :param seed: of the scrambling of the samples and of the resampling of the errors.
    :raises Error: for settings without bounds, and where SALib is not installed.

    ``points`` are the combinations, for :func:`experiment`::

        design = gridlock.SobolDesign({"sir.radius": (0.01, 0.03), "sir.speed": (0.0, 0.1)}, samples=64)
        made = gridlock.experiment({"model": gridlock.library.SIR}, design.points, steps=400, seeds=4)
        print(design.indices(made.means["recovered"]))

    Source: I. M. Sobol (2001), doi:10.1016/S0378-4754(00)00270-6; A. Saltelli et al. (2010), doi:10.1016/j.cpc.2009.09.018;
    J. Herman, W. Usher (2017), doi:10.21105/joss.00097.
    """

    def __init__(self, bounds: Mapping[str, Sequence[float]] | Sequence[str], *, samples: int = 256, seed: int = 1) -> None:
        given = dict(bounds) if isinstance(bounds, Mapping) else {key: _bounds_of(key) for key in bounds}
        if not given:
            raise Error("there are no settings to vary\n  hint: for example {'sir.radius': (0.01, 0.03)}")
        self.bounds = {key: _as_bounds(key, pair) for key, pair in given.items()}
        self.seed = as_count(seed, "the seed", "use a whole number from 0 on", least=0)
        count = as_count(samples, "samples", "use a power of 2")
        if count & (count - 1):
            raise Error(f"samples is {count}\n  hint: use a power of 2, with which Sobol's points are balanced")
        sample = library("SALib.sample.sobol", "SALib")
        self._problem = {"num_vars": len(self.bounds), "names": list(self.bounds), "bounds": [[0.0, 1.0]] * len(self.bounds)}
        shares: NDArray[np.float64] = sample.sample(self._problem, count, calc_second_order=False, seed=self.seed)
        self.points = [{key: _at(self.bounds[key], share) for key, share in zip(self.bounds, row)} for row in shares]

    def indices(self, values: ArrayLike) -> NDArray[Any]:
        """The indices of values, one for each of ``points``: a table of ``setting``, ``first``, ``first_error``, ``total``, ``total_error``. The
        errors are standard errors, by resampling; what differs between seeds counts as a part of the errors.

        :raises Error: for another number of values, for those that are not finite, and where all are equal.
        """
        numbers = as_numbers(values, "the values", (len(self.points),), f"use one number for each of the {len(self.points)} points")
        if np.ptp(numbers) == 0:
            raise Error(f"all values are {numbers[0]:g}\n  hint: no setting makes a difference within these bounds")
        analyze = library("SALib.analyze.sobol", "SALib")
        found = analyze.analyze(self._problem, numbers, calc_second_order=False, conf_level=_one_sigma, seed=self.seed)
        return structured({
            "setting": list(self.bounds), "first": found["S1"], "first_error": found["S1_conf"], "total": found["ST"], "total_error": found["ST_conf"],
        })

    def __repr__(self) -> str:
        return f"<gridlock.SobolDesign: {len(self.points)} points over {', '.join(self.bounds)}>"


#: The probability within one standard error of a normal distribution.
_one_sigma = 0.6826894921370859


def _bounds_of(key: str) -> tuple[float, float]:
    """The bounds that a setting of a model in Python has."""
    model, _, name = key.partition(".")
    for kind in registered_models():
        setting = settings_of(kind).get(name) if kind.name == model else None
        if setting is not None and np.isfinite([setting.least, setting.most]).all():
            is_whole = isinstance(setting.default, int) and not isinstance(setting.default, bool)
            return (int(setting.least), int(setting.most)) if is_whole else (setting.least, setting.most)
    raise Error(f"{key} has no bounds to take samples from\n  hint: give them, {{'{key}': (0.1, 0.5)}}")


def _as_bounds(key: str, pair: Sequence[float]) -> tuple[float, float]:
    hint = f"use two numbers, {{'{key}': (0.1, 0.5)}}"
    if isinstance(pair, str) or not isinstance(pair, (tuple, list, np.ndarray)) or len(pair) != 2:
        raise Error(f"the bounds of {key} are {in_short(pair)}\n  hint: {hint}")
    low, high = (as_number(bound, f"a bound of {key}", hint, least=-np.inf) for bound in pair)
    if not low < high:
        raise Error(f"the bounds of {key} are {low:g} and {high:g}\n  hint: give the lower one first")
    is_whole = all(isinstance(bound, (int, np.integer)) for bound in pair)
    return (int(low), int(high)) if is_whole else (low, high)


def _at(bounds: tuple[float, float], share: float) -> float:
    low, high = bounds
    if isinstance(low, int) and isinstance(high, int):
        return min(high, low + int(share * (high - low + 1)))
    return float(low + share * (high - low))
