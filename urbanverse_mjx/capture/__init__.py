"""Renders a scene of a bank along a camera path to recordings with ground truth."""

from .filming import FilmOptions, film_scene
from .ground_truth import true_graph, true_objects
from .path import CameraPath, PathOptions, walk

__all__ = ["CameraPath", "FilmOptions", "PathOptions", "film_scene", "true_graph", "true_objects", "walk"]
