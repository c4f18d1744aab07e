"""Moving agents: reciprocal collision avoidance, routes and behaviours of people and vehicles."""

from . import deadlock, half_planes, linear_program, neighbours, orca, resolve_collisions
from .bodies import Bodies, PreferredVelocity, Traits, num_long, num_wheeled, traits_of
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
    "PreferredVelocity",
    "Traits",
    "advance",
    "deadlock",
    "disturbed",
    "half_planes",
    "linear_program",
    "make_step",
    "neighbours",
    "no_walls",
    "num_long",
    "num_wheeled",
    "orca",
    "resolve_collisions",
    "traits_of",
]
