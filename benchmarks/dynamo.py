#!/usr/bin/env python3
"""The engine `exact` beside DynamO (Bannerman and others 2011, doi:10.1002/jcc.21915): grains, one core, in turns.

    apt-get install libboost-filesystem-dev libboost-program-options-dev libboost-system-dev libboost-test-dev libbz2-dev libeigen3-dev \
        libjudy-dev
    git clone https://github.com/toastedcrumpets/DynamO
    git -C DynamO checkout 78d4ee1ff621cf40fae0632ae39d5fc48eca6bcc
    git -C DynamO submodule update --init
    benchmarks/dynamo.py DynamO --core 1

The commit is DynamO's last when this was written, of June 2024. It is built in build-dynamo/, without pictures, with -O3 for this
processor. Its disks are spheres in one layer of a box that is four diameters high, its own way to two dimensions (dynamod --pack-mode 0
with one cell in z): they never leave the layer, and it looks for neighbours in the empty layers too.

Both start from one file of `gridlock run`: elastic disks after a hundred collisions each, in a periodic box. Each round runs DynamO to
--before collisions of a disk and, from the same start, to --collisions more: the difference counts, so that reading and writing
files do not. gridlock_bench_exact tells what the same collisions took. The mean kinetic energy at the end is written beside: the
programs simulate the same grains where it agrees, but for chaos.

Writes benchmarks/results/exact_against_dynamo.csv: nanoseconds a collision, of processor time and by the clock. speed_up is the least
processor time of DynamO over the least of the row.
"""

import dataclasses
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

import result_file

WORK = result_file.ROOT / "build-dynamo"
LAYER = 4.0000001  # diameters: the least that DynamO's neighbour list takes


# --- DynamO ------------------------------------------------------------------------------------------------------------

def build_dynamo(dynamo):
    """The folder of its programs."""
    if not (dynamo / "extern/stator/stator").is_dir():
        sys.exit(f"a part of DynamO is missing: git -C {dynamo} submodule update --init")
    build = WORK / "build"
    # Without NDEBUG, which CMake sets by itself, its assertions would be checked.
    configure = ["cmake", "-S", dynamo, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DVISUALIZER_SUPPORT=OFF",
                 "-DCMAKE_CXX_FLAGS_RELEASE=-O3 -march=native -DNDEBUG"]
    if shutil.which("ccache"):
        configure.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", build, "--target", "dynarun", "dynamod", "--parallel", str(os.cpu_count())], check=True)
    return build


# --- The start ---------------------------------------------------------------------------------------------------------

def make_start(options):
    """The path of the start in extended XYZ."""
    side = math.sqrt(options.disks * math.pi / 4 / options.packing_fraction)
    text = f"""run.seed = 1
box = {{ width = {side!r}, height = {side!r}, edge = "periodic" }}
disks = {{ count = {options.disks}, radius = 0.5 }}
velocities = {{ kind = "maxwell", max = 2.0 }}
[[protocol]]
stage = "run"
collisions_per_disk = 100
"""
    name = f"start_{options.packing_fraction}_{options.disks}"
    settings, directory = WORK / f"{name}.toml", WORK / name
    start = directory / "final.xyz"
    if not start.exists() or settings.read_text() != text:
        settings.write_text(text)
        command = [options.program, "run", settings, "-o", directory, "--overwrite", "--no-pictures"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return start


def for_dynamo(start, programs, restitution):
    """The path of the same start as DynamO reads it: its own lattice, and the disks of `start` in place of its own."""
    lines = start.read_text().splitlines()
    lattice = lines[1].split('Lattice="')[1].split('"')[0].split()
    width, height = float(lattice[0]), float(lattice[4])
    disks = [[float(word) for word in line.split()[1:7]] for line in lines[2:]]
    side = math.ceil(math.sqrt(len(disks)))
    path = WORK / f"{start.parent.name}_{restitution}.xml"
    density = len(disks) / (width * height)
    command = [programs / "dynamod", "--pack-mode", "0", "--rectangular-box", "--i1", "2", "-x", side, "-y", side, "-z", 1,
               "-d", density, "--f1", restitution, "-o", path]
    subprocess.run([str(word) for word in command], check=True, capture_output=True)
    document = xml.parse(path)
    size = document.find(".//SimulationSize")
    size.set("x", repr(width))
    size.set("y", repr(height))
    particles = document.find(".//ParticleData")
    for particle in list(particles):
        particles.remove(particle)
    for number, (x, y, _, _, velocity_x, velocity_y) in enumerate(disks):
        particle = xml.SubElement(particles, "Pt", ID=str(number))
        xml.SubElement(particle, "P", x=repr(x - width / 2), y=repr(y - height / 2), z="0")
        xml.SubElement(particle, "V", x=repr(velocity_x), y=repr(velocity_y), z="0")
    document.write(path)
    return path


# --- The race ----------------------------------------------------------------------------------------------------------

@dataclasses.dataclass
class Contestant:
    """The nanoseconds a collision that a program has taken so far, and the kinetic energy of a disk at its end."""

    name: str
    processor: list = dataclasses.field(default_factory=list)
    clock: list = dataclasses.field(default_factory=list)
    kinetic_energy: float = math.nan
    state_hash: str = ""


def timed(command):
    """Seconds of processor time and of the clock."""
    begin = time.perf_counter()
    with subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL) as program:
        _, status, usage = os.wait4(program.pid, 0)
        program.returncode = os.waitstatus_to_exitcode(status)
    if program.returncode != 0:
        sys.exit(f"{command[0]} failed")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - begin


def run_dynamo(options, contestant, config, programs):
    final = WORK / "final.xml"
    data = WORK / "output.xml"
    taken = []
    for collisions in (options.before, options.before + options.collisions):
        command = [programs / "dynarun", config, "-c", collisions * options.disks // 2, "-s", 1, "-p", 10**9, "-o", final,
                   "--out-data-file", data]
        taken.append(timed(options.pin + command))
    events = xml.parse(data).find(".//Duration").get("TwoParticleEvents")
    if int(events) != (options.before + options.collisions) * options.disks // 2:
        sys.exit(f"DynamO made {events} collisions")
    block = options.collisions * options.disks // 2
    contestant.processor.append(1e9 * (taken[1][0] - taken[0][0]) / block)
    contestant.clock.append(1e9 * (taken[1][1] - taken[0][1]) / block)
    velocities = [velocity.attrib for velocity in xml.parse(final).iterfind(".//Pt/V")]
    contestant.kinetic_energy = sum(float(v["x"]) ** 2 + float(v["y"]) ** 2 for v in velocities) / 2 / len(velocities)


def run_gridlock(options, contestant, start, restitution):
    command = options.pin + [options.bench, "--start", start, options.before * options.disks // 2,
                             options.collisions * options.disks // 2, 1, restitution]
    done = subprocess.run([str(word) for word in command], text=True, capture_output=True, check=True)
    found = dict(line.split() for line in done.stdout.splitlines())
    contestant.processor.append(float(found["nanoseconds"]))
    contestant.clock.append(float(found["nanoseconds_by_the_clock"]))
    contestant.kinetic_energy = float(found["kinetic_energy"])
    contestant.state_hash = found["state_hash"]


def race(options, programs, start, restitution):
    config = for_dynamo(start, programs, restitution)
    dynamo, gridlock = Contestant("DynamO"), Contestant("exact")
    for _ in range(options.rounds):
        run_dynamo(options, dynamo, config, programs)
        run_gridlock(options, gridlock, start, restitution)
    for contestant in (dynamo, gridlock):
        speed_up = min(dynamo.processor) / min(contestant.processor)
        yield (f"exact_against_dynamo,{contestant.name},{options.disks},{options.packing_fraction},{restitution},"
               f"{min(contestant.processor):.1f},{statistics.median(contestant.processor):.1f},{min(contestant.clock):.1f},"
               f"{statistics.median(contestant.clock):.1f},{speed_up:.2f},{contestant.kinetic_energy:.4g},{contestant.state_hash}")


def main():
    parser = result_file.parser_of("exact_against_dynamo", __doc__)
    parser.add_argument("dynamo", type=pathlib.Path, help="a clone of DynamO")
    parser.add_argument("--programs", type=pathlib.Path, help="where dynarun and dynamod are, if they are built already")
    parser.add_argument("--disks", type=int, default=10_000)
    parser.add_argument("--packing-fraction", type=float, default=0.3)
    parser.add_argument("--restitutions", nargs="+", type=float, default=[0.95, 0.9])
    parser.add_argument("--before", type=int, default=10, help="collisions of a disk before those that count")
    parser.add_argument("--collisions", type=int, default=40, help="collisions of a disk that count")
    parser.add_argument("--rounds", type=int, default=5)
    options = result_file.options_of(parser, "gridlock_bench_exact")
    WORK.mkdir(exist_ok=True)
    programs = options.programs or build_dynamo(options.dynamo.resolve())
    start = make_start(options)
    load = os.getloadavg()[0]
    commit = result_file.first_word(["git", "-C", options.dynamo, "rev-parse", "--short", "HEAD"])
    compiler = result_file.first_word(["g++", "-dumpfullversion"])
    results = result_file.ResultFile(
        options.output,
        f"DynamO {commit}, g++ {compiler} -O3 -march=native; {options.rounds} rounds in turns; {load:.1f} programs at work on "
        f"{os.cpu_count()} cores at the beginning; benchmarks/dynamo.py")
    results.write("benchmark,name,n,packing_fraction,restitution,nanoseconds_min,nanoseconds_median,clock_min,clock_median,speed_up,"
                  "kinetic_energy,state_hash")
    for restitution in options.restitutions:
        for row in race(options, programs, start, restitution):
            results.write(row)


main()
