"""The study from the first run to the report."""

from __future__ import annotations

import dataclasses
import importlib.util
import os
import pathlib
import time
import warnings
from collections.abc import Callable
from typing import NamedTuple, Union

from .. import _core
from ..errors import Error
from ..settings import as_threads
from ..simulation import ProgressBar
from . import extent as extents
from . import figure_4, figure_5, figure_6, figure_7, open_choices, physics_or_step, report, turn_order
from .chapter import Chapter, Claim, Context
from .extent import Extent
from .replicas import ReplicaSet
from .runs import PartialResults, cores

REPORT = "report.html"
PARTIAL_RESULTS = "partial_results"

#: A function of the share of the work that is done and of what is being done now, a few times a second; what it raises ends the
#: study.
Progress = Union[bool, Callable[[float, str], None]]


class _Part(NamedTuple):
    """What makes one chapter of the report."""

    figure: int | None  #: None: made only with all figures
    plan: Callable[[Context], list[ReplicaSet]] | None
    make: Callable[[Context], Chapter] | None  #: None: Figure 5, which is measured on its own, before anything runs beside it


_PARTS = (
    _Part(4, None, figure_4.make),
    _Part(5, None, None),
    _Part(6, figure_6.plan, figure_6.make),
    _Part(7, figure_7.plan, figure_7.make),
    _Part(None, open_choices.plan, open_choices.make),
    _Part(None, None, physics_or_step.make),
    _Part(None, turn_order.plan, turn_order.make),
)


@dataclasses.dataclass(frozen=True)
class Paper:
    """What a study has made."""

    claims: list[Claim]  #: what the paper says, what was measured, and the verdict
    files: list[pathlib.Path]  #: everything written, the report last
    notes: list[str]  #: runs that failed
    seconds: float  #: of real time


class Stopped(KeyboardInterrupt):
    """A study that was interrupted; what it has finished is kept."""

    def __init__(self, partial_results: pathlib.Path, simulations: int, finished: int) -> None:
        # Figure 5 is made of timings alone.
        held = f"{finished} finished simulations of {simulations}" if simulations else "the timings that are finished"
        super().__init__(f"{partial_results} holds {held}")


class _Progression:
    """Shares the progress among the parts of the study by the seconds each is expected to take."""

    def __init__(self, on_progress: Callable[[float, str], None]) -> None:
        self.seconds = [0.0, 0.0, 4.0]  # of Figure 5, the simulations and the pictures
        self.part = 0
        self._pictures = 0
        self._on_progress = on_progress

    def report(self, share_of_part: float, what: str) -> None:
        done = sum(self.seconds[:self.part]) + self.seconds[self.part] * share_of_part
        self._on_progress(done / sum(self.seconds), what)

    def draws(self, name: str) -> None:
        """Before each picture, of which there are nine at most."""
        self._pictures += 1
        self.report(min(self._pictures / 10.0, 1.0), f"drawing {name}")


def make(
    directory: str | os.PathLike[str],
    extent: str | Extent = "quick",
    figure: int | None = None,
    *,
    seed: int = 1,
    threads: int | None = None,
    overwrite: bool = False,
    progress: Progress = False,
) -> Paper:
    """Makes Figures 4 to 7 of the paper afresh and sets its claims beside what was measured.

    :param directory: where each figure is written as data (``figure_*.csv``), SVG and PNG; ``runs.csv`` with every simulation,
        its settings and state hash; and ``report.html``, which holds all pictures, claims and verdicts and needs no other file.
    :param extent: "quick", about three minutes on two cores; "full", about half an hour; or an :class:`Extent`.
    :param figure: 4, 5, 6 or 7 alone; None: all of them and the choices that the paper leaves open.
    :param seed: the seeds of the runs are this one and those after it. The numbers follow from it alone, but for the timings.
    :param threads: simulations at a time; None: one for each core.
    :param overwrite: whether everything is made again, also what an interrupted study has kept.
    :param progress: True for a bar by tqdm, or a function of the share of the work that is done and what is being done now.
    :raises Error: for an impossible extent, and a directory that is in use or holds other results.
    :raises Stopped: a KeyboardInterrupt, within about a second after Ctrl-C. What is finished is kept in ``partial_results``,
        also of a study that was killed; the same call again does only the rest, with the same results.

    Needs the packages NumPy, SciPy, matplotlib and Jinja2: ``pip install ".[paper]"`` in the sources of Gridlock. Source: J.-X. Shen, Agent based
    simulations and optimization with uniform grid applied to colloidal jamming transitions.
    """
    if isinstance(extent, str):
        if extent not in ("quick", "full"):
            raise Error(f"there is no extent {extent!r}\n  hint: use 'quick', 'full' or an Extent")
        extent = extents.quick() if extent == "quick" else extents.full()
    if figure not in (None, 4, 5, 6, 7):
        raise Error(f"the study has no Figure {figure!r}\n  hint: use 4, 5, 6 or 7")
    _require_packages()
    extents.require_possible(extent)
    figure_5.require_possible(extent)
    jobs = min(as_threads(threads or 0) or cores(), cores())
    path = pathlib.Path(directory)
    kept = _core.Directory(os.fspath(path), overwrite)
    partial_results = PartialResults(path / PARTIAL_RESULTS)
    try:
        if overwrite:
            partial_results.remove_all()
        # Last to come and first to go: a directory with a report holds a finished study.
        (path / REPORT).unlink(missing_ok=True)
        with ProgressBar(_as_bar(progress), None) as bar:
            progression = _Progression(_as_function(progress, bar))
            context = Context(extent, seed, path, kept, partial_results, progression.draws)
            try:
                with warnings.catch_warnings():
                    # The report itself says where the rule misleads.
                    warnings.simplefilter("ignore", UserWarning)
                    return _make(context, figure, jobs, progression)
            except KeyboardInterrupt:
                raise Stopped(partial_results.directory, len(context.runs), context.runs.finished) from None
    finally:
        kept.release()


def _require_packages() -> None:
    """Before anything is run, not when the report is to be written."""
    missing = [name for name in ("jinja2", "matplotlib", "scipy") if importlib.util.find_spec(name) is None]
    if missing:
        raise Error(f"the study of the paper needs {' and '.join(missing)}\n  hint: pip install {' '.join(missing)}")


def _as_bar(progress: Progress) -> bool:
    return progress is True


def _as_function(progress: Progress, bar: Callable[[int, float], None] | None) -> Callable[[float, str], None]:
    if callable(progress):
        return progress
    return lambda share, what: None if bar is None else bar(0, share)


def _make(context: Context, figure: int | None, jobs: int, progression: _Progression) -> Paper:
    start = time.perf_counter()
    parts = [part for part in _PARTS if figure in (None, part.figure)]
    for part in parts:
        if part.plan is not None:
            context.plan(part.plan(context))
    is_resumed = context.runs.finished > 0
    measures_times = figure in (None, 5)
    progression.seconds[:2] = figure_5.expected_seconds(context.extent) * measures_times, context.runs.work * 2e-7 / jobs

    costs: list[figure_5.StepCost] = []
    if measures_times:
        costs = figure_5.Measurement(context).measure(
            jobs, lambda share: progression.report(share, "Figure 5: counting distances and timing steps"))
    progression.part = 1
    if len(context.runs):
        context.runs.run_all(jobs, lambda share: progression.report(
            share, f"{context.runs.finished} of {len(context.runs)} simulations"))
        _write_runs(context)
    progression.part = 2
    chapters = [figure_5.make(context, costs) if part.make is None else part.make(context) for part in parts]

    context.notes += context.runs.failures
    if context.partial_results.problem:
        context.notes.append(f"partial results were not all kept: {context.partial_results.problem}")
    seconds = time.perf_counter() - start
    progression.report(1.0, "drawing")  # a wish to stop that comes later comes too late
    context.write(REPORT, report.html(context, chapters, seconds, is_resumed=is_resumed).encode())
    context.partial_results.remove_all()
    claims = [claim for chapter in chapters for claim in chapter.claims]
    return Paper(claims, context.files, context.notes, seconds)


def _write_runs(context: Context) -> None:
    """Every simulation, its settings and what came out."""
    context.write_table(
        "runs.csv", "start sites edge engine contact state_hash disks steps seed packing_fraction time_step time "
        "mean_displacement halted_fraction collision_rate seconds",
        [(run.start, run.sites, run.edge, run.engine, run.contact, outcome.state_hash, run.disks,
          int(outcome.series["step"][-1]), run.seed, run.packing_fraction, run.time_step,
          *(float(outcome.series[name][-1]) for name in ("time", "mean_displacement", "halted_fraction", "collision_rate")),
          outcome.seconds) for run, outcome in context.runs])
