"""Agent models of one's own in Python: columns, a step over arrays, births and deaths, and the files of every run."""

from __future__ import annotations

import inspect
import keyword
import math
import os
import threading
import traceback
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from . import _core
from ._core import ModelWorld
from .analysis import separations
from .arrays import as_array, as_count
from .box import Box
from .errors import Error, RunFailure
from .neighbors import Neighbors
from .simulation import Clock

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_column_types = ("float64", "int32", "uint32", "uint64")
#: Of columns that observables know.
_types_of_columns = {"velocity_x": "float64", "velocity_y": "float64", "radius": "float64", "mass": "float64", "image_x": "int32", "image_y": "int32"}
_names_of_world = ("x", "y", "ids", "positions", "box", "clock", "seed", "time_step")


class Setting:
    """A setting of a model: a key of the table ``[name]`` of the model, with its default, unit, bounds and meaning.

    :param default: True or False, a whole number from 0 on, a number, a text, or a list of numbers: the type of the setting.
    :param choices: the texts that it can be.

    In the model, ``self.radius`` is its value.
    """

    def __init__(
        self,
        default: bool | int | float | str | Sequence[float],
        documentation: str = "",
        *,
        unit: str = "",
        least: float = -math.inf,
        most: float = math.inf,
        choices: Sequence[str] = (),
    ) -> None:
        try:
            self.default = default if isinstance(default, (bool, int, float, str)) else [float(number) for number in default]
        except (TypeError, ValueError):
            raise Error(f"a setting has the default {default!r}\n  hint: use True or False, a number, a text, or a list of numbers") from None
        self.documentation = documentation
        self.unit = unit
        self.least = least
        self.most = most
        self.choices = list(choices)
        self.key = ""
        if not isinstance(self.default, (bool, str, list)) and not math.isfinite(self.default):
            raise Error(f"a setting has the default {default}\n  hint: use a finite number")
        if isinstance(default, int) and not isinstance(default, bool):
            self.least = max(0.0, least)
            if default < 0:
                raise Error(f"a setting has the default {default}\n  hint: whole numbers begin at 0; write {default}.0 for a number below")
        if isinstance(self.default, (int, float)) and not self.least <= self.default <= self.most:
            raise Error(f"a setting has the default {default}, which is not between {self.least} and {self.most}\n  hint: use a value that it may have")
        if self.choices and default not in self.choices:
            raise Error(f"a setting has the default {default!r}, which is none of {', '.join(self.choices)}\n  hint: use one of them")

    def __set_name__(self, owner: type, name: str) -> None:
        if self.key not in ("", name):
            raise Error(f"the setting {self.key} gets the name {name} too\n  hint: write {name} = property(lambda self: self.{self.key})")
        self.key = name

    def __get__(self, model: Any, owner: type | None = None) -> Any:
        if model is None:
            return self
        return model.__dict__["_values"].get(self.key, self.default)

    def _definition(self) -> tuple[str, str, str, float, float, list[str], str, Any]:
        kind = type(self.default).__name__
        default = float(self.default) if kind == "float" else self.default  # type: ignore[arg-type]
        return (self.key, self.unit, self.documentation, float(self.least), float(self.most), self.choices, kind, default)


class _SeenByModel:
    """What a model sees of its world in its start and in a step."""

    _core: ModelWorld
    _model: Model

    def __len__(self) -> int:
        return self._core.size()

    @property
    def box(self) -> Box:
        return Box(*self._core.box())

    @property
    def seed(self) -> int:
        return self._core.seed()


class Start(_SeenByModel):
    """What a model fills in its ``start``: a box without agents."""

    def __init__(self, core: ModelWorld, model: Model) -> None:
        self._core = core
        self._model = model

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


class World(_SeenByModel):
    """What a model sees and changes in its ``step``.

    ``world.x``, ``world["x"]`` and every other column are arrays of shape (N,), ``positions`` of shape (N, 2): the agents themselves,
    without a copy. What a step writes into them holds at once. Row k is the agent ``ids[k]`` within one step; rows change their
    order between steps.
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
        return self._array(name, lambda: self._core.column(name))

    def __setitem__(self, name: str, values: ArrayLike) -> None:
        self[name][...] = values

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_") or (name not in ("x", "y") and name not in self._model.columns):
            raise self._no_column(name)
        return self[name]

    def __setattr__(self, name: str, values: Any) -> None:
        if name not in ("x", "y", "positions") and name not in self._model.columns:
            raise self._no_column(name)
        array = self.positions if name == "positions" else self[name]
        array[...] = values

    def neighbors(self, cutoff: float) -> Neighbors:
        """The neighbours of every agent nearer than the cutoff, by rows, on the threads of ``engine.threads``."""
        lists: Any = self._core.neighbor_lists(float(cutoff))
        return Neighbors(*lists)

    def pairs(self, cutoff: float) -> NDArray[np.uint32]:
        """All pairs of rows nearer than the cutoff, each once, shape (P, 2)."""
        found: Any = self._core.pairs(float(cutoff))
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

    def _no_column(self, name: str) -> AttributeError:
        return AttributeError(f"there is no column {name!r}; there are {', '.join(['x', 'y', *self._model.columns])}")

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


class Model:
    """An agent model: derive a class from it, and run it by its name.

    ::

        @gridlock.register_model
        class Walkers(gridlock.Model):
            \"\"\"Points that walk at random.\"\"\"

            name = "walkers"
            count = gridlock.Setting(1000, "Agents.", least=1)
            length = gridlock.Setting(0.01, "Of a step in each direction.", unit="length", least=0.0)

            def start(self, start):
                start.add(positions=start.anywhere(self.count))

            def step(self, world):
                world.move(self.length * world.normal(2))

        simulation = gridlock.Simulation(model="walkers", walkers={"count": 500}, box={"edge": "periodic"})

    - ``columns``: what agents have besides x and y, with their types: ``{"health": np.uint32}``; float64, int32, uint32 or uint64.
    - ``events``: names of what :meth:`World.count` counts. ``value_names``: names of the numbers 0, 1, 2 … of a column.
    - ``time_step``: the physical time of a step; a number, a setting, or a property.
    - :meth:`start`, :meth:`step`, :meth:`observe`, :meth:`check`: see there. In place of ``step``, ``turn`` is what one agent does, compiled
      by Numba; see :mod:`gridlock.turns`.

    All that changes in a run belongs into columns: checkpoints, trajectories and resumed runs know nothing else.
    """

    name: ClassVar[str] = ""
    columns: ClassVar[Mapping[str, Any]] = {}
    events: ClassVar[Sequence[str]] = ()
    value_names: ClassVar[Mapping[str, Sequence[str]]] = {}
    observations: ClassVar[Mapping[str, str]] = {}
    time_step: Any = 1.0

    def __init__(self, **settings: Any) -> None:
        known = _settings_of(type(self))
        for key in settings:
            if key not in known:
                raise Error(f"the model {self.name} has no setting {key!r}\n  hint: it has {', '.join(known) or 'none'}")
        self.__dict__["_values"] = settings

    def __setattr__(self, name: str, value: Any) -> None:
        raise Error(
            f"a model cannot keep {name!r} from one step to the next\n"
            "  hint: keep what changes in columns of the agents, so that checkpoints have it, and what is fixed in settings"
        )

    @property
    def settings(self) -> dict[str, Any]:
        """The values of all settings."""
        return {key: getattr(self, key) for key in _settings_of(type(self))}

    def check(self, box: Box) -> None:
        """Raises :class:`Error` for settings with which no run is possible."""

    def start(self, start: Start) -> None:
        """Puts the first agents into the box."""
        raise NotImplementedError

    def step(self, world: World) -> None:
        """What happens in one step."""
        from .turns import take_turns

        take_turns(self, world)

    def observe(self, world: World) -> Mapping[str, float]:
        """Numbers by name, the same names at every time: columns of the series, averaged. It cannot change the world.

        ``observations`` gives the names their meaning: ``{"order": "1 where all move in one direction"}``.
        """
        return {}

    @classmethod
    def _made_with(cls, values: Mapping[str, Any]) -> Model:
        return cls(**values)

    def _checked_time_step(self) -> float:
        step = self.time_step
        if isinstance(step, bool) or not isinstance(step, (int, float, np.number)) or not 0.0 < float(step) < math.inf:
            raise Error(f"the model {self.name} has the time step {step!r}\n  hint: use a finite number above 0")
        return float(step)

    def _check(self, width: float, height: float, is_periodic: bool) -> None:
        self._checked_time_step()
        self.check(Box(width, height, is_periodic))

    def _start(self, core: ModelWorld) -> None:
        self.start(Start(core, self))

    def _step(self, core: ModelWorld) -> None:
        world = World(core, self)
        try:
            self.step(world)
        finally:
            world._close()

    def _observed(self, core: ModelWorld) -> list[tuple[str, str, str]]:
        seen = self._seen(core)
        taken = ("step", "time", "agents", *self.events)
        for name in seen:
            if not isinstance(name, str) or not name.isidentifier() or name in taken:
                raise Error(f"observe() of the model {self.name} has the name {name!r}\n"
                            f"  hint: use letters, digits and _, and no name of another column: {', '.join(taken)}")
        return [(name, "", self.observations.get(name, "")) for name in seen]

    def _observe(self, core: ModelWorld, names: list[str]) -> list[float]:
        seen = self._seen(core)
        if list(seen) != names:
            raise Error(f"observe() returned {', '.join(seen)} in place of {', '.join(names)}\n  hint: return the same names at every time")
        return [float(value) for value in seen.values()]

    def _seen(self, core: ModelWorld) -> Mapping[str, float]:
        world = World(core, self, is_read_only=True)
        try:
            seen = self.observe(world) or {}
        finally:
            world._close()
        if not isinstance(seen, Mapping):
            raise Error(f"observe() of the model {self.name} returned {type(seen).__name__}\n  hint: return numbers by name, {{\"order\": 0.5}}")
        return seen


def register_model(model: type[Model]) -> type[Model]:
    """Makes a model known by its name to simulations, runs and sweeps of this process; also a decorator.

    A class of the same name that was registered before is replaced.

    :raises Error: for a name that a model of Gridlock has, and for columns, events and settings that cannot be.

    >>> @register_model
    ... class Drifters(Model):
    ...     name = "drifters"
    ...     count = Setting(10, "Agents.")
    ...     def start(self, start):
    ...         start.add(positions=start.anywhere(self.count))
    ...     def step(self, world):
    ...         world.move(np.full((len(world), 2), 0.1))
    >>> import gridlock
    >>> simulation = gridlock.Simulation(model="drifters", drifters={"count": 3}, box={"edge": "periodic"})
    >>> simulation.run(steps=10)
    >>> len(simulation.agents)
    3
    """
    if not isinstance(model, type) or not issubclass(model, Model):
        raise Error(f"{model!r} is no model\n  hint: derive a class from gridlock.Model")
    columns = {name: np.dtype(kind).name for name, kind in model.columns.items()}
    settings = _settings_of(model)
    _require_possible(model, columns, list(settings))
    documentation = " ".join((inspect.getdoc(model) or "").split("\n\n")[0].split()) if model.__doc__ else ""
    with _lock:
        _core.register_model(
            model,
            model.name,
            documentation,
            list(columns.items()),
            list(model.events),
            {name: list(names) for name, names in model.value_names.items()},
            [setting._definition() for setting in settings.values()],
            model.name in _registered,
        )
        _registered[model.name] = model
    return model


_registered: dict[str, type[Model]] = {}
_lock = threading.Lock()


def registered_models() -> list[type[Model]]:
    """The models of Python that this process knows, for other processes that work for it."""
    return list(_registered.values())


def settings_of_model(model: Any) -> dict[str, Any]:
    """What ``model=`` of a simulation means: the name of a model, its class, or an object of it with settings."""
    if isinstance(model, str):
        return {"model.kind": model}
    kind = model if isinstance(model, type) else type(model)
    if not issubclass(kind, Model):
        raise Error(f"model={model!r} is no model\n  hint: use a name, a class derived from gridlock.Model, or an object of one")
    if _registered.get(kind.name) is not kind:
        register_model(kind)
    values = {} if isinstance(model, type) else model.__dict__["_values"]
    return {"model.kind": kind.name, **{f"{kind.name}.{key}": value for key, value in values.items()}}


class _Failure(threading.local):
    exception: BaseException | None = None


_failure = _Failure()


def failure_text(exception: BaseException, model: str, step: int) -> str:
    """What a run says of an exception of a model; :func:`take_failure` gives the exception itself."""
    _failure.exception = exception
    package = os.path.dirname(__file__)
    frames = [frame for frame in traceback.extract_tb(exception.__traceback__) if os.path.dirname(frame.filename) != package]
    place = f" ({os.path.basename(frames[-1].filename)}, line {frames[-1].lineno})" if frames else ""
    if isinstance(exception, RunFailure):
        return str(exception)
    is_ours = isinstance(exception, Error)
    text = str(exception) if is_ours else "raised " + "".join(traceback.format_exception_only(type(exception), exception)).strip()
    what, mark, hint = text.partition("\n  hint: ")
    return f"step {step}: the model {model}{':' if is_ours else ''} {what}{place}{mark}{hint}"


def take_failure() -> BaseException | None:
    """The exception behind the last failure of a model in this thread, once."""
    exception, _failure.exception = _failure.exception, None
    return exception


def _settings_of(model: type[Model]) -> dict[str, Setting]:
    settings: dict[str, Setting] = {}
    for base in reversed(model.__mro__):
        settings.update({key: value for key, value in vars(base).items() if isinstance(value, Setting)})
    return settings


def _require_possible(model: type[Model], columns: Mapping[str, str], settings: Sequence[str]) -> None:
    what = f"the model {model.__name__}"
    if not isinstance(model.name, str) or not model.name.isidentifier() or not model.name.isascii():
        raise Error(f"{what} has the name {model.name!r}\n  hint: give it one of letters, digits and _: name = \"walkers\"")
    if model.name in _tables():
        raise Error(f"{what} is called {model.name}, as a table of the settings is\n  hint: choose another name")
    if model.step is Model.step and not hasattr(model, "turn"):
        raise Error(f"{what} has no step\n  hint: define step(self, world), or turn() for Numba")
    if model.step is Model.step:
        from .turns import require_turn

        require_turn(model)
    if model.start is Model.start:
        raise Error(f"{what} has no start\n  hint: define start(self, start), which adds the first agents")
    for name, kind in columns.items():
        if not name.isidentifier() or keyword.iskeyword(name) or name in _names_of_world or hasattr(World, name):
            raise Error(f"{what} has a column {name!r}\n  hint: choose another name")
        known = _types_of_columns.get(name, kind)
        if kind != known:
            raise Error(f"the column {name} of {what} has the type {kind}\n  hint: observables take it for {known}; use that, or another name")
        if kind not in _column_types:
            raise Error(f"the column {name} of {what} has the type {kind}\n  hint: use {', '.join(_column_types)}")
    names = [*columns, *model.events]
    is_taken = any(name in ("step", "time", "agents") for name in model.events)
    if is_taken or len(set(model.events)) < len(model.events) or not all(isinstance(name, str) and name.isidentifier() for name in names):
        raise Error(f"{what} has the events {list(model.events)}\n  hint: give each a name of its own")
    for name in model.value_names:
        if name not in columns:
            raise Error(f"{what} names the values of a column {name!r} that it does not have\n  hint: it has {', '.join(columns) or 'none'}")


def _tables() -> set[str]:
    return {"box", "model", "disks", "velocities", "engine", "run", "observe", "checkpoint", "trajectory", "sweep"}


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
        places = np.asarray(given.pop("positions"), dtype=np.float64)
        if places.ndim != 2 or places.shape[1] != 2:
            raise Error(f"the positions of new agents have shape {places.shape}\n  hint: use an array of shape (agents, 2)")
        given["x"], given["y"] = places[:, 0], places[:, 1]
    types = {"x": np.dtype(np.float64), "y": np.dtype(np.float64), **{name: np.dtype(kind) for name, kind in model.columns.items()}}
    for name in given:
        if name not in types:
            raise Error(f"new agents have a column {name!r}\n  hint: the model has {', '.join(types)}")
    if "x" not in given or "y" not in given:
        raise Error("new agents have no place\n  hint: give x and y, or positions")
    try:
        values = {name: np.asarray(value) for name, value in given.items()}
        shape = np.broadcast_shapes(*(value.shape for value in values.values()), (1,))
        if len(shape) != 1:
            raise Error(f"the values of new agents have shape {shape}\n  hint: use a number or an array of shape (agents,) for each column")
        return [
            np.ascontiguousarray(np.broadcast_to(values[name], shape).astype(kind, casting="same_kind"))
            if name in values
            else np.zeros(shape, dtype=kind)
            for name, kind in types.items()
        ]
    except (TypeError, ValueError) as error:
        if isinstance(error, Error):
            raise
        raise Error(f"the values of new agents do not fit: {error}\n  hint: use arrays of one length, of the types of the columns") from None
