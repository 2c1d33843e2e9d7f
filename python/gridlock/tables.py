"""Tables of numbers and words by named columns, which can be read where they are shown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Of a table that is shown: characters in a line, and rows before those between the first and the last are left out.
WIDTH, ROWS = 110, 12


class Table(np.ndarray):
    """A structured array: ``table["time"]`` is a column, ``table[3]`` a row, ``table.dtype.names`` are the names.

    Where it is shown, it has lines and columns.

    >>> structured({"step": [0, 100], "time": [0.0, 0.5]})
    step  time
       0     0
     100   0.5
    2 rows, 2 columns
    """

    def __getitem__(self, key: Any) -> Any:
        found = super().__getitem__(key)
        return found.view(np.ndarray) if isinstance(found, Table) and found.dtype.names is None else found

    def __repr__(self) -> str:
        if self.dtype.names is None or self.ndim != 1:
            return repr(self.view(np.ndarray))
        return _shown(self, list(self.dtype.names))

    __str__ = __repr__


def structured(columns: Mapping[str, Any]) -> NDArray[Any]:
    """Columns by name as one table."""
    if not columns:
        return np.empty(0, dtype=[("step", np.uint64), ("time", np.float64)]).view(Table)
    first = next(iter(columns.values()))
    table = np.empty(len(first), dtype=[(name, np.asarray(values).dtype) for name, values in columns.items()])
    for name, values in columns.items():
        table[name] = values
    return table.view(Table)


def _shown(table: Table, names: Sequence[str]) -> str:
    is_whole = len(table) <= ROWS
    rows = list(range(len(table))) if is_whole else [*range(ROWS - 4), *range(len(table) - 3, len(table))]
    columns: list[list[str]] = []
    for name in names:
        cells = [name, *(_cell(table[name][row]) for row in rows)]
        width = max(map(len, cells))
        # The first one is shown, however long it is.
        if columns and sum(len(column[0]) + 2 for column in columns) + width > WIDTH:
            break
        columns.append([cell.rjust(width) for cell in cells])
    lines = ["  ".join(cells) for cells in zip(*columns)]
    if not is_whole:
        lines.insert(ROWS - 3, "…".rjust(len(columns[0][0])))
    size = f"{len(table)} rows, {len(names)} columns"
    hidden = ", ".join(names[len(columns) :])
    if hidden:
        size += f"; not shown: {hidden if len(hidden) <= 3 * WIDTH else hidden[: 3 * WIDTH] + '…'}"
    return "\n".join([*lines, size])


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)
