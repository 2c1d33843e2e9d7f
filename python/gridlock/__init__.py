"""Gridlock: many agents that interact only with nearby neighbours.

Hard disks and agent models at the speed of C++, with the same bits as the command line; and the neighbour search for any points.

>>> import gridlock
>>> simulation = gridlock.Simulation(disks={"count": 100, "packing_fraction": 0.5}, engine={"kind": "exact"})
>>> simulation.equilibrate(steps=100)
>>> simulation.run(steps=400)
>>> simulation.results["compressibility_factor"].value > 2
True
"""

from . import _core
from .analysis import (
    DensityProfile,
    PairCorrelation,
    StructureFactor,
    Voronoi,
    bond_orientation,
    clusters,
    density_profile,
    mean_squared_displacement,
    pair_correlation,
    separations,
    structure_factor,
    voronoi,
)
from .box import Box
from .changes import Change
from .combine import Combined, combine
from .dynamics import Dynamics, diffusion_coefficient, dynamics, shear_viscosity
from .errors import Error, Problem, RunFailure
from .experiments import Experiment, ExperimentStopped, experiment, run_until
from .fields import Field
from .files import Frame, FrameContacts, RunDirectory, Trajectory, Verification, read_xyz, verify
from .files import open as open
from .glass import CollectiveScattering, StringLengths, VanHove, collective_scattering, string_lengths, van_hove
from .models import Model, Setting, register_model
from .neighbors import Neighbors, WeightedNeighbors, neighbors, pairs, pairs_of_disks
from .networks import Edges, Network, WorldNetwork
from .order import (
    Defects,
    OrderCorrelation,
    PairCorrelationMap,
    StructurePeak,
    defects,
    order_correlation,
    pair_correlation_map,
    structure_peak,
)
from .packings import Contacts, SpectralDensity, contacts, spectral_density
from .sensitivity import SobolDesign
from .show import Shown, show
from .simulation import Agents, Clock, Column, Result, Results, Simulation, run
from .sweeps import SweepDirectory, sweep
from .tables import Table
from .world import Halts, Start, World

__version__: str = _core.version.replace("-dev", ".dev0")  # as Python packages are numbered
__all__ = [
    "Agents", "Box", "Change", "Clock", "CollectiveScattering", "Column", "Combined", "Contacts", "Defects", "DensityProfile", "Dynamics", "Edges",
    "Error", "Experiment", "ExperimentStopped", "Field", "Frame", "FrameContacts", "Halts", "Model", "Neighbors", "Network", "OrderCorrelation",
    "PairCorrelation", "PairCorrelationMap", "Problem", "Result", "Results", "RunDirectory", "RunFailure", "Setting", "Shown",
    "Simulation", "SobolDesign", "SpectralDensity", "Start", "StringLengths", "StructureFactor", "StructurePeak", "SweepDirectory",
    "Table", "Trajectory", "VanHove", "Verification", "Voronoi", "WeightedNeighbors", "World", "WorldNetwork", "bond_orientation",
    "clusters", "collective_scattering", "combine", "contacts", "defects", "density_profile", "diffusion_coefficient", "dynamics",
    "experiment", "explain", "mean_squared_displacement", "neighbors", "order_correlation", "pair_correlation", "pair_correlation_map",
    "pairs", "pairs_of_disks", "read_xyz", "register_model", "run", "run_until", "separations", "shear_viscosity", "show",
    "spectral_density", "string_lengths", "structure_factor", "structure_peak", "sweep", "van_hove", "verify", "voronoi",
]


def explain(key: str) -> str:
    """What a setting means: type, unit, bounds, default.

    >>> print(explain("run.seed").splitlines()[0])
    run.seed
    """
    return _core.explain(key)
