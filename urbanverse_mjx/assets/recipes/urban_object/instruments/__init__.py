"""Recipes of musical instruments."""
