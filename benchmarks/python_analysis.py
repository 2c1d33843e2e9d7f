#!/usr/bin/env python3
"""Analysis of arrays: gridlock beside what else PyPI has, in turns in one run, one thread each.

    pip install scipy freud-analysis MDAnalysis
    PYTHONPATH=build/python benchmarks/python_analysis.py 5

Every row gives the least and the median time of all turns, how many times as long as gridlock it takes, and a number that all
rows of a group share up to their conventions. Timings are of the wall clock. freud is asked for what its own classes offer; its
LinkCell is not used, for its time grows with the square of the points in two dimensions.
"""

import statistics
import sys
import warnings

import numpy as np

import gridlock
from in_turns import timed_in_turns

COUNT = 100_000
FRAMES, AGENTS = 1000, 1000


def fluid():
    """Points of a dense, disordered system in a periodic box, at a distance of about 1 from their neighbours."""
    side = round(np.sqrt(COUNT))
    lattice = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)[:COUNT].astype(float)
    box = (float(side), float(-(-COUNT // side)))
    return np.mod(lattice + np.random.default_rng(1).normal(size=lattice.shape) * 0.3, box), box


def freud_box(points, box):
    import freud

    freud.parallel.set_num_threads(1)
    flat = np.zeros((len(points), 3), dtype=np.float32)
    flat[:, :2] = points - 0.5 * np.array(box)
    return freud, freud.box.Box(*box), flat


def pair_correlations(points, box):
    yield "gridlock.pair_correlation", lambda: gridlock.pair_correlation(points, box, range=5.0, bins=250).g[100:].mean()
    kinds = np.arange(len(points)) % 2
    yield "gridlock.pair_correlation, 2 kinds", lambda: gridlock.pair_correlation(
        points, box, range=5.0, bins=250, kinds=kinds).g[0, 1, 100:].mean()
    try:
        freud, its_box, flat = freud_box(points, box)
        yield "freud RDF", lambda: freud.density.RDF(bins=250, r_max=5.0).compute((its_box, flat)).rdf[100:].mean()
    except ImportError:
        pass
    try:
        import MDAnalysis

        dimensions = np.array([*box, 20.0, 90, 90, 90], dtype=np.float32)
        solid = np.zeros((len(points), 3), dtype=np.float32)
        solid[:, :2] = points

        def distances():
            found = MDAnalysis.lib.distances.self_capped_distance(solid, 5.0, box=dimensions, return_distances=True)[1]
            counts, edges = np.histogram(found, bins=250, range=(0, 5))
            return (counts / (0.5 * len(points) ** 2 * np.pi * np.diff(edges**2) / (box[0] * box[1])))[100:].mean()

        yield "MDAnalysis distances, NumPy histogram", distances
    except ImportError:
        pass


def orders(points, box):
    def by_cutoff():
        return abs(gridlock.bond_orientation(points, 1.5, box)).mean()

    yield "gridlock.bond_orientation, cutoff", by_cutoff
    try:
        freud, its_box, flat = freud_box(points, box)
        yield "freud Hexatic, cutoff", lambda: abs(freud.order.Hexatic(k=6).compute(
            (its_box, flat), neighbors={"mode": "ball", "r_max": 1.5, "exclude_ii": True}).particle_order).mean()
    except ImportError:
        pass


def displacements():
    walk = np.random.default_rng(1).normal(size=(FRAMES, AGENTS, 2)).cumsum(axis=0)
    yield "gridlock.dynamics", lambda: gridlock.dynamics(walk).msd[:100].mean()
    yield "gridlock.dynamics, 100 lags", lambda: gridlock.dynamics(walk, lags=100).msd[:50].mean()
    yield "gridlock.dynamics with F_s", lambda: gridlock.dynamics(walk, q=0.1).msd[:100].mean()
    yield "gridlock.mean_squared_displacement", lambda: gridlock.mean_squared_displacement(walk)[1:101].mean()
    solid = np.zeros((FRAMES, AGENTS, 3), dtype=np.float32)
    solid[:, :, :2] = walk
    try:
        import freud

        box = freud.box.Box.square(1e6)
        yield "freud MSD, window", lambda: freud.msd.MSD(box, mode="window").compute(solid).msd[1:101].mean()
    except ImportError:
        pass
    try:
        import MDAnalysis
        import MDAnalysis.analysis.msd

        universe = MDAnalysis.Universe.empty(AGENTS, trajectory=True)
        universe.load_new(solid)
        yield "MDAnalysis EinsteinMSD, no FFT", lambda: MDAnalysis.analysis.msd.EinsteinMSD(
            universe, msd_type="xy", fft=False).run().results.timeseries[1:101].mean()
    except ImportError:
        pass


def cells(points, box):
    yield "gridlock.voronoi", lambda: gridlock.voronoi(points, box).areas.std()
    try:
        freud, its_box, flat = freud_box(points, box)
        yield "freud Voronoi", lambda: freud.locality.Voronoi().compute((its_box, flat)).volumes.std()
    except ImportError:
        pass
    try:
        from scipy.spatial import Delaunay, Voronoi

        yield "scipy Voronoi, open, no areas", lambda: len(Voronoi(points).ridge_points)
        yield "scipy Delaunay, open", lambda: len(Delaunay(points).simplices)
    except ImportError:
        pass


def compare(title, todo, turns):
    times, found = timed_in_turns(todo, turns)
    base = statistics.median(next(iter(times.values())))
    print(f"\n{title:<40}{'least ms':>10}{'median ms':>11}{'times':>8}{'value':>14}")
    for name, seconds in times.items():
        median = statistics.median(seconds)
        print(f"{name:<40}{1e3 * min(seconds):>10.1f}{1e3 * median:>11.1f}{median / base:>8.1f}{found[name]:>14.6g}")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    warnings.simplefilter("ignore")
    turns = int(sys.argv[1])
    points, box = fluid()
    compare(f"g(r) of {COUNT} points, range 5", dict(pair_correlations(points, box)), turns)
    compare(f"ψ6 of {COUNT} points", dict(orders(points, box)), turns)
    compare(f"MSD of {FRAMES} frames of {AGENTS} agents", dict(displacements()), turns)
    compare(f"Voronoi cells of {COUNT} points", dict(cells(points, box)), turns)


main()
