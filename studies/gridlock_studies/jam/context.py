"""What the chapters of the study share."""

from __future__ import annotations

from collections.abc import Iterable

from ..chapter import Context as StudyContext
from .extent import Extent
from .runs import DECOMPRESS, Outcome, Run, run_of


class Context(StudyContext[Extent, Run, Outcome]):
    """The settings, the simulations and the directory of the study."""

    def outcomes(self, runs: Iterable[Run]) -> list[Outcome]:
        """Of the runs that are finished."""
        return [outcome for outcome in (self.runs[run] for run in runs) if outcome is not None]

    def seeds(self, count: int) -> range:
        return range(self.seed, self.seed + count)

    def decompressed(self, potential: str = "harmonic", *, is_large: bool = False, is_box_free: bool = False) -> list[Run]:
        """Random points quenched at 0.86 and decompressed; shared by several figures."""
        extent = self.extent
        disks = extent.large_disks if is_large else extent.decompressed_disks
        starts = extent.large_starts if is_large else extent.decompressed_starts
        stages = [{"stage": "quench"}, DECOMPRESS if not is_large else {**DECOMPRESS, "until_pressure": 1e-6}]
        if is_box_free:
            stages = [{**stage, "box_shape": "free"} for stage in stages]
        title = f"{disks} {potential} disks, decompressed{' in a free box' if is_box_free else ''}"
        return [run_of(title, stages, seed, 0.5 * (disks / 256) ** 2, disks=disks,
                       packing_fraction=0.86, potential=potential) for seed in self.seeds(starts)]
