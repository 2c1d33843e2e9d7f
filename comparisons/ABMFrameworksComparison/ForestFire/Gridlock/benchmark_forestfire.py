"""The median time of 100 runs of the small and of the large model, as DECLARATION.md has them. Needs gridlock."""

import random
import timeit

import gridlock
from gridlock.library import ForestFire

N_RUN = 100
MODELS = {
    "small": {"model": ForestFire(side=100, density=0.7)},
    "large": {"model": ForestFire(side=500, density=0.9)},
}


def run(settings, seed):
    gridlock.Simulation({**settings, "engine.threads": 1, "observe.every": 100, "run.seed": seed}).run(steps=100)


for size, settings in MODELS.items():
    run(settings, 0)
    random.seed(42)
    seeds = [random.randint(1, 10000) for _ in range(N_RUN)]
    times = sorted(timeit.timeit(lambda: run(settings, seed), number=1) for seed in seeds)
    print(f"Gridlock ForestFire-{size} (ms): {1000 * times[N_RUN // 2]}")
