"""Where disks jam, and how: quenched, grown and decompressed packings beside published numbers.

:func:`make` is what ``gridlock jam`` calls.
"""

from ..chapter import Claim
from ..statistics import Verdict
from .extent import Extent, full, quick
from .study import Jamming, Stopped, make

__all__ = ["Claim", "Extent", "Jamming", "Stopped", "Verdict", "full", "make", "quick"]
