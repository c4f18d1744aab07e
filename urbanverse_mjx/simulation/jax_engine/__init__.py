"""The engine on MJX: the robot in JAX, its contacts with streamed hulls, bodies and agents as rows of one solver."""

from .engine import JaxEngine

__all__ = ["JaxEngine"]
