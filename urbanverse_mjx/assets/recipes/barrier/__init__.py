"""Recipes of barriers: what bars a route, and the stones and debris that obstruct one."""
