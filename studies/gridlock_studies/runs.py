"""Simulations of a study: each is done once, whichever figures need it, and kept until the report is written."""

from __future__ import annotations

import concurrent.futures
import contextlib
import functools
import hashlib
import io
import json
import os
import pathlib
import re
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np

from gridlock import Error, RunFailure, __version__

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Outcome(Protocol):
    """What a study keeps of a run."""

    @property
    def arrays(self) -> dict[str, Any]:
        """To be kept."""


OutcomeType = TypeVar("OutcomeType", bound=Outcome)
OutcomeOfRun = TypeVar("OutcomeOfRun", bound=Outcome, covariant=True)


class Run(Protocol[OutcomeOfRun]):
    """Something to be run, told from others by its settings."""

    @property
    def work(self) -> float:
        """What it costs, in any unit; only for the order and the progress."""

    @property
    def key(self) -> str:
        """Everything that the outcome depends on."""

    @property
    def title(self) -> str:
        """What a reader of a failure calls it."""

    def carry_out(self, on_progress: Callable[[int, float], None]) -> OutcomeOfRun:
        """Calls ``on_progress`` with the steps done and the fraction of the run now and then; what that raises ends the run."""

    def restored(self, arrays: Mapping[str, NDArray[Any]]) -> OutcomeOfRun:
        """The outcome that was kept."""


RunType = TypeVar("RunType", bound="Run[Any]")


def recorded_settings(run: Any) -> dict[str, Any] | None:
    """The settings of a run that has them in JSON, as ``recorded_settings`` or ``settings``; None where they do not tell all of it."""
    text = getattr(run, "recorded_settings", getattr(run, "settings", ""))
    if not isinstance(text, str) or not text:
        return None
    found: dict[str, Any] = json.loads(text)
    return found


class PartialResults:
    """Finished pieces of a study that is not finished, one file each, so that a study that is stopped or killed continues
    without doing them again.

    A piece is found by its key, which says everything that its result depends on. Its file holds the key and the version of the
    library as well; a file that is damaged or of another version counts as none. Every file is written whole or not at all.
    """

    def __init__(self, directory: pathlib.Path) -> None:
        self.directory = directory
        self.problem = ""  #: why a piece could not be kept

    def _file(self, key: str) -> pathlib.Path:
        return self.directory / f"{hashlib.sha256(key.encode()).hexdigest()[:16]}.npz"

    def restore(self, key: str) -> dict[str, NDArray[Any]] | None:
        """The arrays that were kept, or None."""
        try:
            with np.load(self._file(key), allow_pickle=False) as file:
                arrays = dict(file.items())
        except Exception:  # Whatever is wrong with the file, the piece is done again.
            return None
        is_this = str(arrays.pop("key", "")) == key and str(arrays.pop("version", "")) == __version__
        return arrays if is_this else None

    def keep(self, key: str, arrays: Mapping[str, Any]) -> None:
        """Where it cannot be written the study continues, and ``problem`` says why."""
        data = io.BytesIO()
        np.savez(data, key=np.array(key), version=np.array(__version__), **arrays)
        file = self._file(key)
        part = file.with_name(f".{file.name}.part")
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            part.write_bytes(data.getbuffer())
            part.replace(file)
        except OSError as error:
            self.problem = self.problem or str(error)

    def remove_all(self) -> None:
        """Removes all pieces, and the directory where nothing else is in it."""
        for file in self.directory.glob("*"):
            # What a killed process has left of a piece is hidden and ends with "part".
            if re.fullmatch(r"[0-9a-f]{16}\.npz|\.[0-9a-f]{16}\.npz\.part", file.name):
                file.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.directory.rmdir()


class _Stopped(Exception):
    """Ends a run that nobody waits for any more."""


def cores() -> int:
    """How many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class RunPool(Generic[RunType, OutcomeType]):
    """Simulations that several figures share."""

    def __init__(self, partial_results: PartialResults) -> None:
        self._partial_results = partial_results
        self._outcomes: dict[RunType, OutcomeType | None] = {}
        self._failures: dict[RunType, str] = {}
        self._done: dict[RunType, float] = {}  # the share that is done of each run of this call
        self._is_stopped = False

    def add(self, run: RunType) -> None:
        """Notes that a run is needed; one that was asked for before is not done twice."""
        if run in self._outcomes:
            return
        kept = self._partial_results.restore(run.key)
        if kept is None:
            self._outcomes[run] = None
        else:
            self._outcomes[run] = run.restored(kept)

    def __len__(self) -> int:
        return len(self._outcomes)

    def __iter__(self) -> Iterator[tuple[RunType, OutcomeType]]:
        """The finished runs."""
        return ((run, outcome) for run, outcome in self._outcomes.items() if outcome is not None)

    def __getitem__(self, run: RunType) -> OutcomeType | None:
        """What came out of a run; None where it is not finished, or was never asked for."""
        return self._outcomes.get(run)

    @property
    def finished(self) -> int:
        return sum(1 for _ in self)

    @property
    def work(self) -> float:
        """Of all runs that are not finished."""
        return sum(run.work for run, outcome in self._outcomes.items() if outcome is None)

    @property
    def failures(self) -> list[str]:
        """Runs that broke, in words."""
        return [f"{run.title}: {text}" for run, text in self._failures.items()]

    def run_all(self, threads: int, on_progress: Callable[[float], None]) -> None:
        """Does what is not finished, ``threads`` runs at a time, the longest first.

        on_progress is called a few times a second with the share of the work that is done; whatever it raises stops every run at
        its next look.
        """
        runs = sorted((run for run, outcome in self._outcomes.items() if outcome is None), key=lambda run: -run.work)
        work = sum(run.work for run in runs)
        self._done = {run: 0.0 for run in runs}
        self._is_stopped = False
        with concurrent.futures.ThreadPoolExecutor(threads) as executor:
            waiting = {executor.submit(self._carry_out, run) for run in runs}
            try:
                while waiting:
                    ended, waiting = concurrent.futures.wait(waiting, timeout=0.1)
                    for future in ended:
                        future.result()
                    on_progress(sum(run.work * share for run, share in self._done.items()) / work)
            finally:
                self._is_stopped = True
                for future in waiting:
                    future.cancel()

    def _carry_out(self, run: RunType) -> None:
        try:
            outcome = run.carry_out(functools.partial(self._note, run))
        except _Stopped:
            return
        except (Error, RunFailure) as error:
            self._failures[run] = str(error)
            self._done[run] = 1.0
            return
        self._partial_results.keep(run.key, outcome.arrays)
        self._outcomes[run] = outcome
        self._done[run] = 1.0

    def _note(self, run: RunType, steps: int, fraction: float) -> None:
        if self._is_stopped:
            raise _Stopped
        self._done[run] = fraction
