"""A run is verified in Python as on the command line, and a link of the command line is that of the package."""

import base64
import pathlib
import subprocess
import zlib

import gridlock
import pytest

SETTINGS = {"disks": {"count": 25}, "run": {"steps": 400}, "checkpoint": {"keep_states": 3}}


def test_a_run_is_verified_whole_and_in_windows_and_a_changed_one_refused(tmp_path: pathlib.Path) -> None:
    gridlock.run(SETTINGS, tmp_path / "run")
    whole = gridlock.verify(tmp_path / "run")
    assert whole.is_verified and whole.steps == 400 and whole.states == 3
    part = gridlock.verify(tmp_path / "run", windows=2, seed=5, threads=1)
    assert part.is_verified and 0 < part.steps < 400 and "2 windows" in part.text
    file = tmp_path / "run" / "config.resolved.toml"
    file.write_text(file.read_text().replace("seed = 1\n", "seed = 2\n"))
    with pytest.raises(gridlock.Error, match="run.seed 1 → 2"):
        gridlock.verify(tmp_path / "run")
    with pytest.raises(gridlock.Error, match="windows is -1"):
        gridlock.verify(tmp_path / "run", windows=-1)


def test_a_sweep_is_verified_as_on_the_command_line(tmp_path: pathlib.Path, program: str) -> None:
    gridlock.sweep({"disks": {"count": 9}, "run": {"steps": 100}, "checkpoint": {"keep_states": 1}}, {"run.seed": [1, 2]}, tmp_path / "sweep")
    found = gridlock.verify(tmp_path / "sweep", windows=0)
    assert found.is_verified and found.runs == 2 and found.steps == 200
    out = subprocess.run([program, "verify", "--windows", "0", str(tmp_path / "sweep")], check=True, capture_output=True, text=True).stdout
    assert out == found.text + "\n"
    (tmp_path / "sweep" / "runs" / "seed=2" / "hashes.csv").unlink()
    other = gridlock.verify(tmp_path / "sweep")
    assert not other.is_verified and other.runs == 1 and other.text.endswith("1 of 2 runs verified; 0 different, 1 cannot be verified")


def test_a_link_of_the_command_line_holds_the_settings_of_the_run(tmp_path: pathlib.Path, program: str) -> None:
    gridlock.run(SETTINGS, tmp_path / "run")
    out = subprocess.run([program, "verify", str(tmp_path / "run"), "--link"], check=True, capture_output=True, text=True).stdout
    packed = out.rpartition("#toml=")[2].strip()
    text = zlib.decompress(base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4)), -zlib.MAX_WBITS).decode()
    assert text == (tmp_path / "run" / "config.resolved.toml").read_text()
