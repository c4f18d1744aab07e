"""Urban scenes, batched simulation and navigation training on MuJoCo MJX and JAX."""

__version__ = "0.1.0"
