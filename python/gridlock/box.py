"""The box that agents and points lie in."""

from __future__ import annotations

import numbers
from typing import Any, NamedTuple, Union

import numpy as np

from .arrays import as_number
from .errors import Error


class Box(NamedTuple):
    """The rectangle [0, width] × [0, height], periodic or between walls, for x and y apart.

    Along a periodic axis every distance is that to the nearest image.

    >>> Box(2.0, 1.0).area
    2.0
    >>> channel = Box(2.0, 1.0, (True, False))  # periodic in x, with walls below and above
    >>> channel.periodic_x, channel.periodic_y
    (True, False)
    >>> sheared = Box(2.0, 1.0, tilt=0.25)  # its images above are 0.25 farther to the right
    """

    width: float
    height: float
    #: whether it is periodic: one answer for x and y, or a pair
    periodic: bool | tuple[bool, bool] = True
    #: xy/L_y of a sheared periodic box; tilts that differ by width/height have the same images
    tilt: float = 0.0

    def __repr__(self) -> str:
        tilt = f", tilt={self.tilt!r}" if self.tilt else ""
        return f"Box(width={self.width!r}, height={self.height!r}, periodic={self.periodic!r}{tilt})"

    @property
    def shift(self) -> float:
        """How much farther to the right its images above are."""
        return self.tilt * self.height

    @property
    def area(self) -> float:
        return self.width * self.height

    @property
    def periodic_x(self) -> bool:
        return self.periodic[0] if isinstance(self.periodic, tuple) else self.periodic

    @property
    def periodic_y(self) -> bool:
        return self.periodic[1] if isinstance(self.periodic, tuple) else self.periodic

    @property
    def edge_x(self) -> str:
        """"periodic" or "wall", as in the settings of a run."""
        return "periodic" if self.periodic_x else "wall"

    @property
    def edge_y(self) -> str:
        return "periodic" if self.periodic_y else "wall"


BoxLike = Union[Box, float, "tuple[float, float]", None]


#: Width, height, whether the box is periodic in x and in y, and the shift of its images above: as the library takes and gives it.
BoxValues = tuple[float, float, bool, bool, float]


def box_of(values: BoxValues) -> Box:
    """The box that the library gives: ``periodic`` is a pair only where x and y differ."""
    width, height, periodic_x, periodic_y, shift = values
    return Box(width, height, periodic_x if periodic_x == periodic_y else (periodic_x, periodic_y), shift / height)


def _as_tilt(tilt: Any) -> float:
    if not isinstance(tilt, (numbers.Real, np.number)) or not np.isfinite(float(tilt)):
        raise Error(f"the tilt of the box is {tilt!r}\n  hint: use a finite number, xy over the height")
    return float(tilt)


def as_box(box: BoxLike) -> BoxValues | None:
    """A box as the library takes it: a Box, (width, height) or a side of a periodic box, or None for no box."""
    if box is None:
        return None
    hint = "use Box(width, height, periodic), (width, height), a side, or None"
    given: Any = box
    tilt: Any = 0.0
    if isinstance(box, Box):
        width, height, periodic, tilt = given
    elif isinstance(box, numbers.Real) or (isinstance(box, np.ndarray) and box.ndim == 0):
        width = height = given
        periodic = True
    else:
        try:
            width, height = given
        except (TypeError, ValueError):
            raise Error(f"{box!r} is no box\n  hint: {hint}") from None
        periodic = True
    of_axes = periodic if isinstance(periodic, (tuple, list)) else (periodic, periodic)
    if len(of_axes) != 2 or not all(isinstance(of_axis, (bool, np.bool_)) for of_axis in of_axes):
        raise Error(f"periodic is {periodic!r}\n  hint: use True or False, or one of each for x and y: (True, False)")
    sides = as_number(width, "the width of the box", hint), as_number(height, "the height of the box", hint)
    return *sides, bool(of_axes[0]), bool(of_axes[1]), _as_tilt(tilt) * sides[1]
