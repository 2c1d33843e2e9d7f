"""The version that the package, its program and its files name."""

import json
import pathlib
import re
import subprocess

import gridlock


def test_the_version_names_a_commit_in_the_form_of_python_packages() -> None:
    assert re.fullmatch(r"[0-9]+\.[0-9]+\.[0-9]+(\.dev0)?\+([0-9a-f]{12}(\.modified)?|unknown)", gridlock.__version__)


def test_the_package_and_its_program_have_one_version(program: str) -> None:
    printed = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
    assert printed.split()[1].rstrip(",").replace("-dev", ".dev0") == gridlock.__version__


def test_a_summary_names_the_version(tmp_path: pathlib.Path) -> None:
    gridlock.run({"disks": {"count": 16, "packing_fraction": 0.3}, "run": {"steps": 10}}, tmp_path / "run")
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["gridlock"].replace("-dev", ".dev0") == gridlock.__version__
