#!/usr/bin/env python3
"""The engine `exact` beside EDMD (F. Smallenburg 2022, doi:10.1140/epje/s10189-022-00180-8), one core, in turns.

    git clone https://github.com/FSmallenburg/EDMD
    benchmarks/edmd.py EDMD [--sizes 1000 10000] [--rounds 5] [--cases fluid_0.30 …]

EDMD simulates spheres. Its single-event variant, Single/mdSingle.c, is reduced to two dimensions by the edits below, in a
copy in build-edmd/: no third coordinate is stored or computed, the start is a file of Gridlock, and nothing but the time is
written while it runs. It is compiled with its own flags for this processor, for AVX2 and for SSE4; the engine takes the same
instructions by GRIDLOCK_TARGET. Programs that simulate the same disks run one after the other, round by round.

The start is made by Gridlock: positions, velocities and radii are read by both. EDMD's neighbour shell is tuned for each start:
each of --shells runs once, and the quickest is measured. Both compressibility factors are written beside the times: where
they differ, the programs do not simulate the same fluid. Equal disks at a packing fraction of 0.30 have 2.064 (Henderson 1975).

Writes benchmarks/results/exact_against_edmd.csv, in nanoseconds of processor time a collision. speed_up is the least time of
EDMD with the same instructions over the least time of the row.
"""

import dataclasses
import math
import os
import pathlib
import platform
import re
import statistics
import subprocess
import sys

import result_file

WORK = result_file.ROOT / "build-edmd"
COMPILER = os.environ.get("CC", "gcc")
# Which of EDMD's builds a target of Gridlock is compared with.
ARCHITECTURES = {
    "x86_64": {"avx512": "native", "avx2": "x86-64-v3", "sse4": "x86-64-v2", "scalar": "x86-64-v2"},
    "aarch64": {"neon": "native", "scalar": "native"},
}
HENDERSON_AT_30 = (1 + 0.30**2 / 8) / (1 - 0.30) ** 2
COLLISIONS_BEFORE = 5  # of each disk, before the time counts


@dataclasses.dataclass(frozen=True)
class Case:
    """What is simulated."""

    name: str
    packing_fraction: float
    mixture: bool = False
    crystal: bool = False

    @property
    def disks(self):
        return "50:50 of 1:1.4" if self.mixture else "equal"


CASES = [
    Case("fluid_0.30", 0.30),
    Case("fluid_0.70", 0.70),
    Case("crystal_0.85", 0.85, crystal=True),
    Case("mixture_0.70", 0.70, mixture=True),
    Case("mixture_0.80", 0.80, mixture=True),
]


# --- The start ---------------------------------------------------------------------------------------------------------

def settings_of_start(case, n):
    """The settings of a run whose final state is the start; the largest disks get the diameter 1, masses are 1."""
    if case.crystal:
        # A lattice without defects: rows and columns of a box that is nearly square.
        rows = 2 * round(math.sqrt(n / math.sqrt(0.75)) / 2)
        columns = round(n / rows)
        n = rows * columns
        spacing = math.sqrt(math.pi / math.sqrt(12) / case.packing_fraction)
        width, height = columns * spacing, rows * spacing * math.sqrt(0.75)
    else:
        area_of_disks = n * math.pi / 4 * ((1 + 1 / 1.96) / 2 if case.mixture else 1)
        width = height = math.sqrt(area_of_disks / case.packing_fraction)
    species = "[{fraction = 0.5}, {fraction = 0.5, size_ratio = 1.4}]" if case.mixture else "[]"
    # Mixtures do not fit on a lattice at these densities: they grow.
    grow = f'[[protocol]]\nstage = "grow"\nrate = 0.01\nuntil_packing_fraction = {case.packing_fraction}\n'
    return f"""[run]
seed = 1
[box]
edge = "periodic"
width = {width!r}
height = {height!r}
[disks]
count = {n}
packing_fraction = {0.55 if case.mixture else case.packing_fraction}
start = "{"triangular" if case.crystal else "square"}"
species = {species}
[velocities]
kind = "maxwell"
max = 2.0
{grow if case.mixture else ""}
[[protocol]]
stage = "run"
collisions_per_disk = {100 if n < 50_000 else 20}
"""


def make_start(case, n, program):
    """The path of the start, in extended XYZ, in the order of the lattice that it began as."""
    directory = WORK / f"start_{case.name}_{n}"
    start = directory / "final.xyz"
    settings = WORK / f"start_{case.name}_{n}.toml"
    text = settings_of_start(case, n)
    if not start.exists() or settings.read_text() != text:
        start.unlink(missing_ok=True)
        settings.write_text(text)
        command = [program, "run", settings, "-o", directory, "--overwrite", "--no-pictures"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return start


# --- EDMD in two dimensions --------------------------------------------------------------------------------------------

MAIN = r"""
double seconds() {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

/* START COLLISIONS_BEFORE BLOCK REPEATS */
int main(int argc, char** argv) {
    if (argc != 5) return 2;
    inputfilename = argv[1];
    init();
    unsigned int target = atoi(argv[2]), block = atoi(argv[3]), repeat, repeats = atoi(argv[4]);
    while (colcounter < target) step();
    double time_before = simtime, virial_before = dvtot, energy = 0;
    for (repeat = 0; repeat < repeats; repeat++) {
        double begin = seconds();
        target += block;
        while (colcounter < target) step();
        printf("nanoseconds %.17g\n", 1e9 * (seconds() - begin) / block);
    }
    for (int i = 0; i < N; i++)
        energy += particles[i].mass * (particles[i].vx * particles[i].vx + particles[i].vy * particles[i].vy);
    printf("compressibility_factor %.17g\n", 1 - (dvtot - virial_before) / (energy * (simtime - time_before)));
    return 0;
}
"""

LOAD = r"""
/* Extended XYZ as Gridlock writes it. */
void loadparticles() {
    FILE* file = fopen(inputfilename, "r");
    if (!file || fscanf(file, "%d Lattice=\"%lf 0 0 0 %lf %*[^\n]", &N, &xsize, &ysize) != 3) exit(3);
    initparticles(N);
    for (int i = 0; i < N; i++) {
        particle* p = particles + i;
        char kind;
        if (fscanf(file, " %c %lf %lf %*f %*d %lf %lf %*f %lf %lf %*d %*d", &kind, &p->x, &p->y, &p->vx, &p->vy, &p->radius,
                   &p->mass) != 7) exit(3);
        p->type = kind - 'A';
        backinbox(p);
    }
    fclose(file);
}
"""


def function(name):
    """A pattern for the definition of a C function."""
    return rf"(?ms)^\w[\w ]*\*? ?{name}\([^)]*\)[^\n;]*\n\{{.*?^\}}\n"


# What is replaced, and how often it occurs.
EDITS_OF_SOURCE = [
    (r"#include <stdio.h>", "#include <stdio.h>\n#include <time.h>", 1),
    (r"(?m)^#define MAXNEIGH .*$", "", 1),  # given to the compiler, as the shell is
    (r"const double shellsize = [\d.]+;", "const double shellsize = SHELL;", 1),
    (r'char inputfilename\[100\] = "[^"]*";', "char* inputfilename;", 1),
    (function("main"), lambda _: MAIN, 1),
    (function("loadparticles"), lambda _: LOAD, 1),
    *((function(name), "", 1) for name in
      ("printstuff", "fcc", "mygetline", "randommovement", "outputsnapshot", "write", "thermostat", "random_gaussian")),
    # Nothing is written and nobody kicks the disks.
    (r"case 10[01]:\s*\w+\(ev\);\s*break;", "", 2),
    (r"(?s)particle\* writeevent = .*?addevent\(writeevent\);", "", 1),
    (r"(?s)if \(usethermostat\)\s*\{.*?\n    \}", "", 1),
    (r"(?s)if \(initialconfig == 0\).*?randommovement\(\);", "loadparticles();", 1),
    (r"(?m)^\s*printf\(\"Cells.*$", "", 1),
    # Cells of a plane.
    (r"(?m)^\s*for \(cdz .*$", "", 1),
    (r" \+ c\*cx\*cy", "", 1),
    (r"int a, int b, int c\b", "int a, int b", 1),
    (r"cx\*cy\*cz", "cx*cy", 2),
    (r", cdz % cz\)", ")", 1),
    (r" \|\| cellz == (?:0|cz - 1)", "", 2),
    (r", (?:int cellz|cellz|p->z \* iczsize)\)", ")", 5),
    # Sums over three coordinates, and lists of them.
    (r" \+ (?:dv|d)z \* (?:dv|d)z\b", "", 8),
    (r", (?:dz|cdz|dvz = p1->vz|cellz = p1->z \* iczsize|zsize|hz|iczsize|cz)(?=[,;])", "", 8),
    (r"  dz \*= rinv;| hz = 0\.5 \* zsize;", "", 2),
]
EDITS_OF_HEADER = [
    (r"int main\(\);", "", 1),
    (r", (?:z|vz|zn|boxestraveledz);", ";", 4),
    (r"int a, int b, int c\b", "int a, int b", 1),
    (r", int cellz\)", ")", 1),
]
THIRD_COORDINATE = re.compile(r"\b(?:z|vz|zn|dz|dvz|cz|hz|cdz|cellz|zsize|iczsize|boxestraveledz)\b")
OTHER_COORDINATES = re.compile(r"\b(?:x|y|vx|vy|xn|yn|dx|dy|dvx|dvy|cx|cy|hx|hy|cellx|celly|xsize|ysize|boxestraveled[xy])\b")


def edit(text, edits):
    for pattern, replacement, times in edits:
        text, found = re.subn(pattern, replacement, text)
        if found != times:
            sys.exit(f"EDMD is not the version that the edits are for: {found} in place of {times} of {pattern}")
    kept = []
    for line in text.splitlines():
        code = line.split("//")[0]
        if THIRD_COORDINATE.search(code) and not line.lstrip().startswith("*"):
            if OTHER_COORDINATES.search(code):
                sys.exit(f"EDMD is not the version that the edits are for: a third coordinate is left in {line.strip()}")
            continue
        kept.append(line)
    return "\n".join(kept) + "\n"


def reduce_to_two_dimensions(edmd):
    single = edmd / "Single"
    (WORK / "mdSingle.c").write_text(edit((single / "mdSingle.c").read_text(), EDITS_OF_SOURCE))
    (WORK / "mdSingle.h").write_text(edit((single / "mdSingle.h").read_text(), EDITS_OF_HEADER))
    (WORK / "mt19937ar.c").write_text((single / "mt19937ar.c").read_text())


def build_edmd(architecture, shell):
    program = WORK / f"edmd_{architecture}_{shell}"
    # As many neighbours as the shell has room for: a disk that is not needed costs memory.
    most_neighbours = 16 if shell <= 1.6 else 24
    command = [COMPILER, "-w", "-Ofast", "-funroll-loops", f"-march={architecture}", f"-DSHELL={shell}",
               f"-DMAXNEIGH={most_neighbours}", WORK / "mdSingle.c", "-o", program, "-lm"]
    subprocess.run(command, check=True)
    return program


# --- The race ----------------------------------------------------------------------------------------------------------

class Contestant:
    """A program, and what it has measured so far."""

    def __init__(self, name, command, environment=None):
        self.name = name
        self.command = [str(word) for word in command]
        self.environment = environment or {}
        self.nanoseconds = []
        self.compressibility_factor = math.nan
        self.result = "0" * 16

    def run(self):
        """False where the program does not run: too many neighbours in a shell."""
        done = subprocess.run(self.command, env=os.environ | self.environment, text=True, capture_output=True)
        if done.returncode != 0:
            print(f"# {self.name} failed: {(done.stderr or done.stdout).strip()[-200:]}", file=sys.stderr)
            return False
        for line in done.stdout.splitlines():
            word, _, value = line.partition(" ")
            if word == "nanoseconds":
                self.nanoseconds.append(float(value))
            elif word == "compressibility_factor":
                self.compressibility_factor = float(value)
            elif word == "state_hash":
                self.result = value
        return True


def targets_here(program):
    """The instructions that this processor and the build have, with EDMD's build to compare with."""

    def has(target):
        environment = os.environ | {"GRIDLOCK_TARGET": target}
        return subprocess.run([program, "--version"], env=environment, capture_output=True).returncode == 0

    known = ARCHITECTURES.get(platform.machine(), {"scalar": "native"})
    return {target: architecture for target, architecture in known.items() if has(target)}


def race(case, start, n, options, targets):
    block = min(max(2 * n, 200_000), 2_000_000)
    protocol = [start, COLLISIONS_BEFORE * n, block, options.repeats]
    baselines = {}
    for architecture in dict.fromkeys(targets.values()):
        tried = []
        for shell in options.shells:
            candidate = Contestant(f"EDMD -march={architecture} shell {shell}", options.pin + [build_edmd(architecture, shell), *protocol])
            if candidate.run():
                tried.append(candidate)
        baselines[architecture] = min(tried, key=lambda contestant: min(contestant.nanoseconds))
        baselines[architecture].nanoseconds.clear()
    contestants = list(baselines.values())
    contestants += [
        Contestant(f"Gridlock {target}", options.pin + [options.bench, "--start", *protocol], {"GRIDLOCK_TARGET": target})
        for target in targets
    ]
    for _ in range(options.rounds):
        for contestant in contestants:
            if not contestant.run():
                sys.exit(1)
    for contestant in contestants:
        baseline = baselines[targets[contestant.name.split()[1]]] if contestant.name.startswith("Gridlock") else contestant
        times = contestant.nanoseconds
        speed_up = min(baseline.nanoseconds) / min(times)
        yield (f"exact_against_edmd,{contestant.name},{case.disks},{n},{case.packing_fraction:.2f},{min(times):.1f},"
               f"{statistics.median(times):.1f},{speed_up:.2f},{baseline.name},{contestant.compressibility_factor:.4f},"
               f"{contestant.result}")


def main():
    parser = result_file.parser_of("exact_against_edmd", __doc__)
    parser.add_argument("edmd", type=pathlib.Path, help="a clone of EDMD")
    parser.add_argument("--cases", nargs="+", choices=[case.name for case in CASES], default=[case.name for case in CASES])
    parser.add_argument("--sizes", nargs="+", type=int, default=[1000, 10_000, 100_000, 1_000_000])
    parser.add_argument("--shells", nargs="+", type=float, default=[1.3, 1.4, 1.5, 1.7, 2.0, 2.4, 2.8])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--repeats", type=int, default=3, help="blocks of collisions a program measures in a round")
    options = result_file.options_of(parser, "gridlock_bench_exact")
    WORK.mkdir(exist_ok=True)
    reduce_to_two_dimensions(options.edmd)
    targets = targets_here(options.program)
    commit = result_file.first_word(["git", "-C", options.edmd, "rev-parse", "--short", "HEAD"])
    compiler = result_file.first_word([COMPILER, "-dumpfullversion"])
    results = result_file.ResultFile(
        options.output,
        f"EDMD (Smallenburg) {commit}, single-event variant reduced to two dimensions, gcc {compiler} "
        f"-Ofast -funroll-loops; {options.rounds} rounds of {options.repeats} in turns; benchmarks/edmd.py",
    )
    results.write("benchmark,name,disks,n,packing_fraction,nanoseconds_min,nanoseconds_median,speed_up,baseline,"
                  "compressibility_factor,result")
    for case in CASES:
        if case.name not in options.cases:
            continue
        for n in options.sizes:
            start = make_start(case, n, options.program)
            with start.open() as file:
                count = int(file.readline())
            for row in race(case, start, count, options, targets):
                results.write(row)
    if "fluid_0.30" in options.cases:
        print(f"# the compressibility factor of equal disks at 0.30 is {HENDERSON_AT_30:.3f} (Henderson 1975)")


main()
