"""What follows without simulation: how far points are from their starts, at once and in the end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ..statistics import total

if TYPE_CHECKING:
    from numpy.typing import NDArray

_BINS = 64


def mean_distance_in_square(side: float) -> float:
    """⟨|r − r′|⟩ for both points uniform in a square: side · (2 + √2 + 5 arsinh 1)/15.

    >>> round(mean_distance_in_square(1.0), 10)
    0.5214054332
    """
    return side * (2.0 + math.sqrt(2.0) + 5.0 * math.asinh(1.0)) / 15.0


def _integral_from_corner(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """∫∫ |q| over 0 ≤ x ≤ a, 0 ≤ y ≤ b = (2abd + a³ arsinh(b/a) + b³ arsinh(a/b)) / 6 with the diagonal d."""
    with np.errstate(divide="ignore", invalid="ignore"):
        integral = (2.0 * a * b * np.hypot(a, b) + a * a * a * np.arcsinh(b / a) + b * b * b * np.arcsinh(a / b)) / 6.0
    return np.where((a > 0.0) & (b > 0.0), integral, 0.0)


def mean_distance(sites: NDArray[Any], lower: float, upper: float) -> float:
    """⟨|q − p|⟩ for p one of the sites, shape (N, 2), and q uniform in the square [lower, upper]² around them, exactly.

    How far disks are from their starts, on average, once they have forgotten them and their centres are uniform. Each site cuts
    the square into four rectangles with a corner at the site.
    """
    left, below = sites[:, 0] - lower, sites[:, 1] - lower
    right, above = upper - sites[:, 0], upper - sites[:, 1]
    integral = (_integral_from_corner(left, below) + _integral_from_corner(right, below)
                + _integral_from_corner(left, above) + _integral_from_corner(right, above))
    side = upper - lower
    return total(integral / (side * side)) / len(sites)


def _diffused_between_walls(starts: NDArray[Any], length: float, deviation: float) -> NDArray[Any]:
    """How likely each of equal bins of [0, length] is after diffusing from each start, by mirror images at both ends."""
    from scipy.special import ndtr  # type: ignore[import-untyped]

    # Beyond eight deviations nothing is left that a double could hold.
    images = math.ceil(8.0 * deviation / (2.0 * length)) + 1
    edges = np.linspace(0.0, length, _BINS + 1)
    shifts = 2.0 * length * np.arange(-images, images + 1)[:, None, None]
    below = ndtr((edges - starts[:, None] - shifts) / deviation) + ndtr((edges + starts[:, None] - shifts) / deviation)
    likely: NDArray[Any] = np.diff(below.sum(axis=0), axis=1)
    return likely


def mean_distance_after_diffusion(sites: NDArray[Any], lower: float, upper: float, diffused: float) -> float:
    """⟨|r(t) − r(0)|⟩ for points that start on the sites and diffuse between reflecting walls at ``lower`` and ``upper``.

    From √(πDt) at first to :func:`mean_distance` in the end, to a relative error of about 1e-3; ``diffused`` is D·t.
    """
    side = upper - lower
    deviation = math.sqrt(2.0 * diffused)
    # Narrower than a few bins, the walls are far for nearly all sites and the value of the plane holds.
    if deviation < 3.0 * side / _BINS:
        return deviation * math.sqrt(0.5 * math.pi)
    # A site and its mirror images count alike, and sites of a lattice share few coordinates: each is diffused once.
    folded = np.round(0.5 * side - np.abs(sites - 0.5 * (lower + upper)), 14)
    starts, places = np.unique(folded, return_inverse=True)
    pairs, counts = np.unique(np.sort(places.reshape(sites.shape), axis=1), axis=0, return_counts=True)
    middles = side * (np.arange(_BINS) + 0.5) / _BINS
    likely = _diffused_between_walls(starts, side, deviation)
    squares = (middles - starts[:, None]) ** 2
    distance = 0.0
    for (column, row), count in zip(pairs, counts):
        distance += count * (likely[column] @ np.sqrt(squares[column][:, None] + squares[row]) @ likely[row])
    return float(distance) / len(sites)


def enskog_diffusion(packing_fraction: float, radius: float, temperature: float) -> float:
    """Enskog's coefficient of self-diffusion for equal hard disks of mass 1, in length²/time.

        D = σ √(kT/π) / (2 ρσ² g(σ)),   ρσ² = 4φ/π,   g(σ) = (1 − 7φ/16)/(1 − φ)²

    Good to a few percent in the fluid below φ ≈ 0.6; nothing is claimed for the solid. Sources: S. Chapman & T. G. Cowling, The
    Mathematical Theory of Non-uniform Gases (1970), chapter 16; D. Henderson, A simple equation of state for hard discs (1975),
    doi:10.1080/00268977500102511.
    """
    density = 4.0 * packing_fraction / math.pi
    free = 1.0 - packing_fraction
    contact_value = (1.0 - 7.0 * packing_fraction / 16.0) / (free * free)
    return 2.0 * radius * math.sqrt(temperature / math.pi) / (2.0 * density * contact_value)
