"""Building traditions of the world's regions: recipes outside the catalogue, for streets whose graph names a city."""
