"""Data of each category that need no mesh: names, sizes, materials, mass and friction."""
