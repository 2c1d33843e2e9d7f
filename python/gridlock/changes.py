"""Settings of a model that change while its simulation goes on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from .errors import Error
from .settings import assignments

if TYPE_CHECKING:
    from .models import Model, Setting


class Change(NamedTuple):
    """A setting that was changed in a simulation, and the number of steps that it had taken then."""

    step: int
    key: str
    before: Any
    value: Any

    def __str__(self) -> str:
        return f"step {self.step}: {self.key} was {self.before} and is {self.value}"


def setting_that_may_change(model: Model | None, key: str) -> Setting | None:
    """The setting of a model with this key, None where another value of it needs a new start.

    That is so for settings of the library, for those that give a model its fields and its time step, and for those that its ``start`` has
    read, unless they say otherwise.
    """
    from .models import settings_of

    table, _, name = key.partition(".")
    setting = settings_of(type(model)).get(name) if model is not None and table == model.name else None
    if model is None or setting is None or name in model.__dict__["_read_by_world"]:
        return None
    restarts = name in model.__dict__["_read_by_start"] if setting.restarts is None else setting.restarts
    return None if restarts else setting


def read_values(model: Model | None, settings: Mapping[str, Any]) -> dict[str, Any]:
    """The values of settings by their keys, of the types that the model knows. Errors: Error for settings that need a new start."""
    from .files import settings_in
    from .models import settings_of

    values = {}
    known = [f"{model.name}.{name}" for name in settings_of(type(model))] if model is not None else []
    for key, text in assignments(settings):
        if key not in known:
            raise Error(f"{key} is no setting of a model in Python, and no other changes in a simulation\n"
                        f"  hint: {'there are ' + ', '.join(known) if known else 'make a simulation with the other value'}")
        setting = setting_that_may_change(model, key)
        if setting is None:
            raise Error(f"{key} cannot change in a simulation: its start, its fields or its time step depend on it\n"
                        "  hint: make a simulation with the other value")
        values[key] = settings_in(f"value = {text}")["value"]
    return values


def changed(model: Model, step: int, values: Mapping[str, Any]) -> list[Change]:
    """Changes a model, and says how. The values are possible ones."""
    from .models import BOOKKEEPING

    found = []
    for key, value in values.items():
        setting = setting_that_may_change(model, key)
        assert setting is not None
        before = getattr(model, setting.key)
        model.__dict__["_values"][setting.key] = now = setting.of_its_type(value)
        found += [Change(step, key, before, now)] if now != before else []
    # All else that the model keeps, such as cached properties and the layout of turns, may depend on what has changed.
    for name in model.__dict__.keys() - BOOKKEEPING:
        del model.__dict__[name]
    return found


def latest(changes: Sequence[Change]) -> dict[str, Any]:
    """The values after some changes, by their keys."""
    return {change.key: change.value for change in changes}
