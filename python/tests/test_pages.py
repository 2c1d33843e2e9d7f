"""Every program in Python that the pages show runs."""

import re
import warnings

import pytest

import gridlock

PAGES = ["README.md", "docs/getting_started/python.md", "docs/getting_started/own_model_python.md"]


@pytest.mark.parametrize("page", PAGES)
def test_programs_of_the_page_run(root, page, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    programs = re.findall(r"```python\n(.*?)```", (root / page).read_text(), re.DOTALL)
    programs = [program for program in programs if "import gridlock" in program]
    assert programs
    for program in programs:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exec(compile(program, page, "exec"), {})  # noqa: S102
        assert capsys.readouterr().out


def test_the_reference_has_every_public_name(root):
    page = (root / "docs/reference/python.md").read_text()
    named = set(re.findall(r"auto\w+:: gridlock\.(\w+)$", page, re.MULTILINE))
    assert set(gridlock.__all__) <= named
    assert {name for name in named if not hasattr(gridlock, name)} <= {"turns", "plot", "paper"}
