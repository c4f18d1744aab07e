"""Recipes of shops: town houses with a shop front, its goods, emblems and signs."""
