"""Geometry that every package shares: rotations, grids seen from above, geodesic fields. It imports nothing of the
project, takes arrays, and each caller names its own cell size and cut-offs.

| module | what it answers | libraries |
| --- | --- | --- |
| `rotations` | quaternions and matrices, headings | those of the arrays: numpy or JAX |
"""
