"""Ground materials and skies: how they are painted, described and found."""
