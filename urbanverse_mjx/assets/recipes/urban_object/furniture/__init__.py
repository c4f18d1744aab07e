"""Recipes of furniture and fixtures."""
