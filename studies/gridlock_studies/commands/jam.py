"""``gridlock jam``: where disks jam, and how, beside published numbers."""

from __future__ import annotations

import sys

from ..command import StudyCommand, run

COMMAND = StudyCommand(
    name="gridlock jam",
    description="Jam disks by quench, growth and decompression, shear them, and compare with published numbers",
    figures=(1, 10),
    quick="few starts of 64 and 256 disks, at most three minutes on two cores",
    full="more starts and larger systems",
    directory="results/jam",
    module="gridlock_studies.jam",
)


def main(arguments: list[str] | None = None) -> int:
    """See :func:`gridlock_studies.command.run`."""
    return run(COMMAND, arguments)


if __name__ == "__main__":
    sys.exit(main())
