"""Sweeps: every combination of listed values, on all cores or on any executor, resumable."""

from __future__ import annotations

import concurrent.futures
import os
import pathlib
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _core
from .errors import Error, RunFailure
from .files import RunDirectory
from .models import Model, register_model, registered_models
from .progress import ProgressBar
from .settings import as_threads, assignments, given
from .tables import structured

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped]
    from numpy.typing import NDArray

Settings = tuple["str | None", "list[tuple[str, str]]"]


class SweepDirectory:
    """What a sweep has written."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(path)

    @property
    def table(self) -> NDArray[Any]:
        """One row for each run: its values, ``status``, ``state_hash`` and every result with its error."""
        return structured(_core.read_csv(str(self.path / "sweep.csv")))

    def frame(self) -> pandas.DataFrame:
        """The table as a frame of pandas, which has to be installed."""
        import pandas

        return pandas.DataFrame(_core.read_csv(str(self.path / "sweep.csv")))

    @property
    def means(self) -> NDArray[Any]:
        """One row for each combination, averaged over ``run.seed``; errors combine seeds and blocks."""
        return structured(_core.read_csv(str(self.path / "means.csv")))

    @property
    def runs(self) -> list[RunDirectory]:
        """The run directories, by their names."""
        return [RunDirectory(path) for path in sorted((self.path / "runs").iterdir())]

    def __repr__(self) -> str:
        return f"<gridlock.SweepDirectory {self.path}>"


def sweep(
    settings: Mapping[str, Any] | str | os.PathLike[str] | None,
    values: Mapping[str, Sequence[Any]],
    directory: str | os.PathLike[str],
    *,
    executor: concurrent.futures.Executor | None = None,
    overwrite: bool = False,
    threads: int = 0,
    progress: bool | Callable[[int, float], None] = False,
) -> SweepDirectory:
    """Runs every combination of the listed values; the last list varies fastest.

    :param settings: what all runs share, as for :class:`Simulation`; it gives them their end, ``run.steps`` or another.
    :param values: a list for each setting: ``{"disks.packing_fraction": [0.5, 0.6], "run.seed": [1, 2, 3]}``.
    :param directory: where the runs and tables are written, as by ``gridlock sweep``. Where it holds this sweep already, finished
        runs are kept and interrupted ones are continued, to the same bits.
    :param executor: any executor of ``concurrent.futures``, or a client of Dask; each run is one task. All workers see the directory.
        None: the cores of this machine.
    :param threads: runs at a time without an executor; 0 for one on each core.
    :raises Error: where not one run can be made, and for a directory that holds something else.
    :raises RunFailure: where runs failed; the others are finished, and the tables written. Where a worker of the
        executor died; the tables have the runs so far, and the same call continues.

    >>> import tempfile
    >>> made = sweep({"run.steps": 50, "disks.count": 16}, {"disks.packing_fraction": [0.2, 0.4]}, tempfile.mkdtemp())
    >>> made.table["status"].tolist()
    ['finished', 'finished']
    """
    file, base = given(settings, {})
    if not isinstance(values, Mapping) or not values:
        raise Error("there are no values to try\n  hint: for example {'run.seed': [1, 2, 3]}")
    for key, listed in values.items():
        if isinstance(listed, (str, bytes)) or not hasattr(listed, "__len__"):
            raise Error(f"{key} has no list of values\n  hint: for example {{'{key}': [1, 2, 3]}}")
        base += assignments({f"sweep.{key}": list(listed)})
    path = os.fspath(directory)
    if executor is None:
        with ProgressBar(progress, None) as on_progress:
            made = _core.sweep_directory(file, base, path, overwrite, as_threads(threads), None, on_progress)
    else:
        count, kinds = _core.sweep_size(file, base)
        models = [model for model in registered_models() if model.name in kinds]
        tasks = ((_run_one, (file, base), path, overwrite, number, count, models) for number in range(1, count + 1))
        try:
            with ProgressBar(progress, None) as on_progress:
                _wait_for(executor, tasks, count, on_progress)
        except concurrent.futures.BrokenExecutor as error:
            executor.shutdown()  # it takes no more tasks; its other workers must have left the directory
            _collect_what_there_is(path)
            raise RunFailure(f"a worker of the executor died: {error}\n"
                             "  hint: the same call with another executor continues the sweep") from error
        made = _core.collect_directory(path)
    _, _, failures, interruptions, messages = made
    if failures or interruptions:
        raise RunFailure(f"{failures} runs failed and {interruptions} were stopped; the tables have the others\n" + "\n".join(messages))
    return SweepDirectory(path)


def _wait_for(executor: concurrent.futures.Executor, tasks: Iterable[tuple[Any, ...]], count: int, on_progress: Any) -> None:
    """Has the executor do all tasks; what ends the waiting, such as Ctrl-C, takes back those that have not begun."""
    submitted: list[concurrent.futures.Future[None]] = []
    try:
        for task in tasks:
            submitted.append(executor.submit(*task))
        for number, future in enumerate(submitted, start=1):
            future.result()
            if on_progress is not None:
                on_progress(number, number / count)
    finally:
        for future in submitted:
            future.cancel()


def _collect_what_there_is(directory: str) -> None:
    """Tables of the runs so far; none where not one has begun."""
    try:
        _core.collect_directory(directory)
    except Error as error:
        warnings.warn(f"the tables could not be written: {error}", stacklevel=3)


def _run_one(settings: Settings, directory: str, overwrite: bool, number: int, count: int, models: list[type[Model]]) -> None:
    """Run ``number`` of a sweep, where it is not finished, with the models of the process that asks for it. What fails is told by the
    tables, so that one run stops no other."""
    for model in models:
        if model not in registered_models():
            register_model(model)
    file, values = settings
    _, _, _, _, messages = _core.sweep_directory(file, values, directory, overwrite, 1, (number, count), None)
    for message in messages:
        warnings.warn(message, stacklevel=2)
