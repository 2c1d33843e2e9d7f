"""Experiments: many small simulations of one declaration, in memory and on all cores, and the time until something happens."""

from __future__ import annotations

import concurrent.futures
import itertools
import multiprocessing
import operator
import os
import re
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np

from .arrays import as_count, in_short
from .errors import Error, RunFailure
from .models import Model, register_model, registered_models
from .progress import ProgressBar
from .settings import given, to_toml
from .simulation import Clock, Simulation
from .tables import structured

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped]
    from numpy.typing import NDArray

Condition = Union[str, Callable[[Simulation], bool]]

_comparisons = {"<": operator.lt, "<=": operator.le, "==": operator.eq, "!=": operator.ne, ">=": operator.ge, ">": operator.gt}
_hint_of_condition = "give a function of the simulation, or a text such as \"infected == 0\" of a column of the series and a number"
#: Columns of the table that say how a run ended.
_ends = ("run.seed", "step", "time", "ended")


def run_until(simulation: Simulation, condition: Condition, *, steps: int, every: int = 1) -> Clock | None:
    """Runs a simulation until a condition holds: the time to an event.

    :param condition: a function of the simulation; or a text, a column of the series, a comparison and a number, ``"infected == 0"``, asked of
        the newest sample (``observe.every`` says how often there is one).
    :param steps: the largest number of steps.
    :param every: steps from one question to the next; the first one is asked before the first step.
    :returns: the clock when the condition held; None where it did not within the steps.
    :raises Error: for a condition that cannot be asked.

    The bits of the simulation are those of ``simulation.run()``.

    >>> import gridlock, gridlock.library
    >>> fire = gridlock.Simulation(model="forest_fire", forest_fire={"side": 50, "density": 0.3}, observe={"every": 1})
    >>> run_until(fire, "burning == 0", steps=1000) == fire.clock
    True
    """
    asked = _as_question(condition)
    left = as_count(steps, "steps", "use a whole number of steps", least=0, most=2**63 - 1)
    stride = as_count(every, "every")
    simulation.run(steps=0)
    while not asked(simulation):
        if left == 0:
            return None
        taken = min(stride, left)
        simulation.run(steps=taken)
        left -= taken
    return simulation.clock


def _as_question(condition: Condition) -> Callable[[Simulation], bool]:
    if callable(condition):
        return condition
    found = re.fullmatch(r"\s*(\w+)\s*(<=|>=|==|!=|<|>)\s*(\S+)\s*", condition) if isinstance(condition, str) else None
    try:
        name, compare, number = found[1], _comparisons[found[2]], float(found[3])  # type: ignore[index]
    except (TypeError, ValueError):
        raise Error(f"{condition!r} is no condition\n  hint: {_hint_of_condition}") from None

    def ask(simulation: Simulation) -> bool:
        series = simulation.series
        if name not in (series.dtype.names or ()):
            raise Error(f"the condition {condition!r} asks for {name}, which the series does not have\n"
                        f"  hint: it has {', '.join(series.dtype.names or ())}")
        return bool(compare(series[name][-1], number))

    return ask


class _Job(NamedTuple):
    """What all runs of an experiment share."""

    settings: Any
    more: dict[str, Any]
    points: list[dict[str, Any]]
    seeds: list[int]
    steps: int
    until: Condition | None
    every: int
    measure: Callable[[Simulation], Mapping[str, float]] | None
    models: list[type[Model]]


class ExperimentStopped(KeyboardInterrupt):
    """Ctrl-C has ended an experiment; ``experiment`` has the runs that were done, None where there was none."""

    experiment: Experiment | None = None


class Experiment:
    """What an experiment has found. ``table`` has one row for each run: the values, ``run.seed``, the last ``step`` and ``time``, ``ended``
    (whether the condition held then), and what was measured."""

    def __init__(self, keys: Sequence[str], table: NDArray[Any], points: Sequence[int]) -> None:
        self.keys = tuple(keys)
        self.table = table
        self._numbers = np.asarray(points)  # of the combination of each row

    @property
    def means(self) -> NDArray[Any]:
        """One row for each combination of values, in their order: means over the seeds, and ``…_error``, one standard error by their scatter
        (not a number for one seed). Where not all runs have ended, the mean of ``step`` is one of the times so far."""
        columns: dict[str, Any] = {key: [] for key in (*self.keys, "runs")}
        names = [name for name in self.table.dtype.names or () if name not in (*self.keys, "run.seed")]
        for rows in self._points():
            for key in self.keys:
                columns[key].append(rows[key][0])
            columns["runs"].append(len(rows))
            for name in names:
                numbers = rows[name].astype(np.float64)
                error = np.std(numbers, ddof=1) / np.sqrt(len(numbers)) if len(numbers) > 1 else np.nan
                columns.setdefault(name, []).append(numbers.mean())
                columns.setdefault(f"{name}_error", []).append(error)
        return structured(columns)

    def histogram(self, name: str, bins: int | Sequence[float] = 10) -> NDArray[Any]:
        """How often a column of the table had which value over the seeds: one row for each combination of values and each bin, with ``low``,
        ``high`` and ``runs``. All combinations have the same bins; what is not a number is left out."""
        if name not in (self.table.dtype.names or ()):
            raise Error(f"the experiment has no column {name!r}\n  hint: it has {', '.join(self.table.dtype.names or ())}")
        numbers = self.table[name].astype(np.float64)
        try:
            edges = np.histogram_bin_edges(numbers[np.isfinite(numbers)], as_count(bins, "bins", most=10**6) if np.ndim(bins) == 0 else bins)
            if len(edges) < 2 or not np.isfinite(edges).all():
                raise ValueError
        except (TypeError, ValueError) as error:
            raise error if isinstance(error, Error) else Error(
                f"bins is {in_short(bins)}\n  hint: say how many, 1 to 1000000, or give the edges of all bins in ascending order") from None
        columns: dict[str, Any] = {key: [] for key in (*self.keys, "low", "high", "runs")}
        for rows in self._points():
            found, _ = np.histogram(rows[name].astype(np.float64), edges)
            for key in self.keys:
                columns[key] += [rows[key][0]] * len(found)
            columns["low"] += list(edges[:-1])
            columns["high"] += list(edges[1:])
            columns["runs"] += list(found)
        return structured(columns)

    def frame(self) -> pandas.DataFrame:
        """The table as a frame of pandas, which has to be installed."""
        import pandas

        return pandas.DataFrame(np.asarray(self.table))

    def _points(self) -> Iterator[NDArray[Any]]:
        """The rows of each combination; the runs of one follow one another."""
        ends = [*np.flatnonzero(np.diff(self._numbers)) + 1, len(self.table)]
        for begin, end in zip([0, *ends], ends):
            yield self.table[begin:end]

    def __repr__(self) -> str:
        return f"<gridlock.Experiment: {len(self.table)} runs over {', '.join(self.keys) or 'seeds'}>"


def experiment(
    settings: Mapping[str, Any] | str | os.PathLike[str] | None,
    values: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]] = (),
    *,
    steps: int,
    seeds: int | Sequence[int] = 10,
    until: Condition | None = None,
    every: int = 1,
    measure: Callable[[Simulation], Mapping[str, float]] | None = None,
    processes: int = 0,
    executor: concurrent.futures.Executor | None = None,
    progress: bool | Callable[[int, float], None] = False,
) -> Experiment:
    """Runs settings for every combination of listed values and every seed, in memory, and keeps what each run ends with.

    For runs that last minutes, and to keep their files and to continue them, see :func:`sweep`.

    :param settings: what all runs share, as for :class:`Simulation`; ``{"model": gridlock.library.Schelling, "box.edge": "wall"}``.
    :param values: a list for each setting that varies, the last one fastest, ``{"schelling.wanted": [2, 3, 4]}``; or the combinations
        themselves, a list of ``{"schelling.wanted": 2}``.
    :param steps: of each run; with a condition the most steps.
    :param seeds: how many, 1, 2, 3 …; or a list of them.
    :param until: a condition with which a run ends, and ``every``, as in :func:`run_until`.
    :param measure: a function of the simulation at its end that returns numbers by name. None: the newest row of the series.
    :param processes: at a time; 0 for one on each core, 1 for this process alone.
    :param executor: any executor of ``concurrent.futures``, or a client of Dask; its functions have to be those of modules.
    :raises Error: for settings and values of which a run cannot be made.
    :raises RunFailure: where a run failed, with its values.
    :raises ExperimentStopped: on Ctrl-C, a ``KeyboardInterrupt`` with the table of the runs that are done; those going on are ended.

    >>> import gridlock.library
    >>> fires = experiment({"model": gridlock.library.ForestFire, "forest_fire.side": 30}, {"forest_fire.density": [0.4, 0.8]},
    ...                    seeds=4, steps=1000, until="burning == 0", processes=1)
    >>> fires.means["burnt"].round(1).tolist()
    [0.1, 1.0]
    """
    file, base = given(settings, {})
    points = _points_of(values)
    numbers = list(range(1, as_count(seeds, "seeds") + 1)) if isinstance(seeds, (int, np.integer)) else [int(seed) for seed in seeds]
    if not numbers or len(set(numbers)) < len(numbers):
        raise Error(f"the seeds are {numbers}\n  hint: give each once, or how many")
    if until is not None:
        _as_question(until)
    stride, most = as_count(every, "every"), as_count(steps, "steps", "use a whole number of steps", least=0, most=2**63 - 1)
    # The newest row of the series is then that of the end.
    is_sampled = file is not None or any(key == "observe.every" for key, _ in base)
    more = {} if is_sampled else {"observe.every": max(1, most) if until is None else stride}
    kinds = {value.strip('"') for key, value in base if key == "model.kind"}
    models = [model for model in registered_models() if model.name in kinds]
    job = _Job(settings, more, points, numbers, most, until, stride, measure, models)
    rows: dict[int, dict[str, Any]] = {}

    def found() -> Experiment:
        keys, done = list(points[0]), sorted(rows)
        whole = [{**{key: _as_cell(points[run // len(numbers)][key]) for key in keys}, "run.seed": numbers[run % len(numbers)], **rows[run]}
                 for run in done]
        return Experiment(keys, _table(whole, without=() if until is not None else ("ended",)), [run // len(numbers) for run in done])

    try:
        with ProgressBar(progress, None) as on_progress:
            _run_all(job, rows, processes, executor, on_progress)
    except KeyboardInterrupt as stop:
        stopped = ExperimentStopped(f"{len(rows)} of {len(points) * len(numbers)} runs of the experiment are done; they are in .experiment of this error")
        stopped.experiment = found() if rows else None
        raise stopped from stop
    return found()


def _table(rows: list[dict[str, Any]], without: Sequence[str]) -> NDArray[Any]:
    """Rows as a table, without some columns, and without those that were defined in no run."""
    names = list(rows[0])
    if any(list(row) != names for row in rows):
        raise Error("the runs have measured different names\n  hint: return the same names from every run")
    columns = {name: np.array([row[name] for row in rows]) for name in names if name not in without}
    return structured({name: column for name, column in columns.items() if column.dtype.kind != "f" or not np.isnan(column).all()})


def _as_cell(value: Any) -> Any:
    """A value of a setting as a table can hold it: a number or a word; of lists their text."""
    return value if isinstance(value, (bool, int, float, str, np.generic)) else to_toml(value)


def _points_of(values: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Every combination of values, by their keys."""
    if isinstance(values, Mapping):
        for key, listed in values.items():
            if isinstance(listed, (str, bytes)) or not hasattr(listed, "__len__") or len(listed) == 0:
                raise Error(f"{key} has no list of values\n  hint: for example {{'{key}': [1, 2, 3]}}")
        points = [dict(zip(values, combination)) for combination in itertools.product(*values.values())]
    else:
        points = [dict(point) for point in values] or [{}]
    if any(list(point) != list(points[0]) for point in points):
        raise Error("the combinations name different settings\n  hint: give all of them the same keys")
    taken = [key for key in points[0] if key in _ends]
    if taken:
        raise Error(f"{taken[0]} is listed among the values\n  hint: give the seeds as seeds=")
    return points


#: The job of this process, which those that it forks inherit: functions of a prompt or of a notebook need no name in a module.
_inherited: list[_Job] = []


def _run_all(
    job: _Job, rows: dict[int, dict[str, Any]], processes: int, executor: concurrent.futures.Executor | None,
    on_progress: Callable[[int, float], None] | None,
) -> None:
    """Puts what each run has found under its number into ``rows``."""
    count = len(job.points) * len(job.seeds)
    workers = min(count, as_count(processes, "processes", "use a whole number, 0 for all cores", least=0) or os.cpu_count() or 1)
    if executor is None and workers > 1 and "fork" in multiprocessing.get_all_start_methods():
        _inherited.append(job)
        others = set(multiprocessing.active_children())
        try:
            with concurrent.futures.ProcessPoolExecutor(workers, multiprocessing.get_context("fork"), _leave_interrupts_to_parent) as own:
                try:
                    _gather([own.submit(_inherited_row, number) for number in range(count)], rows, on_progress)
                except KeyboardInterrupt:
                    for process in set(multiprocessing.active_children()) - others:
                        process.kill()
                    raise
        finally:
            _inherited.pop()
    elif executor is not None:
        _gather([executor.submit(_row, job, number) for number in range(count)], rows, on_progress)
    else:
        for number in range(count):
            rows[number] = _row(job, number)
            if on_progress is not None:
                on_progress(number + 1, (number + 1) / count)


def _leave_interrupts_to_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _gather(
    futures: list[concurrent.futures.Future[dict[str, Any]]], rows: dict[int, dict[str, Any]], on_progress: Callable[[int, float], None] | None
) -> None:
    """Waits for all futures; the first that fails takes back those that have not begun."""
    try:
        for number, future in enumerate(futures):
            rows[number] = future.result()
            if on_progress is not None:
                on_progress(number + 1, (number + 1) / len(futures))
    except concurrent.futures.BrokenExecutor as error:
        raise RunFailure(f"a process of the experiment died: {error}\n  hint: it may have run out of memory; use fewer processes") from error
    except KeyboardInterrupt:
        rows.update({number: future.result() for number, future in enumerate(futures) if _has_row(future)})
        raise
    finally:
        for future in futures:
            future.cancel()


def _has_row(future: concurrent.futures.Future[dict[str, Any]]) -> bool:
    return future.done() and not future.cancelled() and future.exception() is None


def _inherited_row(number: int) -> dict[str, Any]:
    return _row(_inherited[-1], number)


def _row(job: _Job, number: int) -> dict[str, Any]:
    """One run of an experiment."""
    for model in job.models:
        if model not in registered_models():
            register_model(model)
    point, seed = job.points[number // len(job.seeds)], job.seeds[number % len(job.seeds)]
    where = ", ".join(f"{key} = {in_short(value)}" for key, value in {**point, "run.seed": seed}.items())
    try:
        simulation = Simulation(job.settings, **{**job.more, **point, "run.seed": seed})
        ended = False
        if job.until is None:
            simulation.run(steps=job.steps)
        else:
            ended = run_until(simulation, job.until, steps=job.steps, every=job.every) is not None
        clock = simulation.clock
        return {"step": clock.step, "time": clock.time, "ended": ended, **_measured(job, simulation)}
    except (Error, RunFailure) as error:
        what, mark, hint = str(error).partition("\n  hint: ")
        raise type(error)(f"the run with {where}: {what}{mark}{hint}") from None
    except Exception as error:  # of a condition, or a measure
        raise RunFailure(f"the run with {where}: {type(error).__name__}: {error}") from error


def _measured(job: _Job, simulation: Simulation) -> dict[str, Any]:
    if job.measure is not None:
        seen = job.measure(simulation)
        if not isinstance(seen, Mapping) or any(name in _ends for name in seen):
            raise Error(f"measure returned {type(seen).__name__}\n  hint: return numbers by name, none of them {', '.join(_ends)}")
        return dict(seen)
    series = simulation.series
    return {name: series[name][-1] for name in series.dtype.names or () if name not in ("step", "time")}
