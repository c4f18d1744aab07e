"""Moving agents: reciprocal collision avoidance of people and vehicles, where they go and how they behave."""

from .bodies import Bodies, Traits, Wish, num_wheeled, traits_of
from .kinds import KINDS, AgentKind
from .linear_program import HalfPlanes
from .orca import Grid, Options, advance, disturbed, make_step, no_walls

__all__ = [
    "KINDS",
    "AgentKind",
    "Bodies",
    "Grid",
    "HalfPlanes",
    "Options",
    "Traits",
    "Wish",
    "advance",
    "disturbed",
    "make_step",
    "no_walls",
    "num_wheeled",
    "traits_of",
]
