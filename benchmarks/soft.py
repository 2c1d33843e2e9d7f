#!/usr/bin/env python3
"""Soft disks of the engine `soft` beside LAMMPS, one core, in turns.

    benchmarks/soft.py lmp --core 1

LAMMPS is that of Debian (apt-get install lammps). Both start from a triangular lattice at the same density and temperature, with disks
of diameter, mass and energy 1, and move --mixed steps before what counts. Harmonic disks are gran/hooke without friction and damping;
the others are lj/cut at 2.5. LAMMPS runs with each of --skins, and the quickest is kept; `soft` chooses its own.

Writes benchmarks/results/soft.csv: nanoseconds of processor time a disk and step, of `soft` as the difference of a long and a short
run, and how many times as fast as LAMMPS that is.
"""

import math
import os
import pathlib
import re
import subprocess
import tempfile

import result_file

# Density, temperature and time step of each potential; LAMMPS's style and coefficients.
FLUIDS = {
    "harmonic": (1.0, 0.01, 0.05, "atom_style sphere", "pair_style gran/hooke 1.0 0.0 0.0 0.0 0.0 0", "pair_coeff * *"),
    "lennard_jones": (0.7, 1.0, 0.004, "atom_style atomic", "pair_style lj/cut 2.5\npair_modify shift yes",
                      "pair_coeff 1 1 1.0 1.0 2.5"),
}
FRICTION = 1.0


def gridlock_settings(potential, dynamics, side, n, steps):
    _, temperature, step, *_ = FLUIDS[potential]
    lines = [
        f"box = {{ width = {side[0]!r}, height = {side[1]!r}, edge = 'periodic' }}",
        f"disks = {{ count = {n}, radius = 0.5, start = 'triangular' }}",
        f"velocities = {{ kind = 'maxwell', max = {2 * math.sqrt(temperature)!r} }}",
        f"engine = {{ kind = 'soft', time_step = {step}, threads = 1 }}",
        f"potential.kind = '{potential}'",
        f"run = {{ steps = {steps}, final_state = false }}",
        f"observe = {{ every = {max(steps, 1)}, structure_every = 0 }}",
        "checkpoint = { every_seconds = 0.0, keep_last = false }",
    ]
    if dynamics == "langevin":
        lines.append(f"thermostat = {{ kind = 'langevin', temperature = {temperature}, friction = {FRICTION} }}")
    return "\n".join(lines) + "\n"


def lammps_input(potential, dynamics, side, lattice, skin, mixed, steps):
    _, temperature, step, atoms, pair, coefficients = FLUIDS[potential]
    mass = "set group all diameter 1.0 density 1.9098593171" if potential == "harmonic" else "mass 1 1.0"
    bath = f"fix bath all langevin {temperature} {temperature} {1.0 / FRICTION} 4711" if dynamics == "langevin" else ""
    columns, rows, spacing = lattice
    return f"""units lj
dimension 2
boundary p p p
newton on
{atoms}
comm_modify vel yes
lattice custom {2 / (math.sqrt(3) * spacing * spacing)!r} a1 1 0 0 a2 0 {math.sqrt(3)!r} 0 a3 0 0 1 basis 0 0 0 basis 0.5 0.5 0
region box block 0 {columns} 0 {rows // 2} -0.5 0.5
create_box 1 box
create_atoms 1 box
{mass}
{pair}
{coefficients}
neighbor {skin} bin
neigh_modify delay 0 every 1 check yes
timestep {step}
velocity all create {temperature} 4711
fix move all nve
{bath}
fix flat all enforce2d
thermo 1000000
run {mixed}
run {steps}
"""


def lattice_of(density, count):
    """Columns, rows and spacing of a triangular lattice, and the sides of its box."""
    spacing = math.sqrt(2 / (math.sqrt(3) * density))
    columns = round(math.sqrt(count * math.sqrt(3) / 2))
    rows = 2 * round(count / columns / 2)
    return (columns, rows, spacing), (columns * spacing, rows * spacing * math.sqrt(3) / 2), columns * rows


def time_gridlock(options, directory, settings):
    times = []
    for steps in (options.mixed, options.mixed + options.steps):
        file = directory / "soft.toml"
        file.write_text(gridlock_settings(*settings, steps))
        command = [options.program, "run", file, "-o", directory / "run", "--overwrite", "--no-pictures"]
        times.append(result_file.processor_time(options.pin + command))
    return times[1] - times[0]


def time_lammps(options, directory, text):
    file = directory / "in.soft"
    file.write_text(text)
    done = subprocess.run(options.pin + [options.lmp, "-log", "none", "-in", file], check=True, text=True, capture_output=True,
                          env=os.environ | {"OMP_NUM_THREADS": "1"})
    seconds = float(re.findall(r"Loop time of (\S+)", done.stdout)[-1])
    return seconds * float(re.findall(r"(\S+)% CPU use", done.stdout)[-1]) / 100


def race(options, potential, dynamics, count):
    lattice, side, n = lattice_of(FLUIDS[potential][0], count)
    options.steps = max(options.min_steps, round(options.disk_steps / n))
    names = ["soft"] + [f"LAMMPS skin {skin}" for skin in options.skins]
    least = dict.fromkeys(names, math.inf)
    with tempfile.TemporaryDirectory() as name:
        directory = pathlib.Path(name)
        for _ in range(options.rounds):
            least["soft"] = min(least["soft"], time_gridlock(options, directory, (potential, dynamics, side, n)))
            for skin in options.skins:
                text = lammps_input(potential, dynamics, side, lattice, skin, options.mixed, options.steps)
                least[f"LAMMPS skin {skin}"] = min(least[f"LAMMPS skin {skin}"], time_lammps(options, directory, text))
    baseline = min(names[1:], key=least.get)
    for name in ("soft", baseline):
        nanoseconds = 1e9 * least[name] / (n * options.steps)
        yield f"soft,{name},{potential},{dynamics},{n},{nanoseconds:.1f},{least[baseline] / least[name]:.2f}"


def main():
    parser = result_file.parser_of("soft", __doc__)
    parser.add_argument("lmp", help="the program of LAMMPS")
    parser.add_argument("--disks", nargs="+", type=int, default=[1_000, 10_000, 100_000, 1_000_000])
    parser.add_argument("--potentials", nargs="+", choices=list(FLUIDS), default=list(FLUIDS))
    parser.add_argument("--dynamics", nargs="+", choices=["newton", "langevin"], default=["newton", "langevin"])
    parser.add_argument("--skins", nargs="+", type=float, default=[0.2, 0.3, 0.5])
    parser.add_argument("--mixed", type=int, default=300, help="steps before the start")
    parser.add_argument("--min-steps", type=int, default=50)
    parser.add_argument("--disk-steps", type=float, default=2e7, help="disks times steps of a run")
    parser.add_argument("--rounds", type=int, default=2)
    options = result_file.options_of(parser, "")
    results = result_file.ResultFile(options.output, result_file.beside_lammps(options, "soft"))
    results.write("benchmark,name,potential,dynamics,n,nanoseconds_min,speed_up")
    for potential in options.potentials:
        for dynamics in options.dynamics:
            for count in options.disks:
                for row in race(options, potential, dynamics, count):
                    results.write(row)


main()
