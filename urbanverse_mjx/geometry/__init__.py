"""Geometry that every package shares: rotations, grids seen from above, geodesic fields. It imports no other package of
the project, takes arrays, and each caller passes its own cell size and cut-offs.

| module | contents | libraries |
| --- | --- | --- |
| `rotations` | quaternions and matrices, headings | those of the arrays: numpy or JAX |
| `grids` | square cells on the ground plane | numpy, SciPy; `cell_of` JAX too |
| `raster` | which cells convex shapes touch, how far they are from them | numpy, SciPy |
| `geodesics` | cheapest paths over passable cells | numpy, SciPy |
| `polygons` | which cells rings cover, for code that makes scenes | shapely, scikit-image |
"""
