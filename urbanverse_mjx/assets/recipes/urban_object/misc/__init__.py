"""Recipes of the remaining urban objects: toys, tents, boards, weapons."""
