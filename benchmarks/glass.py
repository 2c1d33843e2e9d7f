#!/usr/bin/env python3
"""χ₄ of displacements relative to cages: gridlock beside a program of NumPy and SciPy, one thread each.

    pip install scipy
    PYTHONPATH=build/python benchmarks/glass.py 10000 1000

Arguments: disks and frames. Both take the same frames, neighbours within 1.5 at each origin, lags evenly in their logarithm and all
origins of each, and print the processor time of the user with the largest difference of their curves.
"""

import os
import sys

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

import gridlock

CUTOFF, LENGTH, LAGS = 1.5, 0.3, 30


def trajectory(count, frames):
    """Disks that rattle about the sites of a square lattice, which drift apart slowly; ids in no order of space."""
    random = np.random.default_rng(1)
    side = round(np.sqrt(count))
    sites = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2).astype(float)
    sites = sites[random.permutation(len(sites))]
    drift = random.normal(size=(frames, len(sites), 2)).cumsum(axis=0) * 0.01
    return sites + drift + 0.1 * random.normal(size=drift.shape), float(side)


def by_numpy(positions, side, lags):
    """The mean squared displacement and χ₄ relative to cages."""
    frames, count, _ = positions.shape
    square, near = np.zeros(len(lags)), [np.full(frames - lag, np.nan) for lag in lags]
    for origin in range(frames - 1):
        inside = np.mod(positions[origin], side)
        pairs = cKDTree(inside, boxsize=side).query_pairs(CUTOFF, output_type="ndarray")
        i, j = np.concatenate([pairs[:, 0], pairs[:, 1]]), np.concatenate([pairs[:, 1], pairs[:, 0]])
        counts = np.maximum(np.bincount(i, minlength=count), 1)
        mean = csr_matrix((1.0 / counts[i], (i, j)), shape=(count, count))
        for k, lag in enumerate(lags):
            if origin + lag < frames:
                moved = positions[origin + lag] - positions[origin]
                moved -= mean @ moved
                squares = np.einsum("ij,ij->i", moved, moved)
                square[k] += squares.sum()
                near[k][origin] = np.count_nonzero(squares <= LENGTH**2)
    msd = square / (count * (frames - np.array(lags)))
    return msd, [susceptibility(values, lag) / count for values, lag in zip(near, lags)]


def susceptibility(near, lag):
    """The variance from all pairs of origins whose intervals do not overlap."""
    if len(near) <= lag:
        return np.nan
    d = near - near.mean()
    first, second, before = np.cumsum(d)[:-lag], np.cumsum(d**2)[:-lag], np.arange(1, len(d) - lag + 1)
    later = d[lag:]
    return 0.5 * (second - 2 * first * later + before * later**2).sum() / before.sum()


def timed(work):
    before = os.times().user
    result = work()
    return os.times().user - before, result


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    positions, side = trajectory(int(sys.argv[1]), int(sys.argv[2]))
    ours, found = timed(lambda: gridlock.dynamics(positions, overlap_length=LENGTH, lags=LAGS, neighbors=CUTOFF, box=side))
    plain, _ = timed(lambda: gridlock.dynamics(positions, overlap_length=LENGTH, lags=LAGS))
    theirs, (msd, chi) = timed(lambda: by_numpy(positions, side, [round(lag) for lag in found.lag]))
    print(f"{positions.shape[1]} disks, {len(positions)} frames, {len(found.lag)} lags, {found.origins.sum()} pairs of frames")
    print(f"gridlock, relative to cages   {ours:8.2f} s")
    print(f"gridlock, displacements alone {plain:8.2f} s")
    print(f"NumPy, relative to cages      {theirs:8.2f} s   {theirs / ours:.1f} times as long")
    print(f"largest difference: MSD {np.nanmax(abs(found.msd / msd - 1)):.1e}, chi4 {np.nanmax(abs(found.susceptibility - chi)):.1e}")


main()
