"""The transfer function of sRGB (IEC 61966-2-1) between linear light and encoded values, for NumPy and JAX."""

from typing import Any


def encoded(linear: Any) -> Any:
    """sRGB values in [0, 1] of linear light; light outside [0, 1] is clipped. Array of the same shape and kind."""
    xp = linear.__array_namespace__()
    linear = xp.clip(linear, 0.0, 1.0)
    return xp.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def linear(encoded: Any) -> Any:
    """Linear light of sRGB values in [0, 1]; array of the same shape and kind."""
    xp = encoded.__array_namespace__()
    return xp.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
