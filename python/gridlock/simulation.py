"""A simulation in memory: settings in, agents as arrays, series and averages out."""

from __future__ import annotations

import os
import warnings
import weakref
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _core, converters
from .arrays import as_column, as_observed
from .box import Box, box_of
from .changes import Change, changed, latest, read_values
from .errors import Error, RunFailure
from .progress import ProgressBar
from .settings import as_threads, assignments, given
from .tables import structured

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped]
    from numpy.typing import NDArray

    from .files import Frame
    from .models import Model


class Clock(NamedTuple):
    """Whole steps taken, and physical time."""

    step: int
    time: float


class Result(NamedTuple):
    """An average with one standard error, ``None`` where the data cannot tell."""

    value: float
    error: float | None
    unit: str

    def __str__(self) -> str:
        error = "" if self.error is None else f" ± {self.error:.2g}"
        return f"{self.value:.6g}{error}{' ' + self.unit if self.unit else ''}"


class Column(NamedTuple):
    """A column of the series: its name, unit and meaning."""

    name: str
    unit: str
    documentation: str


class Results(Mapping[str, Result]):
    """Averages by the names of their columns."""

    def __init__(self, results: Mapping[str, Result]) -> None:
        self._results = dict(results)

    def __getitem__(self, name: str) -> Result:
        if name not in self._results:
            raise KeyError(f"there is no result {name!r}; there are {', '.join(self._results) or 'none yet'}")
        return self._results[name]

    def __iter__(self):  # type: ignore[no-untyped-def]
        return iter(self._results)

    def __len__(self) -> int:
        return len(self._results)

    def __repr__(self) -> str:
        return "\n".join(f"{name:<28} {result}" for name, result in self._results.items())


class Agents:
    """The agents of a simulation as arrays, without a copy.

    ``agents.x``, ``agents["x"]`` and all other columns have shape (N,), those of one kind of agents a row for each of that kind;
    ``positions`` and ``velocities`` have shape (N, 2). What is written into them is what the simulation goes on with; it is checked then. Row k is the agent ``ids[k]``: rows change
    their order while a simulation runs, Ids do not.

    An array is the simulation's own until it goes on, or until the callback returns that took it. Afterwards it keeps the values it
    had, and cannot be written any more; slices of it that were made before can be, without effect. In an observable, a progress function and a
    step of a model arrays are copies that cannot be written.
    The engine checks what was written: of disks positions, overlaps, radii, masses and velocities, of other models positions.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def __len__(self) -> int:
        return self._simulation._core.agents()

    @property
    def names(self) -> list[str]:
        """The names of all columns."""
        return self._simulation._core.column_names()

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._simulation._array(name)

    def __setitem__(self, name: str, values: Any) -> None:
        array = self[name]
        array[...] = as_column(values, name, array.dtype)

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self.names:
            raise AttributeError(f"the agents have no column {name!r}; they have {', '.join(self.names)}")
        return self[name]

    def __setattr__(self, name: str, values: Any) -> None:
        if name.startswith("_") or name in ("positions", "velocities"):
            object.__setattr__(self, name, values)
        elif name in self.names:
            self[name] = values
        else:
            raise AttributeError(f"the agents have no column {name!r}; they have {', '.join(self.names)}")

    @property
    def ids(self) -> NDArray[np.uint64]:
        """The Id of each row, shape (N,); cannot be written."""
        return self._simulation._array()

    @property
    def positions(self) -> NDArray[np.float64]:
        """x and y, shape (N, 2)."""
        return self._simulation._array("x", "y")

    @positions.setter
    def positions(self, values: Any) -> None:
        self.positions[...] = as_column(values, "positions", np.float64)

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities, shape (N, 2); models without velocities have none."""
        return self._simulation._array("velocity_x", "velocity_y")

    @velocities.setter
    def velocities(self, values: Any) -> None:
        self.velocities[...] = as_column(values, "velocities", np.float64)

    def __repr__(self) -> str:
        return f"{len(self)} agents with {', '.join(self.names)}"


class Simulation:
    """One simulation of hard disks or of an agent model, in the memory of this process.

    :param settings: nested dicts with dotted or plain names, or the path of a TOML file.
    :param threads: in place of ``engine.threads``; the results do not depend on it.
    :param more: settings over those, by their tables: ``disks={"count": 100}``, ``engine={"kind": "exact"}``.
    :raises Error: for settings that cannot be run, with the same texts as the command line.

    The bits are those of ``gridlock run`` with the same settings.

    >>> simulation = Simulation(disks={"count": 100, "packing_fraction": 0.3}, run={"seed": 7})
    >>> simulation.run(steps=200)
    >>> simulation.clock.step
    200
    >>> len(simulation.agents.x)
    100
    """

    def __init__(
        self,
        settings: Mapping[str, Any] | str | os.PathLike[str] | None = None,
        *,
        threads: int | None = None,
        **more: Any,
    ) -> None:
        file, values = given(settings, more)
        _take_started()
        self._core = _core.Simulation(file, values, None if threads is None else as_threads(threads))
        self._model = _take_started()
        if self._model is not None:
            self._model._require_curves([column.name for column in self.columns])
        self._changes: list[Change] = []
        self._hands_out_copies = False
        self._functions: list[Callable[[Simulation], Any]] = []
        self._arrays: list[weakref.ref[NDArray[Any]]] = []
        self._ends = self._core.has_end()
        for note in self._core.notes():
            warnings.warn(note, stacklevel=2)

    def run(self, steps: int | None = None, *, progress: bool | Callable[[int, float], None] = False) -> None:
        """Runs ``steps`` more, or to the end that the settings give.

        :param progress: True for a progress bar by tqdm; or a function of the steps done and the fraction of the whole.
        :raises RunFailure: where the physics breaks an invariant.
        :raises Error: for agents that were changed into something that cannot go on.
        :raises KeyboardInterrupt: on Ctrl-C; the simulation stops at a step and can go on.

        The bits do not depend on how a run is cut into calls.
        """
        if steps is not None:
            _require_steps(steps)
        self._forget_arrays()
        # Only callbacks of on_step are called between two steps; whoever else asks meanwhile gets copies.
        before, self._hands_out_copies = self._hands_out_copies, True
        with ProgressBar(progress, steps) as on_progress:
            try:
                self._core.run(None if steps is None else int(steps), on_progress)
            except RunFailure as failure:
                raise failure from _take_failure()
            finally:
                self._hands_out_copies = before

    def step(self) -> None:
        """Runs one step."""
        self.run(steps=1)

    def equilibrate(self, steps: int) -> None:
        """Runs ``steps`` whose samples are left out of all averages, now and later."""
        _require_steps(steps)
        self._core.leave_out_until(self.clock.step + int(steps))
        self.run(steps=steps)

    def on_step(self, every: int, function: Callable[[Simulation], None] | None = None) -> Any:
        """Calls ``function(simulation)`` at every multiple of ``every`` steps from the start on.

        Also a decorator. To be added before the first step. An exception ends the run at that step.

        >>> simulation = Simulation(disks={"count": 16, "packing_fraction": 0.2})
        >>> steps = []
        >>> simulation.on_step(50, lambda simulation: steps.append(simulation.clock.step))
        >>> simulation.run(steps=100)
        >>> steps
        [0, 50, 100]
        """
        if isinstance(every, bool) or not isinstance(every, (int, np.integer)) or not 1 <= every < 2**63:
            raise Error(f"every={every!r}\n  hint: use a whole number of steps, at least 1")
        if function is not None and not callable(function):
            raise Error(f"{function!r} cannot be called\n  hint: give a function of the simulation")
        if function is None:
            def decorate(decorated: Callable[[Simulation], None]) -> Callable[[Simulation], None]:
                self.on_step(every, decorated)
                return decorated
            return decorate
        self._core.add_callback(self._bound(function), int(every))
        return None

    def observe(
        self,
        function: Callable[[Simulation], float | Sequence[float]],
        name: str | Sequence[str] | None = None,
        *,
        unit: str = "",
        documentation: str = "",
    ) -> None:
        """Measures ``function(simulation)`` with every sample: a column of the series, and an average with its error.

        :param name: of the column; that of the function where left out. Several names for a function of several numbers.

        To be added before the first step.

        >>> simulation = Simulation(disks={"count": 16, "packing_fraction": 0.2}, observe={"every": 10})
        >>> simulation.observe(lambda s: s.agents.x.mean(), "mean_x", unit="length")
        >>> simulation.run(steps=100)
        >>> simulation.results["mean_x"].unit
        'length'
        """
        if name is None:
            name = getattr(function, "__name__", "")
        names = [name] if isinstance(name, str) else list(name)
        if not callable(function):
            raise Error(f"{function!r} cannot be called\n  hint: give a function of the simulation")
        taken = {column.name for column in self.columns}
        for column in names:
            if not isinstance(column, str) or not column.isidentifier():
                raise Error(f"{column!r} is no name of a column\n  hint: use letters, digits and _")
            if column in taken:
                raise Error(f"there is a column {column} already\n  hint: choose another name")
            taken.add(column)
        if not names:
            raise Error("an observable without a name\n  hint: give it one name, or one for each of its numbers")
        bound = self._bound(function, is_observable=True)

        def measure() -> list[float]:
            return as_observed(bound(), f"the observable {names[0]}")

        self._core.add_observable(measure, [(column, unit, documentation) for column in names])

    @property
    def agents(self) -> Agents:
        """The agents as arrays."""
        return Agents(self)

    @property
    def frame(self) -> Frame:
        """A copy of all agents as they are now, in the order of their Ids; self-propelled disks have ``heading_x`` and ``heading_y``.

        >>> swimmers = Simulation(disks={"count": 4, "packing_fraction": 0.1}, propulsion={"speed": 1.0})
        >>> swimmers.frame.heading_x.shape
        (4,)
        """
        from .files import frame_of_values

        names = {name: self._core.value_names(name) for name in self.agents.names}
        return frame_of_values(self._core.frame(), names)

    @property
    def box(self) -> Box:
        return box_of(self._core.box())

    @property
    def clock(self) -> Clock:
        return Clock(*self._core.clock())

    @property
    def time_step(self) -> float:
        """The physical time of one step."""
        return self._core.time_step()

    @property
    def state_hash(self) -> str:
        """The bitwise identity of the state, as ``gridlock run`` prints it."""
        return f"{self._core.state_hash():016x}"

    @property
    def settings(self) -> str:
        """All settings of this simulation in TOML, those left out too, as they were at its start; for what has changed since see ``changes``."""
        return self._core.configuration()

    def change(self, settings: Mapping[str, Any] | None = None, **more: Any) -> None:
        """Changes settings of a model in Python from the next step on, without a new start: between two calls of :meth:`run`, or in a function
        of :meth:`on_step`.

        :param settings: as those of a simulation: ``{"walkers.length": 0.02}``, or ``walkers={"length": 0.02}``.
        :raises Error: for settings that the start of the model has read, unless they have ``restarts=False``, for all that are not the
            model's, and for values that cannot be; then nothing is changed.

        The same changes at the same steps give the same bits: ``changes`` has them all.

        >>> import gridlock.library
        >>> meadow = Simulation(model="wolf_sheep", run={"seed": 7})
        >>> meadow.run(steps=100)
        >>> meadow.change(wolf_sheep={"sheep_birth": 0.0})
        >>> print(meadow.changes[0])
        step 100: wolf_sheep.sheep_birth was 0.2 and is 0.0
        """
        if self._hands_out_copies:
            raise Error("settings change between two steps\n  hint: change them between two calls of run(), or in a function of on_step()")
        values = read_values(self._model, {**(settings or {}), **more})
        self._core.require_possible(assignments({**latest(self._changes), **values}))
        if self._model is not None:
            self._changes += changed(self._model, self.clock.step, values)

    @property
    def changes(self) -> list[Change]:
        """What :meth:`change`, or a page that shows this simulation, has changed since the start."""
        return list(self._changes)

    @property
    def columns(self) -> list[Column]:
        """What the series has, with units and meaning."""
        return [Column(*column) for column in self._core.series_columns()]

    @property
    def series(self) -> NDArray[Any]:
        """All samples so far: a structured array with a field for each column."""
        return structured(self._core.series())

    def series_frame(self) -> pandas.DataFrame:
        """The series as a frame of pandas, which has to be installed."""
        import pandas

        return pandas.DataFrame(self._core.series())

    @property
    def results(self) -> Results:
        """Averages over the samples that count, with their errors."""
        return Results({name: Result(value, error, unit) for name, value, error, unit in self._core.results()})

    @property
    def distributions(self) -> dict[str, NDArray[Any]]:
        """The measured curves, as structured arrays: pair_correlation, speed_distribution …"""
        return {name: structured(columns) for name, columns in self._core.distributions().items()}

    @property
    def counts(self) -> dict[str, int]:
        """What happened since the start: moves, collisions, events of the model."""
        return self._core.counts()

    def write(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the agents as extended XYZ.

        :raises Error: where the file is there already, unless ``overwrite``, and where the simulation was made from it.
        """
        converters.protect(path, "gridlock.Simulation.write", overwrite, self._core.inputs())
        self._core.write_state(os.fspath(path))

    def _bound(self, function: Callable[[Simulation], Any], *, is_observable: bool = False) -> Callable[[], Any]:
        """Calls the function with this simulation. The library gets no reference to either, so that a function which knows the
        simulation is a cycle that Python can see and collect."""
        this = weakref.ref(self)
        number = len(self._functions)
        self._functions.append(function)

        def call() -> Any:
            simulation = this()
            if simulation is None:
                return None
            before, simulation._hands_out_copies = simulation._hands_out_copies, is_observable
            try:
                return simulation._functions[number](simulation)
            finally:
                simulation._hands_out_copies = before
                if not is_observable:
                    simulation._forget_arrays()
                    simulation._core.end_callback()

        return call

    def _array(self, *names: str) -> NDArray[Any]:
        """One column, or two as the columns of one array; without names the Ids."""
        core: Any = self._core
        array: NDArray[Any]
        if self._hands_out_copies:
            columns = [core.column(name) for name in names] or [core.ids()]
            array = columns[0].copy() if len(columns) == 1 else np.stack(columns, axis=1)
            array.flags.writeable = False
            return array
        core.prepare_arrays()
        array = core.columns(*names) if len(names) == 2 else core.column(*names) if names else core.ids()
        if len(self._arrays) > 1000:
            self._arrays = [reference for reference in self._arrays if reference() is not None]
        self._arrays.append(weakref.ref(array))
        return array

    def _forget_arrays(self) -> None:
        for reference in self._arrays:
            array = reference()
            if array is not None:
                array.flags.writeable = False
        self._arrays.clear()

    def __repr__(self) -> str:
        step, time = self.clock
        return f"<gridlock.Simulation of {self._core.model()}: {len(self.agents)} agents, step {step}, time {time:.6g}>"

    def __reduce__(self) -> Any:
        raise TypeError("a simulation cannot be pickled; hand over its settings, or write a run directory")


def run(
    settings: Mapping[str, Any] | str | os.PathLike[str] | None,
    directory: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    threads: int | None = None,
    progress: bool | Callable[[int, float], None] = False,
    **more: Any,
) -> None:
    """Runs settings to their end in a directory: the files of ``gridlock run FILE -o directory``, with the same bits.

    Stopped by Ctrl-C or killed, the run goes on with ``gridlock resume directory``.

    :raises Error: for settings that cannot be run and directories that hold other results.
    :raises RunFailure: where the run breaks.
    """
    file, values = given(settings, more)
    with ProgressBar(progress, None) as on_progress:
        _core.run_directory(file, values, os.fspath(directory), overwrite, None if threads is None else as_threads(threads),
                            on_progress)


def _take_failure() -> BaseException | None:
    """What a model in Python has raised."""
    from .models import take_failure

    return take_failure()


def _take_started() -> Model | None:
    """The model in Python that was started last."""
    from .models import take_started

    return take_started()


def _require_steps(steps: Any) -> None:
    if isinstance(steps, bool) or not isinstance(steps, (int, np.integer)) or not 0 <= steps < 2**63:
        raise Error(f"steps={steps!r}\n  hint: use a whole number of steps")
