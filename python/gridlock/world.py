"""What a model in Python sees of its world, in its start, in a step and in an observation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._core import ModelWorld
from .analysis import separations
from .arrays import as_array, as_column, as_count, as_numbers, refuse_masked
from .box import Box, box_of
from .errors import Error
from .fields import FieldsOfWorld
from .neighbors import Neighbors, as_cutoff
from .simulation import Clock

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .models import Model


class _SeenByModel:
    """What a model sees of its world in its start and in a step."""

    _core: ModelWorld
    _model: Model

    def __len__(self) -> int:
        return self._core.size()

    def __repr__(self) -> str:
        what = f"<gridlock.{type(self).__name__} of {self._model.name}"
        try:
            return f"{what}: {len(self)} agents, step {self._core.clock()[0]}>"
        except RuntimeError:
            return f"{what}: its step is over>"

    @property
    def box(self) -> Box:
        return box_of(self._core.box())

    @property
    def seed(self) -> int:
        return self._core.seed()


class Start(_SeenByModel):
    """What a model fills in its ``start``: a box without agents, and fields of zeros.

    ``start.grass`` is the field grass, an array of shape (rows, columns).
    """

    def __init__(self, core: ModelWorld, model: Model) -> None:
        self._core = core
        self._model = model

    def __getattr__(self, name: str) -> NDArray[np.float64]:
        if name.startswith("_") or name not in self._model.fields:
            raise AttributeError(f"the start has no field {name!r}; it has {', '.join(self._model.fields) or 'none'}")
        field: Any = self._core.field(name)
        return field  # type: ignore[no-any-return]

    def __setattr__(self, name: str, values: Any) -> None:
        if name.startswith("_"):
            object.__setattr__(self, name, values)
        else:
            _put_into(getattr(self, name), name, values)

    def anywhere(self, count: int) -> NDArray[np.float64]:
        """Places of so many agents anywhere in the box, shape (count, 2)."""
        places: NDArray[np.float64] = self.uniform(count, 2, purpose=0) * np.array([self.box.width, self.box.height])
        return places

    def uniform(self, count: int, size: int | None = None, *, purpose: int = 1) -> NDArray[np.float64]:
        """Random numbers in [0, 1) for each of so many agents, shape (count,) or (count, size).

        Those of an agent are a function of the seed, its number and the purpose; 0 is that of :meth:`anywhere`.
        """
        return _numbers(self._core, count, size, purpose, False)

    def normal(self, count: int, size: int | None = None, *, purpose: int = 1) -> NDArray[np.float64]:
        """The same with mean 0 and variance 1."""
        return _numbers(self._core, count, size, purpose, True)

    def add(self, **columns: ArrayLike) -> None:
        """Adds agents: a number or an array for x, y (or ``positions``) and every other column; columns left out are 0."""
        self._core.add(_new_agents(self._model, columns))


class World(_SeenByModel, FieldsOfWorld):
    """What a model sees and changes in its ``step``.

    ``world.x``, ``world["x"]`` and every other column are arrays of shape (N,), ``positions`` of shape (N, 2): the agents themselves,
    without a copy. What a step writes into them holds at once. Row k is the agent ``ids[k]`` within one step; rows change their
    order between steps.

    ``world.grass`` of a model with a field grass is that field, an array of shape (rows, columns): row 0 is at the bottom of the box.
    """

    _arrays: dict[str, NDArray[Any]]
    _is_read_only: bool

    def __init__(self, core: ModelWorld, model: Model, *, is_read_only: bool = False) -> None:
        object.__setattr__(self, "_core", core)
        object.__setattr__(self, "_model", model)
        object.__setattr__(self, "_arrays", {})
        object.__setattr__(self, "_is_read_only", is_read_only)

    @property
    def clock(self) -> Clock:
        return Clock(*self._core.clock())

    @property
    def time_step(self) -> float:
        return float(self._model.time_step)

    @property
    def ids(self) -> NDArray[np.uint64]:
        """The Id of each row, shape (N,)."""
        return self._array("ids", self._core.ids)

    @property
    def positions(self) -> NDArray[np.float64]:
        """x and y, shape (N, 2). They stay inside the box; :meth:`move` sees to that."""
        return self._array("positions", self._core.positions)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._array(name, lambda: self._core.field(name) if name in self._model.fields else self._core.column(name))

    def __setitem__(self, name: str, values: ArrayLike) -> None:
        self._require_writable(f"change {name}")
        _put_into(self[name], name, values)

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_") or not self._has(name):
            raise self._no_column(name)
        return self[name]

    def __setattr__(self, name: str, values: Any) -> None:
        if name != "positions" and not self._has(name):
            raise self._no_column(name)
        self._require_writable(f"change {name}")
        _put_into(self.positions if name == "positions" else self[name], name, values)

    def neighbors(self, cutoff: float) -> Neighbors:
        """The neighbours of every agent nearer than the cutoff, by rows, on the threads of ``engine.threads``."""
        lists: Any = self._core.neighbor_lists(as_cutoff(cutoff))
        return Neighbors(*lists)

    def pairs(self, cutoff: float) -> NDArray[np.uint32]:
        """All pairs of rows nearer than the cutoff, each once, shape (P, 2)."""
        found: Any = self._core.pairs(as_cutoff(cutoff))
        pairs: NDArray[np.uint32] = found.T
        return pairs

    def separations(self, i: NDArray[np.integer[Any]], j: NDArray[np.integer[Any]]) -> NDArray[np.float64]:
        """The vectors from the agents of rows i to those of rows j, the nearest image in a periodic box, shape (len(i), 2)."""
        return separations(self.positions, i, j, self.box)

    def uniform(self, size: int | None = None, *, purpose: int = 0) -> NDArray[np.float64]:
        """Random numbers in [0, 1) for each agent, shape (N,) or (N, size).

        A function of the seed, the step, the Id and the purpose alone: the same on any machine, and after a resume. Two calls with
        one purpose in one step give the same numbers; use another purpose for others.
        """
        return _numbers(self._core, None, size, purpose, False)

    def normal(self, size: int | None = None, *, purpose: int = 0) -> NDArray[np.float64]:
        """The same with mean 0 and variance 1."""
        return _numbers(self._core, None, size, purpose, True)

    def uniform_of_step(self, count: int) -> NDArray[np.float64]:
        """Random numbers in [0, 1) of the whole model, a function of the seed and the step, shape (count,)."""
        numbers: Any = self._core.numbers_of_step(_whole("count", count))
        return numbers  # type: ignore[no-any-return]

    def move(self, displacements: ArrayLike) -> NDArray[np.bool_]:
        """Moves every agent by its row of an array of shape (N, 2), around the edges of a periodic box or turned back by walls.

        A model with columns ``image_x`` and ``image_y`` (int32) has the edges counted there that an agent has crossed, so that trajectories
        can be unwrapped.

        :returns: in which directions walls turned it back, shape (N, 2).
        :raises RunFailure: for a displacement that is not finite or as long as a side of the box.
        """
        self._require_writable("move agents")
        array = np.asarray(as_array(displacements, "the displacements are", "use an array of numbers"), dtype=np.float64)
        if array.shape != (len(self), 2):
            raise Error(f"the displacements have shape {array.shape}\n  hint: use an array of shape ({len(self)}, 2)")
        turned: Any = self._core.move(array)
        bounces: NDArray[np.bool_] = turned.view(np.bool_)
        return bounces

    def add(self, **columns: ArrayLike) -> None:
        """Births: a number or an array for x, y (or ``positions``) and every other column. The newborn are there after the step."""
        self._require_writable("add agents")
        self._core.add(_new_agents(self._model, columns))

    def remove(self, rows: ArrayLike) -> None:
        """Deaths, by a mask of shape (N,) or by rows. The dead are gone after the step."""
        self._require_writable("remove agents")
        refuse_masked(rows, "the rows to remove are")
        array = np.asarray(rows)
        if array.dtype == np.bool_:
            if array.shape != (len(self),):
                raise Error(f"the mask has shape {array.shape}\n  hint: use one of shape ({len(self)},)")
            array = np.flatnonzero(array)
        if array.ndim != 1 or (array.size and not np.issubdtype(array.dtype, np.integer)) or np.any(array < 0):
            raise Error("agents are removed by a mask or by rows\n  hint: use an array of True and False, or of whole numbers from 0 on")
        self._core.remove(np.ascontiguousarray(array, dtype=np.uint64))

    def count(self, event: str, times: int = 1) -> None:
        """Counts an event of ``events``."""
        if event not in self._model.events:
            raise Error(f"the model declares no event {event!r}\n  hint: it has {', '.join(self._model.events) or 'none; name them in events'}")
        self._core.count(list(self._model.events).index(event), _whole("times", times))

    def _has(self, name: str) -> bool:
        return name in ("x", "y") or name in self._model.columns or name in self._model.fields

    def _no_column(self, name: str) -> AttributeError:
        return AttributeError(f"there is no column {name!r}; there are {', '.join(['x', 'y', *self._model.columns, *self._model.fields])}")

    def _require_writable(self, what: str) -> None:
        if self._is_read_only:
            raise Error(f"an observation cannot {what}\n  hint: do it in step()")

    def _array(self, name: str, make: Any) -> NDArray[Any]:
        if name not in self._arrays:
            self._arrays[name] = make()
            if self._is_read_only:
                self._arrays[name].flags.writeable = False
        return self._arrays[name]

    def _close(self) -> None:
        for array in self._arrays.values():
            array.flags.writeable = False
        self._arrays.clear()


def _put_into(array: NDArray[Any], name: str, values: ArrayLike) -> None:
    """Writes numbers into a column or a field, one for all or one for each."""
    numbers = as_column(values, name, array.dtype)
    try:
        array[...] = numbers
    except ValueError:
        raise Error(f"{name}: the values have shape {numbers.shape}\n  hint: use a number or an array of shape {array.shape}") from None


def _whole(what: str, number: Any) -> int:
    return as_count(number, what, "use a whole number from 0 on", least=0)


def _numbers(core: ModelWorld, count: int | None, size: int | None, purpose: int, is_normal: bool) -> NDArray[np.float64]:
    each = 1 if size is None else _whole("size", size)
    found: Any = core.numbers(None if count is None else _whole("count", count), each, _whole("purpose", purpose), is_normal)
    numbers: NDArray[np.float64] = found[:, 0] if size is None else found
    return numbers


def _new_agents(model: Model, columns: Mapping[str, ArrayLike]) -> list[object]:
    """The values of new agents, an array for each column of the model."""
    given = dict(columns)
    if "positions" in given:
        places = as_numbers(given.pop("positions"), "the positions of new agents", (None, 2), "use an array of shape (agents, 2)", finite=False)
        given["x"], given["y"] = places[:, 0], places[:, 1]
    types = {"x": np.dtype(np.float64), "y": np.dtype(np.float64), **{name: np.dtype(kind) for name, kind in model.columns.items()}}
    for name in given:
        if name not in types:
            raise Error(f"new agents have a column {name!r}\n  hint: the model has {', '.join(types)}")
    if "x" not in given or "y" not in given:
        raise Error("new agents have no place\n  hint: give x and y, or positions")
    values = {name: as_column(given[name], name, kind) for name, kind in types.items() if name in given}
    lengths = {name: array.shape for name, array in values.items() if array.ndim > 0}
    shape = next((found for found in lengths.values() if found != (1,)), (1,))
    for name, found in lengths.items():
        if len(found) != 1 or found not in (shape, (1,)):
            raise Error(f"column {name}: the values of new agents have shape {found}\n"
                        f"  hint: use a number or an array of shape {shape if len(shape) == 1 else '(agents,)'} for each column")
    return [
        np.ascontiguousarray(np.broadcast_to(values[name], shape)) if name in values else np.zeros(shape, dtype=kind)
        for name, kind in types.items()
    ]
