"""Recipes of sports equipment."""
