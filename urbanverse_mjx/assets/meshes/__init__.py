"""From recipes to meshes: solids, paint, the register of recipes, and instances of one base shape."""
