"""Settings from Python: dicts and keyword arguments become dotted keys with values in TOML."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import _core
from .arrays import as_count, in_short
from .errors import Error


def to_toml(value: Any, key: str = "") -> str:
    """A value in TOML.

    >>> to_toml({"radius": 0.5, "names": ["a", "b"]})
    '{"radius" = 0.5, "names" = ["a", "b"]}'
    """
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if math.isnan(value):
            return "nan"
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, os.PathLike):
        return to_toml(os.fspath(value), key)
    if isinstance(value, np.ndarray):
        return to_toml(value.tolist(), key)
    if isinstance(value, Mapping):
        entries = (f"{json.dumps(str(name))} = {to_toml(entry, f'{key}.{name}')}" for name, entry in value.items())
        return "{" + ", ".join(entries) + "}"
    if isinstance(value, Sequence):
        return "[" + ", ".join(to_toml(entry, key) for entry in value) + "]"
    raise Error(
        f"{key} has a value of type {type(value).__name__}\n  hint: use a number, a text, True or False, or a list or dict of them"
    )


def given(settings: Mapping[str, Any] | str | os.PathLike[str] | None, more: Mapping[str, Any]) -> tuple[str | None, list[tuple[str, str]]]:
    """The TOML file, where settings are the path of one, and everything that is set over it."""
    if isinstance(settings, (str, os.PathLike)):
        return os.fspath(settings), assignments(more)
    return None, (assignments(settings) if settings is not None else []) + assignments(more)


def as_threads(threads: Any) -> int:
    """A number of threads, 0 for all cores."""
    return as_count(threads, "threads", "use a whole number, 0 for all cores", least=0)


def _key_for(value: Any, keys: Sequence[str]) -> str:
    """The key of a table that a value may be meant for, with the value: one that has such a choice, or else the first one."""
    chosen = next((key for key in keys if isinstance(value, str) and f'"{value}"' in _core.explain(key)), None)
    name = (chosen or keys[0]).split(".", 1)[1]
    return f'"{name}": {json.dumps(value, default=str)}' if chosen else f'"{name}": …'


def assignments(settings: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """The dotted keys of nested dicts, with their values in TOML; ``None`` leaves a setting out.

    >>> assignments({"disks": {"count": 100}, "run.steps": 10, "box": None})
    [('disks.count', '100'), ('run.steps', '10')]
    """
    if not isinstance(settings, Mapping):
        raise Error(f"settings are a dict, not {type(settings).__name__}\n  hint: for example {{'disks': {{'count': 100}}}}")
    result: list[tuple[str, str]] = []
    for name, value in settings.items():
        if not isinstance(name, str) or not name:
            raise Error(f"{name!r} is no name of a setting\n  hint: names are texts such as 'disks.count'")
        key = f"{prefix}{name}"
        if value is None:
            continue
        if key == "model" and not isinstance(value, Mapping):
            from .models import settings_of_model

            result += assignments(settings_of_model(value))
            continue
        if isinstance(value, Mapping):
            result += assignments(value, key + ".")
        elif "." not in key and not isinstance(value, (list, tuple)) and (keys := [known for known in _core.setting_keys() if known.startswith(f"{key}.")]):
            raise Error(f"{key} is {in_short(value)}, but must be a table\n  hint: write {key}={{{_key_for(value, keys)}}}")
        else:
            result.append((key, to_toml(value, key)))
    return result
