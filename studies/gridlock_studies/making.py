"""A study from the first run to the report."""

from __future__ import annotations

import dataclasses
import importlib.util
import os
import pathlib
import re
import time
import warnings
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, Union

from gridlock import Error, _core, playground
from gridlock.progress import ProgressBar
from gridlock.settings import as_threads

from . import report, style
from .chapter import Chapter, Claim, Context, SetUp
from .runs import PartialResults, cores, recorded_settings

REPORT = "report.html"
PARTIAL_RESULTS = "partial_results"
#: Of a chapter that does not choose its own.
MOST_LINKS = 12

#: A function of the share of the work that is done and of what is being done now, a few times a second; what it raises ends the
#: study.
Progress = Union[bool, Callable[[float, str], None]]


@dataclasses.dataclass(frozen=True)
class Part:
    """What makes one chapter of the report."""

    figure: int | None  #: None: made only with all figures
    plan: Callable[[Any], Sequence[Any]] | None  #: the runs that it needs
    make: Callable[[Any], Chapter]
    #: What is measured by itself before anything runs beside it, on so many cores, with a function of the share that is done.
    measure: Callable[[Any, int, Callable[[float], None]], None] | None = None
    #: The seconds that ``measure`` is expected to take.
    measure_seconds: Callable[[Any], float] | None = None
    measured: str = ""  #: what is being done meanwhile


@dataclasses.dataclass(frozen=True)
class Study:
    """What a study consists of."""

    parts: tuple[Part, ...]
    texts: report.Texts
    packages: tuple[str, ...]  #: that it needs besides NumPy
    seconds_of_work: float  #: of one unit of Run.work on one core
    context: type[Context[Any, Any, Any]]
    write_runs: Callable[[Any], None]  #: every run, its settings and what came out
    #: The names of all that it writes, without their endings.
    tables: tuple[str, ...]
    pictures: tuple[str, ...]

    @property
    def figures(self) -> list[int]:
        return [part.figure for part in self.parts if part.figure is not None]

    @property
    def files(self) -> list[str]:
        """The names of all files that a study may write."""
        drawn = [f"{name}.{format}" for name in self.pictures for format in style.FORMATS]
        return [*drawn, *(f"{name}.csv" for name in self.tables), playground.FILE, REPORT]


@dataclasses.dataclass(frozen=True)
class Made:
    """What a study has made."""

    claims: list[Claim]  #: what was published, what was measured, and the verdict
    files: list[pathlib.Path]  #: everything written, the report last
    notes: list[str]  #: runs that failed
    seconds: float  #: of real time


ExtentOf = TypeVar("ExtentOf")


def as_extent(extent: str | ExtentOf, quick: Callable[[], ExtentOf], full: Callable[[], ExtentOf]) -> ExtentOf:
    """An extent by its name, or as it is.

    :raises Error: for another name.
    """
    if not isinstance(extent, str):
        return extent
    if extent not in ("quick", "full"):
        raise Error(f"there is no extent {extent!r}\n  hint: use 'quick', 'full' or an Extent")
    return quick() if extent == "quick" else full()


class Stopped(KeyboardInterrupt):
    """A study that was interrupted; what it has finished is kept."""

    def __init__(self, partial_results: pathlib.Path, simulations: int, finished: int) -> None:
        # A figure may be made of timings alone.
        held = f"{finished} finished simulations of {simulations}" if simulations else "the timings that are finished"
        super().__init__(f"{partial_results} holds {held}")


class _Progression:
    """Shares the progress among the parts of the study by the seconds each is expected to take."""

    def __init__(self, on_progress: Callable[[float, str], None]) -> None:
        self.seconds = [0.0, 0.0, 4.0]  # of measurements, the simulations and the pictures
        self.part = 0
        self._pictures = 0
        self._on_progress = on_progress

    def report(self, share_of_part: float, what: str) -> None:
        done = sum(self.seconds[:self.part]) + self.seconds[self.part] * share_of_part
        self._on_progress(done / sum(self.seconds), what)

    def draws(self, name: str) -> None:
        """Before each picture, of which there are about nine."""
        self._pictures += 1
        self.report(min(self._pictures / 10.0, 1.0), f"drawing {name}")


def carry_out(
    study: Study,
    directory: str | os.PathLike[str],
    extent: Any,
    figure: int | None,
    seed: int,
    threads: int | None,
    overwrite: bool,
    progress: Progress,
) -> Made:
    """Makes the figures of a study, or one of them.

    :raises Error: for a figure that the study does not have, and a directory that is in use or holds other results.
    :raises Stopped: a KeyboardInterrupt, within about a second after Ctrl-C.
    """
    if figure is not None and figure not in study.figures:
        *others, last = map(str, study.figures)
        raise Error(f"the study has no Figure {figure!r}\n  hint: use {', '.join(others)} or {last}")
    _require_packages(study)
    jobs = min(as_threads(threads or 0) or cores(), cores())
    path = pathlib.Path(directory)
    kept = _core.Directory(os.fspath(path), study.files, overwrite)
    partial_results = PartialResults(path / PARTIAL_RESULTS)
    try:
        if overwrite:
            partial_results.remove_all()
        # Last to come and first to go: a directory with a report holds a finished study.
        (path / REPORT).unlink(missing_ok=True)
        with ProgressBar(progress is True, None) as bar:
            progression = _Progression(_as_function(progress, bar))
            context = study.context(extent, seed, path, kept, partial_results, progression.draws)
            try:
                with warnings.catch_warnings():
                    # The report itself says where a rule misleads.
                    warnings.simplefilter("ignore", UserWarning)
                    return _make(study, context, figure, jobs, progression)
            except KeyboardInterrupt:
                raise Stopped(partial_results.directory, len(context.runs), context.runs.finished) from None
    finally:
        kept.release()


def _require_packages(study: Study) -> None:
    """Before anything is run, not when the report is to be written."""
    missing = [name for name in study.packages if importlib.util.find_spec(name) is None]
    if missing:
        raise Error(f"{study.texts.name} needs {' and '.join(missing)}\n  hint: pip install {' '.join(missing)}")


def _as_function(progress: Progress, bar: Callable[[int, float], None] | None) -> Callable[[float, str], None]:
    if callable(progress):
        return progress
    return lambda share, what: None if bar is None else bar(0, share)


def _make(study: Study, context: Context[Any, Any, Any], figure: int | None, jobs: int, progression: _Progression) -> Made:
    start = time.perf_counter()
    parts = [part for part in study.parts if figure in (None, part.figure)]
    for part in parts:
        if part.plan is not None:
            context.plan(part.plan(context))
    is_resumed = context.runs.finished > 0
    measuring = [part for part in parts if part.measure is not None]
    progression.seconds[0] = sum(part.measure_seconds(context) for part in measuring if part.measure_seconds is not None)
    progression.seconds[1] = context.runs.work * study.seconds_of_work / jobs

    for part in measuring:
        assert part.measure is not None
        what = part.measured
        part.measure(context, jobs, lambda share, what=what: progression.report(share, what))  # type: ignore[misc]
    progression.part = 1
    if len(context.runs):
        context.runs.run_all(jobs, lambda share: progression.report(
            share, f"{context.runs.finished} of {len(context.runs)} simulations"))
        study.write_runs(context)
    progression.part = 2
    chapters = [part.make(context) for part in parts]
    for part, chapter in zip(parts, chapters):
        if part.plan is not None and not chapter.set_ups:
            chapter.set_ups = _set_ups_of(part.plan(context))

    context.notes += context.runs.failures
    if context.partial_results.problem:
        context.notes.append(f"partial results were not all kept: {context.partial_results.problem}")
    seconds = time.perf_counter() - start
    progression.report(1.0, "drawing")  # a wish to stop that comes later comes too late
    page = _playground_of(context, chapters)
    context.write(REPORT, report.html(study.texts, context, chapters, seconds, is_resumed=is_resumed, page=page).encode())
    context.partial_results.remove_all()
    claims = [claim for chapter in chapters for claim in chapter.claims]
    return Made(claims, context.files, context.notes, seconds)


def _set_ups_of(runs: Sequence[Any]) -> list[SetUp]:
    """The first run of each title, whatever its seed, for the playground; some of them, evenly chosen, where there are many."""
    firsts: dict[str, Any] = {}
    for run in runs:
        firsts.setdefault(re.sub(r", seed \d+$", "", run.title), run)
    found = [SetUp(title, settings) for title, run in firsts.items() if (settings := recorded_settings(run)) is not None]
    step = -(-len(found) // MOST_LINKS) or 1
    return found[::step]


def _playground_of(context: Context[Any, Any, Any], chapters: Sequence[Chapter]) -> str | None:
    """The address of the playground for links of the report. A page that is a file is copied beside the report, so that both can be
    moved and sent; None where no page is found or no chapter has a set-up for it."""
    page = playground.find_page() if any(chapter.set_ups for chapter in chapters) else None
    if page is None or page.startswith(("http://", "https://")):
        return page
    try:
        context.write(playground.FILE, pathlib.Path(page).read_bytes())
    except OSError as problem:
        context.notes.append(f"the report has no links to the playground: {problem}")
        return None
    return playground.FILE
