"""Builds meshes from recipes: solids, images, the register of recipes, and instances of base shapes."""
