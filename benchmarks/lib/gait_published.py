"""The tables of `benchmarks.go2_gait`: a gait's results with its goals, and with published figures.

Published figures are copied from their source; none comes from a run of this benchmark. A quantity without a published
figure is in the first table only.
"""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from benchmarks.lib import tables

#: %, share of trials from which a kerb or ramp counts as passed.
KERB_SHARE, RAMP_SHARE = 90.0, 100.0
Found = Mapping[str, Any]


@dataclasses.dataclass(frozen=True)
class Published:
    """A published figure.

    Attributes:
      what: quantity and unit.
      theirs: as published.
      whose: robot, engine, device.
      source: of the figure.
      ours: this benchmark's result; None if it was not measured.
    """

    what: str
    theirs: str
    whose: str
    source: str
    ours: Callable[[Found], str | None]


def _speed(found: Found) -> str | None:
    row = found.get("straight")
    return f"{row['speed_m_s']:.2f}" if row and row["speed_m_s"] is not None else None


def _minutes(found: Found) -> str | None:
    """Returns env-steps and wall time of the training, from the gait's file."""
    meta = found["meta"]
    if not meta.get("wall_seconds"):
        return None
    wall = float(np.sum(meta["wall_seconds"]))
    return f"{meta['steps'] / 1e6:.0f} M in {wall / 60:.1f} min, {meta['device']}"


def _rate(found: Found) -> str | None:
    meta = found["meta"]
    if not meta.get("wall_seconds"):
        return None
    return f"{meta['steps'] / float(np.sum(meta['wall_seconds'])) / 1e3:.0f} k, compilation included"


def _highest(found: Found) -> str | None:
    """Returns the highest kerb that was climbed and descended in `KERB_SHARE` of the trials."""
    shares: dict[float, float] = {}
    for row in found["kerbs"]:
        shares[row["height_m"]] = min(shares.get(row["height_m"], 100.0), row["passed_percent"])
    passed = [height for height, share in shares.items() if share >= KERB_SHARE]
    return f"{100 * max(passed):.0f} in at least {KERB_SHARE:.0f} %" if passed else None


def _steepest(found: Found) -> str | None:
    passed = [row["slope"] for row in found["ramps"] if row["passed_percent"] >= RAMP_SHARE]
    return f"{np.degrees(np.arctan(max(passed))):.0f}, always" if passed else None


_PLAYGROUND = "google-deepmind/mujoco_playground, learning/notebooks/locomotion.ipynb, commit d5e6b47"
_RL_GAMES = "Denys88/rl_games, docs/MJLAB.md"
_RUDIN = "arXiv 2109.11978, abstract; steps are those of legged_gym's settings, commit 8fa29ac"
_MAKER = "the maker's product page, read second hand and not checked"
PUBLISHED = (
    Published("speed when told 1.0 m/s ahead, m/s", "0.9", "Go1, mjlab", _RL_GAMES, _speed),
    Published("training", "200 M env-steps in 7 min", "Go1 joystick, Playground, one RTX 4090", _PLAYGROUND, _minutes),
    Published("training", "197 M in 17.1 min", "Go1 velocity, mjlab, one RTX 4090", _RL_GAMES, _minutes),
    Published("training", "30 M in under 4 min", "ANYmal on flat ground, Isaac Gym, one GPU", _RUDIN, _minutes),
    Published("training", "147 M in 20 min", "ANYmal on rough ground, Isaac Gym, one GPU", _RUDIN, _minutes),
    Published("env-steps/s with PPO", "476 k", "Go1 joystick, Playground, one RTX 4090", _PLAYGROUND, _rate),
    Published("env-steps/s with PPO", "200 k", "Go1 velocity, mjlab, one RTX 4090", _RL_GAMES, _rate),
    Published("highest step, cm", "16", "Go2 with its own controller", _MAKER, _highest),
    Published("steepest slope, degrees", "40", "Go2 with its own controller", _MAKER, _steepest),
)


def published_table(found: Found) -> str:
    """Markdown: results with published figures."""
    rows = [(row.what, row.ours(found) or "not tried", row.theirs, row.whose, row.source) for row in PUBLISHED]
    return tables.markdown(("what", "this gait", "others", "whose", "where it stands"), rows)


def goals_table(found: Found, at_most: dict[str, float], kerbs: dict[float, float], push: float, ramp: float) -> str:
    """Markdown: results, and the goal where there is one.

    Args:
      found: of `go2_gait.judge_all`.
      at_most: field of the level ground -> goal.
      kerbs: height (m) -> goal (%).
      push, ramp: goals (%).
    """
    flat, pushes = found["flat"], found["pushes"]
    rows = [(_LABELS.get(k, k), f"{at_most[k]:g}" if k in at_most else "", _number(flat[k])) for k in _LABELS]
    kicked = f"kicks of {pushes['kick_m_s']:g} m/s survived, % of {pushes['episodes']}"
    rows.append((kicked, f"{push:g}", _number(pushes["survived_percent"])))
    for row in found["kerbs"]:
        what = f"kerb of {100 * row['height_m']:.0f} cm {row['way']}, % of {row['episodes']}"
        rows.append((what, f"{kerbs[row['height_m']]:g}" if row["height_m"] in kerbs else "", _passed(row)))
    for row in found["ramps"]:
        what = f"ramp of {np.degrees(np.arctan(row['slope'])):.1f} degrees, % of {row['episodes']}"
        rows.append((what, f"{ramp:g}", _passed(row)))
    level = f"{flat['episodes']} episodes of {flat['seconds']:g} s on level ground"
    return tables.markdown((level, "goal", "this gait"), rows)


_LABELS = {
    "error_linear_m_s": "error of the velocity, m/s",
    "error_angular_rad_s": "error of the yaw rate, rad/s",
    "error_linear_instant_m_s": "error of the velocity at every instant, m/s",
    "error_angular_instant_rad_s": "error of the yaw rate at every instant, rad/s",
    "falls_percent": "falls, %",
    "cost_of_transport": "cost of transport",
    "slip_m_s": "slip of standing feet, m/s",
    "touch_percent": "time in which something else than a foot touches, %",
    "torque_share_p99": "torque, share of the limit, 99 % of steps",
    "torque_share_max": "torque, share of the limit, largest",
    "speed_share_p99": "joint speed, share of the limit, 99 % of steps",
    "speed_share_max": "joint speed, share of the limit, largest",
    "beyond_range_max_rad": "farthest beyond a joint's range, rad",
}


def _passed(row: Found) -> str:
    return _number(row["passed_percent"])


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"
