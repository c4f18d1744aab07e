"""The scene library: captures of synthetic blocks, and sets of graphs compiled to cousins and packed."""
