"""``gridlock show FILE``: shows a model in Python, or settings, in the browser while it runs."""

from __future__ import annotations

import argparse
import os
import runpy
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import Error, RunFailure
from ..files import settings_in
from ..models import Model, raised_text
from ..show import start, tell

#: The name of a file that is shown, in place of "__main__".
NAME = "gridlock_shown"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="gridlock show", description="Show a model in Python, or settings, in the browser while it runs.")
    parser.add_argument("file", metavar="FILE", help="a file of Python with a model, or settings in TOML")
    parser.add_argument("settings", metavar="SETTINGS", nargs="?", help="settings of the model in TOML")
    parser.add_argument("--set", dest="values", action="append", default=[], metavar="KEY=VALUE", help="a setting over those of the files; may be repeated")
    parser.add_argument("--model", default="", metavar="NAME", help="which model of the file, where it has several")
    parser.add_argument("--port", type=int, default=0, help="port of this machine; left out: a free one")
    parser.add_argument("--no-open", action="store_true", help="print the address, and open no browser")
    return parser


def model_in(path: str, name: str = "") -> type[Model]:
    """The model of a file of Python, the one of that name where it has several. Errors: Error, also for what the file raises."""
    sys.path.insert(0, os.path.dirname(os.path.abspath(path)))
    try:
        found = runpy.run_path(path, run_name=NAME)
    except OSError as error:
        if os.path.abspath(str(error.filename)) != os.path.abspath(path):
            raise Error(raised_text(error)) from error
        raise Error(f"{path} cannot be read: {error.strerror}\n  hint: name a file of Python, or settings in TOML") from None
    except Exception as mistake:
        raise Error(raised_text(mistake)) from mistake
    finally:
        del sys.path[0]
    models = {model.name: model for model in found.values() if isinstance(model, type) and issubclass(model, Model) and model.__module__ == NAME}
    if name:
        models = {one: model for one, model in models.items() if one == name}
    if len(models) == 1:
        return next(iter(models.values()))
    what = f"no model{' ' + name if name else ''}" if not models else f"the models {', '.join(models)}"
    raise Error(f"{path} has {what}\n  hint: " + ("derive a class from gridlock.Model in it" if not models else "choose one by --model NAME"))


def _values(texts: Sequence[str]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for text in texts:
        key, mark, value = text.partition("=")
        if not mark or not key.strip():
            raise Error(f"--set {text} sets nothing\n  hint: write --set KEY=VALUE")
        try:
            values[key.strip()] = settings_in(f"value = {value}")["value"]
        except ValueError:
            values[key.strip()] = value.strip()  # a word without quotes
    return values


class _File:
    """A file with a model, which is read again where it has changed since."""

    def __init__(self, path: str, name: str) -> None:
        self._path, self._name = path, name
        self._stamp = -1
        self._model: type[Model] | None = None

    def read(self) -> type[Model]:
        stamp = os.stat(self._path).st_mtime_ns if os.path.exists(self._path) else 0
        if self._model is None or stamp != self._stamp:
            self._model = model_in(self._path, self._name)
            self._stamp = stamp
        return self._model


def _show(options: argparse.Namespace) -> int:
    values = _values(options.values)
    is_python = options.file.endswith(".py")
    if not is_python and options.settings is not None:
        raise Error(f"settings follow a file of Python, and {options.file} is none\n  hint: gridlock show model.py settings.toml")
    file = _File(options.file, options.model)

    def read() -> tuple[Any, Mapping[str, Any]]:
        if not is_python:
            return options.file, values
        model = file.read()
        return (model, values) if options.settings is None else (options.settings, {"model": model, **values})

    shown = start(read, options.port)
    tell(shown, opens_browser=not options.no_open)
    shown.wait()
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit codes of all commands: 0, 1 for a failure, 2 for input that cannot be used."""
    options = _parser().parse_args(arguments)
    try:
        return _show(options)
    except KeyboardInterrupt:
        return 130  # before anything is shown
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except (MemoryError, OSError, RunFailure) as error:
        print(f"error: {error or 'not enough memory'}", file=sys.stderr)
        return 1
    except Exception as mistake:  # noqa: BLE001: of the start of a model
        print(f"error: {raised_text(mistake)}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
