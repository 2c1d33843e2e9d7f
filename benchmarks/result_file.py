"""What the scripts share that measure Gridlock beside other programs: their common options and the file of results."""

import argparse
import os
import pathlib
import platform
import resource
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def parser_of(script, documentation):
    """A parser with the options of every such script; the results are those of the same name unless --output says otherwise."""
    parser = argparse.ArgumentParser(description=documentation, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build", help="where Gridlock is built")
    parser.add_argument("--core", type=int, help="the core to run on, by taskset")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "benchmarks/results" / f"{script}.csv")
    return parser


def on_core(options):
    """What comes before a command."""
    return [] if options.core is None else ["taskset", "-c", str(options.core)]


def options_of(parser, benchmark):
    """The options of the command line, with the benchmark and the program of the build, and what comes before a command."""
    options = parser.parse_args()
    options.bench = options.build / "benchmarks" / benchmark
    options.program = options.build / "apps/gridlock/gridlock"
    options.pin = on_core(options)
    return options


def first_word(command):
    """The first word that a program prints."""
    return subprocess.run(command, text=True, capture_output=True).stdout.split()[0]


def processor_time(command, directory=None):
    """The seconds of processor time that a command takes on one thread."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=directory, env=os.environ | {"OMP_NUM_THREADS": "1"})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def beside_lammps(options, script):
    """How a script has measured Gridlock beside LAMMPS."""
    return (f"LAMMPS of Debian; {options.rounds} rounds in turns; {os.getloadavg()[0]:.1f} programs at work on {os.cpu_count()} cores at the "
            f"beginning; benchmarks/{script}.py")


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return platform.machine()


class ResultFile:
    """Writes lines to the file of results and to the terminal, each at once; the first says what was measured and how."""

    def __init__(self, path, how, cores="one core"):
        self.file = path.open("w")
        self.write(f"# {processor()}, {cores}; {how}")

    def write(self, line):
        print(line, flush=True)
        print(line, file=self.file, flush=True)
