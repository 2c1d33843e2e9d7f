"""Commands that are programs in Python: by themselves, and as the program gridlock starts them."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import warnings

import pytest

import gridlock
import gridlock.plot
from gridlock.commands.plot import main

DISKS = "disks.count = 36\ndisks.packing_fraction = 0.5\nengine.cells = 5\nrun.steps = 40\nobserve.every = 10\n"
WALKERS = "model.kind = \"epidemic\"\nepidemic.count = 50\nrun.steps = 20\nobserve.every = 5\n"
SWEEP = ("model.kind = \"flocking\"\nflocking.count = 40\nrun.steps = 20\nobserve.every = 5\n"
         "[sweep]\nflocking.noise = [0.1, 0.5, 0.9]\nrun.seed = [1, 2]\n")


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in (("disks", DISKS), ("walkers", WALKERS), ("sweep", SWEEP)):
        (tmp_path / f"{name}.toml").write_text(text)
    return tmp_path


@pytest.fixture
def started(program, here):
    """Starts the program gridlock; returns how it ended."""
    def start(*words, environment=None):
        return subprocess.run([program, *map(str, words)], capture_output=True, text=True, env=environment, timeout=300)

    if not (pathlib.Path(program).parent / "gridlock-plot").exists():
        pytest.skip("no gridlock-plot beside the program")
    return start


def test_the_pictures_of_a_run_are_drawn_again_from_its_data(here, capsys):
    gridlock.run("disks.toml", "out", run={"steps": 10})  # so short that the mark of 10 % is far above the curve
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert main(["out", "--pdf"]) == 0
    out, err = capsys.readouterr()
    names = ["final", "start", "displacement", "pair_correlation", "speed_distribution"]
    assert not any("layout" in str(warning.message) for warning in told)
    assert out.split() == [f"out/{name}.{extension}" for name in names for extension in ("svg", "png", "pdf")]
    assert err == ""
    before = {name: (here / "out" / f"{name}.svg").read_bytes() for name in names}
    assert (here / "out/final.png").read_bytes()[:4] == b"\x89PNG" and (here / "out/final.pdf").read_bytes()[:4] == b"%PDF"
    (here / "out/start.svg").unlink()
    assert main(["out"]) == 0
    assert {name: (here / "out" / f"{name}.svg").read_bytes() for name in names} == before
    assert main(["out", "--colour", "psi6"]) == 0
    assert (here / "out/final.svg").read_bytes() != before["final"]


def test_the_last_state_shows_displacements_in_sides_of_the_box(here):
    simulation = gridlock.Simulation({"box.width": 10.0, "box.height": 10.0}, threads=1, disks={"count": 36}, box={"edge": "periodic"})
    assert simulation.box.width == 10.0
    gridlock.run("disks.toml", "out", box={"width": 1000.0, "height": 1000.0, "edge": "periodic"}, run={"steps": 400})
    drawn = []
    original = gridlock.plot.pictures.__globals__["snapshot"]

    def spy(agents, colour=None, **more):
        drawn.append(colour)
        return original(agents, colour, **more)

    gridlock.plot.pictures.__globals__["snapshot"] = spy
    try:
        gridlock.plot.pictures("out")
    finally:
        gridlock.plot.pictures.__globals__["snapshot"] = original
    series = gridlock.open("out").series
    assert drawn[0].mean() == pytest.approx(series["mean_displacement"][-1], rel=1e-9)
    assert (drawn[0] ** 2).mean() * 1000.0**2 == pytest.approx(series["mean_squared_displacement"][-1], rel=1e-9)


def test_a_run_of_a_model_has_its_agents_and_every_column(here, capsys):
    gridlock.run("walkers.toml", "out")
    assert main(["out", "--color", "direction"]) == 0
    out, err = capsys.readouterr()
    together = {"susceptible", "infected", "recovered"}
    columns = [name for name in gridlock.open("out").series.dtype.names if name not in ("step", "time", *together)]
    drawn = {pathlib.Path(line).stem for line in out.split()}
    assert drawn == {"final", "health", *columns} | ({"pair_correlation"} if (here / "out/pair_correlation.csv").exists() else set())
    assert err == ""
    assert main(["out", "--colour", "displacement"]) == 2
    assert "final.xyz does not tell" in capsys.readouterr().err


def test_a_sweep_is_drawn_against_what_varies_most(here, capsys):
    made = gridlock.sweep("sweep.toml", {"flocking.noise": [0.1, 0.5, 0.9], "run.seed": [1, 2]}, "out")
    assert main(["out"]) == 0
    assert "out/order.svg" in capsys.readouterr().out.split()
    assert main(["out", "--colour", "speed"]) == 2
    assert "a sweep has no agents to colour" in capsys.readouterr().err
    assert made.means["flocking.noise"].tolist() == [0.1, 0.5, 0.9]


@pytest.mark.parametrize(("rows", "label"), [
    ("0.3,2,5,1.5,0.1\n", None), ("0.3,2,5,1.5,0.1\n0.3,4,5,1.6,0.1\n", "substeps"),
    ("0.3,2,5,1.5,0.1\n0.4,2,5,1.6,0.1\n", "packing fraction φ"), ("0.3,2,5,nan,nan\n0.4,2,5,nan,nan\n", None),
])
def test_the_axis_is_a_number_with_two_values(here, capsys, rows, label):
    (here / "means.csv").write_text("disks.packing_fraction,engine.substeps,runs,collision_rate,collision_rate_error\n" + rows)
    labels = []
    axes_type = __import__("matplotlib.axes").axes.Axes
    original = axes_type.set
    axes_type.set = lambda self, **more: (labels.append(more.get("xlabel")), original(self, **more))[1]
    try:
        assert main(["."]) == (0 if label else 2)
    finally:
        axes_type.set = original
    assert label is None or label in labels
    out, err = capsys.readouterr()
    assert ("nothing to draw of ." in err) == (label is None)
    assert main([".", "--if-any"]) == 0


def test_curves_that_cannot_be_told_apart_are_a_note(here, capsys):
    rows = "".join(f'0.{phi},"{word}",1,1.5,0.1\n' for phi in (3, 4) for word in "abcdefghijklm")
    (here / "means.csv").write_text("disks.packing_fraction,word,runs,collision_rate,collision_rate_error\n" + rows)
    assert main(["."]) == 0
    out, err = capsys.readouterr()
    assert (out, err) == ("", "note: collision_rate: 13 curves are too many for one picture; means.csv has them\n")


def test_what_cannot_be_drawn_is_refused_before_anything_is(here, capsys):
    assert main(["missing"]) == 2
    assert capsys.readouterr().err.startswith("error: missing holds neither a run nor a sweep\n  hint: name a directory")
    gridlock.run("disks.toml", "out")
    gridlock.run("walkers.toml", "walkers")
    for directory, column in (("out", "displacement, psi6"), ("walkers", "health")):
        before = sorted(os.listdir(directory))
        assert main([directory, "--colour", "smell"]) == 2
        err = capsys.readouterr().err
        assert column in err and err.count("smell") == 1
        assert sorted(os.listdir(directory)) == before
    gridlock.run("disks.toml", "short", run={"final_state": False})
    assert main(["short"]) == 2
    assert "a run without its last state" in capsys.readouterr().err
    for words in ([], ["out", "more"], ["out", "--colour"], ["--no-such-option", "out"]):
        with pytest.raises(SystemExit) as ended:
            main(words)
        assert ended.value.code == 2


def test_a_picture_that_cannot_be_drawn_keeps_no_other_from_it(here, capsys):
    gridlock.run("disks.toml", "out")
    (here / "out/final.png").mkdir()
    (here / "out/speed_distribution.csv").write_text("speed,density\n1,not a number\n")
    assert main(["out"]) == 0
    out, err = capsys.readouterr()
    assert "out/displacement.png" in out and "out/final.png" not in out
    assert err.startswith("note: final: ") and "note: speed_distribution: " in err


def test_the_program_starts_it(started, here):
    assert started("run", "disks.toml", "-o", "out dir", "--pictures").returncode == 0
    assert (here / "out dir/displacement.svg").stat().st_size > 1000
    before = (here / "out dir/displacement.svg").read_bytes()
    drawn = started("plot", "out dir", "--colour", "speed")
    assert (drawn.returncode, drawn.stderr) == (0, "")
    assert drawn.stdout.splitlines()[0] == "out dir/final.svg"
    assert (here / "out dir/displacement.svg").read_bytes() == before
    assert started("plot", "nowhere").returncode == 2
    help_of = started("plot", "--help")
    assert help_of.returncode == 0 and help_of.stdout.startswith("usage: gridlock plot ")
    assert started("help", "plot").stdout == help_of.stdout


def test_a_sweep_of_the_program_is_drawn(started, here):
    swept = started("sweep", "sweep.toml", "-o", "out")
    assert (swept.returncode, swept.stderr) == (0, "")
    assert (here / "out/order.svg").exists()
    (here / "seeds.toml").write_text("disks.count = 16\nrun.steps = 5\n[sweep]\nrun.seed = [1, 2]\n")
    assert started("sweep", "seeds.toml", "-o", "seeds").stderr == ""
    assert started("plot", "seeds").returncode == 2


def test_pictures_are_results_that_overwrite_removes_and_nothing_else(started, here):
    assert started("run", "walkers.toml", "-o", "only_model").returncode == 0
    assert started("run", "disks.toml", "-o", "out", "--pictures").returncode == 0
    (here / "out/my_own.svg").write_text("mine")
    assert started("run", "walkers.toml", "-o", "out", "--overwrite").returncode == 0
    assert sorted(os.listdir("out")) == sorted([*os.listdir("only_model"), "my_own.svg"])


def test_a_resumed_run_has_the_pictures_of_a_whole_one(started, here):
    assert started("run", "disks.toml", "-o", "whole", "--pictures").returncode == 0
    assert started("run", "disks.toml", "-o", "parts", "--set", "run.steps=20").returncode == 0
    assert started("resume", "parts", "--steps", "40", "--pictures").returncode == 0
    names = sorted(name for name in os.listdir("whole") if name.endswith((".svg", ".png")))
    assert len(names) == 10
    for name in names:
        assert (here / "whole" / name).read_bytes() == (here / "parts" / name).read_bytes(), name


def test_the_present_directory_is_no_place_of_modules(started, here):
    gridlock.run("disks.toml", "out")
    (here / "numpy.py").write_text("raise SystemExit(99)")
    (here / "gridlock").mkdir()
    (here / "gridlock/__init__.py").write_text("raise SystemExit(98)")
    assert started("plot", "out").returncode == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGPIPE])
def test_signals_end_it_without_a_word(here, number):
    text = ("import sys, time\nfrom gridlock.commands import plot\n"
            "plot._plot = lambda options: (print('begun', flush=True), time.sleep(60))\n"
            "sys.argv = ['plot', 'out']\nsys.exit(plot.main())")
    process = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    process.send_signal(number)
    _, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (-number, "")


def test_without_a_gridlock_plot_a_run_says_how_to_get_it(program, here):
    (here / "bin").mkdir()
    shutil.copy(program, here / "bin/gridlock")
    ended = subprocess.run([here / "bin/gridlock", "run", "disks.toml", "-o", "out", "--pictures"], capture_output=True, text=True,
                           env={"PATH": "/no/such/directory"})
    assert ended.returncode == 0
    assert ended.stderr.count("gridlock-plot, which is not installed") == 1


def test_movies_are_made_by_the_program(program, here, monkeypatch):
    if shutil.which("ffmpeg") is None:
        pytest.skip("no ffmpeg")
    gridlock.run("disks.toml", "out", trajectory={"every": 10})
    assert gridlock.plot.movie("out", "a.gif", "psi6", width=64, rate=10, every=2) == pathlib.Path("a.gif")
    assert (here / "a.gif").read_bytes()[:3] == b"GIF"
    gridlock.plot.movie(gridlock.open("out"), "b.mp4", width=64)
    gridlock.plot.movie(gridlock.open("out").trajectory, "c.mp4", width=64)
    assert (here / "b.mp4").read_bytes() == (here / "c.mp4").read_bytes()
    with pytest.raises(gridlock.Error, match="the agents have no column \"smell\"\n  hint: "):
        gridlock.plot.movie("out", "d.mp4", "smell")
    (here / "bin").mkdir()
    (here / "bin/ffmpeg").write_text("#!/bin/sh\necho no room >&2; exit 1\n")
    (here / "bin/ffmpeg").chmod(0o755)
    monkeypatch.setenv("PATH", str(here / "bin"))
    with pytest.raises(gridlock.RunFailure, match="ffmpeg made no movie: no room"):
        gridlock.plot.movie("out", "d.mp4")


def test_without_the_program_a_movie_says_where_it_is_looked_for(here, monkeypatch):
    import sysconfig

    monkeypatch.setenv("GRIDLOCK_PROGRAM", str(here / "nothing"))
    with pytest.raises(gridlock.Error, match="GRIDLOCK_PROGRAM is .*, which is no program"):
        gridlock.plot.movie("out", "a.mp4")
    monkeypatch.delenv("GRIDLOCK_PROGRAM")
    monkeypatch.setenv("PATH", str(here))
    monkeypatch.setattr(sysconfig, "get_path", lambda name: str(here / "scripts"))
    monkeypatch.setattr(sys, "executable", str(here / "python"))
    with pytest.raises(gridlock.Error, match="the program gridlock is not installed"):
        gridlock.plot.movie("out", "a.mp4")
    (here / "scripts").mkdir()
    (here / "scripts/gridlock").write_text("#!/bin/sh\necho \"$@\" > said\n")
    (here / "scripts/gridlock").chmod(0o755)
    gridlock.plot.movie("out", "a.mp4")
    assert (here / "said").read_text() == "movie out -o a.mp4 --quiet --width=720 --rate=25 --every=1\n"
