"""Whether this MuJoCo is of a line that has mujoco-mjx. There it is locked, so a test fails where it is missing."""

import importlib.metadata

#: The last line of MuJoCo with mujoco-mjx is 3.
HAS_MJX = int(importlib.metadata.version("mujoco").partition(".")[0]) < 4
