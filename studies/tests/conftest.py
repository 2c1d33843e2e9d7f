"""Ctrl-C and the playground, as the tests of the package have them, and tables of studies."""

import csv
import gzip
import os
import pathlib
import signal

import pytest

# No report of a test links to the playground, whether it is built or not, unless the test asks for it.
os.environ["GRIDLOCK_PLAYGROUND"] = ""


@pytest.fixture(autouse=True)
def hears_ctrl_c():
    """Python's own answer to Ctrl-C, also where the tests were started with the signal ignored: by nohup, or in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def rows_of(file):
    """The rows of a table, packed or not."""
    file = pathlib.Path(file)
    if not file.exists():
        file = file.with_name(file.name + ".gz")
    with (gzip.open if file.suffix == ".gz" else open)(file, "rt", newline="") as lines:
        return list(csv.DictReader(lines))
