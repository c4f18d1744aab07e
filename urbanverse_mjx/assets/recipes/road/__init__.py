"""Recipes of pieces of roads."""
