"""Opens with h5py the trajectories whose writers were stopped, and looks at every frame that list.txt promises."""
import sys

import h5py
import numpy as np

every = int(sys.argv[1])
count = 0
for line in open("list.txt"):
    name, *agents_in_frame = line.split()
    with h5py.File(name, "r", swmr=True) as file:
        (agents,) = file["particles"].values()
        steps = agents["id/step"]
        assert len(steps) >= len(agents_in_frame), (name, len(steps), len(agents_in_frame))
        for k in range(len(agents_in_frame)):
            assert steps[k] == k * every, (name, k, steps[k])
            # A writer that is stopped while it makes room for more agents leaves some datasets wider than others;
            # what the narrower ones lack is of agents that no frame holds yet.
            width = min(agents["id/value"].shape[1], agents["position/value"].shape[1])
            present = agents["id/value"][k][:width] != agents["id/value"].fillvalue
            assert present.sum() == int(agents_in_frame[k]), (name, k, present.sum())
            position = agents["position/value"][k][:width][present]
            assert np.isfinite(position).all() and (position[:, :2] >= 0).all(), (name, k)
            assert (position[:, :2] <= agents["box/edges/value"][k].diagonal()[:2]).all(), (name, k)
    count += 1
print(count, "trajectories read")
