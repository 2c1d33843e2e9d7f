"""The gallery of the pages, with small systems; and the charts that are made of committed results."""

import pathlib
import re
import subprocess
import sys

import pytest


def draw(script, *words):
    ended = subprocess.run([sys.executable, script, *map(str, words)], capture_output=True, text=True, timeout=300)
    assert (ended.returncode, ended.stderr) == (0, "")
    return ended.stdout


def test_the_gallery_draws_the_pictures_of_its_page(root, tmp_path):
    out = draw(root / "examples/gallery.py", tmp_path / "new", "--small")
    drawn = {path.name for path in (tmp_path / "new").iterdir()}
    assert {pathlib.Path(line).name for line in out.split()} == drawn
    page = (root / "docs/how_to/gallery.md").read_text()
    assert drawn == set(re.findall(r"images/(gallery_\w+\.png)", page))
    assert all(path.read_bytes()[:4] == b"\x89PNG" for path in (tmp_path / "new").iterdir())


@pytest.mark.parametrize(("script", "pictures"), [
    ("docs/notebook/performance.py", ["performance_k.svg", "performance_n.svg", "scaling_ranks.svg"]),
    ("validation/models.py", ["epidemic_sir.svg", "vicsek_density.svg", "vicsek_noise.svg"]),
])
def test_charts_are_made_of_committed_results(root, tmp_path, script, pictures):
    draw(root / script, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == pictures
    for name in pictures:
        assert (root / "docs/images" / name).exists()
