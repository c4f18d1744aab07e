"""Tools for manually composed scenes and procedural places: free ground plans, layered ground, groups of objects."""
