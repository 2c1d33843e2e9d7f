"""How much of the paper is simulated."""

from __future__ import annotations

import dataclasses

from gridlock import Error

Densities = tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class Engine:
    """One curve of Figures 6 and 7: the setting ``engine.kind``, and what the plots call it."""

    kind: str
    label: str


@dataclasses.dataclass(frozen=True)
class Length:
    """How long runs are, and how many there are of each."""

    steps: int
    sample_every: int
    seeds: int  #: one alone has no error over seeds, and no verdict rests on it
    #: Densities above it are left to the first engine: exact disks near closest packing collide so often that one point takes
    #: longer than all the others.
    densest_of_others: float = 1.0
    #: Densities that runs of this length do without.
    left_out: Densities = ()


@dataclasses.dataclass(frozen=True)
class Extent:
    """What the study simulates. Densities rise; for 841 disks they lie below 0.785 on the square lattice and 0.865 on the
    triangular one."""

    name: str
    #: Figure 6, and what compares the points of Figure 7 among themselves, for which it takes errors.
    figure_6: Length
    figure_7: Length  #: where it is that of Figure 6, so are the runs
    square_densities: Densities
    triangular_densities: Densities
    fan_densities: Densities  #: of Figure 6; those above the square lattice's largest start triangular
    disks: int = 841
    #: The curves of Figures 6 and 7, the paper's rule first; all run for the same physical time.
    engines: tuple[Engine, ...] = (Engine("stepped", "the paper's rule"), Engine("exact", "exact dynamics"))

    #: Figure 5: disks of one size, so large that the most of them just fit.
    timing_counts: tuple[int, ...] = (225, 400, 625, 900, 1000, 1225, 1600, 2000, 2209, 2304, 2401, 2500)
    timing_repeats: int = 3

    # The plateau at low density: runs long enough to forget the start, with a step chosen for speed.
    plateau_densities: Densities = (0.1,)
    plateau_seeds: int = 4
    plateau_time_step: float = 0.5  #: diameters per v_max
    plateau_relaxations: float = 10.0  #: length in relaxation times of the slowest mode of the box; the last 40 % count

    # What the paper leaves open, at the same physical time for every time step, beside the dynamics without one.
    choice_reference: Engine = Engine("exact", "exact dynamics")
    choice_time_steps: tuple[float, ...] = (0.05, 0.1, 0.2)  #: diameters per v_max
    choice_diameters: float = 150.0  #: length of the runs in diameters per v_max
    choice_seeds: int = 5
    choice_square_densities: Densities = (0.66, 0.74)
    choice_triangular_densities: Densities = (0.8,)

    # The order of the turns, which the paper leaves open too: stepped and tiled, beside exact, from the same starts.
    order_diameters: float = 128.0  #: length of the runs in diameters per v_max
    order_time_steps: tuple[float, ...] = (0.1, 0.025)  #: diameters per v_max; the curves are drawn of the first
    order_seeds: int = 8
    order_square_densities: Densities = (0.3, 0.6, 0.7)  #: none here and in the next two: not compared
    order_triangular_densities: Densities = (0.7, 0.8)
    order_periodic_densities: Densities = (0.3, 0.7)  #: from the square start


def quick() -> Extent:
    """Two minutes on two cores: Figure 7 has the paper's 100,000 steps and one seed, all else 10,000 and more seeds.

    A run of 100,000 steps costs as much as ten others, and an exact one at φ = 0.8 as much as ten at 0.5.
    """
    return Extent(
        name="quick",
        figure_6=Length(steps=10_000, sample_every=20, seeds=3, densest_of_others=0.76),
        figure_7=Length(steps=100_000, sample_every=200, seeds=1, densest_of_others=0.5, left_out=(0.3, 0.66, 0.8)),
        square_densities=(0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.72, 0.75, 0.78),
        triangular_densities=(0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.72, 0.76, 0.8, 0.84),
        fan_densities=(0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.72, 0.75, 0.8, 0.84),
        order_seeds=5,
    )


def full() -> Extent:
    """The paper's length, 100,000 steps: two lattices, at least 20 densities each, 4 seeds."""
    length = Length(steps=100_000, sample_every=100, seeds=4)
    return Extent(
        name="full",
        figure_6=length,
        figure_7=length,
        square_densities=(0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.55, 0.6, 0.62, 0.64, 0.66,
                          0.68, 0.69, 0.7, 0.71, 0.72, 0.73, 0.74, 0.75, 0.76, 0.77, 0.78),
        triangular_densities=(0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.55, 0.6, 0.62, 0.64, 0.66, 0.68,
                              0.69, 0.7, 0.71, 0.72, 0.73, 0.74, 0.76, 0.78, 0.8, 0.82, 0.84, 0.86),
        fan_densities=(0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.71, 0.73, 0.76, 0.8, 0.84),
        timing_repeats=9,
        plateau_densities=(0.1, 0.3, 0.5),
        plateau_seeds=8,
        plateau_relaxations=20.0,
        choice_time_steps=(0.025, 0.05, 0.1, 0.2),
        choice_diameters=1000.0,
        choice_seeds=4,
        choice_square_densities=(0.5, 0.66, 0.7, 0.74, 0.77),
        choice_triangular_densities=(0.7, 0.74, 0.8, 0.84),
        order_diameters=512.0,
        order_seeds=10,
        order_square_densities=(0.1, 0.3, 0.5, 0.66, 0.7, 0.74),
        order_triangular_densities=(0.7, 0.74, 0.8, 0.84),
        order_periodic_densities=(0.3, 0.5, 0.7),
    )


def require_possible(extent: Extent) -> None:
    """:raises Error: for an extent that is empty in part, or whose densities do not rise."""
    needed: list[object] = []
    for length in (extent.figure_6, extent.figure_7):
        needed += [length.steps, length.sample_every, length.seeds]
    needed += [extent.timing_repeats, extent.plateau_seeds, extent.choice_seeds, extent.engines, extent.square_densities,
              extent.triangular_densities, extent.fan_densities, extent.timing_counts, extent.choice_time_steps]
    if extent.order_square_densities + extent.order_triangular_densities + extent.order_periodic_densities:
        needed += [extent.order_diameters, extent.order_time_steps, extent.order_seeds]
    if not all(needed):
        raise Error("the extent of the study is empty in part\n  hint: start from quick() or full()")
    for densities in (extent.square_densities, extent.triangular_densities):
        if list(densities) != sorted(densities):
            raise Error("the packing fractions of the study do not rise\n  hint: sort them")
