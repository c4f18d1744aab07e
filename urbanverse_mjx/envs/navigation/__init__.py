"""The navigation task: drive to a goal over the pavement of a street, by camera, among people and objects."""

from .env import NavEnv

__all__ = ["NavEnv"]
