#!/usr/bin/env python3
"""The charts of docs/notebook/models.md from the committed results: python validation/models.py docs/images

Needs the Python package gridlock with its plots (pip install ".[plots]").
"""

import csv
import pathlib
import sys

from matplotlib.figure import Figure

import gridlock.plot

RESULTS = pathlib.Path(__file__).resolve().parent / "results"


def table(name):
    with open(RESULTS / f"{name}.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(rows, *names):
    return [[float(row[name]) for row in rows] for name in names]


def chart(file, draw, **axes_settings):
    figure = Figure((4.6, 3.2), layout="constrained")
    axes = figure.subplots()
    draw(axes)
    axes.set(**axes_settings)
    figure.savefig(file, metadata={"Date": None})


def noise(axes):
    rows = table("vicsek_noise")
    for number, count in enumerate(("40", "100", "400", "4000", "10000")):
        chosen = [row for row in rows if row["agents"] == count]
        gridlock.plot.points(axes, *numbers(chosen, "noise", "order", "error"), label=f"{count} agents", number=number)
    axes.axvline(2.9, color="#666666", linestyle=":", linewidth=0.8)
    axes.text(2.95, 0.94, "η$_\\mathrm{c}$(∞) = 2.9", color="#666666", fontsize="small")
    axes.legend(loc="lower left")


def density(axes):
    gridlock.plot.points(axes, *numbers(table("vicsek_density"), "density", "order", "error"))


def epidemic(axes):
    rows = table("epidemic")
    for number, state in enumerate(("susceptible", "infected", "recovered")):
        for seed in ("1", "2", "3"):
            chosen = [row for row in rows if row["seed"] == f"seed={seed}"]
            gridlock.plot.line(axes, *numbers(chosen, "time", state), label=state if seed == "1" else "", color=gridlock.plot.COLOURS[number],
                               alpha=0.5, linewidth=2)
        gridlock.plot.line(axes, *numbers(table("sir"), "time", state), label="SIR equations" if number == 0 else "", color="black",
                           linestyle="-", linewidth=0.7)
    axes.legend(loc="center right")


def main(directory):
    with gridlock.plot.style():
        chart(directory / "vicsek_noise.svg", noise, title="Vicsek model: order against noise, density 4", xlabel="noise η",
              ylabel="order v$_\\mathrm{a}$", xlim=(0, 5), ylim=(0, 1.02))
        chart(directory / "vicsek_density.svg", density, title="Vicsek model: order against density, side 20, η = 2", xlabel="density ρ",
              ylabel="order v$_\\mathrm{a}$", xlim=(0, 10.2), ylim=(0, 1))
        chart(directory / "epidemic_sir.svg", epidemic, title="Epidemic among fast walkers, three seeds, and the SIR equations",
              xlabel="time", ylabel="agents", xlim=(0, 50), ylim=(0, 10_000))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
