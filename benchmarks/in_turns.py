"""What the benchmarks in Python share: things timed one after the other, turn by turn, so that a slow minute is everybody's."""

import time


def timed_in_turns(todo, turns):
    """The seconds of each turn, and what came out last, by name."""
    times = {name: [] for name in todo}
    found = {}
    for _ in range(turns):
        for name, call in todo.items():
            begin = time.perf_counter()
            found[name] = call()
            times[name].append(time.perf_counter() - begin)
    return times, found
