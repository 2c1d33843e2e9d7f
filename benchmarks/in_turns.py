"""What the benchmarks in Python share: things timed one after the other, turn by turn, so that a slow minute is everybody's."""

import time


def timed_in_turns(todo, turns, warm=False):
    """The seconds of each turn, and what came out last, by name; warm: each is called before its time is taken too, so that it
    does not pay for the memory and the threads that another one leaves behind."""
    times = {name: [] for name in todo}
    found = {}
    for _ in range(turns):
        for name, call in todo.items():
            if warm:
                call()
            begin = time.perf_counter()
            found[name] = call()
            times[name].append(time.perf_counter() - begin)
    return times, found
