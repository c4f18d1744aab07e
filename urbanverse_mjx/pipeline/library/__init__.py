"""Builds the scene library: captures of synthetic blocks, and sets of compiled cousins packed into banks."""
