#!/usr/bin/env python3
"""Pairs of points of the plane in arrays: gridlock.pairs beside what else PyPI has, in turns in one run.

    pip install scipy freud-analysis vesin matscipy
    PYTHONPATH=build/python benchmarks/python_neighbours.py 1000,10000,100000,1000000 5

Points are uniform in a periodic unit square, in no order, six neighbours each on average; codes of three dimensions get them at z = 0 in a flat box that
is not periodic in z. Before anything is timed, all have to find the same pairs; those of freud, in single precision, but for pairs whose distance is that
of the cutoff to 10⁻⁶ of the side. Every row gives the least and the median time of all turns by the clock on the wall, each
that of the second of two calls: small searches are slow right after a large one. freud's LinkCell is left out above
20,000 points: its time grows with their square in a two-dimensional box.
"""

import statistics
import sys

import numpy as np

import gridlock
from in_turns import timed_in_turns


def listed(neighbors):
    """Rows of both ends of each neighbour in lists."""
    return np.repeat(np.arange(len(neighbors.counts)), neighbors.counts), neighbors.indices


def searches(points, cutoff):
    """Name, search and what turns its result into rows of both ends, for everything that is installed."""
    count = len(points)
    solid = np.zeros((count, 3))
    solid[:, :2] = points
    cell = np.diag([1.0, 1.0, 4 * cutoff])
    for threads, words in ((1, ""), (0, ", all cores")):
        yield f"gridlock.pairs{words}", lambda threads=threads: gridlock.pairs(points, cutoff, box=1.0, threads=threads), lambda found: found.T
        yield f"gridlock.neighbors{words}", lambda threads=threads: gridlock.neighbors(points, cutoff, box=1.0, threads=threads), listed
    try:
        from scipy.spatial import cKDTree

        yield "scipy cKDTree, query_pairs", lambda: cKDTree(points, boxsize=1.0).query_pairs(cutoff, output_type="ndarray"), lambda found: found.T
    except ImportError:
        pass
    try:
        import freud

        box = freud.box.Box.square(1.0)
        flat = (solid - [0.5, 0.5, 0.0]).astype(np.float32)
        query = {"mode": "ball", "r_max": cutoff, "exclude_ii": True}

        def by_freud(make, threads):
            freud.parallel.set_num_threads(threads)
            return make().query(flat, query).toNeighborList()

        def ends(found):
            return found.query_point_indices, found.point_indices

        def tree():
            return freud.locality.AABBQuery(box, flat)

        yield "freud AABBQuery", lambda: by_freud(tree, 1), ends
        yield "freud AABBQuery, all cores", lambda: by_freud(tree, 0), ends
        if count <= 20_000:
            yield "freud LinkCell", lambda: by_freud(lambda: freud.locality.LinkCell(box, flat, cutoff), 1), ends
    except ImportError:
        pass
    try:
        import vesin

        calculator = vesin.NeighborList(cutoff=cutoff, full_list=False)
        yield "vesin", lambda: calculator.compute(points=solid, box=cell, periodic=[True, True, False], quantities="ij"), lambda found: found
    except ImportError:
        pass
    try:
        from matscipy.neighbours import neighbour_list

        yield ("matscipy neighbour_list", lambda: neighbour_list("ij", positions=solid, cell=cell, pbc=[True, True, False], cutoff=cutoff),
               lambda found: found)
    except ImportError:
        pass


def keys(ends, count):
    """One number for each pair, in order, however often and in which direction it is listed."""
    i, j = (np.asarray(one, dtype=np.int64) for one in ends)
    return np.unique(np.minimum(i, j) * count + np.maximum(i, j))


def require_same_pairs(name, found, expected, points, cutoff):
    differ = np.setxor1d(found, expected, assume_unique=True)
    gaps = points[differ // len(points)] - points[differ % len(points)]
    distances = np.hypot(*(gaps - np.rint(gaps)).T)
    if len(differ) and not (name.startswith("freud") and np.abs(distances - cutoff).max() < 1e-6):
        sys.exit(f"{name} finds other pairs: {len(differ)} of {len(expected)} differ")


def measure(count, turns):
    points = np.random.default_rng(1).random((count, 2))
    cutoff = float(np.sqrt(6 / (np.pi * count)))
    todo = {}
    for name, search, ends in searches(points, cutoff):
        found = keys(ends(search()), count)
        expected = found if not todo else expected
        require_same_pairs(name, found, expected, points, cutoff)
        todo[name] = search
    times, _ = timed_in_turns(todo, turns, warm=True)
    base = statistics.median(times["gridlock.pairs"])
    print(f"{f'{count} points, {len(expected)} pairs':<32}{'least ms':>10}{'median ms':>11}{'ns / point':>12}{'times':>8}")
    for name, seconds in times.items():
        median = statistics.median(seconds)
        print(f"{name:<32}{1e3 * min(seconds):>10.2f}{1e3 * median:>11.2f}{1e9 * median / count:>12.0f}{median / base:>8.1f}", flush=True)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    for count in sys.argv[1].split(","):
        measure(int(count), int(sys.argv[2]))


main()
