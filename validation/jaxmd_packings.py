#!/usr/bin/env python3
"""Compares gridlock.contacts with packings that jax-md has analysed: python validation/jaxmd_packings.py FILE.nc …

The files 2d_polyuniform_N64_Lp-1.0.nc and -4.0.nc are test data of jax-md: 10 harmonic packings of 64 disks each, with energies, stresses
and elastic constants. Prints one line a packing and the largest difference of each quantity; ends with 1 where one is above 1e-8.
Needs h5py.
"""

import sys

import h5py
import numpy as np

import gridlock

#: The allowed difference, over the largest component of a quantity in its packing.
BOUND = 1e-8


def compare(file, k):
    """The analysis of packing k of a file, and its largest relative differences from what stands there."""
    side = float(file["box"][k][0])
    points = side * file["pos"][k].reshape(-1, 2)
    found = gridlock.contacts(points, file["rad"][k], side, residual=1e-3)
    unit = found.smallest_diameter**2
    pairs = {
        "energy": (found.energy, file["Energy"][k]),
        "stress": (found.stress / unit, file["Stress"][k].reshape(2, 2)),
        "elastic constants": (found.elastic_constants / unit, file["Cijkl"][k]),
    }
    return found, {name: np.abs(ours - theirs).max() / np.abs(theirs).max() for name, (ours, theirs) in pairs.items()}


def main(paths):
    largest = {}
    for path in paths:
        print(f"{path}\n  {'N0':>3} {'Nc':>4} {'excess':>6} {'pressure':>12} {'residual':>9}  differences of energy, stress, elastic constants")
        with h5py.File(path, "r") as file:
            for k in range(len(file["Energy"])):
                found, differences = compare(file, k)
                print(f"  {found.backbone_disks:>3} {found.backbone_contacts:>4} {found.excess_contacts:>6} {found.pressure:12.6e} "
                      f"{found.residual_force:9.1e}  " + " ".join(f"{value:.1e}" for value in differences.values()))
                for name, value in differences.items():
                    largest[name] = max(largest.get(name, 0.0), value)
    for name, value in largest.items():
        print(f"{name}: largest difference {value:.2g}, allowed {BOUND:g}")
    return 0 if all(value <= BOUND for value in largest.values()) else 1


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1:]))
