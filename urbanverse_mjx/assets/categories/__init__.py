"""What is known of each category before any mesh exists: names, sizes, matter, mass and friction."""
