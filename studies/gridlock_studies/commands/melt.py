"""``gridlock melt``: how hard disks melt, beside published numbers."""

from __future__ import annotations

import sys

from ..command import StudyCommand, run

COMMAND = StudyCommand(
    name="gridlock melt",
    description="Melt hard disks and compare pressures, order and defects with published numbers",
    figures=(1, 7),
    quick="72 to 3,120 disks, about four minutes on two cores",
    full="up to 49,920 disks and longer runs, about seven hours on two cores",
    directory="results/melt",
    module="gridlock_studies.melt",
)


def main(arguments: list[str] | None = None) -> int:
    """See :func:`gridlock_studies.command.run`."""
    return run(COMMAND, arguments)


if __name__ == "__main__":
    sys.exit(main())
