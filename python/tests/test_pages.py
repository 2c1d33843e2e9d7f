"""Every program in Python that the pages show runs."""

import re
import warnings

import pytest

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
