"""Converts a video to a `Recording`: frames, screening, poses, metric scale, depth, objects and surfaces."""

from .frames import Frames, SamplingOptions, photograph, sample
from .mapping import StructureOptions, reconstruct
from .observation import FrameObservation, Predictor
from .perceive import Perception, perceive
from .privacy import Blur, blur_by_name
from .single_image import Photograph, perceive_photograph
from .trajectory import TrajectoryError, trajectory_error

__all__ = [
    "Blur",
    "FrameObservation",
    "Frames",
    "Perception",
    "Photograph",
    "Predictor",
    "SamplingOptions",
    "StructureOptions",
    "TrajectoryError",
    "blur_by_name",
    "perceive",
    "perceive_photograph",
    "photograph",
    "reconstruct",
    "sample",
    "trajectory_error",
]
