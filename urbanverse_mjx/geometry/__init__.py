"""Geometry that every package shares: rotations, grids seen from above, geodesic fields. It imports nothing of the
project, takes arrays, and each caller names its own cell size and cut-offs.

| module | what it answers | libraries |
| --- | --- | --- |
| `rotations` | quaternions and matrices, headings | those of the arrays: numpy or JAX |
| `grids` | square cells on the ground plane | numpy, SciPy; `cell_of` JAX too |
| `raster` | which cells convex shapes touch, how far they are from them | numpy, SciPy |
| `geodesics` | cheapest ways over passable cells | numpy, SciPy |
| `polygons` | which cells rings cover, for what makes scenes | shapely, scikit-image |
"""
