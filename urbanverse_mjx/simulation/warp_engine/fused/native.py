"""The physics steps of one control step in C++, for both compilers that Warp feeds: clang on the CPU, NVRTC for CUDA.

A robot's state stays in one `Work`, in the shared memory of a block of one warp on CUDA and on the stack on a CPU.
The program is a sequence of loops whose iterations are independent (`EACH`): the lanes of the warp divide them, a CPU
runs them one after another. Everything outside these loops is computed by all lanes alike.

The formulas are those of MuJoCo (Todorov, Erez, Tassa 2012, and the "Computation" chapter of its documentation):
composite inertia, recursive Newton-Euler, soft constraints with pyramidal cones, Newton's method with a line search,
and Euler integration with implicit damping. A contact keeps the three rows of its frame instead of the four of its
pyramid, and matrices are factorised within what a tree of joints leaves nonzero (Featherstone 2005).
"""

from typing import Any

import numpy as np

from .native_contacts import CONTACTS
from .native_dynamics import DYNAMICS, WORK
from .native_lanes import ALGEBRA, LANES_SOURCE
from .native_solver import SOLVER
from .native_step import STEP

__all__ = ["LANES", "preamble"]

#: Threads that share the work of an env on CUDA: one warp.
LANES = 32


def _table(name: str, values: Any) -> str:
    values = np.asarray(values)
    dims = "".join(f"[{n}]" for n in values.shape)

    def braces(x: Any) -> str:
        return "{ " + ", ".join(map(braces, x)) + " }" if isinstance(x, list) else f"{x}u" if kind == "u" else str(x)

    kind = values.dtype.kind
    return f"UV_TABLE {'unsigned' if kind == 'u' else 'int'} {name}{dims} = {braces(values.tolist())};\n"


def preamble(numbers: dict[str, int], floats: dict[str, float], tables: dict[str, Any], robot: dict[str, Any]) -> str:
    """The program of one robot, in the namespace `urbanverse`; needs `CUDA_CALLABLE` and the mathematics of C.

    Args:
      numbers, floats: constants by name.
      tables: arrays of whole numbers by name, which say how the robot is connected.
      robot: arrays of numbers by name; those that the program reads lie behind one another in this order, see `Robot`.
    """
    lines = [f"constexpr int {name} = {value};\n" for name, value in numbers.items()]
    lines += [f"constexpr float {name} = {float(value)!r}f;\n" for name, value in floats.items()]
    lines += [_table(name, values) for name, values in tables.items()]
    fields = "".join(
        f"    float {name}{''.join(f'[{n}]' for n in np.shape(values))};\n" for name, values in robot.items()
    )
    parts = [LANES_SOURCE, *lines, f"struct Robot {{\n{fields}}};\n", ALGEBRA, WORK, DYNAMICS, CONTACTS, SOLVER, STEP]
    # Nothing here is seen by another module, whose robot may have other sizes.
    return "namespace urbanverse { namespace {\n" + "".join(parts) + "\n} }\n"
