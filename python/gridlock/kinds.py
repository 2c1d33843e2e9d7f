"""Kinds of agents in one model, such as wolves and sheep, each with columns of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .arrays import in_short
from .errors import Error

if TYPE_CHECKING:
    from .models import Model

#: The column that says which kind an agent is.
COLUMN = "kind"


class ColumnOfModel(NamedTuple):
    """A column of the agents of a model."""

    type: str
    kinds: list[int]  #: the kinds that have it, in ascending order; empty where all agents have it


def columns_of(model: type[Model]) -> dict[str, ColumnOfModel]:
    """All columns besides x and y, in their order in memory: of models with kinds ``kind`` first.

    :raises Error: for one column of two types, and for kinds that are no columns by names.
    """
    _require_mappings(model)
    columns = {COLUMN: ColumnOfModel("uint32", [])} if model.kinds else {}
    columns.update({name: ColumnOfModel(np.dtype(kind).name, []) for name, kind in model.columns.items()})
    for number, (title, own) in enumerate(model.kinds.items()):
        for name, kind in own.items():
            found = columns.setdefault(name, ColumnOfModel(np.dtype(kind).name, []))
            if found.type != np.dtype(kind).name or name in model.columns:
                raise Error(f"the column {name} of the kind {title} is a column of other agents of the model {model.name}\n"
                            "  hint: kinds may share a column of one type; what all agents have belongs into columns")
            found.kinds.append(number)
    return {name: column._replace(kinds=[]) if len(column.kinds) == len(model.kinds) else column for name, column in columns.items()}


def own_columns_of(model: Model, kind: int) -> dict[str, np.dtype[Any]]:
    """The columns that an agent of a kind has besides those of all agents."""
    return {name: np.dtype(found) for name, found in list(model.kinds.values())[kind].items()}


def number_of(model: Model, kind: str) -> int:
    """The value of the column ``kind``."""
    return list(model.kinds).index(kind)


def _require_mappings(model: type[Model]) -> None:
    hint = "name two kinds or more, each with its columns: kinds = {\"wolf\": {\"energy\": float}, \"sheep\": {}}"
    if not isinstance(model.kinds, Mapping) or not all(isinstance(own, Mapping) for own in model.kinds.values()):
        raise Error(f"the model {model.__name__} has the kinds {in_short(model.kinds)}\n  hint: {hint}")
    if len(model.kinds) == 1:
        raise Error(f"the model {model.__name__} has one kind, {in_short(next(iter(model.kinds)))}\n  hint: {hint}")
    if model.kinds and COLUMN in model.columns:
        raise Error(f"the model {model.__name__} has kinds and a column {COLUMN}\n  hint: the kinds are in a column of this name; choose another")


def require_kinds(model: type[Model], columns: Mapping[str, ColumnOfModel], is_taken: Any, types_of_columns: Mapping[str, str]) -> None:
    """Refuses kinds that a model cannot have.

    :param is_taken: whether a name is one of something else that a world has.
    """
    for kind in model.kinds:
        if not isinstance(kind, str) or not kind.isidentifier() or kind in columns or is_taken(kind):
            raise Error(f"the model {model.__name__} has a kind {in_short(kind)}\n  hint: choose another name, of letters, digits and _")
    for name, column in columns.items():
        if column.kinds and name in types_of_columns:
            raise Error(f"the column {name} of the model {model.__name__} is one of some kinds\n"
                        "  hint: observables take it for a column of all agents: name it in columns, or choose another name")
