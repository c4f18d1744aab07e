"""Recipes of amenities: what a street offers for use, its signs, lights and transport."""
