"""How much of melting is simulated."""

from __future__ import annotations

import dataclasses

Densities = tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class System:
    """Runs of so many disks at each packing fraction, half of them from the crystal and half from a compressed liquid."""

    disks: int
    densities: Densities
    collisions_per_disk: float  #: of each run, roughly; a quarter of them is left out of the means
    starts: int  #: of each kind
    frames: int  #: of each run, for correlations and the Bragg peak


@dataclasses.dataclass(frozen=True)
class ConstantPressure:
    """Figure 7: Monte Carlo at pressures βP(2R)²."""

    disks: int
    pressures: tuple[float, ...]
    sweeps: int
    starts: int


@dataclasses.dataclass(frozen=True)
class Extent:
    """What the study simulates."""

    name: str
    #: In rising numbers of disks. 224, 780, 3,120 … fill a square box with a crystal that is strained by less than 1 %; for 72, 224 and
    #: 870 there are published pressures.
    systems: tuple[System, ...]
    samples: int  #: of each run
    constant_pressure: ConstantPressure


_FEW = (0.58, 0.60, 0.62, 0.64, 0.65, 0.66, 0.67, 0.68, 0.69, 0.70, 0.71, 0.72)
_LOOP = (0.66, 0.67, 0.68, 0.69, 0.70, 0.705, 0.71, 0.715, 0.72, 0.74)


def quick() -> Extent:
    """About four minutes on two cores."""
    return Extent(
        name="quick", samples=240, constant_pressure=ConstantPressure(72, (6.5, 6.9, 7.2), 100_000, 4),
        systems=(System(72, _FEW, 40_000.0, 3, 0), System(224, _LOOP, 36_000.0, 3, 8),
                 System(780, (0.66, 0.68, 0.69, 0.70, 0.705, 0.71, 0.715, 0.72, 0.74), 18_000.0, 2, 8),
                 System(870, (0.67, 0.68, 0.69), 8_000.0, 2, 0),
                 System(3120, (0.66, 0.69, 0.70, 0.705, 0.71, 0.72, 0.74), 7_000.0, 2, 8)))


def full() -> Extent:
    """More and larger systems, and longer runs."""
    loop = (0.66, 0.67, 0.68, 0.69, 0.695, 0.70, 0.704, 0.708, 0.712, 0.716, 0.72, 0.73, 0.74)
    large = (0.66, 0.69, 0.698, 0.70, 0.704, 0.708, 0.712, 0.716, 0.72, 0.74)
    return Extent(
        name="full", samples=800, constant_pressure=ConstantPressure(72, (6.5, 6.9, 7.2), 1_000_000, 8),
        systems=(System(72, _FEW, 1_000_000.0, 4, 0), System(224, loop, 500_000.0, 4, 20), System(780, loop, 300_000.0, 4, 20),
                 System(870, (0.67, 0.68, 0.69), 100_000.0, 4, 0), System(3120, loop, 100_000.0, 4, 20),
                 System(12_480, large, 60_000.0, 2, 20), System(49_920, large, 60_000.0, 2, 20)))
