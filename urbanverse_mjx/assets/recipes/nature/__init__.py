"""Recipes of terrain, plants and water."""
