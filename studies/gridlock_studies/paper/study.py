"""The study of the paper: its figures, and how they are made."""

from __future__ import annotations

import os

from ..making import Made as Paper
from ..making import Part, Progress, Stopped, Study, as_extent, carry_out
from ..report import Texts
from . import extent as extents
from . import figure_4, figure_5, figure_6, figure_7, open_choices, physics_or_step, step_cost, turn_order
from .context import Context, runs_of
from .extent import Extent

__all__ = ["STUDY", "Paper", "Stopped", "make"]


def _write_runs(context: Context) -> None:
    """Every simulation, its settings and what came out."""
    context.write_table(
        "runs.csv", "start sites edge engine contact state_hash disks steps seed packing_fraction time_step time "
        "mean_displacement halted_fraction collision_rate seconds settings",
        [(run.start, run.sites, run.edge, run.engine, run.contact, outcome.state_hash, run.disks,
          int(outcome.series["step"][-1]), run.seed, run.packing_fraction, run.time_step,
          *(float(outcome.series[name][-1]) for name in ("time", "mean_displacement", "halted_fraction", "collision_rate")),
          outcome.seconds, run.recorded_settings) for run, outcome in context.runs])


STUDY = Study(
    parts=(
        Part(4, None, figure_4.make),
        Part(5, None, figure_5.make, figure_5.measure, lambda context: step_cost.expected_seconds(context.extent),
             "Figure 5: counting distances and timing steps"),
        Part(6, lambda context: runs_of(figure_6.plan(context)), figure_6.make),
        Part(7, lambda context: runs_of(figure_7.plan(context)), figure_7.make),
        Part(None, lambda context: runs_of(open_choices.plan(context)), open_choices.make),
        Part(None, None, physics_or_step.make),
        Part(None, lambda context: runs_of(turn_order.plan(context)), turn_order.make),
    ),
    texts=Texts(
        name="the study of the paper",
        title="The paper's figures, made again",
        summary="Agent based simulations and optimization with uniform grid applied to colloidal jamming transitions (J.-X. Shen).",
        claimant="the paper says",
    ),
    packages=("jinja2", "matplotlib", "scipy"),
    seconds_of_work=7e-8,
    context=Context,
    write_runs=_write_runs,
    tables=("runs", "figure_4", "figure_5", "figure_6", "figure_7", "figure_7_plateau", "figure_7_theory", "open_choices", "turn_order",
            "turn_order_comparisons"),
    pictures=("figure_4_start", "figure_4_after", "figure_5", "figure_5_checks", "figure_6", "figure_6_logarithmic", "figure_7",
              "open_choices", "turn_order"),
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
) -> Paper:
    """Makes Figures 4 to 7 of the paper again and sets its claims beside what was measured.

    :param directory: where each figure is written as data (``figure_*.csv``), SVG and PNG; ``runs.csv`` with every simulation,
        its settings and state hash; and ``report.html``, which holds all pictures, claims and verdicts and needs no other file.
    :param extent: "quick", about two minutes on two cores; "full", about half an hour; or an :class:`Extent`.
    :param figure: 4, 5, 6 or 7 alone; None: all of them and the choices that the paper leaves open.
    :param seed: the seeds of the runs are this one and those after it. The numbers follow from it alone, but for the timings.
    :param threads: simulations at a time; None: one for each core.
    :param overwrite: whether everything is made again, also what an interrupted study has kept.
    :param progress: True for a bar by tqdm, or a function of the share of the work that is done and what is being done now.
    :raises Error: for an impossible extent, and a directory that is in use or holds other results.
    :raises Stopped: a KeyboardInterrupt, within about a second after Ctrl-C. What is finished is kept in ``partial_results``,
        also of a study that was killed; the same call again does only the rest, with the same results.

    Needs the packages NumPy, SciPy, matplotlib and Jinja2: ``pip install ".[paper]"`` in the sources of Gridlock. Source: J.-X. Shen, Agent based
    simulations and optimization with uniform grid applied to colloidal jamming transitions.
    """
    extent = as_extent(extent, extents.quick, extents.full)
    extents.require_possible(extent)
    step_cost.require_possible(extent)
    return carry_out(STUDY, directory, extent, figure, seed, threads, overwrite, progress)
