"""Tools for manually composed scenes and procedural places: a free plan, ground in layers, groups of objects."""
