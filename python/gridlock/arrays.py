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
    refuse_masked(values, what)
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise Error(f"{what} no array of numbers: {error}\n  hint: {hint}") from None
    wanted = "iu" if integers else "iuf"
    if array.dtype.kind not in wanted and array.size > 0:
        raise Error(f"{what} no array of {'whole ' if integers else ''}numbers but of type {array.dtype}\n  hint: {hint}")
    return array


def refuse_masked(values: Any, what: str) -> None:
    """Refuses an array with masked values: what lies below a mask is no value.

    :param what: "the points are", as the error begins.
    """
    if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
        masked = int(np.ma.getmaskarray(values).sum())
        raise Error(f"{what} an array with {masked} masked values\n  hint: leave them out or fill them: array[~array.mask], array.filled(0)")


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
    number = math.nan if isinstance(value, (bool, np.bool_)) else _as_float(value)
    if not math.isfinite(number) or not number > least:
        raise Error(f"{what} is {in_short(value)}\n  hint: {hint}")
    return number


def _as_float(value: Any) -> float:
    """A real number as it is, and not a number for anything else, also for whole numbers beyond all floating-point numbers."""
    try:
        return float(value) if isinstance(value, numbers.Real) else math.nan
    except OverflowError:
        return math.nan


def in_short(value: Any) -> str:
    """A value for an error: long ones are cut."""
    try:
        text = repr(value.item() if isinstance(value, np.generic) else value)
    except ValueError:  # Python prints no whole number of more than 4,300 digits
        text = f"a whole number of {value.bit_length()} bits"
    return text if len(text) <= 60 else f"{text[:40]}… ({len(text)} characters)"


def named_in_short(values: Any) -> str:
    """A named tuple in one line: of arrays their types and shapes.

    >>> from collections import namedtuple
    >>> named_in_short(namedtuple("Curve", "q s unit")(np.zeros(3), np.zeros((2, 3)), "length"))
    "Curve(q: float64 (3,), s: float64 (2, 3), unit: 'length')"
    """
    def shown(value: Any) -> str:
        return f"{value.dtype} {value.shape}" if isinstance(value, np.ndarray) and value.ndim > 0 else in_short(value)

    fields = ", ".join(f"{name}: {shown(value)}" for name, value in zip(values._fields, values))
    return f"{type(values).__name__}({fields})"


#: The largest number of steps.
MOST_STEPS = 2**63 - 1


def as_count(value: Any, what: str, hint: str = "use a whole number, at least 1", *, least: int = 1, most: int = 2**31 - 1) -> int:
    """A whole number from ``least`` to ``most``."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        raise Error(f"{what} is {in_short(value)}\n  hint: {hint}")
    return int(value)


def as_observed(seen: Any, what: str) -> list[float]:
    """The numbers that an observable has returned, one or several; what is not defined is not a number.

    :param what: "the observable order", as the error begins.
    """
    hint = "return a number, or one for each name"
    if seen is None:
        raise Error(f"{what} returned nothing\n  hint: {hint}")
    refuse_masked(seen, f"{what} returned")
    try:
        array = np.asarray(seen)
        if array.dtype.kind in "biufO" and array.ndim <= 1 and all(value is not None for value in array.flat):
            return [float(number) for number in array.astype(np.float64).flat]
    except (TypeError, ValueError, OverflowError):
        pass
    raise Error(f"{what} returned {in_short(seen)}\n  hint: {hint}")


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


def as_column(values: Any, name: str, kind: Any) -> NDArray[Any]:
    """Values of a column of agents in its type: any numbers that it can hold, one for all or an array.

    >>> as_column([0, 1.0, True], "kind", np.uint32)
    array([0, 1, 1], dtype=uint32)
    >>> as_column(0.5, "kind", np.uint32)
    Traceback (most recent call last):
    gridlock.errors.Error: column kind: 0.5 is no whole number
      hint: its type is uint32: use whole numbers from 0 to 4294967295
    """
    wanted = np.dtype(kind)
    if type(values) is np.ndarray and values.dtype == wanted:
        return values
    refuse_masked(values, f"column {name}: the values are")
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise Error(f"column {name}: the values are no array: {error}\n  hint: {_fitting(wanted)}") from None
    unfit = _first_unfit(array, wanted)
    if unfit is not None:
        place, why = unfit
        where = "" if array.ndim == 0 else f", at {place[0] if len(place) == 1 else place}"
        raise Error(f"column {name}: {in_short(array[place])} {why}{where}\n  hint: {_fitting(wanted)}")
    return array.astype(wanted, copy=False)


def _fitting(wanted: np.dtype[Any]) -> str:
    if wanted.kind not in "iu":
        return f"its type is {wanted}: use numbers"
    return f"its type is {wanted}: use whole numbers from {np.iinfo(wanted).min} to {np.iinfo(wanted).max}"


def _first_unfit(array: NDArray[Any], wanted: np.dtype[Any]) -> tuple[tuple[int, ...], str] | None:
    """The place of the first value that the type cannot hold, and why; nothing where it can hold all."""
    if array.dtype.kind not in "biuf":
        # Texts, complex numbers, and whole numbers beyond 64 bits.
        for place in np.ndindex(array.shape):
            why = _why_unfit(array[place], wanted)
            if why is not None:
                return place, why
        return None
    if wanted.kind == "f" or np.can_cast(array.dtype, wanted):
        return None
    limits = np.iinfo(wanted)
    with np.errstate(invalid="ignore"):
        fits = np.trunc(array) == array if array.dtype.kind == "f" else np.ones(array.shape, dtype=np.bool_)
        # As a floating-point number the largest one of 64 bits is one too large.
        fits &= (array >= limits.min) & ((array <= limits.max) if array.dtype.kind != "f" else (array < float(limits.max) + 1.0))
    if fits.all():
        return None
    place = tuple(int(k) for k in np.argwhere(~fits)[0])
    return place, _why_unfit(array[place], wanted) or "does not fit"


def _why_unfit(value: Any, wanted: np.dtype[Any]) -> str | None:
    """Why a column of that type cannot hold a value; nothing where it can."""
    if not isinstance(value, (numbers.Real, np.bool_)):
        return "is no number"
    is_float = isinstance(value, (float, np.floating))
    if wanted.kind == "f":
        return None if is_float or math.isfinite(_as_float(int(value) if isinstance(value, np.bool_) else value)) else "is too large"
    number: Any = value
    if (is_float and not math.isfinite(number)) or int(number) != number:
        return "is no whole number"
    limits = np.iinfo(wanted)
    if int(number) < limits.min:
        return f"is below {limits.min}"
    return f"is above {limits.max}" if int(number) > limits.max else None
