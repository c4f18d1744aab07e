"""A scene of a bank seen along a camera path: recordings with the truth in them."""

from .path import CameraPath, PathOptions, walk
from .tour import TourOptions, tour
from .truth import true_graph, true_objects

__all__ = ["CameraPath", "PathOptions", "TourOptions", "tour", "true_graph", "true_objects", "walk"]
