"""Charts by matplotlib: snapshots, packings, series, measured curves and sweeps with errors, the pictures of a run, movies.

Colours are those of Okabe and Ito, and viridis: both are told apart by colour-blind readers and in grey. Every function draws into
``axes``, or into new ones, and returns them; ``axes.figure.savefig("picture.pdf")`` writes a file. Inside ``with style():`` they have
the look and the size of a column of a journal. matplotlib has to be installed.
"""

from ..errors import Error

try:
    import matplotlib as _matplotlib  # noqa: F401
except ImportError:
    raise Error("drawing needs matplotlib, which is not installed\n  hint: pip install matplotlib") from None

from .agents import snapshot
from .charts import curve, dynamics, histogram, line, points, reference, series, sweep
from .movies import movie
from .packings import packing
from .pictures import Pictures, pictures
from .style import COLOURS, COLUMN, GREY, MARKERS, PAGE, STYLE, axis_label, sequential, style

__all__ = [
    "COLOURS", "COLUMN", "GREY", "MARKERS", "PAGE", "STYLE", "Pictures",
    "axis_label", "curve", "dynamics", "histogram", "line", "movie", "packing", "pictures", "points", "reference", "sequential", "series", "snapshot", "style",
    "sweep",
]
