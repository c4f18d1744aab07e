"""Full float32 in matrix products.

On CUDA JAX multiplies float32 matrices with TF32's 10 bits by default, which networks do not notice. Physics does: on
one H200 a COCO was 33 mm beside C MuJoCo's after four seconds on a ramp, and is 0.03 mm with all 23 bits
(`benchmarks.parity --impl jax`).
"""

import functools
from collections.abc import Callable

import jax


def full_precision[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The function with every product of matrices inside it in float32; whatever calls it keeps its own precision."""

    @functools.wraps(function)
    def precise(*args: P.args, **kwargs: P.kwargs) -> R:
        with jax.default_matmul_precision("highest"):
            return function(*args, **kwargs)

    return precise
