"""Opens the contacts of a trajectory with h5py and compares them with those that ``gridlock contacts`` finds."""
import csv
import sys

import h5py

file = h5py.File(sys.argv[1], "r")
group = file["connectivity/contacts"]
rows = list(csv.DictReader(open(sys.argv[2])))
assert len(rows) > 100 and {row["wall"] for row in rows} == {"0"}
assert file[group.attrs["particles_group"]].name == "/particles/disks"
assert group["value"].shape == (1, len(rows), 2) and group["force"].shape == (1, len(rows))
assert set(file["particles/disks/id/value"][0]) >= set(group["value"][0].ravel())
assert [group["step"][0]] == list(file["particles/disks/id/step"]) and [group["time"][0]] == list(file["particles/disks/id/time"])
assert group["force"].attrs["reduced_unit"] == b"energy/length" and group["time"].attrs["reduced_unit"] == b"time"
for row, ids, force in zip(rows, group["value"][0], group["force"][0]):
    assert (int(row["i"]), int(row["j"])) == tuple(ids) and float(row["force"]) == force
print("all agree")
