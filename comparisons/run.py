#!/usr/bin/env python3
"""Puts the entries of Gridlock into a clone of the public comparison of agent frameworks, and runs them beside Mesa, MASON and NetLogo, in turns.

    git clone https://github.com/JuliaDynamics/ABMFrameworksComparison comparison
    pip install mesa==3.2.0 numba
    cmake --build build --target gridlock_bench_public_comparison
    PYTHONPATH=$PWD/build/python comparisons/run.py comparison --rounds 2 --runs 3

Needs java and javac for MASON, whose library the clone has, bc, and for NetLogo its archive unpacked as comparison/netlogo, as the clone asks; without
it NetLogo is left out. Each program runs as the comparison has it and prints the median of its runs; --runs makes them fewer than its 100.
The least of the medians of all rounds is written into the results and the table of docs/reference/other_codes.md: other programs at work make times longer.
After them come the neighbour searches of benchmarks/python_neighbours.py and the entries for FLAME GPU's comparisons, each with
a table of its own.
--table prints all tables from the results. What is changed:

- The comparison took its forest fire away in 2023; it is brought back from the history of the clone, but for the program of MASON,
  which sweeps over the cells of one forest, so that a fire crosses it in one step.
- The published wolves and sheep of Mesa never run the simulator by which their grass grows; "MesaMended" does.
- Seeds of NetLogo are written here, not by Julia, and its times are sorted as numbers, not as text. A median is the middle one of all.
"""

import argparse
import importlib.metadata
import io
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tarfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
ENTRIES = ROOT / "comparisons/ABMFrameworksComparison"
CPP = ROOT / "build/benchmarks/gridlock_bench_public_comparison"
MODELS = {"WolfSheep": "wolfsheep", "Flocking": "flocking", "Schelling": "schelling", "ForestFire": "forestfire"}
BEFORE_FOREST_FIRE_WENT = "c448691^"
MARK = ".made_by_gridlock"  # a file in the copy of the clone
RESULTS = ROOT / "benchmarks/results/public_comparison.csv"
OTHERS = RESULTS.with_name("public_comparison_others.csv")
POINTS = (1000, 10_000, 100_000, 1_000_000)
TURNS = 5  # of the neighbour searches, which are short
PAGE = ROOT / "docs/reference/other_codes.md"
# Mesa 3.2.0 and Ark.jl 0.4.0 to Agents.jl 6.2.10; README.md of the comparison, 22 February 2026.
PUBLISHED = {"WolfSheep-small": (9.38, 0.34), "WolfSheep-large": (3.28, 0.14), "Flocking-small": (159.29, 0.73), "Flocking-large": (59.5, 0.36),
             "Schelling-small": (29.73, 0.61), "Schelling-large": (26.66, 0.59)}
NAMES = {"Gridlock": "Gridlock, Python with Numba", "GridlockCpp": "Gridlock, C++", "Mason": "MASON 22.0", "NetLogo": "NetLogo 6.4.0", "Mesa": "Mesa 3.2.0",
         "MesaMended": "Mesa, mended"}


def changed(path, pattern, replacement):
    path.write_text(re.sub(pattern, replacement, path.read_text(), flags=re.MULTILINE))


def copy_of(comparison, runs):
    """A copy of the clone with our entries, in which every program makes so many runs."""
    work = comparison.parent / f"{comparison.name}_with_gridlock"
    if work.exists() and not (work / MARK).exists():
        sys.exit(f"{work} is there, and not made by this program; move it away")
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(comparison, work, symlinks=True, ignore=shutil.ignore_patterns(".git"))
    packed = subprocess.run(["git", "archive", BEFORE_FOREST_FIRE_WENT, "ForestFire"], cwd=comparison, stdout=subprocess.PIPE, check=True).stdout
    tarfile.open(fileobj=io.BytesIO(packed)).extractall(work)
    (work / MARK).touch()
    shutil.rmtree(work / "ForestFire/Mason")
    shutil.copytree(ENTRIES, work, dirs_exist_ok=True)
    mended = work / "WolfSheep/Mesa/benchmark_mended.py"
    shutil.copy(work / "WolfSheep/Mesa/benchmark_wolfsheep.py", mended)
    changed(mended, r"for i in range\(0, 100\):\n +wolfsheep.step\(\)", "wolfsheep.simulator.run_for(100)")
    changed(mended, r"Mesa WolfSheep", "MesaMended WolfSheep")
    for script in work.glob("*/*/benchmark_*"):
        changed(script, r"^(n_run|N_RUN)( ?= ?)100$", rf"\g<1>\g<2>{runs}")
        changed(script, r" \+ (n_run|\$N_RUN) % 2", "")
        changed(script, r"^julia .*$", "")
        changed(script, r"\| sort\)$", "| sort -n)")
    return work


def seed_netlogo(path, runs):
    """Writes seeds for every experiment of NetLogo; its script takes the first line away."""
    draw = random.Random(42)
    text = re.sub(r'(variable="seed">)\s*', lambda found: found[1] + "".join(f'<value value="{draw.randint(1, 10000)}"/>' for _ in range(runs)),
                  path.read_text())
    path.with_suffix(".xml").write_text('<?xml version="1.0"?>\n' + text[text.index("<experiments>"):])


def commands(work, folder, runs):
    """What runs a model, one command for each framework."""
    file = MODELS[folder]
    yield [sys.executable, f"{folder}/Gridlock/benchmark_{file}.py"]
    if folder != "ForestFire":
        yield [str(CPP), folder, str(runs)]
        yield ["bash", f"{folder}/Mason/benchmark_{file}.sh"]
    if (work / "netlogo").exists():
        seed_netlogo(work / f"{folder}/NetLogo/parameters_{file}.xml", runs)
        yield ["bash", f"{folder}/NetLogo/benchmark_{file}.sh"]
    yield [sys.executable, f"{folder}/Mesa/benchmark_{file}.py"]
    if folder == "WolfSheep":
        yield [sys.executable, f"{folder}/Mesa/benchmark_mended.py"]


def found_in(pattern, command, folder=ROOT):
    """What a command prints that has this form, once it has ended."""
    printed = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE, check=True).stdout
    return re.findall(pattern, printed, flags=re.MULTILINE) or sys.exit(f"{' '.join(command)} prints no times")


def medians(command, work):
    """Milliseconds by framework and model, from lines such as "Mesa Flocking-small (ms): 12.5"."""
    return {(name, model): float(value) for name, model, value in found_in(r"^(\w+) (\w+-\w+) \(ms\): ([\d.]+)$", command, work)}


def load():
    return f"{os.getloadavg()[0]:.1f} programs at work on {os.cpu_count()} cores at the end; comparisons/run.py"


def results(least, options):
    """Lines of the file of results: the least medians, under a line that says how they came about."""
    yield (f"# {options.runs} runs, up to {options.rounds} rounds in turns; Mesa {importlib.metadata.version('mesa')}; "
           f"{load()}")
    yield "model," + ",".join(f"{name}_milliseconds" for name in NAMES)
    for model in sorted({model for _, model in least}):
        yield f"{model}," + ",".join(f"{least[name, model]:.2f}" if (name, model) in least else "" for name in NAMES)


def other_results(runs):
    """Lines of the file of the other entries: in which table each is, how much was measured, the time, and what it was."""
    rows = []
    for count in POINTS:
        command = [sys.executable, "benchmarks/python_neighbours.py", str(count), str(TURNS)]
        for name, nanoseconds in found_in(r"^(\w.*?)  +[\d.]+ +[\d.]+ +(\d+) +[\d.]+$", command):
            rows.append(f"search,{count},{nanoseconds},{name}")
    folder = "comparisons/flamegpu"
    command = [sys.executable, f"{folder}/ABM_Framework_Comparisons/Gridlock/benchmark.py", str(runs)]
    for name, value in found_in(r"^Gridlock (.*) \(mean ms\): (.*)$", command):
        rows.append(f"step,{200_000 if 'Schelling' in name else 80_000},{float(value) / 100:.2f},{name}")
    for count, value in found_in(r"^(\d+),([\d.]+),", [sys.executable, f"{folder}/circles.py", "10000", "100000"]):
        rows.append(f"step,{count},{value},Circles, Python")
    how = f"medians of {TURNS} turns of the neighbour searches; means of {runs} runs of FLAME GPU's, one of its circles"
    return [f"# {how}; {load()}", "table,size,value,entry", *rows]


def shown(milliseconds):
    return "–" if not milliseconds else f"{milliseconds:.{1 if milliseconds < 20 else 0}f}"


def table(path):
    """The results as a table of a page, with the times of Mesa over the published ratios."""
    yield "| milliseconds | " + " | ".join([*NAMES.values(), "Agents.jl, estimated", "Ark.jl, estimated"]) + " |"
    yield "|---" * (3 + len(NAMES)) + "|"
    for line in path.read_text().splitlines()[2:]:
        model, *values = line.split(",")
        times = dict(zip(NAMES, (float(value or 0) for value in values)))
        mesa, ark = PUBLISHED.get(model, (math.inf, 0))
        times |= {"Agents": times["Mesa"] / mesa, "Ark": times["Mesa"] / mesa * ark}
        yield f"| {model} | " + " | ".join(map(shown, times.values())) + " |"


def other_tables():
    """The other entries as two tables: a row for each search, and one for each of FLAME GPU's."""
    rows = [line.split(",", 3) for line in OTHERS.read_text().splitlines()[2:]]
    searches = {(name, int(size)): value for kind, size, value, name in rows if kind == "search"}
    head = ["| nanoseconds a point | " + " | ".join(f"{count:,} points" for count in POINTS) + " |", "|---" * (1 + len(POINTS)) + "|"]
    yield head + ["| " + " | ".join([name, *(searches.get((name, count), "–") for count in POINTS)]) + " |"
                  for name in dict.fromkeys(name for name, _ in searches)]
    yield ["| milliseconds a step | agents | Gridlock |", "|---|---|---|"] + [
        f"| {name} | {int(size):,} | {shown(float(value))} |" for kind, size, value, name in rows if kind == "step"]


def put(lines):
    """Puts a table in the place of the one of the page that has its first cell."""
    cell = lines[0].split("|")[1]
    old = rf"\|{re.escape(cell)}\|.*?\n\n"
    PAGE.write_text(re.sub(old, "\n".join(lines) + "\n\n", PAGE.read_text(), flags=re.DOTALL))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("comparison", type=pathlib.Path, nargs="?", help="a clone of the public comparison")
    parser.add_argument("--table", action="store_true", help="measure nothing, print the table of the results")
    parser.add_argument("--models", nargs="+", choices=MODELS, default=MODELS, help="some models only")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--output", type=pathlib.Path, default=RESULTS)
    options = parser.parse_args()
    if not options.table:
        if not options.comparison:
            parser.error("which clone of the comparison?")
        if not (options.comparison / "WolfSheep").is_dir():
            parser.error(f"{options.comparison} is no clone of the comparison")
        if len(options.models) < len(MODELS) and options.output == RESULTS:
            parser.error("some models alone would take the others out of the table; name another file by --output")
        work = copy_of(options.comparison.resolve(), options.runs)
        least = {}
        for _ in range(options.rounds):
            for folder in options.models:
                for command in commands(work, folder, options.runs):
                    for key, value in medians(command, work).items():
                        least[key] = min(value, least.get(key, value))
            options.output.write_text("\n".join(results(least, options)) + "\n")
        if options.output == RESULTS:
            OTHERS.write_text("\n".join(other_results(options.runs)) + "\n")
    tables = [[*table(options.output)], *(other_tables() if options.output == RESULTS else ())]
    if not options.table and options.output == RESULTS:
        for lines in tables:
            put(lines)
    print("\n\n".join("\n".join(lines) for lines in tables))


main()
