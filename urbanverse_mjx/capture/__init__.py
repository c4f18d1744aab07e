"""A scene of a bank seen along a camera path: recordings with the truth in them."""

from .filming import FilmOptions, film_scene
from .path import CameraPath, PathOptions, walk
from .truth import true_graph, true_objects

__all__ = ["CameraPath", "FilmOptions", "PathOptions", "film_scene", "true_graph", "true_objects", "walk"]
