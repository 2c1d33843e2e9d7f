"""Adds to a repaired wheel the licences of the libraries that came into it: ./dev wheel calls it on Debian.

    python licences_of_libraries.py WHEEL DIRECTORY

writes the wheel with them into the directory. A library in gridlock.libs is that of a Debian package, whose file "copyright" goes to
gridlock.libs/licenses, with the licences of /usr/share/common-licenses that it refers to.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

from auditwheel.wheeltools import InWheelCtx

COMMON = pathlib.Path("/usr/share/common-licenses")


def original_name(library: str) -> str:
    """What the system calls a library that auditwheel has renamed.

    >>> original_name("libhdf5_serial-0f1e2d3c.so.103.2.0"), original_name("libldap-2-062bb940.5.so.0.1.8")
    ('libhdf5_serial.so.103.2.0', 'libldap-2.5.so.0.1.8')
    """
    return re.sub(r"-[0-9a-f]{8}(?=\.)", "", library, count=1)


def package_of(library: str) -> str:
    """The Debian package that has a library."""
    found = subprocess.run(["dpkg-query", "--search", f"*/{library}"], capture_output=True, text=True, check=False)
    if found.returncode != 0:
        raise SystemExit(f"no Debian package has {library}, so that its licence is not known")
    return found.stdout.split(":")[0]


def packages_of(wheel: pathlib.Path) -> list[str]:
    """The Debian packages whose libraries are in a wheel."""
    with zipfile.ZipFile(wheel) as file:
        libraries = [pathlib.PurePath(name) for name in file.namelist()]
    return sorted({package_of(original_name(path.name)) for path in libraries if path.parent.name == "gridlock.libs"})


def add_licences(licences: pathlib.Path, packages: list[str]) -> None:
    """The copyright file of each package, and what these refer to."""
    licences.mkdir()
    for package in packages:
        text = pathlib.Path(f"/usr/share/doc/{package}/copyright").read_text(encoding="utf-8", errors="replace")
        (licences / f"{package}.txt").write_text(text, encoding="utf-8")
        for name in re.findall(r"common-licenses/([A-Za-z]+(?:-[0-9.]*[0-9])?)", text):
            if (COMMON / name).is_file():
                shutil.copyfile(COMMON / name, licences / name)


def main(wheel: str, directory: str) -> None:
    """Reads a wheel and writes another of the same name."""
    source = pathlib.Path(wheel)
    packages = packages_of(source)
    with InWheelCtx(source, pathlib.Path(directory) / source.name) as context:
        add_licences(context.path / "gridlock.libs" / "licenses", packages)


if __name__ == "__main__":
    main(*sys.argv[1:])
