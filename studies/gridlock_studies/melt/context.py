"""What the chapters of the study share."""

from __future__ import annotations

from collections.abc import Iterable

from ..chapter import Context as StudyContext
from .extent import Extent, System
from .points import Point
from .runs import CRYSTAL, LIQUID, Outcome, Run, run_of


class Context(StudyContext[Extent, Run, Outcome]):
    """The settings, the simulations and the directory of the study."""

    def outcomes(self, runs: Iterable[Run]) -> list[Outcome]:
        """Of the runs that are finished."""
        return [outcome for outcome in (self.runs[run] for run in runs) if outcome is not None]

    def runs_at(self, system: System, density: float, kind: str) -> list[Run]:
        return [run_of(system, density, kind, self.extent.samples, self.seed + number) for number in range(system.starts)]

    def runs_of(self, systems: Iterable[System]) -> list[Run]:
        return [run for system in systems for density in system.densities for kind in (CRYSTAL, LIQUID)
                for run in self.runs_at(system, density, kind)]

    def points(self, system: System) -> list[Point]:
        """In rising packing fraction."""
        return [Point(system.disks, density, {kind: self.outcomes(self.runs_at(system, density, kind)) for kind in (CRYSTAL, LIQUID)})
                for density in system.densities]

    @property
    def systems(self) -> tuple[System, ...]:
        return self.extent.systems

    @property
    def largest(self) -> System:
        return self.systems[-1]
