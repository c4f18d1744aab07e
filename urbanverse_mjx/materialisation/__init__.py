"""From what a street holds to what stands where: assets, materials, a sky, and no two things in one place."""

from .materialise import Materialisation, materialise

__all__ = ["Materialisation", "materialise"]
