"""Published numbers and equations that runs are compared with."""

from __future__ import annotations

import math
from typing import NamedTuple

from ..statistics import Estimate

#: Z = Σ A_i x^i with x = φ/(1 − φ) (J. Kolafa, M. Rottner 2006, doi:10.1080/00268970600967963), good to 1e-5 up to φ = 0.67.
_KOLAFA_ROTTNER = {
    0: 1.0, 1: 2.0, 2: 1.12801775, 3: 0.00181895291, 4: -0.0526134737, 5: 0.0504963915, 6: -0.0325578581, 7: 0.0134816028,
    8: 0.00129187484, 9: -0.00808881628, 10: 0.00669011963, 11: -0.00250795961, 12: 0.000336036442, 22: -5.15282664e-9,
    57: 5.77730095e-23,
}
#: Above it the equation of state is not to be used.
LAST_FLUID = 0.67


def fluid_pressure(packing_fraction: float) -> float:
    """P* = βP(2R)² of the infinite fluid.

    >>> round(fluid_pressure(0.65) / (4.0 * 0.65 / math.pi), 4)
    8.408
    """
    x = packing_fraction / (1.0 - packing_fraction)
    return sum(a * x**i for i, a in _KOLAFA_ROTTNER.items()) * 4.0 * packing_fraction / math.pi


class Published(NamedTuple):
    """P* at a packing fraction."""

    packing_fraction: float
    pressure: Estimate


def _published(*rows: tuple[float, float, float]) -> tuple[Published, ...]:
    return tuple(Published(density, Estimate(pressure, error)) for density, pressure, error in rows)


#: B. Li et al. (2022), doi:10.1063/5.0126437: few disks in a square periodic box.
SMALL = {
    72: _published((0.65, 6.901074, 7.1e-5), (0.66, 7.383221, 8.7e-5), (0.67, 7.85637, 1.1e-4), (0.68, 8.23631, 3.4e-4),
                   (0.69, 8.41814, 3.8e-4), (0.70, 8.5517, 5.9e-4)),
    224: _published((0.67, 7.979479, 5.8e-5), (0.68, 8.49105, 1.9e-4)),
    870: _published((0.67, 7.986779, 2.5e-5), (0.68, 8.513249, 3.7e-5), (0.69, 8.969898, 7.5e-5)),
}
#: 1,024² disks, by Monte Carlo (M. Engel et al. 2013, doi:10.1103/PhysRevE.87.042134).
LARGE = _published((0.698, 9.169342, 2.3e-5), (0.70, 9.185405, 8.5e-5), (0.704, 9.18674, 1.4e-4), (0.708, 9.184959, 6.1e-5),
                   (0.712, 9.183379, 7.0e-5), (0.716, 9.18327, 1.0e-4), (0.72, 9.23083, 8.0e-4))
#: The packing fractions and the pressure of liquid and hexatic that coexist (E. P. Bernard, W. Krauth 2011,
#: doi:10.1103/PhysRevLett.107.155704; Engel et al. 2013).
LIQUID, HEXATIC, COEXISTENCE = 0.700, 0.716, 9.185
#: Below so many disks the box bends the transition by more than errors.
MANY_DISKS = 10_000
#: The largest exponents of a hexatic and of a crystal (D. R. Nelson, B. I. Halperin 1979, doi:10.1103/PhysRevB.19.2457).
HEXATIC_EXPONENT, CRYSTAL_EXPONENT = 0.25, 1.0 / 3.0
