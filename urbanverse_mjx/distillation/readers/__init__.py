"""Readers that convert external data to a `Recording`: KITTI-360, the folder documented by UrbanVerse-Gen's authors,
and COLMAP models."""

from .authors_tree import read_authors_tree
from .colmap import read_colmap
from .kitti360 import Kitti360Options, read_kitti360

__all__ = ["Kitti360Options", "read_authors_tree", "read_colmap", "read_kitti360"]
