"""Recipes of what people own, use, eat and leave in a street."""
