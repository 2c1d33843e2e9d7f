"""What MDAnalysis lacks for frames in memory: times that are not even. Imported only where MDAnalysis is used."""

from __future__ import annotations

from typing import Any

from MDAnalysis.coordinates.memory import MemoryReader  # type: ignore[import-untyped]


class TimedReader(MemoryReader):  # type: ignore[misc]
    """Frames in memory, each at a time of its own: ``moments``, one for each frame."""

    def _read_next_timestep(self, ts: Any = None) -> Any:
        ts = super()._read_next_timestep(ts)
        ts.time = float(self._kwargs["moments"][ts.frame])
        return ts
