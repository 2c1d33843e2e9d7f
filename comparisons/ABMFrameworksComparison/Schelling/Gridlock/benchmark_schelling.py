"""The median time of 100 runs of the small and of the large model, as DECLARATION.md has them. Needs gridlock and numba."""

import random
import timeit

import gridlock
from gridlock.library import Schelling

N_RUN = 100
MODELS = {
    "small": {"model": Schelling(), "box.edge": "wall"},
    "large": {"model": Schelling(side=100, count=8000, radius=2, wanted=8), "box.edge": "wall"},
}


def run(settings, seed):
    gridlock.Simulation({**settings, "engine.threads": 1, "observe.every": 20, "run.seed": seed}).run(steps=20)


for size, settings in MODELS.items():
    run(settings, 0)  # Numba compiles.
    random.seed(42)
    seeds = [random.randint(1, 10000) for _ in range(N_RUN)]
    times = sorted(timeit.timeit(lambda: run(settings, seed), number=1) for seed in seeds)
    print(f"Gridlock Schelling-{size} (ms): {1000 * times[N_RUN // 2]}")
