"""The entries in public comparisons run, and the page has what was measured."""

import re
import subprocess
import sys

import pytest

SMALLER = {"N_RUN = 100": "N_RUN = 1", "SAMPLES + 1": "2", "80_000": "80", '"side": 500, "count": 200_000': '"side": 10, "count": 60'}
ENTRIES = {
    "ABMFrameworksComparison/Flocking/Gridlock/benchmark_flocking.py": r"Gridlock Flocking-small \(ms\): [\d.]+\n",
    "ABMFrameworksComparison/ForestFire/Gridlock/benchmark_forestfire.py": r"Gridlock ForestFire-small \(ms\): [\d.]+\n",
    "ABMFrameworksComparison/Schelling/Gridlock/benchmark_schelling.py": r"Gridlock Schelling-small \(ms\): [\d.]+\n",
    "ABMFrameworksComparison/WolfSheep/Gridlock/benchmark_wolfsheep.py": r"Gridlock WolfSheep-small \(ms\): [\d.]+\n",
    "flamegpu/ABM_Framework_Comparisons/Gridlock/benchmark.py": r"(Gridlock (Flocking|Schelling), (C\+\+|Python)(, all cores)? \(mean ms\): [\d.]+\n){5}",
}


@pytest.mark.parametrize("entry", ENTRIES)
def test_the_entry_runs_and_prints_what_the_comparison_reads(entry, root, monkeypatch, capsys):
    text = re.sub(r'^    "large": .*\n', "", (root / "comparisons" / entry).read_text(), flags=re.MULTILINE)
    for old, new in SMALLER.items():
        text = text.replace(old, new)
    monkeypatch.setattr(sys, "argv", [entry])
    exec(compile(text, entry, "exec"), {"__name__": "entry"})  # noqa: S102
    assert re.fullmatch(ENTRIES[entry], capsys.readouterr().out)


def test_the_page_has_the_tables_of_the_results(root):
    printed = subprocess.run([sys.executable, root / "comparisons/run.py", "--table"], text=True, stdout=subprocess.PIPE, check=True).stdout
    tables = printed.rstrip("\n").split("\n\n")
    page = (root / "docs/reference/other_codes.md").read_text()
    assert [table.count("\n") > 7 and f"\n\n{table}\n\n" in page for table in tables] == [True] * 3
