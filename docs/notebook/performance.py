#!/usr/bin/env python3
"""The charts of docs/reference/performance.md from the committed results: python docs/notebook/performance.py docs/images

Needs the Python package gridlock with its plots (pip install ".[plots]").
"""

import csv
import pathlib
import sys

from matplotlib.figure import Figure

import gridlock.plot

ROOT = pathlib.Path(__file__).resolve().parents[2]


def rows(results="paper_rule.csv"):
    with open(ROOT / "benchmarks/results" / results, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def draw(file, curves, title, x_label, limits, legend):
    """``curves`` are pairs of a label and points (x, y)."""
    figure = Figure((5.0, 3.6), layout="constrained")
    axes = figure.subplots()
    for number, (label, points) in enumerate(curves):
        gridlock.plot.points(axes, *zip(*sorted(points)), label=label, number=number)
    axes.set(xscale="log", yscale="log", title=title, xlabel=x_label, ylabel="ns per disk and step", ylim=limits)
    axes.legend(loc=legend)
    figure.savefig(file, metadata={"Date": None})


def over_n(name, fraction):
    """Of tiled on one thread the numbers of the second table, of today's program, where it has the size."""
    newer = [row for row in rows("paper_rule_targets.csv") if row["target"] == "avx512" and row["name"] == "tiled 1 thread"]
    chosen = [row for row in [*rows(), *newer] if row["name"] == name and row["packing_fraction"] == fraction]
    return list({float(row["n"]): float(row["nanoseconds_min"]) for row in chosen}.items())


def over_k(count):
    return [(float(row["name"].removeprefix("lists k=")), float(row["nanoseconds_min"])) for row in rows()
            if row["benchmark"] == "paper_rule_over_k" and row["n"] == str(count)]


def draw_scaling(file):
    """Weak and strong scaling on the simulated cluster, and by the formula."""
    runs = rows("simulated_ranks.csv")

    def curve(scaling, column, disks, count):
        return [(float(row["ranks"]), float(row[column])) for row in runs if row["scaling"] == scaling and row[disks] == str(count)]

    figure = Figure((7.0, 3.2), layout="constrained")
    weak, strong = figure.subplots(1, 2, sharey=True)
    pictures = [
        (weak, "weak", "disks_of_rank", {100_000: "10⁵ disks a rank", 1_000_000: "10⁶ disks a rank"}, "Weak scaling"),
        (strong, "strong", "disks", {6_400_000: "6.4·10⁶ disks in all"}, "Strong scaling"),
    ]
    for axes, scaling, column, counts, title in pictures:
        for number, (count, label) in enumerate(counts.items()):
            for name, how, line in (("efficiency", "simulated", "-"), ("efficiency_by_formula", "formula", ":")):
                ranks, efficiency = zip(*curve(scaling, name, column, count))
                gridlock.plot.points(axes, ranks, efficiency, label=f"{label}, {how}", number=number, linestyle=line)
        axes.set(xscale="log", title=title, xlabel="ranks", ylim=(0.65, 1.0))
        axes.set_xticks([4, 16, 64, 256], ["4", "16", "64", "256"], minor=False)
        axes.minorticks_off()
        axes.legend(loc="lower left")
    weak.set_ylabel("share of a step spent on turns")
    figure.savefig(file, metadata={"Date": None})


def main(directory):
    names = {"lists finest k": "linked lists, finest k", "stepped": "stepped", "tiled 1 thread": "tiled"}
    curves = [(f"{label}, φ = {fraction}", over_n(name, fraction)) for name, label in names.items() for fraction in ("0.7", "0.3")]
    curves.append(("tiled, 2 threads, wall time, φ = 0.7", over_n("tiled 2 threads (wall)", "0.7")))
    with gridlock.plot.style():
        draw(directory / "performance_n.svg", curves, "The paper's rule, one core, cost against N", "number of disks N", (15, 1500), "upper left")
        curves = [(f"N = {count:,}", over_k(count)) for count in (100, 841, 10_000, 100_000, 1_000_000, 10_000_000)]
        draw(directory / "performance_k.svg", curves, "The paper's rule on linked lists, one core, cost against k, φ = 0.7", "cells a side k",
             (100, 200_000), "upper right")
        draw_scaling(directory / "scaling_ranks.svg")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
