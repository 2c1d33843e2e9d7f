"""Runs that differ in the seed alone, and what they have measured together."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable

from .extent import Engine, Extent, Length
from ..chapter import SetUp
from ..runs import RunPool
from .runs import Outcome, Run
from ..statistics import Estimate, mean_over_runs, plain, tail_mean

#: The time step of runs that are not about it, in diameters per v_max.
USUAL_TIME_STEP = 0.1
#: The share of a run, at its end, that halted moves and collision rates are taken over.
LAST_FIFTH = 0.2
_HALTED_FRACTION_OF_ARREST = 0.98


@dataclasses.dataclass(frozen=True)
class ReplicaSet:
    """Runs that differ in the seed alone; ``run`` has the first of their seeds."""

    engine: Engine
    run: Run
    seeds: int

    @property
    def runs(self) -> list[Run]:
        return [dataclasses.replace(self.run, seed=self.run.seed + number) for number in range(self.seeds)]

    def changed(self, **settings: object) -> ReplicaSet:
        """The same with other settings of the runs."""
        return dataclasses.replace(self, run=dataclasses.replace(self.run, **settings))  # type: ignore[arg-type]

    def moved_by(self, engine: Engine) -> ReplicaSet:
        """The same starts under another engine."""
        return dataclasses.replace(self.changed(engine=engine.kind), engine=engine)


def paper_replica_set(extent: Extent, seed: int, length: Length, engine: Engine, start: str,
                      packing_fraction: float) -> ReplicaSet:
    """One point of Figures 6 and 7, in runs of the length given."""
    run = Run(extent.disks, packing_fraction, length.steps, length.sample_every, seed, engine.kind, start)
    return ReplicaSet(engine, run, length.seeds)


def is_run(extent: Extent, length: Length, engine: Engine, packing_fraction: float) -> bool:
    """Whether the study has runs of this length at a density."""
    is_sparse_enough = engine == extent.engines[0] or packing_fraction <= length.densest_of_others
    return is_sparse_enough and packing_fraction not in length.left_out


def paper_replica_sets(extent: Extent, seed: int, length: Length) -> list[ReplicaSet]:
    """All points of Figure 7 in runs of one length: engine after engine, square before triangular, density rising."""
    return [
        paper_replica_set(extent, seed, length, engine, start, density)
        for engine in extent.engines
        for start, densities in (("square", extent.square_densities), ("triangular", extent.triangular_densities))
        for density in densities
        if is_run(extent, length, engine, density)
    ]


def set_ups(replica_sets: Iterable[ReplicaSet]) -> list[SetUp]:
    """The first run of each, for the playground, whose end is left to the reader."""
    made = []
    for one in replica_sets:
        settings = {table: dict(values) for table, values in one.run.settings.items()}
        del settings["run"]["steps"]
        made.append(SetUp(f"φ = {plain(one.run.packing_fraction)}", settings, f"{one.run.start} start, {one.engine.label}"))
    return made


def sampled_evenly(replica_set: ReplicaSet, diameters: float, samples: int) -> ReplicaSet:
    """The replica set with samples at the same physical times whatever its time step, over a length in diameters per v_max."""
    every = max(1, round(diameters / replica_set.run.time_step / samples))
    return replica_set.changed(sample_every=every, steps=every * samples)


class Measured:
    """What a set of replicas has measured, over those of its runs that are finished."""

    def __init__(self, runs: RunPool[Run, Outcome], replica_set: ReplicaSet) -> None:
        self.set = replica_set
        self.outcomes: list[Outcome] = [outcome for run in replica_set.runs if (outcome := runs[run]) is not None]
        self.seeds = len(self.outcomes)
        #: Samples that every run has; the first is the start.
        self.samples = len(self.outcomes[0].series["step"]) if self.outcomes else 0

    def step(self, sample: int) -> float:
        return float(self.outcomes[0].series["step"][sample])

    def time(self, sample: int) -> float:
        return float(self.outcomes[0].series["time"][sample])

    def samples_spread_out(self, parts: int) -> list[int]:
        """Samples that show on a logarithmic axis, where the start has no place: each about a part 1/parts later than the one
        before, and the last."""
        chosen, following = [], 1
        for sample in range(1, self.samples):
            if sample >= following or sample + 1 == self.samples:
                chosen.append(sample)
                following = sample + 1 + sample // parts
        return chosen

    def of_each_seed(self, value: Callable[[Outcome], float]) -> list[float]:
        return [value(outcome) for outcome in self.outcomes]

    def at(self, name: str, sample: int) -> Estimate:
        """A column of the series at a sample, mean and standard error over seeds."""
        return mean_over_runs(self.of_each_seed(lambda outcome: float(outcome.series[name][sample])))

    def tail(self, name: str, share: float) -> Estimate:
        """The same, each run averaged over the last share of its samples first."""
        return mean_over_runs(self.of_each_seed(lambda outcome: tail_mean(outcome.series[name], share)))

    def displacement(self, sample: int = -1) -> Estimate:
        """The mean displacement over the side of the box."""
        return self.at("mean_displacement", sample)

    @property
    def halted_fraction(self) -> Estimate:
        return self.tail("halted_fraction", LAST_FIFTH)

    @property
    def collision_rate(self) -> Estimate:
        return self.tail("collision_rate", LAST_FIFTH)

    @property
    def arrested(self) -> int:
        """Runs in which, over the last fifth, more than 98 % of all moves were halted: the system has come to a standstill. None
        where the engine halts no disks."""
        halted = self.of_each_seed(lambda outcome: tail_mean(outcome.series["halted_fraction"], LAST_FIFTH))
        return sum(share > _HALTED_FRACTION_OF_ARREST for share in halted)
