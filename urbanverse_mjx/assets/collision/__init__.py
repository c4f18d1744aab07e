"""Convex hulls that collide, and the mass properties of what they enclose."""
