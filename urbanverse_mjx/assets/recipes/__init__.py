"""Parametric recipes, one module per family; every module here is imported by `assets.meshes.recipe`."""
