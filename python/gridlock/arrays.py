"""What users hand over, made into what the library takes, or refused in words."""

from __future__ import annotations

import math
import numbers
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray


def as_array(values: Any, what: str, hint: str, *, integers: bool = False) -> NDArray[Any]:
    """An array of real numbers as NumPy has it; nothing is dropped or guessed.

    :param what: "the points are", as the error begins.
    :raises Error: for masked values, complex numbers, booleans, texts, objects and ragged lists.

    >>> as_array([[1, 2]], "the points are", "").shape
    (1, 2)
    """
    if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
        masked = int(np.ma.getmaskarray(values).sum())
        raise Error(f"{what} an array with {masked} masked values\n  hint: leave them out or fill them: array[~array.mask], array.filled(0)")
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise Error(f"{what} no array of numbers: {error}\n  hint: {hint}") from None
    wanted = "iu" if integers else "iuf"
    if array.dtype.kind not in wanted and array.size > 0:
        raise Error(f"{what} no array of {'whole ' if integers else ''}numbers but of type {array.dtype}\n  hint: {hint}")
    return array


def as_numbers(values: Any, what: str, shape: tuple[int | None, ...], hint: str, *, finite: bool = True) -> NDArray[np.float64]:
    """An array of float64 in one piece; not copied where it is one.

    :param what: "the points", as the error begins.
    :param shape: what it must have, ``None`` for any length.
    :raises Error: for what is no array of real numbers of this shape, and where not all of them are finite.
    """
    array = np.ascontiguousarray(as_array(values, f"{what} are", hint), dtype=np.float64)
    fits = array.ndim == len(shape) and all(wanted in (None, length) for wanted, length in zip(shape, array.shape))
    if not fits:
        raise Error(f"{what} have shape {array.shape}\n  hint: {hint}")
    if finite and not np.isfinite(array).all():
        place = tuple(int(k) for k in np.argwhere(~np.isfinite(array))[0])
        raise Error(f"{what} have the value {array[place]} at {place}\n  hint: every number must be finite")
    return array


def as_number(value: Any, what: str, hint: str = "use a positive number", *, least: float = 0.0) -> float:
    """A finite real number above ``least``.

    >>> as_number("x", "the cutoff")
    Traceback (most recent call last):
    gridlock.errors.Error: the cutoff is 'x'
      hint: use a positive number
    """
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    is_real = isinstance(value, numbers.Real) and not isinstance(value, (bool, np.bool_))
    if not is_real or not math.isfinite(value) or not value > least:
        raise Error(f"{what} is {value!r}\n  hint: {hint}")
    return float(value)


#: The largest number of steps.
MOST_STEPS = 2**63 - 1


def as_count(value: Any, what: str, hint: str = "use a whole number, at least 1", *, least: int = 1, most: int = 2**31 - 1) -> int:
    """A whole number from ``least`` to ``most``."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        raise Error(f"{what} is {value!r}\n  hint: {hint}")
    return int(value)


def as_kinds(kinds: Any, count: int) -> NDArray[np.uint32]:
    """The kind of each of ``count`` agents, numbered from 0 in the order of the labels; any whole numbers will do as labels.

    >>> as_kinds([7, 3, 7], 3)
    array([1, 0, 1], dtype=uint32)
    """
    hint = f"give one whole number for each of the {count} agents"
    array = as_array(kinds, "the kinds are", hint, integers=True)
    if array.shape != (count,):
        raise Error(f"the kinds have shape {array.shape}\n  hint: {hint}")
    return np.unique(array, return_inverse=True)[1].reshape(-1).astype(np.uint32)
