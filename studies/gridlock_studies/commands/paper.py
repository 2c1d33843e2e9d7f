"""``gridlock paper``: make the paper's Figures 4 to 7 and check its claims."""

from __future__ import annotations

import sys

from ..command import StudyCommand, run

COMMAND = StudyCommand(
    name="gridlock paper",
    description="Make the paper's Figures 4 to 7 and check its claims",
    figures=(4, 7),
    quick="Figure 7 with the paper's 100,000 steps and one seed, all else with 10,000; about two minutes on two cores",
    full="the paper's 100,000 steps, about half an hour on two cores",
    directory="results/paper",
    module="gridlock_studies.paper",
)


def main(arguments: list[str] | None = None) -> int:
    """See :func:`gridlock_studies.command.run`."""
    return run(COMMAND, arguments)


if __name__ == "__main__":
    sys.exit(main())
