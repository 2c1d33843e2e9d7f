"""The study of melting: its figures, and how they are made."""

from __future__ import annotations

import json
import os

from ..making import Made as Melting
from ..making import Part, Progress, Stopped, Study, as_extent, carry_out
from ..report import Texts
from . import extent as extents
from . import figure_1, figure_2, figure_3, figure_4, figure_5, figure_6, figure_7
from .context import Context
from .extent import Extent

__all__ = ["STUDY", "Melting", "Stopped", "make"]


def _write_runs(context: Context) -> None:
    """Every run, its settings and what came out."""
    rows = []
    for run, outcome in context.runs:
        settings = json.loads(run.settings)
        result = next(name for name in ("packing_fraction_at_pressure", "compressibility_factor") if name in outcome.arrays)
        rows.append((run.title, settings["disks"]["count"], settings["run"]["seed"], str(outcome.arrays["state_hash"]), result,
                     *outcome.result(result), float(outcome.arrays["seconds"]), run.settings))
    context.write_table("runs.csv", "title disks seed state_hash result value error seconds settings", rows)


STUDY = Study(
    parts=tuple(Part(number, figure.plan, figure.make) for number, figure in enumerate(
        (figure_1, figure_2, figure_3, figure_4, figure_5, figure_6, figure_7), start=1)),
    texts=Texts(
        name="the study of melting",
        title="How hard disks melt",
        summary="Pressure, order and defects of hard disks from the liquid to the crystal beside published numbers.",
        claimant="published",
    ),
    packages=("jinja2", "matplotlib", "scipy"),
    seconds_of_work=1.0,
    context=Context,
    write_runs=_write_runs,
    tables=("runs", *(f"figure_{number}" for number in range(1, 8)), "figure_4_peaks"),
    pictures=("figure_1", "figure_2_order", "figure_2_susceptibility", "figure_2_distribution", "figure_3", "figure_4_correlation",
              "figure_4_peak", "figure_5", "figure_6", "figure_7"),
)


def make(
    directory: str | os.PathLike[str],
    extent: str | Extent = "quick",
    figure: int | None = None,
    *,
    seed: int = 1,
    threads: int | None = None,
    overwrite: bool = False,
    progress: Progress = False,
) -> Melting:
    """Runs hard disks from the liquid to the crystal, from two starts, and sets published numbers beside what was measured.

    :param directory: where each figure is written as data (``figure_*.csv``), SVG and PNG; ``runs.csv`` with every run, its settings
        and state hash; and ``report.html``, which holds all pictures, claims and verdicts and needs no other file.
    :param extent: "quick", about four minutes on two cores; "full", hours; or an :class:`Extent`.
    :param figure: 1 to 7 alone; None: all of them.
    :param seed: the seeds of the runs are this one and those after it. The numbers follow from it alone.
    :param threads: simulations at a time; None: one for each core.
    :param overwrite: whether everything is made again, also what an interrupted study has kept.
    :param progress: True for a bar by tqdm, or a function of the share of the work that is done and what is being done now.
    :raises Error: for an extent that does not exist, and a directory that is in use or holds other results.
    :raises Stopped: a KeyboardInterrupt, within about a second after Ctrl-C. What is finished is kept in ``partial_results``,
        also of a study that was killed; the same call again does only the rest, with the same results.

    Needs the packages NumPy, SciPy, matplotlib and Jinja2: ``pip install ".[paper]"`` in the sources of Gridlock.
    """
    return carry_out(STUDY, directory, as_extent(extent, extents.quick, extents.full), figure, seed, threads, overwrite, progress)
