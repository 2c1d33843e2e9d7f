"""The paper's Figures 4 to 7 made again, and its claims beside what was measured.

J.-X. Shen, *Agent based simulations and optimization with uniform grid applied to colloidal jamming transitions*. :func:`make` is
what ``gridlock paper`` calls.
"""

from ..chapter import Claim
from ..statistics import Verdict
from .extent import Engine, Extent, Length, full, quick
from .study import Paper, Stopped, make

__all__ = ["Claim", "Engine", "Extent", "Length", "Paper", "Stopped", "Verdict", "full", "make", "quick"]
