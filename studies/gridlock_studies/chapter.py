"""A chapter of the report, and what it is written with."""

from __future__ import annotations

import csv
import dataclasses
import io
import pathlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar, Union

from gridlock import _core

from . import style
from .runs import OutcomeType, PartialResults, RunPool, RunType
from .statistics import Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclasses.dataclass(frozen=True)
class Claim:
    """One statement of the paper beside what was measured."""

    where: str  #: "Figure 5"
    statement: str  #: what the paper says
    measured: str  #: what came out, with errors, and what the verdict rests on
    verdict: Verdict


@dataclasses.dataclass
class Table:
    """A table of the report; cells are texts and verdicts."""

    header: list[str]
    caption: str = ""
    rows: list[Sequence[Union[str, Verdict]]] = dataclasses.field(default_factory=list)


@dataclasses.dataclass(frozen=True)
class Drawing:
    """Pictures that stand side by side, by their names without an ending."""

    names: tuple[str, ...]
    caption: str


@dataclasses.dataclass(frozen=True)
class SetUp:
    """One of the simulations of a chapter, for the playground."""

    name: str  #: what tells it from the others of its group
    settings: Mapping[str, Any]
    group: str = ""  #: "square start"
    colour: str | None = None  #: what its agents are coloured by
    has_grid: bool = False  #: whether the cells are drawn


@dataclasses.dataclass
class Chapter:
    """One section of the report: what was done, the pictures, the claims, the numbers, what follows from them.

    Words between ** are emphasized.
    """

    title: str
    introduction: list[str] = dataclasses.field(default_factory=list)
    drawings: list[Drawing] = dataclasses.field(default_factory=list)
    claims: list[Claim] = dataclasses.field(default_factory=list)
    tables: list[Table] = dataclasses.field(default_factory=list)
    conclusions: list[str] = dataclasses.field(default_factory=list)
    set_ups: list[SetUp] = dataclasses.field(default_factory=list)


class Extent(Protocol):
    """How much a study simulates."""

    @property
    def name(self) -> str:
        """What the report calls it."""


ExtentType = TypeVar("ExtentType", bound=Extent)


class Context(Generic[ExtentType, RunType, OutcomeType]):
    """The settings, the simulations and the directory of a study."""

    def __init__(self, extent: ExtentType, seed: int, path: pathlib.Path, directory: _core.Directory,
                 partial_results: PartialResults, on_drawing: Callable[[str], None]) -> None:
        self.extent = extent
        self.seed = seed  #: of the first run of each replica set
        self.path = path
        self.partial_results = partial_results
        self.runs: RunPool[RunType, OutcomeType] = RunPool(partial_results)
        self.pictures: dict[str, bytes] = {}  #: SVG by name
        self.files: list[pathlib.Path] = []  #: everything written
        self.notes: list[str] = []  #: what went wrong
        self._directory = directory
        self._on_drawing = on_drawing

    def plan(self, runs: Iterable[RunType]) -> None:
        """Notes that these runs are needed."""
        for run in runs:
            self.runs.add(run)

    def write(self, name: str, content: bytes) -> None:
        self._directory.write(name, content)
        self.files.append(self.path / name)

    def write_table(self, name: str, columns: str, rows: Iterable[Sequence[Any]]) -> None:
        """As CSV: words in quotes, numbers with all their digits. The columns are named in one text, with spaces between."""
        text = io.StringIO()
        text.write(",".join(columns.split()) + "\n")
        csv.writer(text, quoting=csv.QUOTE_NONNUMERIC, lineterminator="\n").writerows(rows)
        self.write(name, text.getvalue().encode())

    def draw(self, name: str, figure: Callable[[], Figure]) -> None:
        """Writes a picture as SVG and PNG."""
        self._on_drawing(name)
        for format, content in style.rendered(figure).items():
            self.write(f"{name}.{format}", content)
            if format == "svg":
                self.pictures[name] = content
