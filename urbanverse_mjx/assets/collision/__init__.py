"""Convex collision hulls, and the mass properties of their volume."""
