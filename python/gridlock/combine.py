"""Means over runs of several seeds, with errors from their differences and from their blocks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from .arrays import as_array, named_in_short
from .errors import Error
from .simulation import Result

Number = Union[float, "NDArray[np.float64]"]


class Combined(NamedTuple):
    """A mean over runs, numbers or arrays of the shape of what was combined. An error that is not known is not a number."""

    value: Number
    error: Number  #: one standard error: the larger one of the next two
    error_by_scatter: Number  #: from the differences between the runs; unknown for one run
    error_by_runs: Number  #: from the errors of the runs, those of blocks; unknown where one has none
    chi_squared: Number  #: Σ (value − mean)² / error²: near ``runs − 1`` where the runs agree within their errors
    runs: int
    unit: str = ""

    def __repr__(self) -> str:
        return named_in_short(self)


def combine(runs: Sequence[Any]) -> Any:
    """The mean of what equally good runs have measured, such as runs of different seeds.

    error = max(√(Σ (v − mean)² / (n (n − 1))), √(Σ e²) / n): the scatter of few runs is a poor estimate, and the errors of the
    runs know nothing of what changes more slowly than their blocks, or from start to start. A χ² far above n − 1 says that the
    runs differ by more than their errors. Every run counts alike: weights from errors would favour those that are too small by
    chance.

    :param runs: one entry for each run: a :class:`Result`; or ``(value, error)``, numbers or arrays of one shape; or all
        ``results`` of a run, or any other mapping of names.
    :returns: :class:`Combined`; of mappings a dictionary of them, for the names that all runs have.
    :raises Error: for no runs, arrays of different shapes, different units, and mappings without a common name.

    Cost: O(runs · numbers). Source: H. Flyvbjerg, H. G. Petersen (1989), doi:10.1063/1.457480, for the errors of the runs.

    >>> both = combine([(1.0, 0.1), (1.4, 0.1)])
    >>> round(both.value, 9), round(both.error, 9), round(both.chi_squared, 9)
    (1.2, 0.2, 8.0)
    """
    entries = list(runs)
    if not entries:
        raise Error("there are no runs to combine\n  hint: give one result for each run")
    if all(isinstance(entry, Mapping) for entry in entries):
        shared = [name for name in entries[0] if all(name in entry for entry in entries)]
        if not shared:
            raise Error(f"the runs have no name in common; the first has {', '.join(map(str, entries[0])) or 'none'}\n"
                        "  hint: combine what all runs have alike")
        return {name: combine([entry[name] for entry in entries]) for name in shared}
    pairs = [_value_and_error(entry) for entry in entries]
    shape = pairs[0][0].shape
    if any(part.shape != shape for pair in pairs for part in pair):
        raise Error(f"the runs have values and errors of the shapes {[(v.shape, e.shape) for v, e in pairs]}\n"
                    "  hint: combine what all runs have alike")
    values, errors = (np.array([pair[k] for pair in pairs]).reshape(len(pairs), -1) for k in (0, 1))
    found = _core.combine(values, errors)
    value, error, by_scatter, by_runs, chi = (float(row[0]) if shape == () else row.reshape(shape) for row in found)
    units = {entry.unit for entry in entries if isinstance(entry, (Result, Combined))} or {""}
    if len(units) > 1:
        raise Error(f"the runs have the units {', '.join(repr(unit) for unit in sorted(units))}\n  hint: combine what all runs have alike")
    unit = units.pop()
    return Combined(value, error, by_scatter, by_runs, chi, len(pairs), unit)


def _value_and_error(entry: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    hint = "use results, (value, error), or mappings of names to them"
    is_pair = isinstance(entry, (tuple, list)) and (isinstance(entry, (Result, Combined)) or len(entry) == 2)
    if not is_pair:
        raise Error(f"{entry!r} is no result\n  hint: {hint}")
    value = as_array(entry[0], "the values are", hint).astype(np.float64)
    if entry[1] is None:
        return value, np.full(value.shape, np.nan)
    error = as_array(entry[1], "the errors are", hint).astype(np.float64)
    if (error < 0).any():
        raise Error(f"there is an error of {error.min()}\n  hint: errors are 0 or above")
    return value, error
