"""The shipped streets as their generators build them, once a process: half a second to a second each."""

import functools
from typing import Any

from urbanverse_mjx.citygen import BUILDERS


@functools.cache
def built(scene_id: str) -> Any:
    """A shipped street, which is only read."""
    return BUILDERS[scene_id]()
