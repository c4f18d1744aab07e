"""Recipes of food and drinks."""
