"""Engines that one would pick for a street, driven alike: what `benchmarks.peers` measures."""
