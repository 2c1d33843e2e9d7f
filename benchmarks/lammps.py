#!/usr/bin/env python3
"""The engine `tiled` beside granular disks of LAMMPS (Debian: apt-get install lammps), one core, in turns.

    benchmarks/lammps.py [--sides 32 100] [--core 1]

Runs gridlock_bench_lammps, which says what is compared, and writes benchmarks/results/lammps.csv.
"""

import os
import shutil
import subprocess
import sys

import result_file


def main():
    parser = result_file.parser_of("lammps", __doc__)
    parser.add_argument("--sides", nargs="+", default=["32", "100", "316", "1000"], help="of squares of disks")
    options = parser.parse_args()
    if not shutil.which("lmp"):
        sys.exit("LAMMPS is not installed: apt-get install lammps")
    bench = (options.build / "benchmarks/gridlock_bench_lammps").resolve()
    # Open MPI would choose the core of LAMMPS.
    environment = os.environ | {"OMPI_MCA_hwloc_base_binding_policy": "none"}
    version = subprocess.run(["lmp", "-help"], text=True, capture_output=True, env=environment).stdout
    version = next(line.split(" - ")[1] for line in version.splitlines() if line.startswith("Large-scale"))
    command = result_file.on_core(options) + [str(bench), *options.sides]
    running = subprocess.Popen(command, cwd=result_file.ROOT, env=environment, stdout=subprocess.PIPE, text=True)
    results = result_file.ResultFile(options.output, f"LAMMPS {version}; benchmarks/lammps.py")
    for line in running.stdout:
        results.write(line.rstrip("\n"))
    sys.exit(running.wait())


main()
