"""What a page needs to know of a simulation: its settings as controls, its columns and its charts."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from .arrays import in_short
from .changes import latest, setting_that_may_change
from .errors import Error
from .files import settings_in
from .models import registered_models

if TYPE_CHECKING:
    from .models import Model
    from .simulation import Simulation


class Control(NamedTuple):
    """A setting as :func:`gridlock.explain` describes it; None for a bound that it does not have."""

    key: str
    kind: str
    unit: str
    documentation: str
    least: float | None
    most: float | None
    leastIsAllowed: bool
    mostIsAllowed: bool
    choices: list[str]

    def read(self, text: str) -> Any:
        """The value that a text means. Errors: Error."""
        if self.kind == "switch" and text in ("true", "false"):
            return text == "true"
        if self.kind in ("text", "choice"):
            return text
        try:
            return int(text) if self.kind == "integer" else float(text)
        except ValueError:
            wanted = {"switch": "true or false", "integer": "a whole number"}.get(self.kind, "a number")
            raise Error(f"{self.key} is {in_short(text)}\n  hint: use {wanted}") from None


#: Lists of tables: their settings have no control.
_LISTS = ("protocol.", "walls.", "disks.species.")
_KINDS = {"number": "number", "whole number": "integer", "true or false": "switch", "text": "text"}


def controls() -> list[Control]:
    """All settings but those of lists of tables and those that are lists of numbers."""
    return _controls(tuple(registered_models()))


@functools.lru_cache(maxsize=8)
def _controls(models: tuple[type[Model], ...]) -> list[Control]:
    # Settings are described anew where there are other models.
    described = (_control(key) for key in _core.setting_keys() if not key.startswith(_LISTS))
    return [control for control in described if control.kind != "numbers"]


def _control(key: str) -> Control:
    lines = [line.strip() for line in _core.explain(key).splitlines()[1:3]]
    documentation = "" if "; default:" in lines[0] else lines.pop(0)
    kind = lines[0].partition("; default:")[0]
    choices = re.findall(r'"([^"]*)"', kind) if kind.startswith("one of ") else []
    least, most = re.search(r"(at least|above) (\S+?)(?= and|$)", kind), re.search(r"(at most|below) (\S+)$", kind)
    unit = re.search(r", in (.*?)(?=, (?:at least|above|at most|below) |$)", kind)
    return Control(
        key, "choice" if choices else _KINDS.get(kind.split(",")[0], "numbers"), unit[1] if unit else "", documentation,
        float(least[2]) if least else None, float(most[2]) if most else None,
        least is None or least[1] == "at least", most is None or most[1] == "at most", choices,
    )


def flat(tables: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested tables as values by dotted keys.

    >>> flat({"disks": {"count": 100}})
    {'disks.count': 100}
    """
    found: dict[str, Any] = {}
    for name, value in tables.items():
        found.update(flat(value, f"{prefix}{name}.") if isinstance(value, Mapping) else {f"{prefix}{name}": value})
    return found


def description(simulation: Simulation, settings: Sequence[Control]) -> dict[str, Any]:
    """All that a page has to know of a run before its first frame."""
    core = simulation._core
    kind = core.model()
    model = next((one for one in registered_models() if one.name == kind), None)
    quantities = [column._asdict() for column in simulation.columns]
    return {
        "version": _core.version,
        "name": kind,
        "documentation": (inspect.getdoc(model) or "").split("\n\n")[0] if model is not None and model.__doc__ else "",
        "agents": "disks" if kind == "disks" else "agents",
        "columns": core.column_names(),
        "valueNames": {name: names for name in core.column_names() if (names := core.value_names(name))},
        "fields": list(core.frame()[5]),
        "quantities": quantities,
        "charts": charts_of(model, quantities) if model is not None else [],
        "settings": [{**one._asdict(), "restarts": setting_that_may_change(simulation._model, one.key) is None} for one in settings],
        "values": {**flat(settings_in(simulation.settings)), **latest(simulation.changes)},
        "changes": [change._asdict() for change in simulation.changes],
        "configuration": simulation.settings,
        "timeStep": simulation.time_step,
    }


def charts_of(model: type[Model], quantities: Sequence[Mapping[str, str]]) -> list[dict[str, Any]]:
    """The charts that a model declares, with their curves, and one for each observation in none of them that says nothing of itself."""
    declared = {name for curves in model.charts.values() for name in curves}
    alone = [quantity["name"] for quantity in quantities if not quantity["documentation"] and quantity["name"] not in declared]
    return [{"title": title, "names": list(curves)} for title, curves in (*model.charts.items(), *((name, [name]) for name in alone))]
