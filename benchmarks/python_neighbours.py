#!/usr/bin/env python3
"""Pairs of points of the plane in arrays: gridlock.pairs beside what else PyPI has, in turns in one run.

    pip install scipy freud-analysis vesin matscipy
    PYTHONPATH=build/python benchmarks/python_neighbours.py 100000 9

Points are uniform in a periodic unit square, in no order, six neighbours each on average. Every row gives the least and the median
time of all turns, and the number of pairs that were found, each counted once. Timings are of the wall clock.
"""

import statistics
import sys

import numpy as np

import gridlock
from in_turns import timed_in_turns


def searches(points, cutoff):
    """Name and function of everything that is installed; each returns how many pairs it finds, both directions counted."""
    count = len(points)
    solid = np.zeros((count, 3))
    solid[:, :2] = points
    # Three-dimensional codes get a box so flat that no image across it is near.
    height = 4 * cutoff
    yield "gridlock.pairs", lambda: 2 * len(gridlock.pairs(points, cutoff, box=1.0))
    yield "gridlock.pairs, 2 threads", lambda: 2 * len(gridlock.pairs(points, cutoff, box=1.0, threads=2))
    yield "gridlock.neighbors", lambda: len(gridlock.neighbors(points, cutoff, box=1.0).indices)
    yield "gridlock.neighbors, 2 threads", lambda: len(gridlock.neighbors(points, cutoff, box=1.0, threads=2).indices)
    try:
        from scipy.spatial import cKDTree

        yield "scipy cKDTree, query_pairs", lambda: 2 * len(
            cKDTree(points, boxsize=1.0).query_pairs(cutoff, output_type="ndarray"))
    except ImportError:
        pass
    try:
        import freud

        freud.parallel.set_num_threads(1)
        box = freud.box.Box.square(1.0)
        flat = (solid - [0.5, 0.5, 0.0]).astype(np.float32)
        query = {"mode": "ball", "r_max": cutoff, "exclude_ii": True}
        yield "freud AABBQuery", lambda: len(freud.locality.AABBQuery(box, flat).query(flat, query).toNeighborList())
        # Its time grows with the square of the points in a two-dimensional box: minutes for 100,000.
        if count <= 20_000:
            yield "freud LinkCell", lambda: len(
                freud.locality.LinkCell(box, flat, cutoff).query(flat, query).toNeighborList())
    except ImportError:
        pass
    try:
        import vesin

        calculator = vesin.NeighborList(cutoff=cutoff, full_list=False)
        cell = np.diag([1.0, 1.0, height])
        yield "vesin", lambda: 2 * len(
            calculator.compute(points=solid, box=cell, periodic=[True, True, False], quantities="ij")[0])
    except ImportError:
        pass
    try:
        from matscipy.neighbours import neighbour_list

        cell = np.diag([1.0, 1.0, height])
        yield "matscipy neighbour_list", lambda: len(
            neighbour_list("i", positions=solid, cell=cell, pbc=[True, True, False], cutoff=cutoff))
    except ImportError:
        pass


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    count, turns = int(sys.argv[1]), int(sys.argv[2])
    points = np.random.default_rng(1).random((count, 2))
    cutoff = float(np.sqrt(6 / (np.pi * count)))
    todo = dict(searches(points, cutoff))
    times, found = timed_in_turns(todo, turns)
    base = statistics.median(times["gridlock.pairs"])
    print(f"{count} points{'':<20}{'least ms':>10}{'median ms':>11}{'ns / point':>12}{'times':>8}{'pairs':>12}")
    for name, seconds in times.items():
        median = statistics.median(seconds)
        print(f"{name:<32}{1e3 * min(seconds):>10.1f}{1e3 * median:>11.1f}{1e9 * median / count:>12.0f}"
              f"{median / base:>8.1f}{found[name] / 2:>12.0f}")


main()
