"""Geometry functions shared by all packages: rotations, grids on the ground plane, geodesic fields. This package
imports no other package of the project; its functions take arrays, and callers pass cell sizes and cut-offs.

| module | contents | libraries |
| --- | --- | --- |
| `rotations` | quaternions and matrices, headings | those of the arrays: numpy or JAX |
| `grids` | square cells on the ground plane | numpy, SciPy; `cell_of` JAX too |
| `raster` | which cells convex shapes touch, how far they are from them | numpy, SciPy |
| `geodesics` | cheapest paths over passable cells | numpy, SciPy |
| `polygons` | which cells rings cover, for code that makes scenes | shapely, scikit-image |
"""
