"""A scene of a bank seen along a camera path: recordings with the ground truth in them."""

from .filming import FilmOptions, film_scene
from .ground_truth import true_graph, true_objects
from .path import CameraPath, PathOptions, walk

__all__ = ["CameraPath", "FilmOptions", "PathOptions", "film_scene", "true_graph", "true_objects", "walk"]
