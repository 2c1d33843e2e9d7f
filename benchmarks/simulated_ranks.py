#!/usr/bin/env python3
"""How `tiled` would scale on a cluster of up to 256 nodes, by simulation (Debian: apt-get install libsimgrid-dev).

    benchmarks/simulated_ranks.py [--most-ranks 64] [--steps 40]

The engine runs as it is, and every message is sent: SimGrid's SMPI says how long that would take on a fat tree of 100 Gbit/s
(benchmarks/simulated/fat_tree.xml). What a rank computes takes as long as it did on a core: nanoseconds of a turn, and of a byte that is packed or
read, from two ranks on one machine (benchmarks/ranks.py). Builds in --build; writes benchmarks/results/simulated_ranks.csv. 64 ranks of 10⁶ disks take
13 GB and a quarter of an hour. 256 of them would take 50 GB, so these are modelled: 256 ranks of 10⁵ disks of which each counts as ten, in turns and, in its side of a rectangle,
in bytes, and the balance of the tiles of the whole system in the place of that of the small one.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile

import result_file

SIMULATED = result_file.ROOT / "benchmarks/simulated"
NANOSECONDS_OF_TURN = 40.0
NANOSECONDS_OF_BYTE = 0.6

# For the formula: 1 µs a link, two or four links, and 12.5 bytes a nanosecond.
SECONDS_OF_MESSAGE = 4e-6
SECONDS_OF_BYTE = 1 / 12.5e9

# What is simulated; of 10⁶ disks a rank fewer steps, which are all alike.
STEPS_OF_MANY = 12
MOST_DISKS = 100_000_000


def program_in(build):
    """The library as code that a shared object may have, since SMPI loads the program once for each rank; and the program."""
    configure = ["cmake", "-S", str(result_file.ROOT), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"]
    options = ["-DCMAKE_POSITION_INDEPENDENT_CODE=ON", "-DGRIDLOCK_MPI=OFF", "-DGRIDLOCK_PYTHON=OFF"]
    subprocess.run(configure + options, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", str(build), "gridlock"], check=True, stdout=subprocess.DEVNULL)
    program = build / "gridlock_bench_simulated_ranks"
    sources = [SIMULATED / "ranks.cpp", result_file.ROOT / "apps/gridlock-mpi/mpi_ranks.cpp"]
    folders = [f"-I{result_file.ROOT / folder}" for folder in ("include", "src", "apps")]
    libraries = [build / "src/libgridlock.a", build / "src/grid/libgridlock_grid.a", "-lfmt", "-ltbb", "-lxxhash", "-lz"]
    compile_it = ["smpicxx", "-std=c++20", "-O3", "-ffp-contract=off", *folders, *sources, *libraries, "-o", program]
    subprocess.run(list(map(str, compile_it)), check=True)
    return program


def smpirun(program, arguments, ranks, disks_of_disk=1):
    """The words of the line that the program prints. The links are as fast as it needs for a disk to count as so many."""
    platform = (SIMULATED / "fat_tree.xml").read_text()
    platform = platform.replace('bw="12.5GBps"', f'bw="{12.5 / disks_of_disk**0.5}GBps"')
    with tempfile.TemporaryDirectory() as directory:
        hosts = pathlib.Path(directory) / "hosts"
        hosts.write_text("".join(f"node-{rank}\n" for rank in range(ranks)))
        cluster = pathlib.Path(directory) / "fat_tree.xml"
        cluster.write_text(platform)
        command = ["smpirun", "-np", str(ranks), "-platform", str(cluster), "-hostfile", str(hosts)]
        # Computing is told, not measured; to look for a message, or whether one has left, takes no tenth of a millisecond, as it would otherwise;
        # collective messages as Open MPI sends them.
        options = ["smpi/host-speed:10Gf", "smpi/simulate-computation:no", "smpi/iprobe:1e-7", "smpi/test:1e-7"]
        options += ["smpi/coll-selector:ompi"]
        command += [f"--cfg={option}" for option in options] + ["--log=root.thresh:warning", str(program)]
        command += [str(value) for value in arguments]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip().split(",")


def simulate(program, ranks, disks, steps, disks_of_disk=1):
    """Simulated seconds of a step, and the hash of the last state."""
    costs = [NANOSECONDS_OF_TURN * disks_of_disk, NANOSECONDS_OF_BYTE * disks_of_disk**0.5]
    words = smpirun(program, [disks, steps, *costs], ranks, disks_of_disk)
    return float(words[2]), words[-1]


def balance(program, disks, ranks):
    """The mean number of disks of a rank, as a share of the largest one."""
    return float(smpirun(program, [disks, ranks], 1)[0])


def modelled(program, ranks, disks, steps):
    """Seconds of a step of a system of which each disk counts as ten of the real one."""
    few = disks // 10
    seconds, _ = simulate(program, ranks, few, steps, disks_of_disk=10)
    return seconds * balance(program, few, ranks) / balance(program, disks, ranks)


def bytes_of_step(disks):
    """Of a rank of so many disks in a square: four sides of a row of cells of 1.8 disks each 1.34 diameters wide, and what its neighbours change in it."""
    cells_of_side = disks**0.5 / 1.34
    return 4 * cells_of_side * 1.8 * 65 * 1.3


def by_formula(disks):
    """Seconds of a step: turns, packing on both sides, messages of five exchanges one after the other."""
    exchanged = bytes_of_step(disks)
    packing = 2 * exchanged * NANOSECONDS_OF_BYTE * 1e-9
    return disks * NANOSECONDS_OF_TURN * 1e-9 + packing + 5 * SECONDS_OF_MESSAGE + exchanged * SECONDS_OF_BYTE


def main():
    parser = result_file.parser_of("simulated_ranks", __doc__)
    parser.set_defaults(build=result_file.ROOT / "build-simulated")
    parser.add_argument("--most-ranks", type=int, default=256)
    parser.add_argument("--steps", type=int, default=40)
    options = parser.parse_args()
    if not shutil.which("smpirun"):
        sys.exit("there is no smpirun: apt-get install libsimgrid-dev")
    program = program_in(pathlib.Path(options.build).resolve())
    results = result_file.ResultFile(options.output, "simulated: SimGrid's SMPI, a fat tree; benchmarks/simulated_ranks.py")
    results.write("scaling,ranks,disks,disks_of_rank,milliseconds_of_step,efficiency,balance,efficiency_by_formula,how,state_hash")
    systems = [("weak", ranks, 100_000 * ranks) for ranks in (4, 16, 64, 256)]
    systems += [("weak", ranks, 1_000_000 * ranks) for ranks in (4, 16, 64, 256)]
    systems += [("strong", ranks, 6_400_000) for ranks in (4, 16, 64, 256)]
    for scaling, ranks, disks in systems:
        if ranks > options.most_ranks:
            continue
        steps = options.steps if disks < 1_000_000 * ranks else min(options.steps, STEPS_OF_MANY)
        if disks > MOST_DISKS:
            how, seconds, state_hash = "modelled", modelled(program, ranks, disks, steps), ""
        else:
            how = "simulated"
            seconds, state_hash = simulate(program, ranks, disks, steps)
        turns = disks / ranks * NANOSECONDS_OF_TURN * 1e-9
        formula = turns / by_formula(disks / ranks)
        results.write(
            f"{scaling},{ranks},{disks},{disks // ranks},{seconds * 1e3:.4g},{turns / seconds:.3f},"
            f"{balance(program, disks, ranks):.3f},{formula:.3f},{how},{state_hash}"
        )


main()
