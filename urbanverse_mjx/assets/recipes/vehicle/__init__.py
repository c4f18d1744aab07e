"""Recipes of vehicles, and the bodies and wheels that they share."""
