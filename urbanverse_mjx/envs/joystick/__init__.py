"""The locomotion task: a legged robot follows velocity commands over uneven ground."""

from .env import JoystickEnv

__all__ = ["JoystickEnv"]
