"""The repository, and the program that was built beside the package."""

import os
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# No report of a test links to the playground, whether it is built or not, unless the test asks for it.
os.environ["GRIDLOCK_PLAYGROUND"] = ""


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
