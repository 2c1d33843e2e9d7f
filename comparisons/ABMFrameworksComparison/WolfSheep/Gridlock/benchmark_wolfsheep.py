"""The median time of 100 runs of the small and of the large model, as DECLARATION.md has them. Needs gridlock and numba."""

import random
import timeit

import gridlock
from gridlock.library import WolfSheep

N_RUN = 100
MODELS = {
    "small": {"model": WolfSheep(), "box.edge": "wall"},
    "large": {"model": WolfSheep(side=100, sheep=1000, wolves=500, regrowth=10, sheep_birth=0.4, wolf_birth=0.2), "box.edge": "wall"},
}


def run(settings, seed):
    gridlock.Simulation({**settings, "engine.threads": 1, "observe.every": 100, "run.seed": seed}).run(steps=100)


for size, settings in MODELS.items():
    run(settings, 0)  # Numba compiles.
    random.seed(42)
    seeds = [random.randint(1, 10000) for _ in range(N_RUN)]
    times = sorted(timeit.timeit(lambda: run(settings, seed), number=1) for seed in seeds)
    print(f"Gridlock WolfSheep-{size} (ms): {1000 * times[N_RUN // 2]}")
