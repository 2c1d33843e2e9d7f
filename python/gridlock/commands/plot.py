"""``gridlock plot DIR``: draws the pictures of a run, sweep or packing from its data."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Sequence

from ..errors import Error, RunFailure


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="gridlock plot", description="Draw the pictures of a run, sweep or packing from its data.")
    parser.add_argument("directory", metavar="DIR", help="directory of a run, a sweep or of gridlock contacts")
    parser.add_argument("--colour", "--color", default="", metavar="NAME",
                        help="of the agents at the end: psi6, speed, direction, neighbourhood, radius, or a column")
    parser.add_argument("--pdf", action="store_true", help="write PDF files too, for papers")
    parser.add_argument("--overwrite", action="store_true", help="replace files that Gridlock has not written")
    parser.add_argument("--if-any", action="store_true", help="do nothing where there is nothing to draw, as of a sweep over one value")
    return parser


def _plot(options: argparse.Namespace) -> int:
    from ..plot import pictures

    made = pictures(options.directory, options.colour, pdf=options.pdf, overwrite=options.overwrite)
    for file in made.files:
        print(file)
    for note in made.notes:
        print(f"note: {note}", file=sys.stderr)
    if not made.files and not made.notes and not options.if_any:
        raise Error(f"there is nothing to draw of {options.directory}\n"
                    "  hint: a sweep is drawn against a number that has two values or more, from the runs that have finished")
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit codes of all commands: 0, 1 for a failure, 2 for input that cannot be used."""
    if arguments is None:
        # As other programs end by Ctrl-C and where nobody reads their output any more.
        for number in (signal.SIGINT, signal.SIGPIPE):
            signal.signal(number, signal.SIG_DFL)
    options = _parser().parse_args(arguments)
    try:
        return _plot(options)
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except (MemoryError, OSError, RunFailure) as error:
        print(f"error: {error or 'not enough memory'}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
