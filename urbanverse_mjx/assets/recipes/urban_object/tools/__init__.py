"""Recipes of tools."""
