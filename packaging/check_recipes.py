#!/usr/bin/env python3
"""Compares the recipes of packaging/ with `dev`, whose list of packages is the one that is built from, and with the version.

packaging/dependencies.csv has a row for each Debian package of program_packages, with its name in the other worlds: `-` where that
world needs none, and `source` where it has none, so that the recipe brings the sources. A recipe that lacks a name, or has one more,
is a fault.
"""
import csv
import pathlib
import re
import sys

packaging = pathlib.Path(__file__).resolve().parent
root = packaging.parent


def text_of(path):
    return (root / path).read_text()


def debian_packages():
    """The names in program_packages of dev, without their reasons."""
    lines = re.search(r"^program_packages=\(\n(.*?)^\)", text_of("dev"), re.DOTALL | re.MULTILINE).group(1).splitlines()
    return {name for line in lines for name in line.split("#")[0].split()}


def names_in(recipe, pattern, section=r"(.*)"):
    """All that a pattern finds in a section of a recipe."""
    text = "\n".join(re.findall(section, text_of(recipe), re.DOTALL))
    return set(re.findall(pattern, text, re.MULTILINE))


# The dependencies that each recipe names, and those that its world alone knows.
recipes = {
    "conda": (names_in("packaging/conda/recipe.yaml", r"^    - ([\w-]+)$", r"\nrequirements:(.*?)\ntests:"), set()),
    "spack": (names_in("packaging/spack/spack_repo/gridlock/packages/gridlock/package.py", r'depends_on\("([\w-]+)'), {"cxx", "mpi"}),
    "nix": (names_in("packaging/nix/default.nix", r"^    ([\w-]+)$", r"Inputs = with pkgs; \[(.*?)\]")
            | names_in("packaging/nix/default.nix", r"pkgs\.(dejavu_fonts)"), {"makeWrapper"}),
    "wheel": (names_in("packaging/libraries_for", r"([\w-]+)", r"(?:archives|sources)=\((.*?)\)"),
              {"libpixman-1-dev", "libpng-dev", "libfreetype-dev", "libfontconfig-dev", "libbrotli-dev", "expat"}),  # of Cairo
    "homebrew": (names_in("packaging/homebrew/gridlock.rb", r'^  depends_on "([\w-]+)"'), set()),
}
version_of = {
    "packaging/conda/recipe.yaml": r'^  version: "([\d.]+)"',
    "packaging/spack/spack_repo/gridlock/packages/gridlock/package.py": r'^    version\("([\d.]+)", tag="v\1"\)',
    "packaging/nix/default.nix": r'^  version = "([\d.]+)"',
    "packaging/homebrew/gridlock.rb": r'^  url .*, tag: "v([\d.]+)"',
    "packaging/apptainer/gridlock.def": r"^    Version ([\d.]+)",
    "packaging/debian/changelog": r"\Agridlock \(([\d.]+)-\d+\)",
    "packaging/release_notes.md": r"\A# Gridlock ([\d.]+)",
    ".zenodo.json": r'^  "version": "([\d.]+)"',
}


def find_faults():
    with (packaging / "dependencies.csv").open() as file:
        rows = list(csv.DictReader(file))
    wanted = debian_packages()
    listed = {row["debian"] for row in rows}
    faults = [f"packaging/dependencies.csv has no row for {name}, which dev installs" for name in sorted(wanted - listed)]
    faults += [f"packaging/dependencies.csv has {name}, which dev does not install" for name in sorted(listed - wanted)]
    for world, (named, own) in recipes.items():
        needed = {row[world] for row in rows} - {"-", "source"}
        faults += [f"the recipe for {world} lacks {name}" for name in sorted(needed - named)]
        faults += [f"the recipe for {world} has {name}, which is not in its column" for name in sorted(named - needed - own)]
    control = names_in("packaging/debian/control", r"^ *(?:Build-Depends:|Depends:)? *([\w+.-]+)(?: \([^)]*\))?,?$")
    control |= names_in("packaging/debian/control", r"fonts-dejavu-core")
    faults += [f"packaging/debian/control lacks {name}" for name in sorted(wanted - {"g++", "ccache"} - control)]
    # The container of Apptainer is made as that of Docker.
    dockerfile = text_of("Dockerfile")
    sections = re.findall(r"^%post\n((?:    .*\n)+)", text_of("packaging/apptainer/gridlock.def"), re.MULTILINE)
    made_by = [line.strip() for section in sections for line in section.splitlines() if not line.startswith("    cd ")]
    faults += [f"the Dockerfile has no command {line}, which that of Apptainer has" for line in made_by if line not in dockerfile]
    version = re.search(r"project\(gridlock VERSION ([\d.]+)", text_of("CMakeLists.txt")).group(1)
    for recipe, pattern in version_of.items():
        found = re.search(pattern, text_of(recipe), re.MULTILINE)
        if not found or found.group(1) != version:
            faults.append(f"{recipe} is not for version {version}")
    return faults


if __name__ == "__main__":
    faults = find_faults()
    for fault in faults:
        print(fault, file=sys.stderr)
    sys.exit(1 if faults else 0)
