"""A process that was forked has none of the threads of its parent, and does not wait for them."""

import os
import signal
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="forks")

SCRIPT = """if True:
    import multiprocessing, warnings
    import gridlock

    warnings.simplefilter("ignore", DeprecationWarning)  # of forks beside threads
    SETTINGS = {"disks": {"count": 2000, "packing_fraction": 0.3}, "engine": {"kind": KIND, "threads": 3}}
    simulation = None

    def work(seed):  # replaces the simulation that it has inherited
        global simulation
        simulation = gridlock.Simulation(SETTINGS, run={"seed": seed})
        simulation.run(steps=5)
        return simulation.state_hash

    expected = [work(seed) for seed in range(4)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        print(pool.map(work, range(4)) == expected)
"""


@pytest.mark.parametrize("kind", ["tiled", "exact"])
def test_a_worker_may_drop_the_simulation_that_it_has_inherited(kind):
    text = SCRIPT.replace("KIND", repr(kind))
    process = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True, start_new_session=True)
    try:
        assert process.communicate(timeout=60)[0] == "True\n"
    finally:
        # Its workers too, which would wait for ever.
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
