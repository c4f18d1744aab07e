"""Recipes of people, animals and walking robots."""
