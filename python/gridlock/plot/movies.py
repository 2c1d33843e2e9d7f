"""Movies, which the program gridlock makes."""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
from typing import Any

from ..errors import Error, RunFailure
from ..files import RunDirectory, Trajectory


def program() -> str:
    """The program gridlock: ``GRIDLOCK_PROGRAM`` names it, or it lies beside the scripts of this Python, or on the path.

    :raises Error: where there is none.
    """
    named = os.environ.get("GRIDLOCK_PROGRAM")
    if named is not None:
        if shutil.which(named) is None:
            raise Error(f"GRIDLOCK_PROGRAM is {named!r}, which is no program\n  hint: let it name the program gridlock, or leave it out")
        return named
    beside = [os.path.join(directory, "gridlock") for directory in (sysconfig.get_path("scripts"), os.path.dirname(sys.executable))]
    found = next((path for path in [*beside, "gridlock"] if shutil.which(path)), None)
    if found is None:
        raise Error("the program gridlock is not installed, which makes the movies\n"
                    "  hint: pip install . in the sources of Gridlock brings it, ./dev package makes a package of it; or let GRIDLOCK_PROGRAM name it")
    return found


def movie(
    run: Any,
    file: str | os.PathLike[str],
    colour: str | None = None,
    *,
    width: int = 720,
    rate: int = 25,
    every: int = 1,
    overwrite: bool = False,
) -> pathlib.Path:
    """A movie of the frames that a run has kept, as ``gridlock movie`` makes it; needs that program and ffmpeg.

    :param run: a :class:`~gridlock.RunDirectory`, a :class:`~gridlock.Trajectory`, or the path of either.
    :param file: ends in .mp4, .mov, .mkv, .webm or .gif.
    :param colour: displacement, psi6, speed, direction, neighbourhood, radius or a column.
    :param width: pixels.
    :param rate: frames a second.
    :param every: shows every so many frames of the trajectory.
    :param overwrite: whether to replace a file that this function and ``gridlock movie`` have not made.
    :raises Error: for what cannot be drawn, with the texts of the command line, and without the program.
    :raises RunFailure: where ffmpeg fails.
    """
    source = run.path if isinstance(run, (RunDirectory, Trajectory)) else run
    words = [program(), "movie", os.fspath(source), "-o", os.fspath(file), "--quiet"]
    words += [f"--width={width}", f"--rate={rate}", f"--every={every}"]
    words += ["--overwrite"] if overwrite else []
    words += [] if colour is None else [f"--colour={colour}"]
    ended = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if ended.returncode != 0:
        text = ended.stderr.strip().removeprefix("error: ") or f"gridlock movie ended with {ended.returncode}"
        raise Error(text) if ended.returncode == 2 else RunFailure(text)
    return pathlib.Path(file)
