"""The repository, and the program that was built beside the package."""

import os
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture
def root():
    return ROOT


@pytest.fixture
def program():
    """The command line; a test that needs it is skipped where GRIDLOCK_PROGRAM does not name it."""
    path = os.environ.get("GRIDLOCK_PROGRAM", "")
    if not path:
        pytest.skip("GRIDLOCK_PROGRAM does not name the program gridlock")
    return path
