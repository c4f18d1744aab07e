"""Shared by recipes of several folders: sizes, outlines, soft and painted shapes, images of fronts."""
