"""Agent models of one's own in Python: columns, a step over arrays, births and deaths, and the files of every run."""

from __future__ import annotations

import contextlib
import inspect
import keyword
import math
import os
import threading
import traceback
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from . import _core
from .arrays import as_observed, in_short
from .box import Box, BoxValues, box_of
from .errors import Error, RunFailure
from .fields import Field
from .kinds import ColumnOfModel, columns_of, require_kinds
from .networks import Network
from .world import Start, World

if TYPE_CHECKING:
    from ._core import ModelWorld

_column_types = ("float64", "int32", "uint32", "uint64")
#: Of columns that observables know.
_types_of_columns = {"velocity_x": "float64", "velocity_y": "float64", "radius": "float64", "mass": "float64", "image_x": "int32", "image_y": "int32"}
_names_of_world = ("x", "y", "ids", "positions", "box", "clock", "seed", "time_step")
#: What files call ids, positions, velocities and images.
_names_in_files = ("id", "position", "pos", "velocity", "velo", "image")


#: Names of the values of one column.
MOST_NAMES = 64
#: Curves of one chart that can be told apart.
MOST_CURVES = 6
#: The largest whole number that a setting can be.
MOST_NUMBER = 2**64 - 1


#: The names under which a model keeps the values of its settings, where it is noted which of them are read, and those that were.
BOOKKEEPING = frozenset({"_values", "_read", "_read_by_world", "_read_by_start"})


class Setting:
    """A setting of a model: a key of the table ``[name]`` of the model, with its default, unit, bounds and meaning.

    :param default: True or False, a whole number from 0 on, a number, a text, or a list of numbers: the type of the setting.
    :param choices: the texts that it can be.
    :param restarts: whether another value needs a new start; None: where ``start`` reads the setting. Others can change in a simulation, see
        :meth:`Simulation.change`, and by a slider of a page.

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
        restarts: bool | None = None,
    ) -> None:
        try:
            self.default = default if isinstance(default, (bool, int, float, str)) else [float(number) for number in default]
        except (TypeError, ValueError):
            raise Error(f"a setting has the default {default!r}\n  hint: use True or False, a number, a text, or a list of numbers") from None
        self.documentation = documentation
        self.unit = unit
        self.least, self.most = _bound(least), _bound(most)
        self.choices = list(choices)
        self.restarts = restarts
        self.key = ""
        if isinstance(self.default, float) and not math.isfinite(self.default):
            raise Error(f"a setting has the default {default}\n  hint: use a finite number")
        if isinstance(default, int) and not isinstance(default, bool):
            self.least = max(0.0, self.least)
            if default < 0:
                raise Error(f"a setting has the default {in_short(default)}\n"
                            f"  hint: whole numbers begin at 0; write {in_short(default)}.0 for a number below")
            if default > MOST_NUMBER:
                raise Error(f"a setting has the default {in_short(default)}\n  hint: the largest whole number is {MOST_NUMBER}")
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
        if (read := model.__dict__["_read"]) is not None:
            read.add(self.key)
        return model.__dict__["_values"].get(self.key, self.default)

    def of_its_type(self, value: Any) -> Any:
        """A value that the setting can have, of its type."""
        return [float(number) for number in value] if isinstance(self.default, list) else type(self.default)(value)

    def __repr__(self) -> str:
        return f"<gridlock.Setting {self.key}: {in_short(self.default)}{', in ' + self.unit if self.unit else ''}>"

    def _definition(self) -> tuple[str, str, str, float, float, list[str], str, Any]:
        kind = type(self.default).__name__
        default = float(self.default) if kind == "float" else self.default  # type: ignore[arg-type]
        return (self.key, self.unit, self.documentation, float(self.least), float(self.most), self.choices, kind, default)


def _bound(bound: Any) -> float:
    try:
        return float(bound)
    except (TypeError, ValueError, OverflowError):
        raise Error(f"a setting has the bound {in_short(bound)}\n  hint: use a number; leave it out for none") from None


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
    - ``kinds``: kinds of agents with columns of their own, ``{"wolf": {"energy": float}, "sheep": {"wool": float}}``.
    - ``events``: names of what :meth:`World.count` counts. ``value_names``: names of the numbers 0, 1, 2 … of a column.
    - ``fields``: numbers on a grid over the box, ``{"grass": gridlock.Field(100)}``; see :class:`gridlock.Field`.
    - ``networks``: edges between the agents, ``{"friends": gridlock.Network()}``; see :class:`gridlock.Network`.
    - ``charts``: observations that :func:`gridlock.show` draws together: ``{"people": ("susceptible", "infected")}``.
    - ``time_step``: the physical time of a step; a number, a setting, or a property.
    - :meth:`start`, :meth:`step`, :meth:`observe`, :meth:`check`: see there. In place of ``step``, ``turn`` is what one agent does, compiled
      by Numba; see :mod:`gridlock.turns`.

    All that changes in a run belongs into columns, fields and networks: checkpoints, trajectories and resumed runs know nothing else.
    """

    name: ClassVar[str] = ""
    columns: ClassVar[Mapping[str, Any]] = {}
    kinds: ClassVar[Mapping[str, Mapping[str, Any]]] = {}
    fields: ClassVar[Mapping[str, Field]] = {}
    networks: ClassVar[Mapping[str, Network]] = {}
    events: ClassVar[Sequence[str]] = ()
    value_names: ClassVar[Mapping[str, Sequence[str]]] = {}
    observations: ClassVar[Mapping[str, str]] = {}
    charts: ClassVar[Mapping[str, Sequence[str]]] = {}
    time_step: Any = 1.0
    _columns: ClassVar[Mapping[str, ColumnOfModel]] = {}

    def __init__(self, **settings: Any) -> None:
        known = settings_of(type(self))
        for key in settings:
            if key not in known:
                raise Error(f"the model {self.name} has no setting {key!r}\n  hint: it has {', '.join(known) or 'none'}")
        self.__dict__.update(_values=settings, _read=None, _read_by_world=set(), _read_by_start=set())

    def __setattr__(self, name: str, value: Any) -> None:
        raise Error(
            f"a model cannot keep {name!r} from one step to the next\n"
            "  hint: keep what changes in columns of the agents, in fields or in networks, so that checkpoints have it, and what is fixed in settings"
        )

    @property
    def settings(self) -> dict[str, Any]:
        """The values of all settings."""
        return {key: getattr(self, key) for key in settings_of(type(self))}

    def __repr__(self) -> str:
        return f"<gridlock.Model {self.name}: {', '.join(f'{key}={in_short(value)}' for key, value in self.settings.items())}>"

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

    @contextlib.contextmanager
    def _noting_what_is_read(self, by: str) -> Iterator[None]:
        self.__dict__["_read"] = self.__dict__[by]
        try:
            yield
        finally:
            self.__dict__["_read"] = None

    def _checked_time_step(self) -> float:
        with self._noting_what_is_read("_read_by_world"):
            step = self.time_step
        if isinstance(step, bool) or not isinstance(step, (int, float, np.number)) or not 0.0 < float(step) < math.inf:
            raise Error(f"the model {self.name} has the time step {step!r}\n  hint: use a finite number above 0")
        return float(step)

    def _check(self, box: BoxValues) -> None:
        self._checked_time_step()
        self.check(box_of(box))

    def _fields(self, box: BoxValues) -> list[tuple[str, int, int]]:
        with self._noting_what_is_read("_read_by_world"):
            shapes = {name: field._shape(name, self, box_of(box)) for name, field in self.fields.items()}
        return [(name, *shapes[name]) for name in sorted(shapes, key=str.encode)]

    def _networks(self) -> list[tuple[str, bool]]:
        return [(name, self.networks[name].directed) for name in sorted(self.networks, key=str.encode)]

    def _start(self, core: ModelWorld) -> None:
        with self._noting_what_is_read("_read_by_start"):
            self.start(Start(core, self))
        _started.model = self

    def _step(self, core: ModelWorld) -> None:
        world = World(core, self)
        try:
            self.step(world)
        finally:
            world._close()

    def _require_curves(self, names: Sequence[str]) -> None:
        """Refuses charts of what is no column of the series."""
        for title, curves in self.charts.items():
            for name in curves:
                if name not in names:
                    raise Error(f"the chart {title!r} of the model {self.name} has a curve {name!r}, which nobody measures\n"
                                f"  hint: it has {', '.join(names)}")

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
        return [self._observed_number(name, value) for name, value in seen.items()]

    def _observed_number(self, name: str, value: Any) -> float:
        what = f"observe() of the model {self.name}: {name}"
        numbers = as_observed(value, what)
        if len(numbers) != 1:
            raise Error(f"{what} returned {len(numbers)} numbers\n"
                        f"  hint: return one number for each name: {{\"{name}_x\": 0.5, \"{name}_y\": 0.25}}, or an average")
        return numbers[0]

    def _seen(self, core: ModelWorld) -> Mapping[str, float]:
        world = World(core, self, is_read_only=True)
        try:
            seen = self.observe(world)
        except ValueError as error:
            if "read-only" not in str(error):
                raise
            raise Error(f"observe() of the model {self.name} cannot change the world: {error}\n  hint: do it in step()") from error
        finally:
            world._close()
        if not isinstance(seen, Mapping):
            what = "nothing" if seen is None else type(seen).__name__
            raise Error(f"observe() of the model {self.name} returned {what}\n  hint: return numbers by name, {{\"order\": 0.5}}")
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
    columns = columns_of(model)
    settings = settings_of(model)
    _require_possible(model, columns, list(settings))
    documentation = " ".join((inspect.getdoc(model) or "").split("\n\n")[0].split()) if model.__doc__ else ""
    with _lock:
        _core.register_model(
            model,
            model.name,
            documentation,
            [(name, *column) for name, column in columns.items()],
            max(1, len(model.kinds)),
            list(model.events),
            {name: list(names) for name, names in {**model.value_names, **({"kind": model.kinds} if model.kinds else {})}.items()},
            [setting._definition() for setting in settings.values()],
            model.name in _registered,
        )
        model._columns = columns
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


class _Started(threading.local):
    model: Model | None = None


_started = _Started()


def take_started() -> Model | None:
    """The model that was started last in this thread, once."""
    model, _started.model = _started.model, None
    return model


class _Failure(threading.local):
    exception: BaseException | None = None


_failure = _Failure()


def failure_text(exception: BaseException, model: str, step: int) -> str:
    """What a run says of an exception of a model; :func:`take_failure` gives the exception itself."""
    _failure.exception = exception
    place = _place_of(exception)
    if isinstance(exception, RunFailure):
        return str(exception)
    is_ours = isinstance(exception, Error)
    text = str(exception) if is_ours else "raised " + "".join(traceback.format_exception_only(type(exception), exception)).strip()
    what, mark, hint = text.partition("\n  hint: ")
    return f"step {step}: the model {model}{':' if is_ours else ''} {what}{place}{mark}{hint}"


def refusal_text(exception: BaseException) -> str:
    """What a start or an observation cannot use, with the line that asked for it; what it refuses by itself, in its own words."""
    text = str(exception)
    frames = traceback.extract_tb(exception.__traceback__)
    if not frames or not _is_ours(frames[-1]):
        return text
    what, mark, hint = text.partition("\n  hint: ")
    return f"{what}{_place_of(exception)}{mark}{hint}"


def _is_ours(frame: traceback.FrameSummary) -> bool:
    return os.path.dirname(frame.filename) == os.path.dirname(__file__)


def _place_of(exception: BaseException) -> str:
    """The file and the line of the user's code that an exception has passed last; empty where it was in none."""
    frames = [frame for frame in traceback.extract_tb(exception.__traceback__) if not _is_ours(frame)]
    return f" ({os.path.basename(frames[-1].filename)}, line {frames[-1].lineno})" if frames else ""


def raised_text(exception: BaseException) -> str:
    """What a file of the user has raised, with its line, in one line and a hint."""
    if isinstance(exception, SyntaxError):
        where = f" ({os.path.basename(exception.filename or '')}, line {exception.lineno})"
        return f"{type(exception).__name__}: {exception.msg}{where}"
    text = str(exception) if isinstance(exception, Error) else "".join(traceback.format_exception_only(type(exception), exception)).strip()
    what, mark, hint = text.partition("\n  hint: ")
    return f"{what}{_place_of(exception)}{mark}{hint}"


def take_failure() -> BaseException | None:
    """The exception behind the last failure of a model in this thread, once."""
    exception, _failure.exception = _failure.exception, None
    return exception


def settings_of(model: type[Model]) -> dict[str, Setting]:
    """The settings of a class by their names, those of its bases first."""
    settings: dict[str, Setting] = {}
    for base in reversed(model.__mro__):
        settings.update({key: value for key, value in vars(base).items() if isinstance(value, Setting)})
    return settings


def _require_possible(model: type[Model], columns: Mapping[str, ColumnOfModel], settings: Sequence[str]) -> None:
    what = f"the model {model.__name__}"
    if not isinstance(model.name, str) or not model.name.isidentifier() or not model.name.isascii():
        raise Error(f"{what} has the name {model.name!r}\n  hint: give it one of letters, digits and _: name = \"walkers\"")
    if model.step is Model.step and not hasattr(model, "turn"):
        raise Error(f"{what} has no step\n  hint: define step(self, world), or turn() for Numba")
    if _is_turn_hidden(model):
        raise Error(f"{what} has both step and turn\n"
                    "  hint: leave one out: step(self, world) is for all agents at once, turn() for one; finish(self, world, bounces) follows all turns")
    if model.step is Model.step:
        from .turns import require_turn

        require_turn(model)
    for name in ("fields", "networks", "charts"):
        if not isinstance(getattr(model, name), Mapping):
            raise Error(f"the {name} of {what} are {in_short(getattr(model, name))}\n  hint: name each of them: {name} = {{\"…\": …}}")
    if model.start is Model.start:
        raise Error(f"{what} has no start\n  hint: define start(self, start), which adds the first agents")
    for name in settings:
        if callable(getattr(Model, name, None)):
            raise Error(f"{what} has a setting {name}, a method of models\n  hint: choose another name")
    for name, (kind, _) in columns.items():
        if not name.isidentifier() or name.startswith("_") or keyword.iskeyword(name) or name in (*_names_of_world, *_names_in_files) or hasattr(World, name):
            raise Error(f"{what} has a column {name!r}\n  hint: choose another name")
        known = _types_of_columns.get(name, kind)
        if kind != known:
            raise Error(f"the column {name} of {what} has the type {kind}\n  hint: observables take it for {known}; use that, or another name")
        if kind not in _column_types:
            raise Error(f"the column {name} of {what} has the type {kind}\n  hint: use {', '.join(_column_types)}")
    require_kinds(model, columns, lambda name: name in model.fields or name in _names_of_world or hasattr(World, name) or hasattr(Start, name),
                  _types_of_columns)
    _require_named(what, "field", model.fields, Field, columns)
    _require_named(what, "network", model.networks, Network, (*columns, *model.fields, *model.kinds))
    names = [*columns, *model.events]
    is_taken = any(name in ("step", "time", "agents") for name in model.events)
    if is_taken or len(set(model.events)) < len(model.events) or not all(isinstance(name, str) and name.isidentifier() for name in names):
        raise Error(f"{what} has the events {list(model.events)}\n  hint: give each a name of its own")
    for name in model.value_names:
        if name not in columns:
            raise Error(f"{what} names the values of a column {name!r} that it does not have\n  hint: it has {', '.join(columns) or 'none'}")
        _require_names(what, name, model.value_names[name])
    for title, curves in model.charts.items():
        if not isinstance(title, str) or isinstance(curves, str) or not all(isinstance(name, str) for name in curves) or len(curves) > MOST_CURVES:
            raise Error(f"the chart {in_short(title)} of {what} has the curves {in_short(curves)}\n"
                        f"  hint: give names of observations or events, {MOST_CURVES} at most: charts = {{\"people\": (\"susceptible\", \"infected\")}}")


def _require_named(what: str, noun: str, things: Mapping[str, Any], kind: type, taken: Iterable[str]) -> None:
    """Refuses fields or networks that a world cannot have under their names."""
    for name, thing in things.items():
        if not isinstance(thing, kind):
            raise Error(f"the {noun} {name} of {what} is {in_short(thing)}\n  hint: use gridlock.{kind.__name__}({'columns' if kind is Field else ''})")
        if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
            raise Error(f"{what} has a {noun} {name!r}\n  hint: use letters, digits and _ for its name")
        if name in (*taken, *_names_of_world, *_names_in_files) or hasattr(World, name) or hasattr(Start, name):
            raise Error(f"{what} has a {noun} {name!r}, the name of something else that a world has\n  hint: choose another name")


def _require_names(what: str, column: str, names: Sequence[str]) -> None:
    if isinstance(names, str) or len(names) > MOST_NAMES:
        raise Error(f"{what} names {len(names)} values of the column {column}\n  hint: give a list of names, {MOST_NAMES} at most")
    for name in names:
        if not isinstance(name, str) or not 0 < len(name.encode()) <= 100:
            raise Error(f"{what} gives a value of the column {column} the name {in_short(name)}\n  hint: use texts of 1 to 100 letters")


def _is_turn_hidden(model: type[Model]) -> bool:
    """Whether a class has a turn that its step keeps from being taken. A step of a class derived from one with a turn may call it."""
    parts: Mapping[str, Any] = next((vars(base) for base in model.__mro__ if "step" in vars(base) or "turn" in vars(base)), {})
    return "turn" in parts and model.step is not Model.step
