"""Robots with legs by data: a row of `legged.toml` becomes an MJCF, its appearance and a description.

In: a name of `NAMES`. Out: the description of `robots.load`, with the MJCF as text; a gait, where one is shipped. When:
once, at construction.

docs/robots.md lists the robots with their sources.
"""

import pathlib

from .mjcf import CAMERA, PHYSICS_TIMESTEP, ROOT, describe, make_mjcf
from .rows import NAMES, LeggedRow, joystick_name, row

__all__ = [
    "CAMERA",
    "NAMES",
    "PHYSICS_TIMESTEP",
    "ROOT",
    "LeggedRow",
    "describe",
    "gait_path",
    "joystick_name",
    "make_mjcf",
    "row",
]


def gait_path(name: str) -> pathlib.Path:
    """Where the gait of a robot lies that ships with the package, be it there or not."""
    return pathlib.Path(__file__).parents[1] / f"{name}_gait.npz"
