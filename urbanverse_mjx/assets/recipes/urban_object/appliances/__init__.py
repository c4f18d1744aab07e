"""Recipes of electrical appliances."""
