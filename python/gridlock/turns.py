"""Models told agent by agent: what one agent does in a step, compiled by Numba where it is installed.

In place of ``step`` a model has a static method ``turn``, the ``cutoff`` of its neighbours or a method ``neighbors(world)`` that returns
their lists, such as those on a network, and, if it likes, ``random_numbers``, how many
uniform numbers each turn gets, and ``finish(world, bounces)``, which is called when all turns are over: for births, and for velocities
that walls turn back. ``awake(world)`` returns a mask of the agents that have a turn; the others stay as they are, and draw no random numbers.
All agents act at the same time, upon the world as it was before the step::

    @gridlock.register_model
    class Epidemic(gridlock.Model):
        name = "contagion"
        columns = {"health": np.uint32}
        events = ("infections",)
        count = gridlock.Setting(1000)
        cutoff = gridlock.Setting(0.03, unit="length")
        chance = gridlock.Setting(0.1)
        random_numbers = 3

        def start(self, start):
            start.add(positions=start.anywhere(self.count), health=np.arange(self.count) == 0)

        @staticmethod
        def turn(row, neighbors, separations, now, next, settings, random, events):
            for k in neighbors:
                if now.health[row] == 0 and now.health[k] == 1 and random[0] < settings.chance:
                    next.health[row] = 1
                    events[0] += 1
                    break
            next.dx[row] = 0.01 * (random[1] - 0.5)
            next.dy[row] = 0.01 * (random[2] - 0.5)

- ``neighbors``: the rows nearer than the cutoff; ``separations[k]``: the vector to neighbors[k], shape (2,).
- ``now.x``, ``now.y`` and all columns: arrays before the step, to be read. ``next``: the columns after it, to be written in ``row``, with the
  displacements ``next.dx`` and ``next.dy``, and ``next.dies``.
- In a model with kinds ``now.kind[row]`` says of which kind an agent is, 0, 1, 2 … in the order of ``kinds``. A column of some kinds has a row for
  every agent here too: 0 for the others, for which nothing may be written.
- ``settings``: the numbers among the settings. ``random``: ``random_numbers`` uniform numbers. ``events``: a count for each of ``events``.

Numba compiles at the first step, for some seconds; afterwards Vicsek's flock takes about three times as long as in C++. Indices beyond an
array end the run. Without Numba the same function runs in Python, some hundred times slower, with a warning.
"""

from __future__ import annotations

import functools
import inspect
import warnings
from collections import namedtuple
from collections.abc import Callable, Hashable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from .errors import Error
from .kinds import COLUMN
from .neighbors import Neighbors, as_neighbors

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .models import Model
    from .world import World

Result = TypeVar("Result")
parameters = ("row", "neighbors", "separations", "now", "next", "settings", "random", "events")
reserved_columns = ("dx", "dy", "dies")


def require_turn(model: type[Model]) -> None:
    """Refuses a class whose turns cannot be taken. Errors: Error."""
    what = f"the model {model.name}"
    turn = inspect.getattr_static(model, "turn")
    if not isinstance(turn, staticmethod) or tuple(inspect.signature(turn.__func__).parameters) != parameters:
        raise Error(f"turn of {what} is no function of a turn\n  hint: @staticmethod def turn({', '.join(parameters)})")
    if not hasattr(model, "cutoff") and not _names_neighbors(model):
        raise Error(f"{what} has no cutoff\n  hint: say how far its agents look, by a number, a setting or a property; or define neighbors(self, world)")
    for name in reserved_columns:
        if any(name in columns for columns in (model.columns, *model.kinds.values())):
            raise Error(f"{what} has a column {name}, a name of turns\n  hint: choose another name")


class _Layout(NamedTuple):
    """What the turns of a model see that no step changes."""

    now: Any  #: a type of named arrays; one for each class, so that Numba compiles once
    next: Any
    common: list[str]  #: columns of all agents that turns change
    own: dict[str, list[str]]  #: columns of some kinds, with the names of these kinds
    settings: Any
    sides: Any


def _layout_of(model: Model, world: World) -> _Layout:
    known: _Layout | None = vars(model).get("_layout")
    if known is not None:
        return known
    kinds = list(model.kinds)
    own = {name: [kinds[number] for number in column.kinds] for name, column in model._columns.items() if column.kinds}
    common = [name for name in model._columns if name not in own and not (kinds and name == COLUMN)]
    settings = {key: value for key, value in model.settings.items() if isinstance(value, (bool, int, float))}
    # A compiled turn reads values alone, no properties.
    sides = {name: getattr(world.box, name) for name in ("width", "height", "periodic_x", "periodic_y")}
    kind: Any = type(model)
    layout = vars(model)["_layout"] = _Layout(
        _named(kind, "Now", ("x", "y", *([COLUMN] if kinds else []), *common, *own)),
        _named(kind, "Next", (*common, *own, *reserved_columns)),
        common, own, _named(kind, "Settings", tuple(settings))(**settings), _named(kind, "Sides", tuple(sides))(**sides),
    )
    return layout


def take_turns(model: Model, world: World) -> None:
    """One step: a turn for every row."""
    kind: Any = type(model)
    layout = _layout_of(model, world)
    found = _neighbors_of(model, world)
    filled = {name: _filled(world, name, kinds) for name, kinds in layout.own.items()}
    now = layout.now(*(filled[name] if name in filled else world[name].copy() for name in layout.now._fields))
    after = [values.copy() for values in filled.values()]
    dead = np.zeros(len(world), dtype=np.bool_)
    moves = np.zeros((len(world), 2))
    then = layout.next(*(world[name] for name in layout.common), *after, moves[:, 0], moves[:, 1], dead)
    events = np.zeros(len(model.events), dtype=np.int64)
    each = getattr(model, "random_numbers", 1)
    if hasattr(model, "awake"):
        rows = world._rows_in_all(model.awake(world))
        random = world.uniform(each, rows=rows)
    else:
        rows, random = np.arange(len(world), dtype=np.uint64), world.uniform(each)
    _compiled(kind.turn)(rows, found.indptr, found.indices, layout.sides, now, then, layout.settings, random, events)
    for (name, kinds), values in zip(layout.own.items(), after):
        _put_back(world, name, kinds, values)
    for event, times in zip(model.events, events.tolist()):
        world.count(event, times)
    world.remove(dead)
    bounces = world.move(moves)
    if hasattr(model, "finish"):
        model.finish(world, bounces)


def _filled(world: World, name: str, kinds: Sequence[str]) -> NDArray[Any]:
    """A column of some kinds with a value for every agent, 0 for the others."""
    parts = [getattr(world, kind) for kind in kinds]
    filled = np.zeros(len(world), dtype=parts[0][name].dtype)
    for part in parts:
        filled[slice(*part._rows)] = part[name]
    return filled


def _put_back(world: World, name: str, kinds: Sequence[str], values: NDArray[Any]) -> None:
    """Writes such a column back. Errors: Error where a turn has written it for another kind."""
    for kind in kinds:
        part = getattr(world, kind)
        own = values[slice(*part._rows)]
        part[name][...] = own
        own[...] = 0
    if values.any():
        raise Error(f"a turn has written {name} for the agent of row {int(values.nonzero()[0][0])}, whose kind does not have it\n"
                    f"  hint: {name} is a column of {', '.join(kinds)} alone: ask for now.kind[row]")


def _names_neighbors(model: type[Model]) -> bool:
    """Whether a method, and not a setting of this name, says who the neighbours are."""
    return callable(getattr(model, "neighbors", None))


def _neighbors_of(model: Any, world: World) -> Neighbors:
    if not _names_neighbors(type(model)):
        return world.neighbors(model.cutoff)
    return as_neighbors(model.neighbors(world), len(world))


@functools.lru_cache(maxsize=None)
def _named(kind: Hashable, title: str, names: tuple[str, ...]) -> Any:
    """A type of named arrays. One for each class, so that Numba compiles once."""
    return namedtuple(title, names)


def compiled(function: Callable[..., Result]) -> Callable[..., Result]:
    """The same function, compiled by Numba at its first call where it is installed: a decorator for the loop of a step in which
    agents act one after the other.

    ::

        @compiled
        def pass_on(order, money):
            for row in order:
                money[row - 1], money[row] = money[row - 1] + money[row], 0.0

    It takes numbers and arrays of one dimension, which it may change, and uses ``math``. Without Numba it runs in Python on lists, some ten times
    slower. The results have the same bits where it computes by + - * / and sqrt on 64-bit numbers, and no array is given twice; powers and
    other functions may differ in the last bit, and only Numba lets whole numbers overflow. An index beyond the end is an IndexError. Numba
    keeps what it has compiled beside the file.
    """

    @functools.wraps(function)
    def call(*arguments: Any) -> Result:
        result: Result = _by_numba(function)(*arguments)
        return result

    return call


@functools.lru_cache(maxsize=None)
def _by_numba(function: Callable[..., Any]) -> Callable[..., Any]:
    try:
        import numba  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        return _on_lists(function)
    try:
        kept: Callable[..., Any] = numba.njit(cache=True, boundscheck=True)(function)
    except RuntimeError:  # There is no place for a cache, or no file.
        kept = numba.njit(boundscheck=True)(function)
    return kept


def _on_lists(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function in Python, which reads lists faster than arrays."""

    def call(*arguments: Any) -> Any:
        lists = [value.tolist() if isinstance(value, np.ndarray) else value for value in arguments]
        result = function(*lists)
        for value, values in zip(arguments, lists):
            if isinstance(value, np.ndarray) and value.flags.writeable:
                value[...] = values
        return result

    return call


@functools.lru_cache(maxsize=None)
def _compiled(turn: Callable[..., None]) -> Callable[..., None]:
    try:
        import numba  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        warnings.warn("turns are slow without Numba: pip install numba", stacklevel=2)
        return _all_turns(turn)
    compiled: Callable[..., None] = numba.njit(boundscheck=True)(_all_turns(numba.njit(boundscheck=True)(turn)))
    return compiled


def _all_turns(turn: Callable[..., None]) -> Callable[..., None]:
    def take(
        rows: Any, ends: Any, indices: Any, box: Any, now: Any, then: Any, settings: Any, random: Any, events: Any
    ) -> None:
        most = 0
        for row in rows:
            most = max(most, ends[row + 1] - ends[row])
        room = np.zeros((int(most), 2))  # for the separations of any agent
        for turn_of_step, row in enumerate(rows):
            neighbors = indices[ends[row] : ends[row + 1]]
            separations = room[: len(neighbors)]
            for place, k in enumerate(neighbors):
                dx = now.x[k] - now.x[row]
                dy = now.y[k] - now.y[row]
                if box.periodic_x:
                    dx -= box.width * np.rint(dx / box.width)
                if box.periodic_y:
                    dy -= box.height * np.rint(dy / box.height)
                separations[place, 0] = dx
                separations[place, 1] = dy
            turn(row, neighbors, separations, now, then, settings, random[turn_of_step], events)

    return take
