"""The box that agents and points lie in."""

from __future__ import annotations

import numbers
from typing import Any, NamedTuple, Union

import numpy as np

from .arrays import as_number
from .errors import Error


class Box(NamedTuple):
    """The rectangle [0, width] × [0, height], periodic or between walls.

    In a periodic box every distance is that to the nearest image.

    >>> Box(2.0, 1.0).area
    2.0
    """

    width: float
    height: float
    periodic: bool = True

    @property
    def area(self) -> float:
        return self.width * self.height


BoxLike = Union[Box, float, "tuple[float, float]", None]


def as_box(box: BoxLike) -> tuple[float, float, bool] | None:
    """A box as the library takes it: a Box, (width, height) or a side of a periodic box, or None for no box."""
    if box is None:
        return None
    hint = "use Box(width, height, periodic), (width, height), a side, or None"
    given: Any = box
    if isinstance(box, Box):
        width, height, periodic = given
    elif isinstance(box, numbers.Real) or (isinstance(box, np.ndarray) and box.ndim == 0):
        width = height = given
        periodic = True
    else:
        try:
            width, height = given
        except (TypeError, ValueError):
            raise Error(f"{box!r} is no box\n  hint: {hint}") from None
        periodic = True
    if not isinstance(periodic, (bool, np.bool_)):
        raise Error(f"periodic is {periodic!r}\n  hint: use True or False")
    return as_number(width, "the width of the box", hint), as_number(height, "the height of the box", hint), bool(periodic)
