"""Exports assets to GLB, OBJ, MJCF and USD."""
