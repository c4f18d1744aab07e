"""Robots on wheels by data: a row of `robots.toml` becomes an MJCF and a description, as a user writes them.

In: a name of `NAMES`. Out: the description of `robots.load`, with the MJCF as text. When: once, at construction.

docs/robots.md lists the robots with their sources.
"""

from .balance import balance_gait
from .mjcf import describe
from .rows import NAMES, PAVEMENT_SPEED, Row, environment_name, row

__all__ = ["NAMES", "PAVEMENT_SPEED", "Row", "balance_gait", "describe", "environment_name", "row"]
