"""Moving agents: reciprocal collision avoidance of people and vehicles, where they go and how they behave."""

from . import half_planes, linear_program, neighbours, orca, patience, settle
from .bodies import Bodies, Traits, Wish, num_long, num_wheeled, traits_of
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
    "half_planes",
    "linear_program",
    "make_step",
    "neighbours",
    "no_walls",
    "num_long",
    "num_wheeled",
    "orca",
    "patience",
    "settle",
    "traits_of",
]
