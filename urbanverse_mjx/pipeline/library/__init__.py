"""The scene library: tours of synthetic blocks, and sets of graphs compiled to cousins and packed."""
