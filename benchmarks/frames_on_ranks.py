#!/usr/bin/env python3
"""Frames of disks that ranks share: handed to one writer in pieces, as gridlock-mpi does, beside the parallel HDF5, in turns.

    benchmarks/frames_on_ranks.py [--disks 1000000] [--ranks 2] [--frames 8] [--rounds 3]

Needs gridlock-mpi, mpirun and the parallel HDF5 (Debian: apt-get install libhdf5-openmpi-dev). Writes benchmarks/results/frames_on_ranks.csv.
Both write Ids, positions and velocities of all disks in the same chunks, deflated at level 1 or not at all. The seconds of a frame of gridlock-mpi are those
of a run with frames less those of the same run without, over the number of frames.
"""

import json
import math
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile

import result_file

SETTINGS = """
[disks]
count = {count}
packing_fraction = 0.7
[box]
edge = "periodic"
[engine]
kind = "tiled"
[run]
steps = {steps}
final_state = false
[observe]
every = {steps}
[checkpoint]
every_seconds = 0
keep_last = false
"""
FRAMES = """
[trajectory]
every = 1
columns = "x y velocity_x velocity_y"
compression = {compression}
"""


def parallel_program(folder):
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "hdf5-openmpi"], text=True, capture_output=True)
    if flags.returncode != 0:
        sys.exit("the parallel HDF5 is not installed: apt-get install libhdf5-openmpi-dev")
    program = pathlib.Path(folder) / "parallel_hdf5"
    source = result_file.ROOT / "benchmarks/parallel_hdf5.cpp"
    subprocess.run(["mpicxx", "-std=c++20", "-O2", source, "-o", program, *shlex.split(flags.stdout)], check=True)
    return program


def mpirun(ranks):
    return ["mpirun", "--oversubscribe", "-n", str(ranks)]


def seconds_of_parallel(program, folder, options, compression):
    file = pathlib.Path(folder) / "frames.h5"
    command = [*mpirun(options.ranks), program, file, options.disks, options.frames, compression]
    output = subprocess.run(list(map(str, command)), check=True, text=True, capture_output=True).stdout
    file.unlink()
    return float(output)


def seconds_of_run(folder, options, frames):
    """Of the steps and what is written meanwhile, as the program says."""
    folder = pathlib.Path(folder)
    settings = folder / "settings.toml"
    settings.write_text(SETTINGS.format(count=options.disks, steps=options.frames - 1) + frames)
    program = options.build / "apps/gridlock-mpi/gridlock-mpi"
    command = [*mpirun(options.ranks), program, "run", settings, "-o", folder / "run", "--overwrite", "--no-pictures"]
    subprocess.run(list(map(str, command)), check=True, capture_output=True)
    return json.loads((folder / "run/summary.json").read_text())["timing"]["seconds"]


def main():
    parser = result_file.parser_of("frames_on_ranks", __doc__)
    parser.add_argument("--disks", type=int, default=1_000_000)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    results = result_file.ResultFile(options.output, "HDF5 1.10; benchmarks/frames_on_ranks.py", f"{options.ranks} ranks")
    results.write("benchmark,name,ranks,disks,compression,seconds_min,seconds_median,speed_up")
    with tempfile.TemporaryDirectory(dir=options.build) as folder:
        program = parallel_program(folder)
        for compression in (0, 1):
            parallel, pieces = [], []
            for _ in range(options.rounds):
                parallel.append(seconds_of_parallel(program, folder, options, compression))
                without = seconds_of_run(folder, options, "")
                frames = seconds_of_run(folder, options, FRAMES.format(compression=compression))
                pieces.append((frames - without) / options.frames)
            for name, seconds in (("the parallel HDF5", parallel), ("pieces to one writer", pieces)):
                speed_up = min(parallel) / min(seconds) if min(seconds) > 0.0 else math.nan
                results.write(f"frames_on_ranks,{name},{options.ranks},{options.disks},{compression},{min(seconds):.4f},"
                              f"{statistics.median(seconds):.4f},{speed_up:.2f}")


main()
