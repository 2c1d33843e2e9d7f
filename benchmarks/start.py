#!/usr/bin/env python3
"""The time of a start of the program: least and median of 200 starts, with what a start of `true` takes beside it.

    benchmarks/start.py build/apps/gridlock/gridlock
"""

import os
import statistics
import sys
import time

STARTS = 200
COMMANDS = (["--version"], ["explain"], ["explain", "disks.count"])


def milliseconds(command, silent):
    begin = time.perf_counter()
    process = os.posix_spawn(
        command[0], command, os.environ, file_actions=[(os.POSIX_SPAWN_DUP2, silent, 1)]
    )
    _, status = os.waitpid(process, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)} failed")
    return 1000 * (time.perf_counter() - begin)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program = os.path.abspath(sys.argv[1])
    silent = os.open(os.devnull, os.O_WRONLY)
    print(f"{'milliseconds':28}{'least':>8}{'median':>8}")
    for command in [["/bin/true"]] + [[program, *words] for words in COMMANDS]:
        milliseconds(command, silent)  # the first start reads from the disk
        times = [milliseconds(command, silent) for _ in range(STARTS)]
        name = " ".join([os.path.basename(command[0]), *command[1:]])
        print(f"{name:28}{min(times):8.2f}{statistics.median(times):8.2f}")


main()
