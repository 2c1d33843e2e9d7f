"""How hard disks melt: equation of state, order and defects through the transition beside published numbers.

:func:`make` is what ``gridlock melt`` calls.
"""

from ..chapter import Claim
from ..statistics import Verdict
from .extent import ConstantPressure, Extent, System, full, quick
from .study import Melting, Stopped, make

__all__ = ["Claim", "ConstantPressure", "Extent", "Melting", "Stopped", "System", "Verdict", "full", "make", "quick"]
