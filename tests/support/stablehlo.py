"""What stands in a program before XLA compiles it."""

import math
import re


def largest_constant(text: str) -> int:
    """Elements of the largest constant of a program in StableHLO."""
    shapes = re.findall(r"stablehlo\.constant dense<.*?> : tensor<((?:\d+x)*)\w+>", text)
    return max((math.prod(int(n) for n in shape.split("x") if n) for shape in shapes), default=0)
