"""Recipes of what people wear, carry and care for themselves with."""
