"""The box that agents and points lie in."""

from __future__ import annotations

from typing import NamedTuple, Union

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
    if isinstance(box, Box):
        return float(box.width), float(box.height), bool(box.periodic)
    if isinstance(box, (int, float)):
        return float(box), float(box), True
    try:
        width, height = (float(side) for side in box)
    except (TypeError, ValueError):
        raise Error(f"{box!r} is no box\n  hint: use Box(width, height, periodic), (width, height), a side, or None") from None
    return width, height, True
