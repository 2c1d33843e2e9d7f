"""The study of jamming: its figures, and how they are made."""

from __future__ import annotations

import json
import os

from ..making import Made as Jamming
from ..making import Part, Progress, Stopped, Study, as_extent, carry_out
from ..report import Texts
from . import extent as extents
from . import figure_1, figure_10, figure_2, figure_3, figure_4, figure_5, figure_6, figure_7, figure_8, figure_9
from .context import Context
from .extent import Extent

__all__ = ["STUDY", "Jamming", "Stopped", "make"]


def _write_runs(context: Context) -> None:
    """Every run, its settings and what came out."""
    rows = []
    for run, outcome in context.runs:
        settings = json.loads(run.settings)
        rows.append((run.title, settings["disks"]["count"], settings["run"]["seed"], str(outcome.arrays["state_hash"]),
                     outcome.result("jamming_packing_fraction"), outcome.result("pressure"), outcome.result("excess_contacts"),
                     outcome.result("is_jammed"), outcome.result("is_shear_stable"), float(outcome.arrays["seconds"]), run.settings))
    context.write_table("runs.csv", "title disks seed state_hash jamming_packing_fraction pressure excess_contacts is_jammed is_shear_stable "
                        "seconds settings", rows)


STUDY = Study(
    parts=tuple(Part(number, figure.plan, figure.make) for number, figure in enumerate(
        (figure_1, figure_2, figure_3, figure_4, figure_5, figure_6, figure_7, figure_8, figure_9, figure_10), start=1)),
    texts=Texts(
        name="the study of jamming",
        title="Where disks jam, and how",
        summary="Quenched, grown, decompressed and sheared disks in two dimensions beside published numbers.",
        claimant="published",
    ),
    packages=("jinja2", "matplotlib", "scipy"),
    seconds_of_work=1.0,
    context=Context,
    write_runs=_write_runs,
    tables=("runs", *(f"figure_{number}" for number in range(1, 11))),
    pictures=tuple(f"figure_{number}" for number in range(1, 11)),
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
) -> Jamming:
    """Jams disks by quench, growth and decompression, shears them, and sets published numbers beside what was measured.

    :param directory: where each figure is written as data (``figure_*.csv``), SVG and PNG; ``runs.csv`` with every run, its settings
        and state hash; and ``report.html``, which holds all pictures, claims and verdicts and needs no other file.
    :param extent: "quick", half a minute on two cores; "full", more starts and larger systems; or an :class:`Extent`.
    :param figure: 1 to 10 alone; None: all of them.
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
