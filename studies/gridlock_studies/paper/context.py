"""What the chapters of the study share."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ..chapter import Context as StudyContext
from .extent import Extent
from .replicas import Measured, ReplicaSet
from .runs import Outcome, Run


if TYPE_CHECKING:
    from .step_cost import StepCost


class Context(StudyContext[Extent, Run, Outcome]):
    """The settings, the simulations and the directory of the study."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.costs: list[StepCost] = []  #: of Figure 5, once they are measured

    def measured(self, replica_sets: Iterable[ReplicaSet]) -> list[Measured]:
        """Those of which a run is finished."""
        return [result for result in (Measured(self.runs, replica_set) for replica_set in replica_sets) if result.seeds]


def runs_of(replica_sets: Iterable[ReplicaSet]) -> list[Run]:
    return [run for replica_set in replica_sets for run in replica_set.runs]
