#!/usr/bin/env python3
"""Read a trajectory of Gridlock with h5py and draw it with matplotlib.

    gridlock run scenes/paper.toml --set run.steps=2000 --set trajectory.every=100 -o results/first
    python3 examples/read_trajectory.py results/first/trajectory.h5

The cells between the lines "# %%" run one by one in editors that know them.
"""
# %% Open it. swmr=True reads a file that is still being written, or whose writer was killed.
import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

path = sys.argv[1] if len(sys.argv) > 1 else "trajectory.h5"
picture = sys.argv[2] if len(sys.argv) > 2 else path.removesuffix(".h5") + "_read.png"
file = h5py.File(path, "r", swmr=True)

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
