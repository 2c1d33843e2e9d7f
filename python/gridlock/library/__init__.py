"""Models that everybody knows, each one file to run, to copy and to change.

``import gridlock.library`` makes them known by their names:

>>> import gridlock, gridlock.library
>>> simulation = gridlock.Simulation(model="forest_fire", forest_fire={"side": 50, "density": 0.7}, observe={"every": 1})
>>> simulation.run(steps=300)
>>> print(f"{simulation.series['burnt'][-1]:.1f} of the trees have burnt")
1.0 of the trees have burnt

Each is a class as any of one's own: its settings have bounds, its docstring gives the rule and its source.
"""

from .ants import Ants
from .boids import Boids
from .flock import Flock
from .forest_fire import ForestFire
from .random_organization import RandomOrganization
from .schelling import Schelling
from .sir import SIR
from .sir_network import SIRNetwork
from .sugarscape import Sugarscape
from .voter import Voter
from .wolf_sheep import WolfSheep

__all__ = ["SIR", "Ants", "Boids", "Flock", "ForestFire", "RandomOrganization", "SIRNetwork", "Schelling", "Sugarscape", "Voter",
           "WolfSheep"]
