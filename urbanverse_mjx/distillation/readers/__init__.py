"""Readers that convert external data to a `Recording`: KITTI-360, and the folder documented by UrbanVerse-Gen's
authors."""

from .authors_tree import read_authors_tree
from .kitti360 import Kitti360Options, read_kitti360

__all__ = ["Kitti360Options", "read_authors_tree", "read_kitti360"]
