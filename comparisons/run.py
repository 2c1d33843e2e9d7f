#!/usr/bin/env python3
"""Puts the entries of Gridlock into a clone of the public comparison of agent frameworks, and runs them beside Mesa and MASON, in turns.

    git clone https://github.com/JuliaDynamics/ABMFrameworksComparison comparison
    pip install mesa==3.2.0 numba
    PYTHONPATH=$PWD/build/python comparisons/run.py comparison --rounds 3 --runs 10

Needs java and javac for MASON, whose library the clone has, and bc. Each program runs as the comparison has it and prints the median of its
runs; --runs makes them fewer than its 100. The table has the least of the medians of all rounds: other programs at work make times longer.
"""

import argparse
import importlib.metadata
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ENTRIES = ROOT / "comparisons/ABMFrameworksComparison"
MODELS = {"WolfSheep": "wolfsheep", "Flocking": "flocking", "Schelling": "schelling"}


def copy_of(comparison, runs):
    """A copy of the clone with our entries, in which every program makes so many runs."""
    work = comparison.parent / f"{comparison.name}_with_gridlock"
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(comparison, work, ignore=shutil.ignore_patterns(".git"))
    shutil.copytree(ENTRIES, work, dirs_exist_ok=True)
    for script in work.glob("*/*/benchmark_*"):
        script.write_text(re.sub(r"^(n_run|N_RUN) ?= ?100$", lambda match: match[0].replace("100", str(runs)), script.read_text(), flags=re.MULTILINE))
    return work


def medians(command, work):
    """Milliseconds by framework and model, from lines such as "Mesa Flocking-small (ms): 12.5"."""
    printed = subprocess.run(command, cwd=work, text=True, stdout=subprocess.PIPE, check=True).stdout
    found = {(name, model): float(value) for name, model, value in re.findall(r"^(\w+) (\w+-\w+) \(ms\): ([\d.]+)$", printed, flags=re.MULTILINE)}
    if not found:
        sys.exit(f"{' '.join(command)} prints no times")
    return found


def table(least, options):
    """Rows of the least medians, under a line that says how they came about."""
    names = ("Gridlock", "Mason", "Mesa")
    lines = [f"# {options.runs} runs, up to {options.rounds} rounds in turns; Mesa {importlib.metadata.version('mesa')}, MASON 22.0; {os.getloadavg()[0]:.1f} programs "
             f"at work on {os.cpu_count()} cores at the end; comparisons/run.py", "model," + ",".join(f"{name}_milliseconds" for name in names)]
    lines += [f"{model}," + ",".join(f"{least[name, model]:.2f}" for name in names) for model in sorted({model for _, model in least})]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("comparison", type=pathlib.Path, help="a clone of the public comparison")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "benchmarks/results/public_comparison.csv")
    options = parser.parse_args()
    work = copy_of(options.comparison.resolve(), options.runs)
    least = {}
    for _ in range(options.rounds):
        for model, file in MODELS.items():
            for command in ([sys.executable, f"{model}/Gridlock/benchmark_{file}.py"], [sys.executable, f"{model}/Mesa/benchmark_{file}.py"],
                            ["bash", f"{model}/Mason/benchmark_{file}.sh"]):
                for key, value in medians(command, work).items():
                    least[key] = min(value, least.get(key, value))
        options.output.write_text(table(least, options))
    print(table(least, options), end="")


main()
