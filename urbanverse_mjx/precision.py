"""Full float32 precision in matrix products.

On CUDA, JAX multiplies float32 matrices with TF32's 10 bits of mantissa by default. This suffices for networks but not
for physics: on one H200 a COCO deviates from C MuJoCo by 33 mm after four seconds on a ramp, and by 0.03 mm with all 23
bits (`benchmarks.parity --impl jax`).
"""

import functools
from collections.abc import Callable

import jax


def full_precision[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """Returns the function with every matrix product inside it in float32; its callers keep their precision."""

    @functools.wraps(function)
    def precise(*args: P.args, **kwargs: P.kwargs) -> R:
        with jax.default_matmul_precision("highest"):
            return function(*args, **kwargs)

    return precise
