"""What commands that carry out a study share: options, progress, signals, exit codes."""

from __future__ import annotations

import argparse
import dataclasses
import importlib
import os
import pathlib
import re
import signal
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, NoReturn

from gridlock import Error, RunFailure

if TYPE_CHECKING:
    from types import FrameType

GOOD, RUN_FAILED, BAD_USE = 0, 1, 2


def _whole_number(least: int, most: int | None = None) -> Callable[[str], int]:
    span = f"at least {least}" if most is None else f"from {least} to {most}"

    def parse(text: str) -> int:
        if not (text.isascii() and text.isdigit()) or int(text) < least or (most is not None and int(text) > most):
            raise argparse.ArgumentTypeError(f"must be a whole number, {span}, but is {text}")
        return int(text)

    return parse


#: What argparse says of bad use, and what this command says.
_COMPLAINTS = (
    (r"argument (?:-\w/)?(--\w+): (must be .*)", r"\1 \2"),
    (r"argument (?:-\w/)?(--\w+): expected one argument", r"\1 needs a value"),
    (r"argument (?:-\w/)?(--\w+): not allowed with argument (--\w+)", r"\2 and \1 cannot be given together"),
    (r"unrecognized arguments: (-\S+).*", r"{command} has no option \1"),
    (r"unrecognized arguments: (\S+).*", r'"\1" is one word too many: {command} takes options only'),
)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        for pattern, complaint in _COMPLAINTS:
            message = re.sub(f"^{pattern}$", complaint.replace("{command}", self.prog), message)
        print(f"error: {message}\n  hint: {self.prog} --help lists its options", file=sys.stderr)
        raise SystemExit(BAD_USE)


@dataclasses.dataclass(frozen=True)
class StudyCommand:
    """What one study says of itself in the help."""

    name: str  #: "gridlock paper"
    description: str
    figures: tuple[int, int]  #: the first and the last
    quick: str
    full: str
    directory: str  #: for the results
    module: str  #: whose make() carries the study out


def _parser(command: StudyCommand) -> argparse.ArgumentParser:
    parser = _Parser(prog=command.name, allow_abbrev=False, description=command.description)
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--quick", action="store_true", help=f"{command.quick} (default)")
    extent.add_argument("--full", action="store_true", help=command.full)
    first, last = command.figures
    parser.add_argument("--figure", type=_whole_number(first, last), metavar="N", help=f"make this figure alone, {first} to {last}")
    parser.add_argument("--seed", type=_whole_number(0), default=1, metavar="N", help="the seeds of the runs are this one and "
                                                                                      "those after it")
    parser.add_argument("-j", "--threads", type=_whole_number(1, 4096), metavar="N",
                        help="simulations at a time; left out: one for each core")
    parser.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path(command.directory), metavar="DIR",
                        help=f"directory for the results; left out: {command.directory}")
    parser.add_argument("--overwrite", action="store_true", help="replace existing results")
    return parser


def duration_text(seconds: float) -> str:
    """
    >>> duration_text(4.25), duration_text(93.0), duration_text(7300.0)
    ('4.2 s', '1 min 33 s', '2 h 01 min')
    """
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02} min"


class _ProgressLine:
    """How far the work has come, on standard error: one line redrawn a few times a second on a terminal; a plain line after a
    second, and then every ten percent or half minute, where the output goes to a file or pipe."""

    def __init__(self) -> None:
        self._is_terminal = sys.stderr.isatty()
        self._start = self._last = time.monotonic()
        self._last_share = -1.0
        self._is_open = False

    def show(self, share: float, what: str) -> None:
        now = time.monotonic()
        waited = now - self._last
        if self._is_terminal:
            is_due = waited >= 0.2 or (share >= 1.0 and self._is_open)
        else:
            is_due = waited >= 30.0 or (waited >= 1.0 and (self._last_share < 0.0 or share - self._last_share >= 0.1))
        if not is_due:
            return
        self._last, self._last_share = now, share
        left = (now - self._start) * (1.0 - share) / share if share > 0.0 else 0.0
        text = f"{100.0 * share:5.1f} %  {what}  {duration_text(left)} left"
        self._is_open = self._is_terminal
        print(f"\r\033[K{text}" if self._is_terminal else f"{text}\n", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self._is_open:
            print(file=sys.stderr)


class _StopSignals:
    """Stops work politely: Ctrl-C and SIGTERM are remembered, and the work asks now and then. A second signal ends the program at
    once. Afterwards signals do what they did before."""

    def __init__(self) -> None:
        self.is_stop_asked = False
        self._former = {number: signal.signal(number, self._remember) for number in (signal.SIGINT, signal.SIGTERM)}

    def close(self) -> None:
        for number, handler in self._former.items():
            signal.signal(number, handler)

    def _remember(self, number: int, frame: FrameType | None) -> None:
        if self.is_stop_asked:
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
        self.is_stop_asked = True


def _make(command: StudyCommand, options: argparse.Namespace) -> int:
    # Packages that the help does not need are imported only here.
    from .making import Stopped

    make = importlib.import_module(command.module).make
    signals, line = _StopSignals(), _ProgressLine()

    def on_progress(share: float, what: str) -> None:
        if not options.quiet:
            line.show(share, what)
        if signals.is_stop_asked:
            raise KeyboardInterrupt

    try:
        made = make(options.output, "full" if options.full else "quick", options.figure, seed=options.seed,
                    threads=options.threads, overwrite=options.overwrite, progress=on_progress)
    except Stopped as stopped:
        same = "the same command without --overwrite" if options.overwrite else "the same command"
        print(f"interrupted: {stopped}; {same} does the rest", file=sys.stderr)
        return RUN_FAILED
    finally:
        line.close()
        signals.close()
    for note in made.notes:
        print(f"note: {note}", file=sys.stderr)
    if not options.quiet:
        for claim in made.claims:
            print(f"{claim.verdict.value:<12} {claim.where}: {claim.statement}")
        print(f"finished in {duration_text(made.seconds)}; open {options.output / 'report.html'}")
    return GOOD


def run(command: StudyCommand, arguments: list[str] | None) -> int:
    """:returns: 0 for a finished study, 1 for one that was stopped or broke, 2 for arguments and directories that cannot be
    used."""
    try:
        options = _parser(command).parse_args(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    try:
        return _make(command, options)
    except (Error, RunFailure) as error:
        text = str(error)
        print(text if text.startswith("error: ") else f"error: {text}", file=sys.stderr)
        return BAD_USE if isinstance(error, Error) else RUN_FAILED

