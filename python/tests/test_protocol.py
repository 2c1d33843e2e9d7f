"""Protocols from Python: the bits of the command line, results and tables, refusals."""

import json
import subprocess

import numpy as np
import pytest

import gridlock
from conftest import OBLONG

MIXTURE = [{"fraction": 0.5}, {"fraction": 0.5, "size_ratio": 1.4}]
SETTINGS = {"box": OBLONG, "disks": {"count": 64, "packing_fraction": 0.5, "start": "uniform", "species": MIXTURE},
            "run": {"seed": 3}}
PROTOCOL = [{"stage": "quench", "packing_fraction": 0.86}, {"stage": "decompress", "until_pressure": 1e-6}]


def test_a_protocol_has_the_bits_of_the_command_line(tmp_path, program):
    simulation = gridlock.Simulation(SETTINGS, protocol=PROTOCOL)
    simulation.run()
    file = tmp_path / "run.toml"
    file.write_text(simulation.settings)
    subprocess.run([program, "run", file, "-o", tmp_path / "run", "-q", "--no-pictures"], check=True)
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["state_hash"] == simulation.state_hash
    assert summary["jamming_packing_fraction"]["value"] == float(simulation.results["jamming_packing_fraction"].value)


def test_what_comes_out_is_what_the_contacts_say():
    simulation = gridlock.Simulation(SETTINGS, protocol=PROTOCOL)
    simulation.run()
    agents, results = simulation.agents, simulation.results
    found = gridlock.contacts(agents.positions, agents.radius, simulation.box)
    assert found.pressure == pytest.approx(results["pressure"].value, rel=1e-6)
    assert found.contact_number == results["contact_number"].value
    assert found.excess_contacts == results["excess_contacts"].value
    assert found.bulk_modulus == pytest.approx(results["bulk_modulus"].value, rel=1e-6)
    levels = simulation.distributions["levels"]
    assert levels["pressure"][-1] == pytest.approx(1e-6, rel=0.1)
    # The ramp begins with the minimum of the quench.
    assert levels["pressure"][0] == pytest.approx(levels["pressure"][1], rel=1e-6)
    assert np.all(np.diff(levels["pressure"][1:]) < 0.0)
    assert len(simulation.distributions["stages"]) == 2


def test_positions_may_be_changed_before_the_protocol():
    simulation = gridlock.Simulation(SETTINGS, protocol=PROTOCOL)
    other = gridlock.Simulation(SETTINGS, protocol=PROTOCOL)
    other.agents.positions[...] = np.random.default_rng(1).random((64, 2))
    simulation.run()
    other.run()
    assert simulation.state_hash != other.state_hash
    assert other.results["is_jammed"].value == 1.0


def test_a_run_may_follow():
    simulation = gridlock.Simulation(SETTINGS, protocol=[*PROTOCOL, {"stage": "separate"}], engine={"kind": "exact"},
                                     run={"collisions_per_disk": 20.0, "seed": 3})
    simulation.run()
    assert simulation.counts["pair_collisions"] == 640
    assert "jamming_packing_fraction" in simulation.results


@pytest.mark.parametrize(("protocol", "message"), [
    ([{"stage": "grow"}], "does not say when it ends"),
    ([{"stage": "melt"}], "melt"),
    ([{"stage": "grow", "until_packing_fraction": 0.9}], "cannot begin: disks .* overlap"),
    ([{"stage": "quench", "rate": 1.0}], "no setting rate"),
])
def test_impossible_protocols_are_refused(protocol, message):
    with pytest.raises(gridlock.Error, match=message):
        gridlock.Simulation(SETTINGS, protocol=protocol)


def test_steps_and_observables_need_a_run():
    simulation = gridlock.Simulation(SETTINGS, protocol=PROTOCOL)
    with pytest.raises(gridlock.Error, match="ends with its protocol"):
        simulation.run(steps=10)
    with pytest.raises(gridlock.Error, match="before the protocol has ended"):
        simulation.observe(lambda simulation: 1.0, "one")


@pytest.mark.parametrize("edge", ["periodic", "wall"])
def test_the_trajectory_has_the_contacts_of_the_minimum(tmp_path, edge):
    gridlock.run(SETTINGS, tmp_path / "run", box={"edge": edge}, protocol=PROTOCOL, trajectory={"every": 1})
    trajectory = gridlock.open(tmp_path / "run").trajectory
    frame, contacts = trajectory[0], trajectory.contacts
    found = gridlock.contacts(frame.positions, frame.radius, frame.box)
    is_of_disks = found.pairs[:, 1] < 64
    assert is_of_disks.all() == (edge == "periodic") and is_of_disks.sum() > 60
    assert contacts.clock == frame.clock
    assert contacts.ids.tolist() == frame.ids[found.pairs[is_of_disks]].tolist()
    assert contacts.forces.tolist() == found.forces[is_of_disks].tolist()


def test_disks_that_do_not_touch_have_no_contacts_and_of_others_none_are_known(tmp_path):
    gridlock.run(SETTINGS, tmp_path / "loose", protocol=[{"stage": "quench", "packing_fraction": 0.4}], trajectory={"every": 1})
    contacts = gridlock.Trajectory(tmp_path / "loose/trajectory.h5").contacts
    assert contacts.ids.shape == (0, 2) and contacts.forces.shape == (0,)
    for name, protocol in (("separated", [*PROTOCOL, {"stage": "separate"}]), ("fluid", [])):
        disks = {**SETTINGS["disks"], "start": "uniform" if protocol else "random"}
        gridlock.run(SETTINGS, tmp_path / name, disks=disks, protocol=protocol, trajectory={"every": 10},
                     run={"seed": 3, "steps": 20}, engine={"kind": "exact"})
        trajectory = gridlock.Trajectory(tmp_path / name / "trajectory.h5")
        assert len(trajectory) == 3 and trajectory.contacts is None
