#!/usr/bin/env python3
"""Read a trajectory of Gridlock with h5py, draw it with matplotlib, and analyse it with MDAnalysis.

    gridlock run scenes/mixture.toml --set run.steps=2000 --set trajectory.every=100 -o results/frames
    python3 examples/read_trajectory.py results/frames/trajectory.h5

Two things need care in other programs. Positions are inside the box, so displacements in a periodic box need the
column `image`. The disks live in a plane: the box has height 1 and z is 0, so anything that divides by a volume of
three dimensions has to divide by an area instead. The last two cells do both, and compare with the run's own values.

The cells between the lines "# %%" run one by one in editors that know them.
"""
# %% Open it. swmr=True reads a file that is still being written, or whose writer was killed.
import os
import sys
import warnings

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

path = sys.argv[1] if len(sys.argv) > 1 else "trajectory.h5"
picture = sys.argv[2] if len(sys.argv) > 2 else path.removesuffix(".h5") + "_read.png"
try:
    file = h5py.File(path, "r", swmr=True)
except OSError:
    sys.exit(f"cannot read {path} as a trajectory; name the file trajectory.h5 of a run")

# %% What is it of?
creator = file["h5md/creator"].attrs
disks = file["particles/disks"]
steps = disks["id/step"][:]  # a frame counts from the moment its step is there
times = disks["id/time"][: len(steps)]
edges = disks["box/edges/value"][0].diagonal()
print(f"{creator['name'].decode()} {creator['version'].decode()}, seed {file['parameters/seed'][0]}")
print(f"{len(steps)} frames from step {steps[0]} to {steps[-1]}, box {edges[0]} x {edges[1]}")
print("its configuration:", file["parameters/configuration"][()].decode().strip().splitlines()[0], "...")

# %% Positions: [frame, disk, x y z]. A disk that left a periodic box is followed by its image.
position = disks["position/value"][: len(steps)]
if "image" in disks:
    position = position + disks["image/value"][: len(steps)] * edges
displacement = np.linalg.norm(position - position[0], axis=2)

# %% Mean displacement against time, and the last frame coloured by displacement.
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5))
left.plot(times, displacement.mean(axis=1), marker=".")
left.set(xlabel="time", ylabel="mean displacement", title="Mean displacement")
last = disks["position/value"][len(steps) - 1]
points = right.scatter(last[:, 0], last[:, 1], c=displacement[-1], s=12)
right.set(aspect="equal", xlim=(0, edges[0]), ylim=(0, edges[1]), title=f"step {steps[-1]}")
figure.colorbar(points, label="displacement")
figure.tight_layout()
figure.savefig(picture, dpi=100)
print("mean displacement at the end:", displacement[-1].mean())
print("picture in", picture)

# %% MDAnalysis reads positions and velocities. It does not read `image`: a transformation adds the crossed edges.
warnings.simplefilter("ignore")
import MDAnalysis
from MDAnalysis.analysis.msd import EinsteinMSD
from MDAnalysis.analysis.rdf import InterRDF

is_periodic = disks["box"].attrs["boundary"][0] == b"periodic"


def opened(*transformations):
    universe = MDAnalysis.Universe.empty(disks["id/value"].shape[1], trajectory=False)
    universe.load_new(path, format="H5MD", convert_units=False)
    universe.trajectory.add_transformations(*transformations)
    return universe


def unwrapped(step):
    step.positions = disks["position/value"][step.frame] + disks["image/value"][step.frame] * edges
    return step


# EinsteinMSD averages over all pairs of frames that are one lag apart. Only the longest lag has one pair, first and
# last frame, and that is the displacement that the run measures.
if "image" in disks:
    msd = EinsteinMSD(opened(unwrapped), select="all", msd_type="xy", fft=False)
    msd.run()
    own = file["observables/mean_squared_displacement/value"][len(steps) - 1]
    print("mean squared displacement by MDAnalysis:", msd.results.timeseries[-1])
    print("mean squared displacement by the run:", own)

# %% g(r) in two dimensions: the pairs of each ring for each one that an ideal gas would have.
# Between walls the rings reach out of the box, which the run's own curve takes into account; so this is for periodic ones.
curve = os.path.join(os.path.dirname(path), "pair_correlation.csv")
if is_periodic and os.path.exists(curve):
    own = np.genfromtxt(curve, delimiter=",", names=True)
    width = own["distance"][1] - own["distance"][0]
    universe = opened()
    rdf = InterRDF(
        universe.atoms,
        universe.atoms,
        nbins=len(own),
        range=(0, len(own) * width),
        norm="none",  # counts of each frame; the other norms divide by the volume of a shell
        exclusion_block=(1, 1),  # no disk is a pair with itself
    )
    rdf.run(start=1)
    count = len(universe.atoms)
    rings = np.pi * np.diff(rdf.results.edges**2)
    ideal = count * (count - 1) / (edges[0] * edges[1]) * rings
    g = rdf.results.count / rdf.n_frames / ideal
    far = own["distance"] > 0.7 * own["distance"][-1]
    print("g(r) far away by MDAnalysis:", g[far].mean())
    print("g(r) far away by the run:", own["pair_correlation"][far].mean())
    print("largest g(r) by MDAnalysis:", g.max())
    print("largest g(r) by the run:", own["pair_correlation"].max())
