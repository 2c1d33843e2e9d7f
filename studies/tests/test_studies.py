"""What holds for every study: where it stands, and whose files it leaves alone."""

import ast
import importlib
import os
import pathlib
import re
import subprocess
import sys

import pytest

import gridlock.plot
import gridlock_studies

#: The names that studies take from the inside of the package: the directory of results with its lock, and how calls are read and shown.
PRIVATE = {"gridlock._core", "gridlock.progress.ProgressBar", "gridlock.settings.as_threads"}


def sources_of(package):
    return list(pathlib.Path(package.__file__).parent.rglob("*.py"))


def imported_names(source):
    """The dotted names that a file imports from gridlock."""
    for node in ast.walk(ast.parse(source.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module is not None and node.module.split(".")[0] == "gridlock":
            yield from (f"{node.module}.{name.name}" for name in node.names)


def test_the_package_does_not_know_its_studies():
    assert [source for source in sources_of(gridlock) if "gridlock_studies" in source.read_text()] == []


def test_importing_the_package_imports_nothing_that_studies_need():
    program = "import sys, gridlock; sys.exit(any(name in sys.modules for name in ('jinja2', 'matplotlib', 'scipy', 'gridlock_studies')))"
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0


def test_studies_use_the_public_interface():
    public = {"gridlock.__version__", "gridlock.playground", *(f"gridlock.{name}" for name in gridlock.__all__),
              *(f"gridlock.plot.{name}" for name in gridlock.plot.__all__)}
    used = {name for source in sources_of(gridlock_studies) for name in imported_names(source)}
    assert {"gridlock.Simulation", "gridlock.contacts"} <= used
    assert used - public == PRIVATE


def test_pip_makes_the_commands_that_the_build_has():
    project = (pathlib.Path(__file__).resolve().parents[2] / "pyproject.toml").read_text()
    commands = dict(re.findall(r'^(gridlock-\w+) = "([\w.]+):main"$', project, re.MULTILINE))
    assert {"gridlock-paper", "gridlock-jam", "gridlock-melt"} <= set(commands)
    assert all(callable(importlib.import_module(module).main) for module in commands.values())
    program = os.environ.get("GRIDLOCK_PROGRAM", "")
    if not program:  # the commands of the build are looked for beside it; tests that ctest runs always have it
        pytest.skip("GRIDLOCK_PROGRAM does not name the program gridlock")
    starters = {path.name: path.read_text() for path in pathlib.Path(program).parent.glob("gridlock-*") if path.name in commands}
    assert {name for name, module in commands.items() if f"from {module} import main" in starters.get(name, "")} == set(commands)


@pytest.mark.parametrize("study", ["paper", "jam", "melt"])
def test_a_study_replaces_no_file_of_the_user(tmp_path, study):
    make = importlib.import_module(f"gridlock_studies.{study}").make
    for name in ("figure_4.csv", "figure_5.svg", "runs.csv", "playground.html"):
        mine = tmp_path / name
        mine.write_text("mine")
        with pytest.raises(gridlock.Error, match=f"{name} would be replaced"):
            make(tmp_path, "quick")
        assert mine.read_text() == "mine"
        mine.unlink()
