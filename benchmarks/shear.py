#!/usr/bin/env python3
"""Quasi-static shear of soft disks beside LAMMPS, one core, in turns.

    benchmarks/shear.py lmp --core 1

LAMMPS is that of Debian (apt-get install lammps). Both shear the same packing of disks 1 : 1.4 in steps of 1e-3 and find the minimum after
each, to a largest force of 1e-10 of the mean contact force: LAMMPS by change_box and min_style fire, which it does with every --time-steps,
and the quickest is kept. Gridlock does not bisect drops here. The disks of LAMMPS are gran/hooke without friction, so all contacts are as
stiff as those of two small disks. What counts is a long run less one of a single step.

Writes benchmarks/results/shear.csv: milliseconds of processor time a step, and how many times as fast as LAMMPS that is.
"""

import math
import pathlib
import re
import tempfile

import result_file

START = """
box.edge = "periodic"
disks.count = {count}
disks.packing_fraction = 0.5
disks.start = "uniform"
disks.species = [{{ fraction = 0.5 }}, {{ fraction = 0.5, size_ratio = 1.4 }}]
protocol = [{{ stage = "quench", packing_fraction = {phi} }}]
soft.residual = 1e-10
run.seed = {seed}
"""
SHEAR = """
disks = {{ start = "file", file = "start/final.xyz" }}
protocol = [{{ stage = "shear", until_strain = {strain}, strain_step = 1e-3, strain_accuracy = 1e-3 }}]
soft.residual = 1e-10
"""
LAMMPS = """units lj
dimension 2
boundary p p p
atom_style sphere
newton on
comm_modify vel yes
read_data start.data
pair_style gran/hooke 1.0 0.0 0.0 0.0 0.0 0
pair_coeff * *
neighbor {skin} bin
neigh_modify delay 0 every 1 check yes
timestep {time_step}
fix flat all enforce2d
min_style fire
min_modify norm max
thermo 1000000
minimize 0 {force} 1000000 10000000
variable dx equal 1e-3*ly
label shear
variable step loop {steps}
change_box all xy delta ${{dx}} remap units box
minimize 0 {force} 1000000 10000000
next step
jump SELF shear
"""


def write_data(packing, data):
    """The packing as LAMMPS reads it, in diameters of the small disks."""
    count, head, *rows = packing.read_text().splitlines()
    lattice = [float(word) for word in re.search(r'Lattice="([^"]*)"', head)[1].split()]
    words = re.search(r"Properties=(\S+)", head)[1].split(":")
    place = dict()
    column = 0
    for name, width in zip(words[::3], words[2::3]):
        place[name] = column
        column += int(width)
    rows = [row.split() for row in rows]
    unit = 2 * min(float(row[place["radius"]]) for row in rows)
    with data.open("w") as file:
        file.write(f"sheared disks\n\n{count} atoms\n2 atom types\n0 {lattice[0] / unit!r} xlo xhi\n0 {lattice[4] / unit!r} ylo yhi\n")
        file.write("-0.5 0.5 zlo zhi\n0 0 0 xy xz yz\n\nAtoms # sphere\n\n")
        for k, row in enumerate(rows, 1):
            diameter = 2 * float(row[place["radius"]]) / unit
            x, y = (float(row[place["pos"] + axis]) / unit for axis in (0, 1))
            density = 6 / math.pi / diameter**3  # a mass of 1
            file.write(f"{k} {1 if diameter < 1.2 else 2} {diameter!r} {density!r} {x!r} {y!r} 0\n")


def main():
    parser = result_file.parser_of("shear", __doc__)
    parser.add_argument("lmp", help="the program of LAMMPS")
    parser.add_argument("--count", type=int, default=1024)
    parser.add_argument("--phi", type=float, default=0.86)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--skin", type=float, default=0.1)
    parser.add_argument("--force", type=float, default=1e-12, help="largest force at a minimum of LAMMPS, in ε/D")
    parser.add_argument("--time-steps", nargs="+", type=float, default=[0.05, 0.1, 0.2])
    parser.add_argument("--rounds", type=int, default=2)
    options = result_file.options_of(parser, "")
    results = result_file.ResultFile(options.output, result_file.beside_lammps(options, "shear"))
    results.write("benchmark,name,n,milliseconds_min,speed_up")
    program = pathlib.Path(options.program).resolve()
    with tempfile.TemporaryDirectory() as name:
        directory = pathlib.Path(name)
        run = [program, "run", "--overwrite", "--no-pictures", "--threads", "1"]
        (directory / "start.toml").write_text(START.format(count=options.count, phi=options.phi, seed=options.seed))
        result_file.processor_time(run + ["start.toml", "-o", "start"], directory)
        write_data(directory / "start" / "final.xyz", directory / "start.data")
        commands = {"shear": []} | {f"LAMMPS step {time_step}": [] for time_step in options.time_steps}
        for steps in (1, 1 + options.steps):
            (directory / f"shear{steps}.toml").write_text(SHEAR.format(strain=1e-3 * steps))
            commands["shear"].append(run + [f"shear{steps}.toml", "-o", "shear"])
            for time_step in options.time_steps:
                text = LAMMPS.format(skin=options.skin, time_step=time_step, force=options.force, steps=steps)
                (directory / f"in.{time_step}.{steps}").write_text(text)
                commands[f"LAMMPS step {time_step}"].append([options.lmp, "-log", "none", "-in", f"in.{time_step}.{steps}"])
        least = dict.fromkeys(commands, math.inf)
        for _ in range(options.rounds):
            for each, (short, long) in commands.items():
                seconds = [result_file.processor_time(options.pin + command, directory) for command in (short, long)]
                least[each] = min(least[each], seconds[1] - seconds[0])
    baseline = min(list(commands)[1:], key=least.get)
    for each in ("shear", baseline):
        results.write(f"shear,{each},{options.count},{1e3 * least[each] / options.steps:.1f},{least[baseline] / least[each]:.2f}")


main()
