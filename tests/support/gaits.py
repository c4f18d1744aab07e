"""Untrained gaits: one that stands, or random small networks."""

import numpy as np

from urbanverse_mjx.robots import go2_body
from urbanverse_mjx.robots.gait import Gait


def make_gait(seed: int | None = None, history: int = 5, hidden: int = 8) -> Gait:
    """A gait of the Go2; without a seed all its actions are 0: it stands."""
    rng = np.random.default_rng(seed)
    gain = 0.0 if seed is None else 0.05
    sizes = [(history * 45, hidden), (hidden, 12)]
    return Gait(
        kernels=tuple((gain * rng.normal(size=s)).astype(np.float32) for s in sizes),
        biases=tuple((gain * rng.normal(size=s[1])).astype(np.float32) for s in sizes),
        stand=np.array(go2_body.stand_pose(), np.float32),
        scale=np.tile(np.array([0.4, 1.0, 1.0], np.float32), 4),
        history=history,
        control_dt=0.02,
        meta={"robot": "go2", "seed": seed},
    )
