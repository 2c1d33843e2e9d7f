"""A simulation that runs on a thread of its own while others look at it, and what they see of it."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future, TimeoutError
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .changes import latest, setting_that_may_change
from .controls import Control, controls, description
from .errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .simulation import Simulation

#: Seconds of steps between two looks at what is asked for.
CHUNK = 0.01
#: Seconds that a thread which waits for a frame has to take it at once, and not when the model next lets other threads run.
HANDOVER = 0.002
#: A running model makes no more frames a second; frames, and readings of the series, cost no more than these shares of its time.
MOST_FRAMES, SHARE_OF_FRAMES, SHARE_OF_SERIES = 50, 0.05, 0.02
#: Seconds between two readings of the series.
SERIES_PAUSE = 0.2
#: Seconds without any page until a run pauses: browsers let hidden pages ask once a minute.
PATIENCE = 90.0
#: Seconds until one who waits for a step to end is told so.
PATIENCE_OF_COMMANDS, PATIENCE_OF_CLOSE = 10.0, 5.0
#: Rows of the series that one frame brings at most.
MOST_ROWS = 20_000


class LiveFrame(NamedTuple):
    """All agents and fields at one step, in four bytes a number, and how the run goes."""

    version: int
    made: float  # by time.monotonic()
    head: dict[str, Any]
    columns: dict[str, NDArray[Any]]
    fields: dict[str, NDArray[np.float32]]
    series: NDArray[np.float64]


class Live:
    """A simulation on a thread of its own: it runs, pauses and begins anew as it is told, and makes frames where somebody waits for one.

    :param make: a simulation with some settings over its usual ones, by their keys. It raises Error for settings that cannot be.

    All calls may come from any thread. What they raise is what the thread of the simulation has raised.
    """

    settings: list[Control]
    _simulation: Simulation
    _about: dict[str, Any]
    _step: int
    #: Steps that fit into a chunk; those taken since the run went on, and when that was.
    _most: int
    _taken: int
    _began: float
    #: When which step was reached of late.
    _paces: deque[tuple[float, int]]

    def __init__(self, make: Callable[[Mapping[str, Any]], Simulation]) -> None:
        self._make = make
        self._overrides: dict[str, Any] = {}
        self._changed = threading.Condition()
        self._commands: deque[tuple[Callable[[], Any], Future[Any]]] = deque()
        self._wishes: dict[int, frozenset[str]] = {}
        self._asked = time.monotonic()
        self._is_closed = False
        self._is_running = False
        self._speed: float | None = 50.0
        self._problem = ""
        self._version = 0
        self._run = 0
        self._frame: LiveFrame | None = None
        self._next_frame = self._next_series = 0.0
        self._series: NDArray[np.float64] = np.empty((0, 0))
        self._begin(make({}))
        self._thread = threading.Thread(target=self._work, name="gridlock model", daemon=True)
        self._thread.start()

    # What others ask for.

    def run(self, steps_per_second: float | None) -> None:
        """Runs on, at so many steps a second or as fast as it can."""
        self._do(lambda: self._go(steps_per_second))

    def pause(self) -> Simulation:
        """Pauses between two steps; the simulation."""
        return self._do(self._stop)  # type: ignore[no-any-return]

    def step(self, steps: int = 1) -> None:
        """Pauses, and takes some steps."""
        self._do(lambda: self._take(steps))

    def restart(self) -> None:
        """Begins anew, with the settings as they were changed, and pauses."""
        self.pause()
        self._do(lambda: self._renew(self._overrides))

    def set(self, key: str, text: str) -> None:
        """Goes on with another value of a setting, or begins anew with it where the run cannot go on, and runs on where it ran. Errors: Error;
        then the run before stays."""
        setting = next((one for one in self.settings if one.key == key), None)
        if setting is None:
            raise Error(f"there is no setting {key!r} to change\n  hint: reload the page")
        value = setting.read(text)
        self._do(lambda: self._change(key, value))

    def frame(self, after: int, columns: frozenset[str], patience: float) -> LiveFrame | None:
        """A frame with some columns that is later than that of a version; None where nothing has changed for so long."""
        came = time.monotonic()
        with self._changed:
            self._asked = came
            number = threading.get_ident()
            self._wishes[number] = columns
            self._changed.notify_all()
            try:
                while not self._is_closed:
                    frame = self._frame
                    if frame is not None and frame.version > after and columns <= frame.columns.keys():
                        if frame.made >= came or frame.version == self._version:
                            return frame
                    if not self._changed.wait(came + patience - time.monotonic()) and time.monotonic() >= came + patience:
                        return None
            finally:
                del self._wishes[number]
                self._changed.notify_all()
        raise Error("this model is shown no more\n  hint: show it again")

    def about(self) -> dict[str, Any]:
        """What is known of a run before its first step."""
        return self._about

    def close(self) -> bool:
        """Ends the thread at the end of its step; whether it has ended."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()
        if threading.current_thread() is not self._thread:
            self._thread.join(PATIENCE_OF_CLOSE)
        return not self._thread.is_alive()

    def _do(self, command: Callable[[], Any]) -> Any:
        answer: Future[Any] = Future()
        with self._changed:
            if self._is_closed:
                raise Error("this model is shown no more\n  hint: show it again")
            self._asked = time.monotonic()
            self._commands.append((command, answer))
            self._changed.notify_all()
        try:
            return answer.result(PATIENCE_OF_COMMANDS)
        except TimeoutError:
            raise Error(f"the model has been at one step for {PATIENCE_OF_COMMANDS:g} s\n"
                        "  hint: it does what it is told at the end of its step; Ctrl-C in its program ends it") from None

    # What the thread of the simulation does.

    def _work(self) -> None:
        while True:
            with self._changed:
                while not (self._is_closed or self._commands or self._due() or self._wants_frame()):
                    self._changed.wait(self._pause())
                    self._look()
                if self._is_closed:
                    break
                commands = list(self._commands)
                self._commands.clear()
            for command, answer in commands:
                _answer(command, answer)
            if self._wants_frame():
                self._show()
            if self._due():
                self._advance(self._due())
        for _, answer in self._commands:
            answer.set_exception(Error("this model is shown no more\n  hint: show it again"))

    def _due(self) -> int:
        """Steps to be taken now."""
        if not self._is_running:
            return 0
        if self._speed is None:
            return self._most
        behind = (time.monotonic() - self._began) * self._speed - self._taken
        if behind > self._most:  # it cannot keep up
            self._began, self._taken = time.monotonic(), 0
            return self._most
        return max(0, int(behind + 1))

    def _pause(self) -> float:
        """Seconds until there may be something to do."""
        until = [1.0]
        if self._is_running and self._speed is not None:
            until.append(self._began + self._taken / self._speed - time.monotonic())
        if self._wishes:
            until.append(0.25 if self._is_current() else self._next_frame - time.monotonic())
        return max(0.0005, min(until))

    def _look(self) -> None:
        """Sees what its user has done with a simulation that is paused."""
        if self._is_running or not self._wishes:
            return
        try:
            step = self._simulation.clock.step
        except RuntimeError:  # its user runs it
            return
        if step != self._step:
            self._step = step
            self._version += 1

    def _is_current(self) -> bool:
        frame = self._frame
        return frame is not None and frame.version == self._version and all(names <= frame.columns.keys() for names in self._wishes.values())

    def _wants_frame(self) -> bool:
        return bool(self._wishes) and not self._is_current() and time.monotonic() >= self._next_frame

    def _go(self, steps_per_second: float | None) -> None:
        self._speed, self._is_running, self._problem = steps_per_second, True, ""
        self._began, self._taken = time.monotonic(), 0
        self._paces = deque([(time.monotonic(), self._step)], maxlen=64)
        self._version += 1

    def _stop(self) -> Simulation:
        self._is_running = False
        self._version += 1
        return self._simulation

    def _take(self, steps: int) -> None:
        self._stop()
        self._problem = ""
        self._advance(steps)

    def _advance(self, steps: int) -> None:
        began = time.perf_counter()
        try:
            self._simulation.run(steps=steps)
        except BaseException as failure:  # noqa: BLE001: whatever a model raises is told
            self._is_running = False
            self._problem = str(failure) or type(failure).__name__
        else:
            # As many steps as fit, but no sudden leap.
            self._most = max(1, min(2 * self._most, int(CHUNK * steps / (time.perf_counter() - began + 1e-9))))
        self._taken += steps
        self._step = self._simulation.clock.step
        self._paces.append((time.monotonic(), self._step))
        self._version += 1
        if not self._wishes and time.monotonic() > self._asked + PATIENCE:
            self._is_running = False  # nobody looks

    def _change(self, key: str, value: Any) -> None:
        simulation, overrides = self._simulation, {**self._overrides, key: value}
        # Before the first step a new start says the same, and needs no record.
        if self._step == 0 or self._problem or setting_that_may_change(simulation._model, key) is None:
            self._renew(overrides)
            return
        try:
            simulation.change({key: value})
        except BaseException:
            self._stop()
            raise
        self._overrides = overrides
        self._describe()

    def _renew(self, overrides: dict[str, Any]) -> None:
        try:
            made = self._make(overrides)
        except BaseException:
            self._stop()
            raise
        self._overrides = overrides
        self._begin(made)

    def _begin(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self.settings = controls()
        self._step = simulation.clock.step
        self._most, self._taken, self._began = 1, 0, time.monotonic()
        self._paces = deque([(self._began, self._step)], maxlen=64)
        self._problem = ""
        self._run += 1
        self._series = np.empty((0, 0))
        self._next_series = 0.0
        self._describe()

    def _describe(self) -> None:
        self._about = {"run": self._run, **description(self._simulation, self.settings)}
        self._version += 1

    def _show(self) -> None:
        """Makes a frame with all columns that anybody waits for."""
        began = time.thread_time()
        with self._changed:
            wanted = frozenset[str]().union(*self._wishes.values())
        simulation = self._simulation
        try:
            frame: Any = simulation._core.frame()
            self._read_series()
        except RuntimeError:  # its user runs it
            self._next_frame = time.monotonic() + 0.1
            return
        if len(simulation._changes) != len(self._about["changes"]):  # by its user
            self._overrides = {**self._overrides, **latest(simulation._changes)}
            self._describe()
        ids, columns, box, step, now, fields = frame[:6]
        width, height, periodic_x, periodic_y, shift = box
        head = {
            "run": self._run, "changes": len(simulation._changes), "version": self._version, "step": step, "time": now, "count": len(ids),
            "box": {"width": width, "height": height, "periodic": [periodic_x, periodic_y], "shift": shift},
            "isRunning": self._is_running, "speed": self._speed, "stepsPerSecond": self._pace(), "problem": self._problem,
            "stateHash": "" if self._is_running else simulation.state_hash,
        }
        shown = {"id": ids if len(ids) and int(ids.max()) >= 2**32 else _in_short(ids), **{name: _in_short(values) for name, values in columns.items() if name in wanted or name in ("x", "y")}}
        # Columns that are asked for and that there are none of are empty ones, so that nobody waits for them.
        shown.update({name: np.empty(0, dtype=np.float32) for name in wanted - shown.keys()})
        layers = {name: np.asarray(field, dtype=np.float32) for name, field in fields.items()}
        with self._changed:
            self._frame = LiveFrame(self._version, time.monotonic(), head, shown, layers, self._series)
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._wishes, HANDOVER)
        pause = max(1 / MOST_FRAMES, (time.thread_time() - began) / SHARE_OF_FRAMES)
        self._next_frame = time.monotonic() + (pause if self._is_running else 0.0)

    def _read_series(self) -> None:
        now = time.monotonic()
        if self._is_running and now < self._next_series:
            return
        began = time.thread_time()
        columns = self._simulation._core.series()
        self._series = np.column_stack([np.asarray(values, dtype=np.float64) for values in columns.values()]) if columns else np.empty((0, 0))
        self._next_series = now + max(SERIES_PAUSE, (time.thread_time() - began) / SHARE_OF_SERIES)

    def _pace(self) -> float:
        """Steps a second of late."""
        if not self._is_running:
            return 0.0
        (began, first), (end, last) = self._paces[0], self._paces[-1]
        return (last - first) / (end - began) if end > began else 0.0


def _answer(command: Callable[[], Any], answer: Future[Any]) -> None:
    try:
        answer.set_result(command())
    except BaseException as failure:  # noqa: BLE001: whoever has asked gets it
        answer.set_exception(failure)


def _in_short(values: NDArray[Any]) -> NDArray[Any]:
    """In four bytes a number; whole numbers beyond are rounded, if they are no Ids."""
    is_whole = values.dtype.kind in "iu"
    if is_whole and values.dtype.itemsize > 4:
        return values.astype(np.uint32) if not len(values) or int(values.max()) < 2**32 else values.astype(np.float32)
    return values if is_whole else values.astype(np.float32)
