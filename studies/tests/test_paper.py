"""The study of the paper: made whole, stopped and continued, killed, refused; its numbers beside those that were kept."""

import base64
import dataclasses
import html.parser
import importlib.util
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import types
import urllib.parse
import zlib

import numpy as np
import pytest

import gridlock
from conftest import rows_of
from gridlock_studies import paper
from gridlock_studies.commands.paper import main
from gridlock_studies.paper import Length, figure_6, figure_7, open_choices, step_cost, turn_order
from gridlock_studies.paper.context import runs_of
from gridlock_studies.paper.runs import Outcome, Run, perfect_triangular_sites, square_sites_to_walls
from gridlock_studies.report import typeset
from gridlock_studies.runs import PartialResults, RunPool

#: The whole study on a toy: a few disks, a few steps.
TINY = dataclasses.replace(
    paper.quick(), name="tiny", disks=49, figure_6=Length(40, 4, 2), figure_7=Length(60, 6, 1), square_densities=(0.2, 0.6, 0.7),
    triangular_densities=(0.2, 0.6, 0.75), fan_densities=(0.2, 0.7), timing_counts=(225, 400, 625, 900), timing_repeats=1,
    plateau_densities=(0.2,), plateau_seeds=2, plateau_relaxations=0.5, choice_time_steps=(0.1, 0.2), choice_diameters=40.0,
    choice_seeds=2, choice_square_densities=(0.6,), choice_triangular_densities=(0.7,), order_diameters=25.6,
    order_time_steps=(0.1,), order_seeds=4, order_square_densities=(0.6,), order_triangular_densities=(0.7,),
    order_periodic_densities=(0.6,))
PICTURES = ("figure_4_start", "figure_4_after", "figure_5", "figure_5_checks", "figure_6", "figure_6_logarithmic", "figure_7",
            "open_choices", "turn_order")
TABLES = ("runs", "figure_4", "figure_5", "figure_6", "figure_7", "figure_7_theory", "figure_7_plateau", "open_choices", "turn_order",
          "turn_order_comparisons")


def names_in(directory):
    """All files but hidden ones such as the list of what --overwrite may remove."""
    return {path.name for path in pathlib.Path(directory).iterdir() if not path.name.startswith(".")}


def tables_in(directory):
    """Every table of a study, without the timings."""
    return {file.name: [{name: cell for name, cell in row.items() if not name.startswith("seconds")} for row in rows_of(file)]
            for file in sorted(pathlib.Path(directory).glob("*.csv"))}


class Stop(Exception):
    """A listener that has heard enough."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A study that was never interrupted, and what it told of its progress."""
    directory = tmp_path_factory.mktemp("whole")
    told = []
    made = paper.make(directory, TINY, progress=lambda share, what: told.append((share, what)))
    return directory, made, told


def test_every_figure_is_made_with_its_data(whole):
    directory, made, told = whole
    expected = {f"{name}.csv" for name in TABLES} | {f"{name}.{format}" for name in PICTURES for format in ("svg", "png")}
    assert names_in(directory) == expected | {"report.html"}
    assert {file.name for file in made.files} == expected | {"report.html"}
    assert made.files[-1].name == "report.html"
    assert made.notes == []
    shares = [share for share, _ in told]
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    assert all(what for _, what in told)
    assert len(made.claims) >= 7
    assert {claim.where for claim in made.claims} == {"Figure 4", "Figure 5", "Figure 6", "Figure 7"}


class Document(html.parser.HTMLParser):
    """What a page shows and what it refers to."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.references, self.text = set(), [], ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self.references += [value for name, value in attributes if name in ("src", "href", "srcset", "action", "data")]

    def handle_data(self, data):
        self.text += data


def test_the_report_needs_no_other_file(whole):
    directory, made, _ = whole
    text = (directory / "report.html").read_text(encoding="utf-8")
    document = Document(text)
    assert not document.tags & {"script", "link", "iframe", "object"}
    assert all(reference.startswith(("data:image/svg+xml;base64,", "#")) for reference in document.references)
    assert "@import" not in text and "url(" not in text
    assert sum(reference.startswith("data:") for reference in document.references) == len(PICTURES)
    for claim in made.claims:
        for text in (claim.statement, claim.measured):
            assert Document(str(typeset(text))).text in document.text
    assert not re.search(r"v_max|\bN\^", document.text)


def set_up_in(reference):
    """The set-up that a link to the playground holds, and how it is shown."""
    fields = urllib.parse.parse_qs(urllib.parse.urlsplit(reference).fragment)
    packed = fields.pop("toml")[0]
    return zlib.decompress(base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4)), -zlib.MAX_WBITS).decode(), fields


def test_a_report_links_to_the_set_ups_of_its_figures_in_a_playground_beside_it(tmp_path, monkeypatch):
    page = tmp_path / "page.html"
    page.write_text("the playground", encoding="utf-8")
    monkeypatch.setenv("GRIDLOCK_PLAYGROUND", str(page))
    made = paper.make(tmp_path / "results", TINY)
    assert (tmp_path / "results" / "playground.html").read_text(encoding="utf-8") == "the playground"
    assert tmp_path / "results" / "playground.html" in made.files
    references = Document((tmp_path / "results" / "report.html").read_text(encoding="utf-8")).references
    links = [reference for reference in references if reference.startswith("playground.html#")]
    set_ups = [set_up_in(link) for link in links]
    assert set_ups[0][0] == 'disks.count = 49\ndisks.packing_fraction = 0.7\nrun.seed = 1\nengine.cells = 10\nengine.grid = "linked"'
    assert set_ups[0][1] == {"colour": ["neighbourhood"], "grid": ["1"]}
    # Every link is a set-up that can run; those of Figure 6 have the bits of its runs.
    states = set()
    for text, _ in set_ups:
        file = tmp_path / "set_up.toml"
        file.write_text(text, encoding="utf-8")
        simulation = gridlock.Simulation(file)
        simulation.run(steps=TINY.figure_6.steps)
        states.add(simulation.state_hash)
    fan = [row["state_hash"] for row in rows_of(tmp_path / "results" / "runs.csv")
           if row["seed"] == "1" and int(row["steps"]) == TINY.figure_6.steps and float(row["packing_fraction"]) in TINY.fan_densities
           and (row["start"], row["sites"], row["edge"], row["contact"]) == ("square", "fitted", "wall", "always")
           and float(row["time_step"]) == 0.1 and row["engine"] in ("stepped", "exact")]
    assert len(fan) >= 4
    assert set(fan) <= states


def test_a_report_links_to_a_playground_elsewhere(tmp_path, monkeypatch):
    monkeypatch.setenv("GRIDLOCK_PLAYGROUND", "https://example.org/gridlock/")
    paper.make(tmp_path, TINY, 4)
    references = Document((tmp_path / "report.html").read_text(encoding="utf-8")).references
    assert any(reference.startswith("https://example.org/gridlock/#toml=") for reference in references)
    assert "playground.html" not in names_in(tmp_path)


def test_pictures_refer_to_nothing_outside_and_keep_their_text(whole):
    directory, _, _ = whole
    for name in PICTURES:
        svg = (directory / f"{name}.svg").read_text(encoding="utf-8")
        assert all(target.startswith("#") for target in re.findall(r'href="([^"]*)"', svg)), name
        assert "<image" not in svg
        assert "<text" in svg
    legend = (directory / "figure_6.svg").read_text(encoding="utf-8")
    for words in ("the paper's rule", "exact dynamics", "φ = 0.20", "φ = 0.70"):
        assert words in legend.replace("&apos;", "'").replace("&#x27;", "'")


def test_the_numbers_do_not_depend_on_the_threads(tmp_path, whole):
    directory, _, _ = whole
    paper.make(tmp_path, TINY, 6, threads=1)
    hashes = {tuple(row.items()) for row in tables_in(directory)["runs.csv"]}
    runs = tables_in(tmp_path)["runs.csv"]
    assert len(runs) == 8  # two densities, two seeds, two engines
    assert all(tuple(row.items()) in hashes for row in runs)


def test_one_figure_alone(tmp_path):
    made = paper.make(tmp_path, TINY, 5)
    assert all(name.startswith("figure_5") or name == "report.html" for name in names_in(tmp_path))
    assert {claim.where for claim in made.claims} == {"Figure 5"}
    for row in rows_of(tmp_path / "figure_5.csv"):
        # Whatever halts a disk only takes checks away; those without halting are of the disks at the start of each step.
        assert 0.0 < float(row["distance_checks"]) < 1.01 * float(row["free_distance_checks"])
        assert 0.0 <= float(row["halted_fraction"]) <= 1.0


def test_figure_7_says_how_long_its_runs_are_and_how_many(tmp_path):
    extent = dataclasses.replace(TINY, figure_7=dataclasses.replace(TINY.figure_7, densest_of_others=0.65, left_out=(0.7,)))
    paper.make(tmp_path, extent, 7)
    text = Document((tmp_path / "report.html").read_text(encoding="utf-8")).text
    for part in ("after 4 steps, 2 seeds", "after 40 steps, 2 seeds", "after 60 steps, 1 seed",
                 "each point is one run, which has no error over seeds", "Above φ = 0.65",
                 "The errors are those of the interpolation alone"):
        assert part in text
    rows = rows_of(tmp_path / "figure_7.csv")
    assert len(rows) == 5 + 4
    assert all(row["engine"] == "stepped" or float(row["packing_fraction"]) <= 0.65 for row in rows)
    assert not any(row["packing_fraction"] == "0.7" for row in rows)
    assert {row["steps"] for row in rows} == {"60"}


def test_the_orders_of_turns_are_compared_from_the_same_starts(whole):
    rows = rows_of(whole[0] / "turn_order_comparisons.csv")
    # Two starts between walls: five moments of 256 samples and three quantities each. One in a periodic box: five moments, about the
    # centre and of it, and two quantities.
    assert len(rows) == 2 * 8 + 12
    for row in rows:
        numbers = {name: float(cell) for name, cell in row.items() if name not in ("quantity", "start", "edge")}
        assert numbers["difference"] == pytest.approx(numbers["tiled"] - numbers["stepped"], abs=1e-9 * numbers["stepped"])
        error = np.hypot(numbers["stepped_error"], numbers["tiled_error"])
        assert numbers["deviation"] * error == pytest.approx(numbers["tiled"] - numbers["stepped"], abs=1e-9 * numbers["stepped"])
        # Exact disks keep their centre as long as their momentum is zero; halted ones do not.
        assert (numbers["exact"] < 1e-9) == (row["quantity"] == "centre_displacement")
    # Another order of turns is another trajectory.
    assert any(float(row["deviation"]) != 0.0 for row in rows)


def test_a_study_stopped_in_every_part_makes_the_files_of_one_that_was_not(tmp_path, whole):
    stopped_in, finished = set(), 0
    for _ in range(100):
        first = None

        def listen(share, what):
            nonlocal first, finished
            simulations = re.fullmatch(r"(\d+) of \d+ simulations", what)
            if simulations is None:
                if what[:9] not in stopped_in:
                    stopped_in.add(what[:9])
                    raise KeyboardInterrupt
                return
            now = int(simulations[1])
            assert now >= finished, "a finished simulation is made again"
            first = now if first is None else first
            finished = now
            if now >= first + 30:
                raise KeyboardInterrupt

        try:
            paper.make(tmp_path, TINY, threads=1, progress=listen)
            break
        except paper.Stopped as stopped:
            assert str(tmp_path / "partial_results") in str(stopped)
            assert not (tmp_path / "report.html").exists()
    assert stopped_in == {"Figure 5:", "drawing f", "drawing o", "drawing t", "drawing"}
    assert names_in(tmp_path) == names_in(whole[0])
    assert tables_in(tmp_path) == tables_in(whole[0])
    same = [name for name in PICTURES if not name.startswith("figure_5")]
    assert all((tmp_path / f"{name}.svg").read_bytes() == (whole[0] / f"{name}.svg").read_bytes() for name in same)


def test_a_killed_study_continues(tmp_path, whole):
    program = f"import sys; sys.path.insert(0, {os.path.dirname(__file__)!r})\n" \
              f"from test_paper import TINY, paper; paper.make({str(tmp_path)!r}, TINY, threads=1)"
    kept = tmp_path / "partial_results"
    with subprocess.Popen([sys.executable, "-c", program]) as process:
        deadline = time.monotonic() + 60
        while len(list(kept.glob("*.npz"))) < 10 and time.monotonic() < deadline:
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    finished = len(list(kept.glob("*.npz"))) - 1  # one holds Figure 5
    assert finished >= 9
    told = []
    paper.make(tmp_path, TINY, progress=lambda share, what: told.append(what))
    first = next(what for what in told if what.endswith(" simulations"))
    assert int(first.split()[0]) >= finished
    assert tables_in(tmp_path) == tables_in(whole[0])
    assert not kept.exists()


def test_each_simulation_is_kept_as_soon_as_it_is_finished(tmp_path):
    def stop_after(count):
        def listen(share, what):
            if int(what.split()[0]) >= count:
                raise Stop
        return listen

    with pytest.raises(Stop):
        paper.make(tmp_path, TINY, 6, threads=1, progress=stop_after(3))
    kept = sorted((tmp_path / "partial_results").iterdir())
    assert 3 <= len(kept) <= 8

    # Neither a damaged result nor one of other settings is taken for one of these.
    content = bytearray(kept[0].read_bytes())
    content[len(content) // 2] ^= 1
    kept[0].write_bytes(content)
    pool = RunPool(PartialResults(tmp_path / "partial_results"))
    for run in all_runs_of_figure_6():
        pool.add(run)
    assert pool.finished == len(kept) - 1
    other = RunPool(PartialResults(tmp_path / "partial_results"))
    for run in all_runs_of_figure_6(seed=1000):
        other.add(run)
    assert other.finished == 0


def all_runs_of_figure_6(seed=1):
    return [Run(49, density, 40, 4, seed + number, engine) for engine in ("stepped", "exact") for density in (0.2, 0.7)
            for number in range(2)]


def test_overwriting_starts_from_nothing_and_leaves_what_is_not_its_own(tmp_path):
    kept = tmp_path / "partial_results"
    kept.mkdir()
    (kept / "notes.txt").write_text("mine")
    (kept / ".0123456789abcdef.npz.part").write_text("of a killed process")
    (kept / "0123456789abcdef.npz").write_text("of another study")
    paper.make(tmp_path, TINY, 4, overwrite=True)
    assert {path.name for path in kept.iterdir()} == {"notes.txt"}


def test_no_size_of_figure_5_is_measured_again(tmp_path):
    done = []

    def stop_soon(share, what):
        done.append(share)
        if share > 0.1:
            raise Stop

    with pytest.raises(Stop):
        paper.make(tmp_path, TINY, 5, progress=stop_soon)
    assert len(list((tmp_path / "partial_results").iterdir())) == 1
    told = []
    paper.make(tmp_path, TINY, 5, progress=lambda share, what: told.append(share))
    assert told[0] > done[-1]


def test_a_directory_serves_one_study_at_a_time(tmp_path):
    refusals = []

    def meanwhile(share, what):
        if not refusals:
            with pytest.raises(gridlock.Error, match="another process is working in") as refusal:
                paper.make(tmp_path, TINY, 4)
            refusals.append(refusal)

    paper.make(tmp_path, TINY, 4, progress=meanwhile)
    assert refusals
    with pytest.raises(gridlock.Error, match="holds results already"):
        paper.make(tmp_path, TINY, 4)


@pytest.mark.parametrize("changes", [
    {"engines": ()}, {"square_densities": (0.5, 0.3)}, {"order_time_steps": ()}, {"timing_counts": (100,)},
    {"figure_6": Length(0, 1, 1)},
])
def test_impossible_extents_are_refused(tmp_path, changes):
    with pytest.raises(gridlock.Error):
        paper.make(tmp_path / "out", dataclasses.replace(TINY, **changes))
    assert not (tmp_path / "out").exists()


def test_other_impossible_wishes_are_refused(tmp_path):
    with pytest.raises(gridlock.Error, match="no Figure 3"):
        paper.make(tmp_path, TINY, 3)
    with pytest.raises(gridlock.Error, match="no extent 'long'"):
        paper.make(tmp_path, "long")
    (tmp_path / "file").write_text("")
    with pytest.raises(gridlock.Error, match="cannot write into the directory"):
        paper.make(tmp_path / "file" / "below", TINY, 4)


def test_the_extents_are_those_of_the_paper():
    full, quick = paper.full(), paper.quick()
    assert full.disks == quick.disks == 841
    assert full.figure_6.steps == full.figure_7.steps == quick.figure_7.steps == 100_000
    assert full.figure_6.seeds >= 4 and quick.figure_6.seeds >= 3
    assert min(len(full.square_densities), len(full.triangular_densities)) >= 20
    for extent in (full, quick):  # the runs of the fan are shared with Figure 7
        for density in extent.fan_densities:
            assert density in (extent.square_densities if density < 0.785 else extent.triangular_densities)


def test_the_quick_study_takes_two_minutes_on_two_cores():
    context = types.SimpleNamespace(extent=paper.quick(), seed=1)
    chapters = (figure_6, figure_7, open_choices, turn_order)
    runs = {run for chapter in chapters for run in runs_of(chapter.plan(context))}
    # In disk-steps, each 50 to 100 ns; Figure 5 and the pictures are the rest.
    assert sum(run.work for run in runs) < 3.3e9


def test_a_run_that_cannot_be_made_is_told_of_and_stops_no_other(tmp_path):
    pool = RunPool(PartialResults(tmp_path))
    impossible, possible = Run(49, 0.8, 10, 5, 1), Run(49, 0.4, 10, 5, 1)
    for run in (impossible, possible, possible):
        pool.add(run)
    assert len(pool) == 2
    shares = []
    pool.run_all(2, shares.append)
    assert shares[-1] == pytest.approx(1.0)
    assert pool[impossible] is None and pool[possible] is not None
    (failure,) = pool.failures
    assert failure.startswith("square start, packing fraction 0.8, seed 1: ")


def test_special_sites_touch_the_walls():
    sites, largest = square_sites_to_walls(2.0, 49, 0.1)
    assert sites[0].tolist() == [0.1, 0.1] and sites[-1].tolist() == [1.9, 1.9]
    assert sites[1, 0] - sites[0, 0] == pytest.approx(1.8 / 6.0, abs=1e-15)
    with pytest.raises(gridlock.Error, match="50 is not the square"):
        square_sites_to_walls(2.0, 50, 0.1)
    sites, largest = perfect_triangular_sites(1.0, 841)
    assert sites.shape == (841, 2)
    assert 841 * np.pi * largest**2 == pytest.approx(0.8518, abs=5e-5)
    with pytest.raises(gridlock.Error, match="do not fit on these sites"):
        Run(841, 0.86, 10, 5, 1, start="triangular", sites="perfect").simulation()


KEPT = pathlib.Path(__file__).resolve().parents[2] / "validation/results/paper_quick"


def kept_runs():
    """The shortest of the kept runs of every kind."""
    shortest = {}
    for row in rows_of(KEPT / "runs.csv"):
        kind = tuple(row[name] for name in ("start", "sites", "edge", "engine", "contact"))
        if kind not in shortest or int(row["steps"]) < int(shortest[kind]["steps"]):
            shortest[kind] = row
    return [pytest.param(row, id=" ".join(kind)) for kind, row in shortest.items()]


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("row", kept_runs())
def test_runs_have_the_bits_and_numbers_that_were_kept(row):
    steps = int(row["steps"])
    run = Run(int(row["disks"]), float(row["packing_fraction"]), steps, steps // (256 if steps % 256 == 0 else 100), int(row["seed"]),
              row["engine"], row["start"], row["sites"], row["edge"], float(row["time_step"]), row["contact"])
    simulation = run.simulation()
    simulation.run()
    outcome = Outcome.of(simulation, 0.0)
    assert outcome.state_hash == row["state_hash"]
    for name in ("time", "mean_displacement", "halted_fraction", "collision_rate"):
        assert repr(float(outcome.series[name][-1])) == row[name]


def test_figure_4_has_the_positions_that_were_kept(tmp_path):
    made = paper.make(tmp_path, "quick", 4)
    assert rows_of(tmp_path / "figure_4.csv") == rows_of(KEPT / "figure_4.csv")
    assert made.claims[0].verdict is paper.Verdict.AGREES
    assert "the largest overlap of two disks is 0;" in made.claims[0].measured


def test_figure_5_counts_the_distances_that_were_kept(tmp_path):
    extent = dataclasses.replace(paper.quick(), timing_counts=(225, 2500), timing_repeats=1)
    paper.make(tmp_path, extent, 5)
    made, kept = rows_of(tmp_path / "figure_5.csv"), {(row["disks"], row["k"]): row for row in rows_of(KEPT / "figure_5.csv")}
    assert len(made) == 6
    for row in made:
        expected = kept[row["disks"], row["k"]]
        assert {name for name in row if row[name] != expected[name]} <= {"seconds", "seconds_spread"}


def test_the_theory_of_figure_7_is_that_which_was_kept():
    predictions = [paper.study.figure_7.Prediction(paper.quick(), start) for start in ("square", "triangular")]
    for row in rows_of(KEPT / "figure_7_theory.csv")[::6]:
        density = float(row["packing_fraction"])
        time = 0.1 * 2.0 * np.sqrt(density / (841 * np.pi)) * 100_000
        for prediction, start in zip(predictions, ("square", "triangular")):
            assert prediction.plateau(density) == pytest.approx(float(row[f"plateau_{start}"]), rel=1e-14)
            assert prediction.diffused(density, time) == pytest.approx(float(row[f"diffusion_{start}"]), rel=1e-11, nan_ok=True)


def test_counted_distances_are_those_of_the_engine():
    for k in (1, 2, 7, 12):
        simulation = gridlock.Simulation(disks={"count": 300, "packing_fraction": 0.4, "start": "random"}, run={"seed": 5},
                                         velocities={"max": 0.0}, engine={"substeps": 5, "cells": k, "grid": "linked", "speed": 0.1})
        looks = step_cost.checks_of_one_look(np.array(simulation.agents.positions), k)
        simulation.run(steps=3)
        assert simulation.counts["distance_checks"] == 3 * 5 * looks


def command(*words, **more):
    environment = {**os.environ, "PYTHONPATH": str(pathlib.Path(gridlock.__file__).parents[1])}
    return subprocess.Popen([sys.executable, "-m", "gridlock_studies.commands.paper", *words], stderr=subprocess.PIPE, text=True,
                            env=environment, **more)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_the_command_and_what_is_finished_is_kept(tmp_path, number):
    with command("--figure", "5", "-o", "out", cwd=tmp_path) as process:
        deadline = time.monotonic() + 60
        while not (tmp_path / "out/.lock").exists() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.5)
        start = time.monotonic()
        process.send_signal(number)
        _, errors = process.communicate(timeout=60)
    assert time.monotonic() - start < 10.0
    assert process.returncode == 1, errors
    assert "interrupted: " in errors and "the same command does the rest" in errors
    # Nothing is drawn of a study that is not finished.
    assert names_in(tmp_path / "out") == {"partial_results"}
    assert len(list((tmp_path / "out/partial_results").iterdir())) == 1


def test_the_command_makes_a_figure_and_refuses_to_replace_it(tmp_path, capsys):
    words = ["--figure", "4", "-o", str(tmp_path / "out")]
    assert main(words) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0].startswith("agrees       Figure 4: Every disk belongs to exactly one")
    assert re.fullmatch(r"finished in [\d.]+ s; open .*report\.html", told[1])
    assert main(words) == 2
    assert "holds results already" in capsys.readouterr().err
    assert main([*words, "--overwrite", "--quiet"]) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("words, complaint", [
    (["--figure", "9"], "--figure must be a whole number, from 4 to 7, but is 9"),
    (["--threads", "0"], "--threads must be a whole number, from 1 to 4096, but is 0"),
    (["--seed", "x"], "--seed must be a whole number, at least 0, but is x"),
    (["--quick", "--full"], "--quick and --full cannot be given together"),
    (["--threads"], "--threads needs a value"),
    (["hello"], '"hello" is one word too many'),
    (["--fig", "4"], "gridlock paper has no option --fig"),
])
def test_arguments_that_cannot_be_used_are_named(words, complaint, capsys):
    assert main(words) == 2
    errors = capsys.readouterr().err
    assert errors.startswith("error: ") and complaint in errors
    assert "hint: gridlock paper --help lists its options" in errors
    assert "usage" not in errors


def test_a_package_that_is_missing_is_named_before_anything_is_run(tmp_path, monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "jinja2" else find(name))
    with pytest.raises(gridlock.Error, match="the study of the paper needs jinja2\n  hint: pip install jinja2"):
        paper.make(tmp_path / "out", TINY)
    assert not (tmp_path / "out").exists()
