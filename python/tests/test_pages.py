"""Every program in Python that the pages show runs."""

import json
import os
import pathlib
import re
import subprocess
import warnings

import numpy as np
import pytest

import gridlock

PAGES = ["README.md", "docs/getting_started/python.md", "docs/getting_started/own_model_python.md", "docs/getting_started/models_in_python.md", "docs/how_to/analysis.md",
         "docs/how_to/experiments.md", "docs/how_to/jamming.md", "docs/how_to/melting.md", "docs/how_to/playground.md", "docs/how_to/verify.md"]


@pytest.mark.parametrize("page", PAGES)
def test_programs_of_the_page_run(root, page, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    pattern = r"```python\n(.*?)```(?:\n\nprints\n\n```text\n(.*?)```)?"
    programs = re.findall(pattern, (root / page).read_text(), re.DOTALL)
    programs = [(program, shown) for program, shown in programs if "import gridlock" in program]
    assert programs
    for program, shown in programs:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exec(compile(program, page, "exec"), {})  # noqa: S102
        printed = capsys.readouterr().out
        assert printed
        assert not shown or printed == shown


def test_every_page_that_shows_what_python_prints_is_run(root):
    pages = [*root.glob("*.md"), *root.glob("docs/**/*.md")]
    shown = {str(page.relative_to(root)) for page in pages
             if re.search(r"```python\n((?!```).)*```\n\nprints\n", page.read_text(), re.DOTALL)}
    assert shown
    assert shown <= set(PAGES)


def test_the_page_of_contacts_runs(root, program, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{pathlib.Path(program).parent}:{os.environ['PATH']}")
    pathlib.Path("examples").symlink_to(root / "examples")
    page = (root / "docs/how_to/contacts.md").read_text()
    subprocess.run(["sh", "-ec", "".join(re.findall(r"```sh\n(.*?)```", page, re.DOTALL))], check=True)
    capfd.readouterr()
    files = re.findall(r"^\| `(\w+\.\w+)` \|", page, re.MULTILINE)
    assert len(files) == 6 and all(pathlib.Path("results/contacts", name).is_file() for name in files)
    named = re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)))
    assert set(named) - {"elastic_xxxx"} <= set(json.loads(pathlib.Path("results/contacts/summary.json").read_text()))
    exec(compile(re.search(r"```python\n(.*?)```", page, re.DOTALL)[1], "page", "exec"), {})  # noqa: S102
    assert capfd.readouterr().out.startswith("Z = 3.967, p = 0.0001055, K = 0.21")


def test_the_reference_has_every_public_name(root):
    page = (root / "docs/reference/python.md").read_text()
    named = set(re.findall(r"auto\w+:: gridlock\.(\w+)$", page, re.MULTILINE))
    assert set(gridlock.__all__) <= named
    assert {name for name in named if not hasattr(gridlock, name)} <= {"turns", "plot", "library"}


def test_the_page_of_models_has_everything_that_a_step_can_do(root):
    page = (root / "docs/getting_started/own_model_python.md").read_text()
    members = {name for name in dir(gridlock.World) if not name.startswith("_")}
    assert "uniform_of_step" in members
    assert {name for name in members if f"world.{name}" not in page} == set()


def test_the_program_for_partial_g_reads_the_run_of_its_page(root, program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (root / "docs/how_to/pair_correlation.md").read_text()
    pathlib.Path("large_mixture.toml").write_text(re.search(r"```toml\n(.*?)```", page, re.DOTALL)[1])
    subprocess.run([program, "run", "large_mixture.toml", "-o", "results/large", "--set", "disks.count=3000", "-q"], check=True)
    exec(compile(re.search(r"```python\n(.*?)```", page, re.DOTALL)[1], "page", "exec"), {})  # noqa: S102
    distance, g = np.loadtxt("small_large.csv", delimiter=",", skiprows=1).T
    assert 0.9 < distance[g.argmax()] < 1.1 and abs(g[distance > 4].mean() - 1) < 0.05
