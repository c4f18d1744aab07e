"""The engine on MuJoCo Warp: the same step as kernels on CUDA devices, called from jitted JAX code."""

from .engine import WarpEngine, load_fused_steps
from .fused import NotFusible

__all__ = ["NotFusible", "WarpEngine", "load_fused_steps"]
