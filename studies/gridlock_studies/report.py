"""The report: one page that needs no other file."""

from __future__ import annotations

import base64
import dataclasses
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gridlock import __version__, playground

from .chapter import Chapter, Claim, Context, SetUp, Table
from .statistics import Verdict

if TYPE_CHECKING:
    from markupsafe import Markup


def typeset(text: str) -> Markup:
    """Words between ** as strong, indices and exponents where they belong, everything else as it is.

    >>> str(typeset("**Note:** v_max, φ_J, N^a and N^(1.59 ± 0.06) in figure_7.csv"))
    '<strong>Note:</strong> v<sub>max</sub>, φ<sub>J</sub>, N<sup>a</sup> and N<sup>1.59 ± 0.06</sup> in figure_7.csv'
    """
    from markupsafe import Markup, escape

    written = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", str(escape(text)))
    written = re.sub(r"(?<![\w.])([^\W\d_])_(max|\w)(?!\w)", r"\1<sub>\2</sub>", written)
    written = re.sub(r"(?<=[\w⟩)])\^\(([^()]*(?:\([^()]*\))?[^()]*)\)", r"<sup>\1</sup>", written)
    return Markup(re.sub(r"(?<=[\w⟩)])\^([−+]?[\d.]*\d|\w)", r"<sup>\1</sup>", written))


def _with_values(table: Table) -> Table:
    """The table without columns in which no row has a value."""
    kept = [k for k in range(len(table.header)) if not table.rows or any(row[k] != "–" for row in table.rows)]
    return Table([table.header[k] for k in kept], table.caption, [[row[k] for k in kept] for row in table.rows])


def _number_columns(table: Table) -> list[bool]:
    """Whether all cells of a column read as numbers, perhaps with an error or unit behind them, or say that there is none."""
    def reads_as_number(cell: object) -> bool:
        return isinstance(cell, str) and len(cell) <= 32 and re.match(r"[–+−]?\d|–$|nan$", cell) is not None

    columns = range(len(table.header))
    return [bool(table.rows) and all(reads_as_number(row[column]) for row in table.rows) for column in columns]


def _count(claims: Sequence[Claim], verdict: Verdict) -> int:
    return sum(claim.verdict is verdict for claim in claims)


def _conclusion(claims: Sequence[Claim]) -> str:
    """What a reader is to take away, from the verdicts alone."""
    differing = [f"“{claim.statement}” ({claim.where})" for claim in claims if claim.verdict is Verdict.DIFFERS]
    undecided = _count(claims, Verdict.UNDECIDED)
    text = f"What to conclude: {_count(claims, Verdict.AGREES)} of the {len(claims)} claims tested here hold"
    if undecided:
        text += f", these runs cannot decide {undecided}"
    return f"{text}, and these do not: {' '.join(differing)}" if differing else f"{text}."


@dataclasses.dataclass(frozen=True)
class Texts:
    """What a report says of its study."""

    name: str  #: "the study of the paper"
    title: str
    summary: str  #: whose claims are tested
    claimant: str  #: above them: "the paper says"


def _overview(texts: Texts, claims: Sequence[Claim]) -> Table:
    table = Table(["where", texts.claimant, "verdict"])
    # "Figure 5" stays on one line, however narrow its column.
    table.rows += [[claim.where.replace(" ", "\u00a0"), claim.statement, claim.verdict] for claim in claims]
    return table


def _claim_table(texts: Texts, claims: Sequence[Claim]) -> Table:
    table = Table([texts.claimant, "measured here", "verdict"])
    table.rows += [[claim.statement, claim.measured, claim.verdict] for claim in claims]
    return table


def _links(set_ups: Sequence[SetUp], page: str) -> list[tuple[str, list[tuple[str, str]]]]:
    """The names and addresses of set-ups, by their groups."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for one in set_ups:
        address = playground.link(one.settings, page, colour=one.colour, grid=one.has_grid)
        groups.setdefault(one.group, []).append((one.name, address))
    return list(groups.items())


def html(texts: Texts, context: Context[Any, Any, Any], chapters: Sequence[Chapter], seconds: float, *, is_resumed: bool,
         page: str | None) -> str:
    """The report. ``page`` is the address of the playground, to which it links; None: no links."""
    import jinja2

    claims = [claim for chapter in chapters for claim in chapter.claims]
    made = (f"Extent: {context.extent.name}. Gridlock {__version__}, seed {context.seed}, {seconds:.0f} s"
            f"{' since the last interruption' if is_resumed else ''}. Every plot has its data (.csv) beside it.")
    if len(context.runs):
        made += (f" Each of the {len(context.runs)} simulations is listed in runs.csv with its settings and state hash; gridlock verify "
                 "makes them again.")
    environment = jinja2.Environment(loader=jinja2.PackageLoader("gridlock_studies", "."), autoescape=True, trim_blocks=True,
                                     lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters["typeset"] = typeset
    environment.filters["with_values"] = _with_values
    environment.filters["number_columns"] = _number_columns
    environment.filters["verdict"] = lambda cell: cell if isinstance(cell, Verdict) else None
    return environment.get_template("report.html.jinja").render(
        title=texts.title,
        summary=f"{texts.summary} Verdicts: {_count(claims, Verdict.AGREES)} agree, {_count(claims, Verdict.DIFFERS)} differ, "
        f"{_count(claims, Verdict.UNDECIDED)} undecided.",
        introduction=[made, *([_conclusion(claims)] if claims else [])],
        overview=_overview(texts, claims),
        chapters=[(chapter, _claim_table(texts, chapter.claims), [] if page is None else _links(chapter.set_ups, page))
                  for chapter in chapters],
        notes=context.notes,
        pictures={name: base64.b64encode(svg).decode() for name, svg in context.pictures.items()},
    )
