"""A robot's size and dynamics as numbers, against what its makers and its table say."""

import numpy as np
import pytest

from urbanverse_mjx.datatypes import RobotSpec
from urbanverse_mjx.datatypes.robot import DRIVES
from urbanverse_mjx.evaluation.planner import motion_of
from urbanverse_mjx.robots import catalogue, load, make_coco, make_coco_arm, make_go2
from urbanverse_mjx.robots.embodiment import FIELDS, describe, size_of


@pytest.fixture(scope="module")
def robots() -> dict[str, RobotSpec]:
    found = {name: load(name) for name in (*catalogue.NAMES, "wheelchair")}
    return found | {"coco": make_coco(), "ackermann": make_coco("ackermann"), "arm": make_coco_arm(), "go2": make_go2()}


def told(robot: RobotSpec) -> dict[str, float]:
    return dict(zip(FIELDS, describe(robot).tolist(), strict=True))


def test_the_kickscooter_is_what_its_makers_and_its_table_say(robots: dict[str, RobotSpec]) -> None:
    """1210 x 570 x 1264 mm; it turns about its rear axle, no tighter than 1.42 m, and leans into bends."""
    row, found = catalogue.row("kickscooter"), told(robots["kickscooter"])
    assert found["ahead, m"] + found["behind, m"] == pytest.approx(1.21, abs=0.1)
    assert found["half width, 0.5 m"] == pytest.approx(0.57, abs=0.02)
    assert found["height, m"] == pytest.approx(1.26, abs=0.02)
    assert found["top speed, 2 m/s"] == pytest.approx(0.7)
    assert found["yaw rate, rad/s"] == pytest.approx(row.max_yaw_rate)
    assert found["turning radius, m"] == pytest.approx(1.42, abs=0.01)
    assert found["turns about a point behind, m"] == pytest.approx(-row.axle)
    assert found["1 / sideways acceleration, s²/m"] == pytest.approx(1.0 / row.lateral)
    assert [found[f"drive: {kind}"] for kind in DRIVES] == [0, 0, 1, 0, 0]


def test_sizes_are_those_of_the_table(robots: dict[str, RobotSpec]) -> None:
    """Handles and plates that stand out do not collide, and the spheres of wheels are wider than the wheels."""
    for name in catalogue.NAMES:
        row, size = catalogue.row(name), size_of(robots[name])
        assert row.size[0] - 0.15 <= size.ahead + size.behind <= row.size[0] + 0.1, name
        assert size.height <= row.size[2] + 0.06, name
        widest = max(wheel.radius for wheel in row.wheels)
        assert 0.5 * row.size[1] - 0.1 <= size.half_width <= 0.5 * row.size[1] + widest, name
        assert size.clearance >= 0.03, name


def test_every_robot_is_told_apart_by_numbers_of_order_one(robots: dict[str, RobotSpec]) -> None:
    values = np.array([describe(robot) for robot in robots.values()])
    assert values.shape == (len(robots), len(FIELDS))
    assert np.isfinite(values).all()
    assert np.abs(values).max() <= 2.0
    values = np.array([describe(robot) for name, robot in robots.items() if name != "arm"])  # COCO with a mast
    apart = np.abs(values[:, None] - values).max(-1)
    assert apart[~np.identity(len(values), dtype=bool)].min() > 0.04


def test_drives_are_those_of_the_table(robots: dict[str, RobotSpec]) -> None:
    for name in catalogue.NAMES:
        drive = catalogue.row(name).drive
        assert robots[name].drive == ("gait" if drive == "balance" else drive), name
    others = {name: robots[name].drive for name in ("coco", "ackermann", "arm", "go2", "wheelchair")}
    assert others == {
        "coco": "differential", "ackermann": "ackermann", "arm": "differential", "go2": "gait",
        "wheelchair": "differential",
    }  # fmt: skip


def test_robots_say_of_their_lags_what_their_planner_knows(robots: dict[str, RobotSpec]) -> None:
    """Of slopes, the planner knows more."""
    walkers = [load(name) for name in ("mini_cheetah", "b2", "g1")]
    for robot in (robots["coco"], robots["ackermann"], robots["go2"], robots["arm"], *walkers):
        motion, response = motion_of(robot), robot.response
        assert response is not None
        assert (response.speed_lag, response.turn_lag) == (motion.speed_lag, motion.turn_lag)
        assert response.pivot == pytest.approx(motion.pivot, abs=0.006)
        assert 1.0 / response.curvature == pytest.approx(1.0 / motion.curvature, abs=0.01)
