"""How much of jamming is simulated."""

from __future__ import annotations

import dataclasses

Densities = tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class Extent:
    """What the study simulates. Disks are half of one size and half 1.4 times as large, unless it says otherwise."""

    name: str
    #: Figure 1: starts at each packing fraction, by the number of disks.
    quench_starts: tuple[tuple[int, int], ...]
    quench_densities: Densities
    #: Figures 2, 3 and 6: packings that are decompressed.
    decompressed_disks: int
    decompressed_starts: int
    #: Figure 3 besides: a larger system, or none.
    large_disks: int
    large_starts: int
    #: Figure 4: the fluid from which disks are quenched, with the collisions a disk that take it to equilibrium.
    fluid_densities: tuple[tuple[float, float], ...]
    fluid_disks: int
    fluid_starts: int
    #: Figure 5: rates of growth.
    growth_rates: tuple[float, ...]
    growth_disks: int
    growth_starts: int
    #: Figure 7: packings of equal disks.
    equal_disks: int
    equal_starts: int
    #: Figure 8: packings sheared in small steps up to a strain.
    sheared_disks: int
    sheared_starts: int
    sheared_strain: float
    #: Figure 9: steady flows.
    flow_disks: int
    flow_starts: int
    flow_rates: tuple[float, ...]
    flow_strain: float
    #: Figure 10: slow shear in long steps, from whose pressures jamming is extrapolated.
    slow_disks: int
    slow_starts: int
    slow_strain: float
    slow_densities: Densities


def quick() -> Extent:
    """At most three minutes on two cores."""
    return Extent(
        name="quick", quench_starts=((64, 120), (256, 24)), quench_densities=(0.815, 0.825, 0.83, 0.835, 0.84, 0.845, 0.855),
        decompressed_disks=256, decompressed_starts=12, large_disks=1024, large_starts=1,
        fluid_densities=((0.4, 200.0), (0.6, 400.0), (0.7, 1000.0), (0.74, 2000.0), (0.775, 5000.0)), fluid_disks=256, fluid_starts=10,
        growth_rates=(2e-2, 2e-3, 4e-4), growth_disks=256, growth_starts=4, equal_disks=256, equal_starts=3,
        sheared_disks=64, sheared_starts=6, sheared_strain=1.5, flow_disks=256, flow_starts=2, flow_rates=(1e-2, 1e-3), flow_strain=6.0,
        slow_disks=256, slow_starts=6, slow_strain=0.6, slow_densities=(0.85, 0.86, 0.87),
    )


def full() -> Extent:
    """More starts and larger systems."""
    return Extent(
        name="full", quench_starts=((64, 600), (256, 150), (1024, 16)),
        quench_densities=(0.81, 0.82, 0.825, 0.83, 0.835, 0.84, 0.845, 0.85, 0.86),
        decompressed_disks=256, decompressed_starts=60, large_disks=1024, large_starts=8,
        fluid_densities=((0.4, 400.0), (0.6, 1000.0), (0.7, 2000.0), (0.74, 4000.0), (0.76, 10000.0), (0.775, 10000.0)),
        fluid_disks=256, fluid_starts=24, growth_rates=(2e-2, 2e-3, 2e-4), growth_disks=256, growth_starts=8, equal_disks=256,
        equal_starts=8, sheared_disks=64, sheared_starts=12, sheared_strain=2.5, flow_disks=256, flow_starts=4,
        flow_rates=(1e-2, 1e-3, 1e-4), flow_strain=10.0, slow_disks=256, slow_starts=12, slow_strain=2.0,
        slow_densities=(0.85, 0.855, 0.86, 0.865, 0.87),
    )
