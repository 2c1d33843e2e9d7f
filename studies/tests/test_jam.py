"""The study of jamming: made whole on a toy, continued, refused; its numbers beside those of the definitions."""

import base64
import dataclasses
import json
import math
import pathlib
import re
import subprocess
import sys
import zlib

import numpy as np
import pytest

import gridlock
from conftest import rows_of
from gridlock_studies import jam
from gridlock_studies.commands.jam import main
from gridlock_studies.jam import figure_1, figure_3, figure_7
from gridlock_studies.statistics import Estimate, Verdict

#: The whole study on a toy: a few disks, a few starts.
TINY = dataclasses.replace(
    jam.quick(), name="tiny", quench_starts=((24, 6), (36, 4)), quench_densities=(0.7, 0.83, 0.9), decompressed_disks=36,
    decompressed_starts=3, large_disks=64, large_starts=1, fluid_densities=((0.4, 20.0), (0.7, 20.0)), fluid_disks=36, fluid_starts=2,
    growth_rates=(5e-2,), growth_disks=36, growth_starts=2, equal_disks=36, equal_starts=2,
    sheared_disks=36, sheared_starts=2, sheared_strain=0.6, flow_disks=36, flow_starts=2, flow_rates=(1e-2, 1e-3), flow_strain=0.5,
    slow_disks=36, slow_starts=2, slow_strain=0.5, slow_densities=(0.86, 0.9))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A study that was never interrupted."""
    directory = tmp_path_factory.mktemp("whole")
    return directory, jam.make(directory, TINY)


def test_every_figure_is_made_with_its_data(whole):
    directory, made = whole
    assert made.notes == []
    names = {path.name for path in pathlib.Path(directory).iterdir() if not path.name.startswith(".")}
    expected = {f"figure_{number}.{ending}" for number in range(1, 11) for ending in ("csv", "svg", "png")}
    assert names == expected | {"runs.csv", "report.html"}
    assert {claim.where for claim in made.claims} == {f"Figure {number}" for number in range(1, 11)}
    text = (directory / "report.html").read_text(encoding="utf-8")
    for claim in made.claims:
        assert claim.where in text
    assert "<script" not in text and "http" not in text.replace("http://www.w3.org", "")


def test_the_numbers_are_those_of_single_runs(whole):
    directory, _ = whole
    row = next(row for row in rows_of(directory / "runs.csv") if row["title"].startswith("36 harmonic disks"))
    simulation = gridlock.Simulation(json.loads(row["settings"]))
    simulation.run()
    assert simulation.state_hash == row["state_hash"]
    assert float(simulation.results["jamming_packing_fraction"].value) == float(row["jamming_packing_fraction"])


def test_a_study_is_verified_as_a_whole_and_an_edited_hash_or_setting_found(tmp_path, whole):
    text = (whole[0] / "runs.csv").read_text()
    (tmp_path / "runs.csv").write_text(text)
    found = gridlock.verify(tmp_path, windows=3, seed=2)
    assert found.is_verified and found.runs == found.hashes == 3 and f"3 of the {len(rows_of(tmp_path / 'runs.csv'))} runs" in found.text
    kept = "\n".join(text.splitlines()[:3]) + "\n"
    for old, new in ((rows_of(tmp_path / "runs.csv")[1]["state_hash"], "0123456789abcdef"), ('""seed"": 2', '""seed"": 22')):
        (tmp_path / "runs.csv").write_text(kept.replace(old, new))
        other = gridlock.verify(tmp_path)
        assert not other.is_verified and other.runs == 1 and "row 2 of runs.csv: the last state hash is" in other.text


def test_every_chapter_links_to_set_ups_that_run(tmp_path, monkeypatch):
    monkeypatch.setenv("GRIDLOCK_PLAYGROUND", "https://example.org/")
    jam.make(tmp_path, TINY, 1)
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    first = re.search(r'href="https://example.org/#toml=([^"]+)">36 disks quenched at 0.9<', report)
    text = zlib.decompress(base64.urlsafe_b64decode(first[1] + "=" * (-len(first[1]) % 4)), -zlib.MAX_WBITS).decode()
    (tmp_path / "run.toml").write_text(text)
    simulation = gridlock.Simulation(tmp_path / "run.toml")
    simulation.run()
    assert simulation.state_hash in (tmp_path / "runs.csv").read_text()


def test_the_numbers_do_not_depend_on_the_threads(tmp_path, whole):
    directory, _ = whole
    jam.make(tmp_path, TINY, 1, threads=1)
    assert (tmp_path / "figure_1.csv").read_text() == (directory / "figure_1.csv").read_text()


def test_shares_grow_from_nothing_to_all(whole):
    directory, _ = whole
    for row in rows_of(directory / "figure_1.csv"):
        share = float(row["share"])
        assert 0.0 <= share <= 1.0
        assert row["packing_fraction"] != "0.7" or share == 0.0
        assert row["packing_fraction"] != "0.9" or share == 1.0


def test_a_study_continues_where_it_was_stopped(tmp_path, whole):
    directory, _ = whole
    seen = []

    def stop(share, what):
        seen.append(share)
        if "simulations" in what and share > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(jam.Stopped):
        jam.make(tmp_path, TINY, progress=stop)
    jam.make(tmp_path, TINY)
    for number in range(1, 11):
        name = f"figure_{number}.csv"
        assert (tmp_path / name).read_text() == (directory / name).read_text(), name


def test_the_rise_is_found_with_its_error():
    """Shares drawn from a known normal distribution."""
    random = np.random.default_rng(1)
    middles, widths = [], []
    for _ in range(60):
        jamming = random.normal(0.838, 0.004, size=(6, 200))
        densities = (0.828, 0.833, 0.837, 0.84, 0.843, 0.848)
        shares = [figure_1.Share(64, density, int(np.sum(ones < density)), 200) for density, ones in zip(densities, jamming)]
        rise = figure_1._rise(shares)
        middles.append((rise.middle.value - 0.838) / rise.middle.error)
        widths.append((rise.width.value - 0.004) / rise.width.error)
    for deviations in (middles, widths):
        assert abs(np.mean(deviations)) < 0.5
        assert 0.7 < np.std(deviations) < 1.3


def test_shares_that_lag_everywhere_differ_together_though_none_does_alone():
    references = [(disks, *one) for disks, of_size in figure_1.REFERENCE.items() for one in of_size]

    def claim(lag):
        """Of made-up shares that many standard errors below those of the independent program."""
        shares = []
        for disks, density, value, error in references:
            jammed = round(600 * max(0.0, value - lag * math.hypot(error, math.sqrt(value * (1 - value) / 600))))
            shares.append(figure_1.Share(disks, density, jammed, 600))
        return figure_1._reference_claim(shares)

    assert claim(0.0).verdict is Verdict.AGREES and "would go unseen" in claim(0.0).measured
    assert claim(1.5).verdict is Verdict.DIFFERS
    assert figure_1._reference_claim([]).verdict is Verdict.UNDECIDED


def test_what_is_said_of_an_exponent_and_of_crystals_follows_from_errors():
    assert "make it larger" in figure_3._exponent_text(Estimate(0.6, 0.02))
    assert "make it larger" not in figure_3._exponent_text(Estimate(0.6, 0.1)) + figure_3._exponent_text(Estimate(0.4, 0.02))
    assert "too few" in figure_3._exponent_text(None)
    order, disorder = Estimate(0.85, 0.01), Estimate(0.55, 0.01)
    assert figure_7._verdict(Estimate(0.885, 0.002), order, disorder) is Verdict.AGREES
    assert figure_7._verdict(Estimate(0.867, 0.002), order, disorder) is Verdict.UNDECIDED
    assert figure_7._verdict(Estimate(0.845, 0.002), order, disorder) is Verdict.DIFFERS
    assert figure_7._verdict(Estimate(0.885, 0.002), Estimate(0.66, 0.02), disorder) is Verdict.UNDECIDED


def test_no_excess_in_a_marginal_packing(whole):
    directory, _ = whole
    for row in rows_of(directory / "figure_3.csv"):
        backbone, contacts = float(row["backbone_disks"]), float(row["contact_number"])
        if backbone > 0.0:
            assert float(row["excess_contacts"]) == pytest.approx((contacts - 4.0 + 2.0 / backbone) * backbone / 2.0, abs=1e-9)
    assert figure_3.PUBLISHED_ERROR == pytest.approx(0.139, abs=1e-3)


@pytest.mark.parametrize(("arguments", "complaint"), [
    (["--figure", "11"], "--figure must be a whole number, from 1 to 10, but is 11"),
    (["--wrong"], "gridlock jam has no option --wrong"),
    (["--quick", "--full"], "--quick and --full cannot be given together"),
    (["extra"], "one word too many"),
])
def test_bad_use_is_refused(capsys, arguments, complaint):
    assert main(arguments) == 2
    assert complaint in capsys.readouterr().err


def test_impossible_arguments_are_refused(tmp_path):
    with pytest.raises(gridlock.Error, match="no extent"):
        jam.make(tmp_path, "large")
    with pytest.raises(gridlock.Error, match="no Figure 11"):
        jam.make(tmp_path, TINY, 11)


def test_the_help_needs_no_packages():
    code = "import sys; from gridlock_studies.commands.jam import main; main(['--help']); sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], stdout=subprocess.DEVNULL, check=False).returncode == 0
