"""The repository, and the program that was built beside the package."""

import os
import pathlib
import signal

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

#: The usual box of these tests: periodic, and of another width than height, so that the two are not taken for each other.
OBLONG = {"width": 1.5, "height": 0.6, "edge": "periodic"}

# No report of a test links to the playground, whether it is built or not, unless the test asks for it.
os.environ["GRIDLOCK_PLAYGROUND"] = ""


@pytest.fixture(autouse=True)
def hears_ctrl_c():
    """Python's own answer to Ctrl-C, also where the tests were started with the signal ignored: by nohup, or in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


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
