#!/usr/bin/env python3
"""One run of `tiled` on ranks of MPI beside the same run on threads, and granular disks of LAMMPS on ranks, in turns; or flocking agents.

    benchmarks/ranks.py [--sides 316 1000] [--rounds 5] [--flocking]

Needs gridlock-mpi and mpirun; LAMMPS (Debian: apt-get install lammps) is left out where it is missing. Writes benchmarks/results/ranks.csv, of
flocking agents ranks_flocking.csv.
Seconds are those that each program says its steps took. Bytes and messages are those of a rank and step, the mean of all ranks: of a run and
one of half the length, so that what is handed out at the start and gathered at the end does not count.
"""

import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

import in_turns
import result_file

# As in lammps.cpp: a disk goes as far in a step as in one of lammps_disks.in.
TIME_STEP_AS_IN_LAMMPS = 0.002

SCENE = """
[disks]
count = {count}
packing_fraction = 0.7
[box]
edge = "periodic"
[engine]
kind = "tiled"
time_step = {time_step}
[run]
steps = {steps}
seed = 20
final_state = false
[observe]
every = {steps}
[checkpoint]
every_seconds = 0
keep_last = false
"""


# Four agents in a square of the radius that they see.
FLOCK = """
[model]
kind = "flocking"
[flocking]
count = {count}
[box]
edge = "periodic"
side = {side}
[run]
steps = {steps}
seed = 20
final_state = false
[observe]
every = {steps}
[checkpoint]
every_seconds = 0
keep_last = false
"""


class Runs:
    """Runs of the programs in a directory of their own."""

    def __init__(self, build, directory):
        self.apps = (build / "apps").resolve()
        self.directory = pathlib.Path(directory)
        self.environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

    def gridlock(self, side, steps, *, ranks=None, threads=1, time_step=0.1, flocks=False):
        """What summary.json says of a run; without ranks one of a single process."""
        scene = self.directory / "scene.toml"
        template = FLOCK if flocks else SCENE
        scene.write_text(template.format(count=side * side, side=side / 2, steps=steps, time_step=time_step))
        program = [str(self.apps / "gridlock/gridlock")]
        if ranks:
            program = ["mpirun", "-n", str(ranks), str(self.apps / "gridlock-mpi/gridlock-mpi")]
        out = self.directory / "out"
        command = [*program, "run", str(scene), "-q", "-j", str(threads), "--overwrite", "-o", str(out)]
        subprocess.run(command, check=True, env=self.environment)
        return json.loads((out / "summary.json").read_text())

    def lammps(self, side, steps, ranks):
        """The seconds of the steps that count."""
        script = result_file.ROOT / "benchmarks/lammps_disks.in"
        variables = {"side": side, "phi": 0.7, "mix": 100, "skin": 0.3, "steps": steps}
        words = [word for name, value in variables.items() for word in ("-var", name, str(value))]
        command = ["mpirun", "-n", str(ranks), "lmp", "-log", "none", "-in", str(script), *words]
        output = subprocess.run(command, check=True, env=self.environment, capture_output=True, text=True).stdout
        return float(re.findall(r"Loop time of (\S+)", output)[-1])


def traffic(summary):
    """Messages and bytes of all ranks."""
    ranks = summary["timing"]["ranks"]
    return [sum(rank[key] for rank in ranks) / len(ranks) for key in ("messages_sent", "bytes_sent")]


def contestants(runs, side, steps, has_lammps, flocks):
    """What is timed, by name; each gives its seconds and the hash of its last state."""

    def of(**how):
        def run():
            summary = runs.gridlock(side, steps, flocks=flocks, **how)
            return summary["timing"]["seconds"], summary["state_hash"]

        return run

    todo = {
        "1 thread": of(),
        "2 threads": of(threads=2),
        "1 rank": of(ranks=1),
        "2 ranks": of(ranks=2),
    }
    if flocks:
        return todo
    todo |= {
        "1 rank, LAMMPS' step": of(ranks=1, time_step=TIME_STEP_AS_IN_LAMMPS),
        "2 ranks, LAMMPS' step": of(ranks=2, time_step=TIME_STEP_AS_IN_LAMMPS),
    }
    if has_lammps:
        todo["LAMMPS, 1 rank"] = lambda: (runs.lammps(side, steps, 1), "")
        todo["LAMMPS, 2 ranks"] = lambda: (runs.lammps(side, steps, 2), "")
    return todo


def race(runs, results, side, rounds, has_lammps, flocks):
    disks = side * side
    steps = max(20, 20_000_000 // disks) if flocks else max(100, 100_000_000 // disks)
    seconds = {}
    hashes = {}
    for _ in range(rounds):
        _, found = in_turns.timed_in_turns(contestants(runs, side, steps, has_lammps, flocks), 1)
        for name, (time, state_hash) in found.items():
            seconds.setdefault(name, []).append(time)
            hashes.setdefault(name, set()).add(state_hash)
    whole = traffic(runs.gridlock(side, steps, ranks=2, flocks=flocks))
    half = traffic(runs.gridlock(side, steps // 2, ranks=2, flocks=flocks))
    of_step = [(one - other) / (steps - steps // 2) for one, other in zip(whole, half)]
    for name, times in seconds.items():
        least = min(times)
        speed_up = min(seconds["1 thread"]) / least
        exchanged = [f"{value:.4g}" for value in of_step] if name == "2 ranks" else ["", ""]
        results.write(
            ",".join(
                [
                    f'"{name}"',
                    str(disks),
                    str(steps),
                    f"{least / steps / disks * 1e9:.2f}",
                    f"{statistics.median(times) / steps / disks * 1e9:.2f}",
                    f"{speed_up:.2f}",
                    *exchanged,
                    "/".join(sorted(hashes[name])),
                ]
            )
        )


def main():
    parser = result_file.parser_of("ranks_flocking" if "--flocking" in sys.argv else "ranks", __doc__)
    parser.add_argument("--sides", nargs="+", type=int, default=[316, 1000], help="of squares of disks")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--flocking", action="store_true", help="agents of the model flocking in place of disks")
    options = parser.parse_args()
    if not shutil.which("mpirun"):
        sys.exit("there is no mpirun: ./dev install mpi")
    has_lammps = shutil.which("lmp") is not None
    results = result_file.ResultFile(options.output, "Open MPI and shared memory; benchmarks/ranks.py", "one core and two")
    results.write("name,disks,steps,ns_min,ns_median,speed_up,messages_of_rank_and_step,bytes_of_rank_and_step,state_hash")
    with tempfile.TemporaryDirectory() as directory:
        for side in options.sides:
            race(Runs(options.build, directory), results, side, options.rounds, has_lammps, options.flocking)


main()
