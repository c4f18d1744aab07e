"""The navigation task: drive to a goal on the pavement of a street, with a camera, among people and objects."""

from .env import NavEnv

__all__ = ["NavEnv"]
