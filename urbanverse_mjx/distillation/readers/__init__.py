"""Other people's recordings become ours: KITTI-360, and what UrbanVerse-Gen's authors document."""

from .authors_tree import read_authors_tree
from .kitti360 import Kitti360Options, read_kitti360

__all__ = ["Kitti360Options", "read_authors_tree", "read_kitti360"]
