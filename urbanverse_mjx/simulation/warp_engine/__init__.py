"""The engine on MuJoCo Warp: the same step as kernels on CUDA devices, called from jitted JAX code."""

from .engine import WarpEngine
from .fused import NotFusible

__all__ = ["NotFusible", "WarpEngine"]
