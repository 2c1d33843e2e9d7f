"""The progress of a run, as it is shown."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any


class ProgressBar:
    """What a run tells how far it is: nothing, a function, or a bar of tqdm."""

    def __init__(self, wish: bool | Callable[[int, float], None], steps: int | None) -> None:
        self._wish = wish
        self._steps = steps
        self._bar: Any = None

    def __enter__(self) -> Callable[[int, float], None] | None:
        if callable(self._wish):
            return self._wish
        if not self._wish:
            return None
        try:
            from tqdm.auto import tqdm  # type: ignore[import-untyped]
        except ImportError:
            warnings.warn("progress=True needs tqdm: pip install tqdm", stacklevel=3)
            return None
        self._bar = tqdm(total=self._steps if self._steps is not None else 1.0, unit="step" if self._steps else "")
        return self._show

    def _show(self, steps: int, fraction: float) -> None:
        self._bar.n = steps if self._steps is not None else fraction
        self._bar.refresh()

    def __exit__(self, kind: Any, value: Any, trace: Any) -> None:
        if self._bar is not None:
            if kind is None:
                self._bar.n = self._bar.total
                self._bar.refresh()
            self._bar.close()
