"""All names used of MuJoCo Warp's private modules; no other module imports these.

The kernels of this package write contacts to its arrays like its own collision kernels; the types of these arrays and
the frame of a contact are not public.

Raises:
  ValidationError: the installed version lacks one of them.
"""

from ..private_modules import missing

#: The versions that these names were taken from; `pyproject.toml` asks for them.
NEEDED = ">=3.17,<3.18"

try:
    # The roots of its search trees by world: for the benchmark of mujoco-warp-pbr's own renderer.
    from mujoco_warp._src.bvh import compute_bvh_group_roots

    # A contact's frame from its normal.
    from mujoco_warp._src.math import make_frame

    # What a contact is for, and the type of a contact's friction and of a geom's solimp.
    from mujoco_warp._src.types import ContactType, vec5
except ImportError as error:
    raise missing("mujoco-warp", NEEDED, "the types of contacts", error) from error

__all__ = ["ContactType", "compute_bvh_group_roots", "make_frame", "vec5"]
