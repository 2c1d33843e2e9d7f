#!/usr/bin/env python3
"""What a page that follows a model in Python costs it, in turns in one run: steps with a page that asks as fast as it can, and without.

    PYTHONPATH=build/python benchmarks/python_show.py 10000 5

Prints frames a second, and processor time a step of the whole process that runs the model, in milliseconds.
"""

import http.client
import json
import subprocess
import sys
import time
import urllib.parse

import numpy as np

import gridlock

SECONDS = 3.0


class Walkers(gridlock.Model):
    """People who walk at random and infect those near them."""

    name = "bench_walkers"
    columns = {"health": np.uint32}
    count = gridlock.Setting(10_000, "People.", least=1)

    def start(self, start):
        start.add(positions=start.anywhere(self.count), health=np.arange(self.count) < 10)

    def step(self, world):
        near = world.neighbors(1.5 / self.count**0.5).sum(world.health == 1)
        world.health[(near > 0) & (world.uniform() < 0.02)] = 1
        world.move(0.1 / self.count**0.5 * world.normal(2, purpose=1))

    def observe(self, world):
        return {"infected": float(np.mean(world.health == 1))}


def follow(url: str) -> None:
    """What a page does: it asks for the next frame when it has one, until the run pauses. Prints how many it got a second."""
    address = urllib.parse.urlsplit(url)
    server = http.client.HTTPConnection(address.netloc)
    version, run, rows = 0, 0, 0
    times: list[float] = []
    head = {"isRunning": False}
    while head["isRunning"] or not times:
        server.request("GET", f"{address.path}live/frame?after={version}&run={run}&rows={rows}&columns=health")
        data = server.getresponse().read()
        if not data:
            continue  # nothing new for a long time
        head = json.loads(data[4 : 4 + int.from_bytes(data[:4], "little")])
        rows = head["series"]["rows"] + (rows if run == head["run"] else 0)
        version, run = head["version"], head["run"]
        if head["isRunning"]:
            times.append(time.monotonic())
    print((len(times) - 1) / (times[-1] - times[0]))


def turn(shown: gridlock.Shown, is_followed: bool) -> tuple[float, float]:
    """Frames a second, and milliseconds of processor a step."""
    shown._live.restart()
    page = subprocess.Popen([sys.executable, __file__, "follow", shown.url], stdout=subprocess.PIPE) if is_followed else None
    time.sleep(1.0)
    began = time.process_time()
    shown._live.run(None)
    time.sleep(SECONDS)
    steps = shown.simulation.clock.step
    cost = 1e3 * (time.process_time() - began) / steps
    return (float(page.communicate()[0]) if page else 0.0), cost


def main() -> None:
    count, turns = int(sys.argv[1]), int(sys.argv[2])
    shown = gridlock.show(Walkers(count=count), box={"edge": "periodic"}, block=False)
    results = np.array([[*turn(shown, True), *turn(shown, False)] for _ in range(turns)])
    frames, with_page, _, without = np.median(results, axis=0)
    print(f"{count} agents: {frames:.0f} frames a second; {with_page:.3f} ms a step with the page, {without:.3f} without: "
          f"{100 * (np.median(results[:, 1] / results[:, 3]) - 1):.1f} % more")
    shown.close()


if sys.argv[1] == "follow":
    follow(sys.argv[2])
else:
    main()
