"""All physics steps of a control step in one launch, for robots of a tree of at most 32 velocities."""

from .batch import FusedBatch
from .kernel import load_steps, make_step
from .program import NotFusible, RobotProgram, build_program

__all__ = ["FusedBatch", "NotFusible", "RobotProgram", "build_program", "load_steps", "make_step"]
