"""The two errors of Gridlock, with the texts of the command line."""

from __future__ import annotations

from typing import TypedDict


class Problem(TypedDict):
    """One thing that is wrong: what, what to do, and where."""

    what: str
    hint: str
    key: str
    file: str
    line: int
    column: int


class Error(ValueError):
    """Input that cannot be used: a setting, a state, an array, a file.

    ``problems`` has every problem that was found, not only the first.
    """

    def __init__(self, text: str, problems: list[Problem] | None = None) -> None:
        super().__init__(text)
        self.problems: list[Problem] = problems if problems is not None else []


class RunFailure(RuntimeError):
    """A run that began well and broke: the physics broke an invariant, or the disk is full."""
