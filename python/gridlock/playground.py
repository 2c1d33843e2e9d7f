"""Links to the playground: the page in which a set-up runs in the browser."""

from __future__ import annotations

import base64
import os
import pathlib
import shutil
import zlib
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from .settings import assignments

#: The page in one file, which needs no server.
FILE = "playground.html"
#: Where the page is, an address or a file; set but empty: nowhere.
VARIABLE = "GRIDLOCK_PLAYGROUND"


def link(settings: Mapping[str, Any], page: str = FILE, *, colour: str | None = None, grid: bool = False) -> str:
    """The address at which the playground shows a set-up.

    :param settings: as those of a :class:`Simulation`.
    :param page: the address of the page, relative or whole.
    :param colour: what the agents are coloured by, such as "neighbourhood" or "psi6"; None: what is usual for them.
    :param grid: whether the cells of the grid are drawn.

    >>> link({"disks": {"count": 100}}, colour="psi6").partition("#toml=")[0]
    'playground.html'
    """
    text = "\n".join(f"{key} = {value}" for key, value in assignments(settings))
    compressor = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    packed = base64.urlsafe_b64encode(compressor.compress(text.encode()) + compressor.flush()).decode().rstrip("=")
    parts = [f"toml={packed}"]
    if colour is not None:
        parts.append(f"colour={quote(colour)}")
    if grid:
        parts.append("grid=1")
    return f"{page}#{'&'.join(parts)}"


def find_page() -> str | None:
    """The address or the file of the page: what the environment variable ``GRIDLOCK_PLAYGROUND`` says, else the file that was installed
    with the package or with the program, else that of the build tree; None where there is none."""
    if VARIABLE in os.environ:
        return os.environ[VARIABLE] or None
    return next((os.fspath(folder / FILE) for folder in _folders() if (folder / FILE).is_file()), None)


def find_folder() -> str | None:
    """The folder of the page with its files side by side, for servers; None where there is none."""
    return next((os.fspath(folder) for folder in _folders() if (folder / "index.html").is_file()), None)


def _folders() -> list[pathlib.Path]:
    """Where the page may be."""
    above = pathlib.Path(__file__).resolve().parents
    prefixes = [above[4] if len(above) > 4 else above[-1]]  # of PREFIX/lib/pythonX.Y/site-packages/gridlock
    program = shutil.which("gridlock")
    if program is not None:
        prefixes.append(pathlib.Path(program).resolve().parents[1])
    places = [prefix / "share" / "gridlock" / "web" for prefix in prefixes]
    return places + [folder / "build-web" / "page" for folder in above[2:4]]  # of the package in the sources, and in a folder of a build
