"""Robots as data."""

from .coco import make_coco
from .go2 import make_go2

__all__ = ["make_coco", "make_go2"]
