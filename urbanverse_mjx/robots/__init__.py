"""Robots as data."""

from .coco import make_coco

__all__ = ["make_coco"]
