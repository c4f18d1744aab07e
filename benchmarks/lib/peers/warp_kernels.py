"""Kernels around MuJoCo Warp's own: episodes that begin again, and images as channels."""

# Warp compiles these functions; their types are not Python's.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp


@wp.kernel
def begin_again(begins: wp.array[bool], start: wp.array2d[float], qpos: wp.array2d[float]):
    """Puts the envs that begin again at their starts; dim (n, nq)."""
    env, i = wp.tid()
    if begins[env]:
        qpos[env, i] = start[env, i]


@wp.kernel
def channels(packed: wp.array2d[wp.uint32], rgb: wp.array3d[wp.uint8]):
    """Unpacks MuJoCo Warp's pixels, red in the highest of three bytes, to (n, pixels, 3); dim (n, pixels)."""
    env, pixel = wp.tid()
    value = packed[env, pixel]
    rgb[env, pixel, 0] = wp.uint8((value >> wp.uint32(16)) & wp.uint32(255))
    rgb[env, pixel, 1] = wp.uint8((value >> wp.uint32(8)) & wp.uint32(255))
    rgb[env, pixel, 2] = wp.uint8(value & wp.uint32(255))
