"""What a model in Python sees of its world, in its start, in a step and in an observation."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np

from ._core import ModelWorld
from .analysis import separations
from .arrays import as_array, as_column, as_count, as_numbers, in_short, named_in_short, refuse_masked
from .box import Box, box_of
from .errors import Error
from .fields import FieldsOfWorld
from .kinds import COLUMN, number_of, own_columns_of
from .neighbors import Neighbors, NeighborsAmong, as_cutoff, as_radii, pairs_of_disks
from .networks import WorldNetwork
from .simulation import Clock

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .models import Model


class _SeenByModel:
    """What a model sees of its world in its start and in a step."""

    _core: ModelWorld
    _model: Model
    _kind: int | None  #: the kind whose agents it shows; of all where there is none

    def __len__(self) -> int:
        return self._core.size() if self._kind is None else self._core.counts()[self._kind]

    def __repr__(self) -> str:
        kind = "" if self._kind is None else f", {list(self._model.kinds)[self._kind]}"
        what = f"<gridlock.{type(self).__name__} of {self._model.name}{kind}"
        try:
            return f"{what}: {len(self)} agents, step {self._core.clock()[0]}>"
        except RuntimeError:
            return f"{what}: its step is over>"

    def _network(self, name: str) -> WorldNetwork:
        return WorldNetwork(self, name)  # type: ignore[arg-type]

    def _born(self, columns: Mapping[str, ArrayLike]) -> NDArray[np.int64]:
        first = self._core.rows_with_newborn()
        self._core.add(self._kind or 0, _new_agents(self._model, self._kind, columns))
        return np.arange(first, self._core.rows_with_newborn())

    def _counted(self, rows: NDArray[Any]) -> NDArray[Any]:
        """What networks call the agents of rows."""
        return rows

    def _require_writable(self, what: str) -> None:
        """Refuses changes where nothing may be changed."""

    @property
    def box(self) -> Box:
        return box_of(self._core.box())

    @property
    def seed(self) -> int:
        return self._core.seed()


class Start(_SeenByModel):
    """What a model fills in its ``start``: a box without agents, fields of zeros, and networks without edges.

    ``start.grass`` is the field grass, an array of shape (rows, columns); ``start.friends`` the network friends, a :class:`WorldNetwork`. Of a
    model with kinds ``start.sheep`` is the start of the sheep: its :meth:`add` adds sheep, and its random numbers are those of the sheep.
    """

    def __init__(self, core: ModelWorld, model: Model, kind: int | None = None, calls: dict[int | None, int] | None = None) -> None:
        self._core = core
        self._model = model
        self._kind = kind
        self._calls = {} if calls is None else calls  # of anywhere(), by the kind

    def __getattr__(self, name: str) -> Any:
        if name in self._model.kinds and self._kind is None:
            return Start(self._core, self._model, number_of(self._model, name), self._calls)
        if not name.startswith("_") and name in self._model.networks and self._kind is None:
            return self._network(name)
        if name.startswith("_") or name not in self._model.fields:
            raise AttributeError(f"the start has no field {name!r}; it has {', '.join([*self._model.fields, *self._model.networks]) or 'none'}")
        return self._core.field(name)

    def __setattr__(self, name: str, values: Any) -> None:
        if name.startswith("_"):
            object.__setattr__(self, name, values)
        elif name in self._model.networks:
            raise _no_value(name)
        else:
            _put_into(getattr(self, name), name, values)

    def anywhere(self, count: int, *, radius: ArrayLike | None = None) -> NDArray[np.float64]:
        """Places of so many agents anywhere in the box, shape (count, 2).

        :param radius: of all agents, or of each: none of these agents overlaps another, or a wall. Where places are taken, they are drawn
            again; agents of other calls are not seen. Each call draws places of its own.
        :raises Error: where 1,000 draws find no place; to about 45 % of the area covered they do.
        """
        call = self._calls.get(self._kind, 0)
        self._calls[self._kind] = call + 1
        first = 2**29 + call if call else 0  # purposes of random numbers
        if radius is None:
            return self._drawn(count, first)
        radii = as_radii(radius, _whole("count", count))
        margin = np.stack([radii * (not self.box.periodic_x), radii * (not self.box.periodic_y)], axis=1)
        places = np.zeros((count, 2))
        missing = np.arange(count)
        for draw in range(1000):
            if len(missing) == 0:
                return places
            drawn = self._drawn(count, 2**30 + 1000 * call + draw if draw else first)
            places[missing] = (margin + drawn * (1 - 2 * margin / [self.box.width, self.box.height]))[missing]
            pairs = pairs_of_disks(places, radii, self.box).astype(np.int64)
            # The agent that was placed before the other keeps its place; of two new ones that with the lower number.
            turn = np.zeros(count, dtype=np.int64)
            turn[missing] = 1 + missing
            missing = np.unique(pairs[np.arange(len(pairs)), np.argmax(turn[pairs], axis=1)])
        raise Error(f"{len(missing)} of {count} agents find no place without overlap\n  hint: use fewer agents, smaller radii, or a lattice")

    def _drawn(self, count: int, purpose: int) -> NDArray[np.float64]:
        places: NDArray[np.float64] = self.uniform(count, 2, purpose=purpose) * np.array([self.box.width, self.box.height])
        return places

    def uniform(self, count: int, size: int | None = None, *, purpose: int = 1) -> NDArray[np.float64]:
        """Random numbers in [0, 1) for each of so many agents, shape (count,) or (count, size).

        Those of an agent are a function of the seed, its number and the purpose; 0 is that of :meth:`anywhere`.
        """
        return _numbers(self._core.numbers_from, self._newcomers(count), size, purpose, False)

    def normal(self, count: int, size: int | None = None, *, purpose: int = 1) -> NDArray[np.float64]:
        """The same with mean 0 and variance 1."""
        return _numbers(self._core.numbers_from, self._newcomers(count), size, purpose, True)

    def _newcomers(self, count: int) -> tuple[int, int]:
        """The numbers of new agents, from the first to before the end; those of two kinds are never the same."""
        first = (self._kind or 0) << 32
        return first, first + _whole("count", count)

    def add(self, **columns: ArrayLike) -> NDArray[np.int64]:
        """Adds agents: a number or an array for x, y (or ``positions``) and every other column; columns left out are 0.

        Returns their numbers: a start counts all agents in the order in which they are added, and networks take these numbers.
        """
        return self._born(columns)

    def _counted(self, rows: NDArray[Any]) -> NDArray[Any]:
        ids: Any = self._core.ids()
        return ids[rows]  # type: ignore[no-any-return]


class Halts(NamedTuple):
    """What has halted agents that moved apart: see :meth:`World.move` with radii."""

    walls: NDArray[np.bool_]  #: whether a wall along x, or along y, has; shape (N, 2)
    partners: NDArray[np.int64]  #: the row of the agent that has, −1 for those that no agent has; shape (N,)

    def __repr__(self) -> str:
        return named_in_short(self)


class World(_SeenByModel, FieldsOfWorld):
    """What a model sees and changes in its ``step``.

    ``world.x``, ``world["x"]`` and every other column are arrays of shape (N,), ``positions`` of shape (N, 2): the agents themselves,
    without a copy. What a step writes into them holds at once. Row k is the agent ``ids[k]`` within one step; rows change their
    order between steps.

    ``world.grass`` of a model with a field grass is that field, an array of shape (rows, columns): row 0 is at the bottom of the box.

    ``world.sheep`` of a model with a kind sheep is the world of the sheep alone: its arrays have a row for each sheep, and its methods
    move, find, add and remove sheep. ``world.friends`` of a model with a network friends is a :class:`WorldNetwork`.
    """

    _is_read_only: bool

    def __init__(self, core: ModelWorld, model: Model, *, is_read_only: bool = False, kind: int | None = None) -> None:
        # Attributes are found here without a call of __getattr__: columns, fields and kinds are added when they are first asked for.
        vars(self).update(_core=core, _model=model, _kind=kind, _is_read_only=is_read_only)

    @property
    def clock(self) -> Clock:
        return Clock(*self._core.clock())

    @property
    def time_step(self) -> float:
        return float(self._model.time_step)

    @cached_property
    def ids(self) -> NDArray[np.uint64]:
        """The Id of each row, shape (N,)."""
        return self._shown(self._own(self._core.ids()))

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """x and y, shape (N, 2). They stay inside the box; :meth:`move` sees to that."""
        return self._shown(self._own(self._core.positions()))

    def __getitem__(self, name: str) -> NDArray[Any]:
        known = vars(self).get(name)
        if isinstance(known, np.ndarray):
            return known
        values: Any = self._core.field(name) if name in self._model.fields else self._own(self._core.column(name), name)
        array = self._shown(values)
        vars(self)[name] = array
        return array

    def __setitem__(self, name: str, values: ArrayLike) -> None:
        self._require_writable(f"change {name}")
        self._put(name, values)

    def __getattr__(self, name: str) -> Any:
        if name in self._model.kinds and self._kind is None:
            part = World(self._core, self._model, is_read_only=self._is_read_only, kind=number_of(self._model, name))
            vars(self)[name] = part
            return part
        if not name.startswith("_") and name in self._model.networks and self._kind is None:
            return self._network(name)
        if name.startswith("_") or not self._has(name):
            raise self._no_column(name)
        return self[name]

    def __setattr__(self, name: str, values: Any) -> None:
        if name in self._model.networks:
            raise _no_value(name)
        if name != "positions" and not self._has(name):
            raise self._no_column(name)
        self._require_writable(f"change {name}")
        self._put(name, values)

    def _put(self, name: str, values: ArrayLike) -> None:
        if name == COLUMN and self._model.kinds:
            raise Error("an agent keeps its kind\n  hint: remove it, and add one of another kind")
        _put_into(self.positions if name == "positions" else self[name], name, values)

    def neighbors(self, cutoff: float, *, of: World | None = None) -> Neighbors:
        """The neighbours of every agent nearer than the cutoff, by rows, on the threads of ``engine.threads``.

        :param of: the agents among whom they are, ``world.wolf.neighbors(0.1, of=world.sheep)``: then rows are those of ``world.sheep``.
            The search is on one thread.

        The lists are kept: as long as nobody moves, is born or dies, the same search costs a comparison of all positions.
        """
        among = self if of is None else _world("of", of)
        lists: Any = self._core.neighbor_lists(as_cutoff(cutoff), self._rows, among._rows)
        if of is None:
            return Neighbors(*lists)
        found = NeighborsAmong(*lists)
        found._others = len(among)
        return found

    def pairs(self, cutoff: float) -> NDArray[np.uint32]:
        """All pairs of rows nearer than the cutoff, each once, shape (P, 2). They are kept as :meth:`neighbors` are."""
        found: Any = self._core.pairs(as_cutoff(cutoff), self._rows)
        pairs: NDArray[np.uint32] = found.T
        return pairs

    def separations(self, i: NDArray[np.integer[Any]], j: NDArray[np.integer[Any]], *, of: World | None = None) -> NDArray[np.float64]:
        """The vectors from the agents of rows i to those of rows j, the nearest image in a periodic box, shape (len(i), 2).

        :param of: whose rows j are, as in :meth:`neighbors`.
        """
        if of is None:
            return separations(self.positions, i, j, self.box)
        both = np.concatenate([self.positions[i], _world("of", of).positions[j]])
        first = np.arange(len(both) // 2)
        return separations(both, first, first + len(first), self.box)

    def uniform(self, size: int | None = None, *, purpose: int = 0, rows: ArrayLike | None = None) -> NDArray[np.float64]:
        """Random numbers in [0, 1) for each agent, shape (N,) or (N, size).

        A function of the seed, the step, the Id and the purpose alone: the same on any machine, and after a resume. Two calls with
        one purpose in one step give the same numbers; use another purpose for others.

        :param rows: a mask, or the rows, of those that need numbers; the others draw none.
        """
        return self._numbers(rows, size, purpose, False)

    def normal(self, size: int | None = None, *, purpose: int = 0, rows: ArrayLike | None = None) -> NDArray[np.float64]:
        """The same with mean 0 and variance 1."""
        return self._numbers(rows, size, purpose, True)

    def random_order(self, *, purpose: int = 0) -> NDArray[np.int64]:
        """The rows in a random order, for agents that act one after the other, shape (N,): that of ``uniform(purpose=purpose)``.

        Cost: about 60 ns an agent.
        """
        order: Any = self._core.random_order(self._rows, _whole("purpose", purpose))
        return order  # type: ignore[no-any-return]

    def _numbers(self, rows: ArrayLike | None, size: int | None, purpose: int, is_normal: bool) -> NDArray[np.float64]:
        if rows is None:
            return _numbers(self._core.numbers_from, self._rows, size, purpose, is_normal)
        return _numbers(self._core.numbers, self._rows_in_all(rows), size, purpose, is_normal)

    def uniform_of_step(self, count: int) -> NDArray[np.float64]:
        """Random numbers in [0, 1) of the whole model, a function of the seed and the step, shape (count,)."""
        numbers: Any = self._core.numbers_of_step(_whole("count", count))
        return numbers  # type: ignore[no-any-return]

    @overload
    def move(self, displacements: ArrayLike) -> NDArray[np.bool_]: ...
    @overload
    def move(self, displacements: ArrayLike, *, radius: ArrayLike, parts: int = 5, shuffled: bool = False) -> Halts: ...
    def move(
        self, displacements: ArrayLike, *, radius: ArrayLike | None = None, parts: int = 5, shuffled: bool = False
    ) -> NDArray[np.bool_] | Halts:
        """Moves every agent by its row of an array of shape (N, 2), around the edges of a periodic box or turned back by walls.

        A model with columns ``image_x`` and ``image_y`` (int32) has the edges counted there that an agent has crossed, so that trajectories
        can be unwrapped.

        :param radius: of all agents, or of each: they move one after the other, and none into another, by the rule of the paper. Each
            displacement has equal parts. The first that would bring an agent nearer than its radius to a wall, or than the sum of the radii to
            another agent, halts it there; its partner is the nearest such agent. Agents that overlap at first may move away from each other.
        :param parts: of each displacement; none may be as long as a radius and the smallest radius together.
        :param shuffled: whether they move in an order drawn anew for each step, in place of that of their Ids.
        :returns: in which directions walls turned it back, shape (N, 2); with radii what has halted it, :class:`Halts`.
        :raises RunFailure: for a displacement that is not finite or as long as a side of the box.
        """
        self._require_writable("move agents")
        array = np.ascontiguousarray(as_array(displacements, "the displacements are", "use an array of numbers"), dtype=np.float64)
        if array.shape != (len(self), 2):
            raise Error(f"the displacements have shape {array.shape}\n  hint: use an array of shape ({len(self)}, 2)")
        if radius is None:
            turned: Any = self._core.move(array, self._rows[0])
            bounces: NDArray[np.bool_] = turned.view(np.bool_)
            return bounces
        radii = self._radii(radius, array, _whole("parts", parts))
        ends: Any = self._core.move_apart(array, self._rows[0], radii, parts, bool(shuffled))
        return Halts(ends[0].view(np.bool_), ends[1])

    def _radii(self, radius: ArrayLike, displacements: NDArray[np.float64], parts: int) -> NDArray[np.float64]:
        """The radii of agents that can move apart."""
        radii = as_radii(radius, len(self))
        if np.any(radii <= 0) or not 1 <= parts <= 1000:
            raise Error(f"agents move apart in {parts} parts, with a smallest radius of {radii.min(initial=np.inf)}\n"
                        "  hint: use 1 to 1000 parts, and radii above 0")
        sides = [side for side, periodic in zip((self.box.width, self.box.height), (self.box.periodic_x, self.box.periodic_y)) if periodic]
        if sides and len(radii) and 4 * radii.max() > min(sides):
            raise Error(f"the largest radius is {radii.max()} in a periodic box of {min(sides)}\n  hint: use at most a quarter of the shorter side")
        length = np.hypot(displacements[:, 0], displacements[:, 1]) / parts
        if np.any(length >= radii + radii.min(initial=np.inf)):
            row = int(np.argmax(length - radii))
            raise Error(f"the agent of row {row} covers {length[row]:.6g} in one part and could jump over another of radius {radii.min():.6g}\n"
                        "  hint: use more parts, or shorter displacements")
        return radii

    def rows_of(self, ids: ArrayLike) -> NDArray[np.int64]:
        """The rows of the agents with these Ids, in an array of their shape.

        :raises Error: for an agent that does not live.
        """
        array = as_array(ids, "the Ids are", "use whole numbers", integers=True)
        order = np.argsort(self.ids)
        places = np.searchsorted(self.ids, array, sorter=order)
        rows: NDArray[np.int64] = order[np.minimum(places, len(order) - 1)] if len(order) else np.zeros(array.shape, dtype=np.int64)
        missing = array[self.ids[rows] != array] if len(order) else array
        if missing.size:
            raise Error(f"no agent with the Id {missing.flat[0]} lives\n  hint: ids has those of all rows")
        return rows

    def add(self, **columns: ArrayLike) -> NDArray[np.int64]:
        """Births: a number or an array for x, y (or ``positions``) and every other column. The newborn are there after the step.

        Returns the rows that ``connect`` of a network takes for them in this step.
        """
        self._require_writable("add agents")
        return self._born(columns)

    def remove(self, rows: ArrayLike) -> None:
        """Deaths, by a mask of shape (N,) or by rows. The dead are gone after the step."""
        self._require_writable("remove agents")
        flags = np.asarray(rows)
        if flags.shape == (len(self),) and flags.dtype.kind in "iu" and len(np.unique(flags)) < len(flags):
            raise Error("whole numbers are rows, and some of these are there twice\n  hint: is it a mask? remove(world.dead == 1)")
        self._core.remove(self._rows_in_all(rows, "the rows to remove are"))

    def _rows_in_all(self, rows: ArrayLike, what: str = "the rows are") -> NDArray[np.uint64]:
        """Rows of this world, given by a mask or by numbers, among those of all agents."""
        first, end = self._rows
        refuse_masked(rows, what)
        array = np.asarray(rows)
        if array.dtype == np.bool_:
            if array.shape != (end - first,):
                raise Error(f"the mask has shape {array.shape}\n  hint: use one of shape ({end - first},)")
            return (array.nonzero()[0] + first).astype(np.uint64)
        if array.ndim != 1 or (array.size and (array.dtype.kind not in "iu" or array.min() < 0)):
            raise Error("agents are chosen by a mask or by rows\n  hint: use an array of True and False, or of whole numbers from 0 on")
        if self._kind is not None and np.any(array >= len(self)):
            raise Error(f"there is no agent in row {array.max()} among {len(self)}\n  hint: rows are those of the arrays in this step")
        return np.ascontiguousarray(array, dtype=np.uint64) + np.uint64(first)

    def count(self, event: str, times: int = 1) -> None:
        """Counts an event of ``events``."""
        if event not in self._model.events:
            raise Error(f"the model declares no event {event!r}\n  hint: it has {', '.join(self._model.events) or 'none; name them in events'}")
        self._core.count(list(self._model.events).index(event), _whole("times", times))

    @property
    def _rows(self) -> tuple[int, int]:
        """The rows of these agents among all: from the first to before the end."""
        counts = self._core.counts()
        if self._kind is None:
            return 0, sum(counts)
        return sum(counts[: self._kind]), sum(counts[: self._kind + 1])

    def _own(self, values: Any, name: str = "ids") -> NDArray[Any]:
        """The values of a column that are those of these agents."""
        if not self._model.kinds:
            return values  # type: ignore[no-any-return]
        column = self._model._columns.get(name)
        kinds = column.kinds if column and column.kinds else list(range(len(self._model.kinds)))
        if (self._kind is None and len(kinds) < len(self._model.kinds)) or self._kind not in (None, *kinds):
            raise Error(f"{name} is a column of {', '.join(list(self._model.kinds)[kind] for kind in kinds)} alone\n"
                        f"  hint: use world.{list(self._model.kinds)[kinds[0]]}.{name}")
        if self._kind is None:
            return values  # type: ignore[no-any-return]
        counts = self._core.counts()
        first = sum(counts[kind] for kind in kinds if kind < self._kind)
        own: NDArray[Any] = values[first : first + counts[self._kind]]
        return own

    def _columns(self) -> list[str]:
        own = [] if self._kind is None else own_columns_of(self._model, self._kind)
        return ["x", "y", *([COLUMN] if self._model.kinds else []), *self._model.columns, *own]

    def _has(self, name: str) -> bool:
        return name in self._columns() or name in self._model.fields

    def _no_column(self, name: str) -> AttributeError:
        networks = [] if self._kind is not None else [*self._model.networks, *self._model.kinds]
        there = [*self._columns(), *self._model.fields, *networks]
        return AttributeError(f"there is no column {name!r}; there are {', '.join(there)}")

    def _require_writable(self, what: str) -> None:
        if self._is_read_only:
            raise Error(f"an observation cannot {what}\n  hint: do it in step()")

    def _shown(self, array: NDArray[Any]) -> NDArray[Any]:
        if self._is_read_only:
            array.flags.writeable = False
        return array

    def _close(self) -> None:
        for name, value in list(vars(self).items()):
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
                del vars(self)[name]
            elif isinstance(value, World):
                value._close()


def _world(name: str, value: Any) -> World:
    if not isinstance(value, World):
        raise Error(f"{name} is {in_short(value)}\n  hint: give a world, such as world.sheep")
    return value


def _no_value(network: str) -> Error:
    return Error(f"{network} is a network, which takes no values\n  hint: {network}.connect(i, j), {network}.weights = …")


def _put_into(array: NDArray[Any], name: str, values: ArrayLike) -> None:
    """Writes numbers into a column or a field, one for all or one for each."""
    numbers = as_column(values, name, array.dtype)
    try:
        array[...] = numbers
    except ValueError:
        raise Error(f"{name}: the values have shape {numbers.shape}\n  hint: use a number or an array of shape {array.shape}") from None


def _whole(what: str, number: Any) -> int:
    return as_count(number, what, "use a whole number from 0 to 2147483647", least=0)


def _numbers(drawn: Any, rows: Any, size: int | None, purpose: int, is_normal: bool) -> NDArray[np.float64]:
    found: NDArray[np.float64] = drawn(rows, 1 if size is None else _whole("size", size), _whole("purpose", purpose), is_normal)
    return found[:, 0] if size is None else found


def _new_agents(model: Model, kind: int | None, columns: Mapping[str, ArrayLike]) -> list[object]:
    """The values of new agents of a kind, an array for each column of the model; empty for columns of other kinds."""
    if model.kinds and kind is None:
        first = next(iter(model.kinds))
        raise Error(f"new agents have no kind\n  hint: the model {model.name} has {', '.join(model.kinds)}: add them to one, as in world.{first}.add")
    given = dict(columns)
    if "positions" in given:
        places = as_numbers(given.pop("positions"), "the positions of new agents", (None, 2), "use an array of shape (agents, 2)", finite=False)
        given["x"], given["y"] = places[:, 0], places[:, 1]
    types = {"x": "float64", "y": "float64"}
    for name, column in model._columns.items():
        if (not column.kinds or kind in column.kinds) and not (model.kinds and name == COLUMN):
            types[name] = column.type
    for name in given:
        if name not in types:
            raise Error(f"new agents have a column {name!r}\n  hint: the model has {', '.join(types)}")
    if "x" not in given or "y" not in given:
        raise Error("new agents have no place\n  hint: give x and y, or positions")
    values = {name: as_column(array, name, types[name]) for name, array in given.items()}
    for name, array in values.items():
        if name not in ("x", "y") and array.dtype.kind == "f" and not np.isfinite(array).all():
            place = int(np.argmin(np.isfinite(array).ravel()))
            raise Error(f"column {name}: agent {place} of the new ones has the value {array.ravel()[place]}\n"
                        "  hint: use finite numbers; mark what is not known by one such as -1")
    shape = next((array.shape for array in values.values() if array.shape not in ((), (1,))), (1,))
    for name, array in values.items():
        if array.ndim > 1 or array.shape not in (shape, (1,), ()):
            raise Error(f"column {name}: the values of new agents have shape {array.shape}\n"
                        f"  hint: use a number or an array of shape {shape if len(shape) == 1 else '(agents,)'} for each column")
    if kind is not None:
        values[COLUMN] = np.asarray(kind, dtype=np.uint32)
    return [
        _repeated(values[name], shape) if name in values else np.zeros(shape if name in types else 0, dtype=found)
        for name, found in [("x", "float64"), ("y", "float64"), *((name, column.type) for name, column in model._columns.items())]
    ]


def _repeated(values: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    return np.ascontiguousarray(values) if values.shape == shape else np.full(shape, values)
