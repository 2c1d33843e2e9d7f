"""Numbers on a grid over the box, which the agents of a model read and change: food, heat, a scent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import as_count, as_number, as_numbers, in_short
from .box import Box
from .errors import Error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._core import ModelWorld
    from .models import Model

_hint = "use a number of columns, (rows, columns), or the name of a setting"


class Field:
    """A field of a model: numbers on a grid of equal cells over the box, 0 at first, an entry of ``fields`` of the class.

    ::

        fields = {"grass": gridlock.Field(100), "scent": gridlock.Field("cells", "What ants leave behind.")}

    :param cells: the number of columns, with as many rows as make the cells most nearly square; (rows, columns); or the name of a
        setting that has the number of columns.

    :meth:`gridlock.Model.start` fills it, ``start.grass[...] = 1.0``, and :meth:`gridlock.Model.step` reads and changes it: see
    :class:`gridlock.World`.
    """

    def __init__(self, cells: int | str | Sequence[int], documentation: str = "") -> None:
        self.documentation = documentation
        self.cells: str | tuple[int, ...]
        if isinstance(cells, str):
            self.cells = cells
        elif isinstance(cells, Sequence):
            self.cells = tuple(_count(number) for number in cells)
            if len(cells) != 2:
                raise Error(f"a field has the cells {in_short(cells)}\n  hint: {_hint}")
        else:
            self.cells = (_count(cells),)

    def __repr__(self) -> str:
        return f"<gridlock.Field of {' × '.join(map(str, self.cells)) if isinstance(self.cells, tuple) else self.cells} cells>"

    def _shape(self, name: str, model: Model, box: Box) -> tuple[int, int]:
        """Rows and columns."""
        from .models import settings_of

        cells = self.cells
        if isinstance(cells, str):
            if cells not in settings_of(type(model)):
                raise Error(f"the field {name} has as many cells as the setting {cells!r}, which the model does not have\n"
                            f"  hint: it has {', '.join(settings_of(type(model))) or 'none'}")
            cells = (_count(getattr(model, cells)),)
        if len(cells) == 2:
            return cells[0], cells[1]
        return max(1, round(cells[0] * box.height / box.width)), cells[0]


def _rate(field: str, what: str, value: float) -> float:
    return as_number(value, f"the {what} of the field {field}", "use a finite number from 0 on", least=-1e-300)


def _count(number: Any) -> int:
    return as_count(number, "the number of cells of a field", _hint)


class FieldsOfWorld:
    """What a model does with its fields in a step."""

    _core: ModelWorld
    _model: Model
    _kind: int | None

    def cells(self, field: str, positions: ArrayLike | None = None) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The row and the column of the cell around each agent, or around each of some positions: an index of the array of the field.

        Positions beyond a periodic edge are on its other side.
        """
        if positions is None and self._kind is not None:
            positions = getattr(self, "positions")
        points = None if positions is None else as_numbers(positions, "the positions", (None, 2), "use an array of shape (N, 2)")
        cells: Any = self._core.cells(field, points)
        rows, columns = np.divmod(cells, getattr(self, field).shape[1])
        return rows, columns

    def at(self, field: str, positions: ArrayLike | None = None) -> NDArray[np.float64]:
        """The values of a field at every agent, or at some positions, shape (N,)."""
        values: NDArray[np.float64] = getattr(self, field)[self.cells(field, positions)]
        return values

    def deposit(self, field: str, amounts: ArrayLike) -> None:
        """Adds a number, or one for each agent, to the cells around the agents."""
        self._require_writable("change a field")
        self._core.deposit(field, self._amounts(amounts))

    def take(self, field: str, amounts: ArrayLike) -> NDArray[np.float64]:
        """Takes a number, or one for each agent, from the cells around the agents; returns what each got, shape (N,).

        Nobody takes more than is there. Where a cell has too little for all agents in it, they take one after the other, in an order that
        is drawn anew in each step.
        """
        self._require_writable("change a field")
        taken: Any = self._core.take(field, self._amounts(amounts))
        first, end = self._rows
        return taken[first:end]  # type: ignore[no-any-return]

    def spread(self, field: str, *, diffusion: float = 0.0, decay: float = 0.0) -> None:
        """Spreads a field for one time step by diffusion, an area over a time, and lets it decay at a rate, 1 over a time.

        The step is the exact solution of du/dt = D ∇²u − k u for cells that exchange with their four neighbours, whatever its length is;
        nothing flows through walls. It costs about 2 (7 + 10 √λ) multiplications a cell, λ = D time_step / width², on
        ``engine.threads`` threads (T. Lindeberg, 1990, doi:10.1109/34.49051).
        """
        self._require_writable("change a field")
        self._core.spread(field, _rate(field, "diffusion", diffusion), _rate(field, "decay", decay), float(self._model.time_step))

    def _require_writable(self, what: str) -> None:
        raise NotImplementedError

    @property
    def _rows(self) -> tuple[int, int]:
        raise NotImplementedError

    def _amounts(self, amounts: ArrayLike) -> NDArray[np.float64]:
        """One amount for each agent, 0 for those that are not of this kind."""
        first, end = self._rows
        if np.ndim(amounts) == 0:
            amounts = np.full(end - first, amounts)
        elif isinstance(amounts, np.ndarray) and amounts.dtype == np.bool_:
            amounts = amounts.astype(np.float64)
        own = as_numbers(amounts, "the amounts", (None,), f"use a number or an array of shape ({end - first},)")
        if self._kind is None:
            return own
        if len(own) != end - first:
            raise Error(f"there are {len(own)} amounts for {end - first} agents\n  hint: give a number, or an array of shape (N,)")
        padded = np.zeros(self._core.size())
        padded[first:end] = own
        return padded
