"""Opens a trajectory and its exports with the programs they are meant for, and compares them with each other."""
import csv
import sys
import warnings

import ase.io
import h5py
import numpy as np
import vtk

warnings.simplefilter("ignore")
import MDAnalysis  # noqa: E402

directory, frames = sys.argv[1], int(sys.argv[2])
file = h5py.File(f"{directory}/trajectory.h5", "r")
disks = file["particles/disks"]
position = disks["position/value"]
velocity = disks["velocity/value"]
assert list(file["h5md"].attrs["version"]) == [1, 1]
assert len(disks["id/step"]) == frames and position.shape[0] == frames
assert (position[:, :, 2] == 0).all()
assert position.compression == "gzip" and position.chunks[0] == 1
assert disks["position/step"].id == disks["id/step"].id or (disks["position/step"][:] == disks["id/step"][:]).all()

universe = MDAnalysis.Universe.empty(position.shape[1], trajectory=False)
universe.load_new(f"{directory}/trajectory.h5", format="H5MD", convert_units=False)
assert universe.trajectory.n_frames == frames
for k, step in enumerate(universe.trajectory):
    assert step.time == disks["id/time"][k] and step.data["step"] == disks["id/step"][k]
    np.testing.assert_array_equal(step.positions, position[k].astype(np.float32))
    np.testing.assert_array_equal(step.velocities, velocity[k].astype(np.float32))
    np.testing.assert_allclose(step.dimensions[:3], disks["box/edges/value"][k].diagonal())

atoms = ase.io.read(f"{directory}/trajectory.xyz", index=":")
assert len(atoms) == frames
for k, frame in enumerate(atoms):
    np.testing.assert_array_equal(frame.positions, position[k])
    np.testing.assert_allclose(frame.get_velocities(), velocity[k], rtol=1e-14)
    np.testing.assert_array_equal(frame.get_masses(), disks["mass/value"][k])
    assert set(frame.arrays["type"]) == set("ABC"[: len(set(disks["radius/value"][k]))])
    assert frame.get_volume() == np.prod(disks["box/edges/value"][k].diagonal())
    assert frame.info["step"] == disks["id/step"][k]

for k, number in enumerate(disks["id/step"][:]):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(f"{directory}/trajectory/step_{number:010d}.vtp")
    reader.Update()
    data = reader.GetOutput()
    assert data.GetNumberOfPoints() == data.GetNumberOfVerts() == position.shape[1]
    for i in range(0, position.shape[1], 7):
        assert data.GetPoint(i) == tuple(position[k, i])
        assert data.GetPointData().GetArray("velocity").GetTuple(i) == tuple(velocity[k, i])
        assert data.GetPointData().GetArray("radius").GetValue(i) == disks["radius/value"][k, i]
    assert data.GetFieldData().GetArray("TimeValue").GetValue(0) == disks["id/time"][k]

rows = list(csv.DictReader(open(f"{directory}/trajectory.csv")))
assert len(rows) == frames * position.shape[1]
assert float(rows[-1]["x"]) == position[-1, -1, 0] and int(rows[-1]["step"]) == disks["id/step"][frames - 1]
print("all agree")
