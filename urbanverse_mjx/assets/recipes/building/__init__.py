"""Recipes of buildings, and the facades and masonry that they are put together from."""
