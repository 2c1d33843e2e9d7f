#!/usr/bin/env python3
"""Puts a built site beside those of other versions, and writes what a choice between them needs.

    docs/versions.py SITE            the list of the folders of SITE, and the page that leads to the newest release
    docs/versions.py SITE NAME HTML  the same, after the folder HTML has become the version NAME

SITE/versions.json names the versions, releases first, the newest at their head; SITE/index.html leads to the first.
"""
import json
import pathlib
import re
import shutil
import sys


def order(name):
    """Releases by their numbers, the newest first, and a candidate behind its release; then other names."""
    numbers = re.fullmatch(r"v(\d+)\.(\d+)\.(\d+)(.*)", name)
    return (0, *(-int(one) for one in numbers.groups()[:3]), numbers[4] != "", name) if numbers else (1, 0, 0, 0, False, name)


def versions(site):
    return sorted((folder.parent.name for folder in site.glob("*/index.html")), key=order)


def write(site):
    names = versions(site)
    if not names:
        sys.exit(f"{site} has no folder of a version with an index.html")
    (site / "versions.json").write_text(json.dumps(names) + "\n")
    (site / "index.html").write_text(f'<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<title>Gridlock</title>\n'
                                     f'<meta http-equiv="refresh" content="0; url={names[0]}/index.html">\n'
                                     f'<p><a href="{names[0]}/index.html">Gridlock {names[0]}</a>\n</html>\n')
    (site / ".nojekyll").touch()  # GitHub leaves out folders that begin with _ without it


def main():
    if len(sys.argv) not in (2, 4):
        sys.exit(__doc__)
    site = pathlib.Path(sys.argv[1])
    site.mkdir(parents=True, exist_ok=True)
    if len(sys.argv) == 4:
        name, built = sys.argv[2], pathlib.Path(sys.argv[3])
        if not re.fullmatch(r"[A-Za-z0-9][\w.-]*", name):
            sys.exit(f"{name} cannot be the folder of a version: letters, digits, points and hyphens can")
        shutil.rmtree(site / name, ignore_errors=True)
        shutil.copytree(built, site / name)
    write(site)


if __name__ == "__main__":
    main()
