"""The MJX engine against C MuJoCo on the scenes' own MJCF: all drives in one batch, every env in its own scene."""

import numpy as np
import pytest

from tests.support.box_bank import box_bank, box_scenes
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.simulation import truth
from urbanverse_mjx.simulation.jax_engine import JaxEngine

NUM_SCENES, NUM_DRIVES, NUM_STEPS, CONTROL_DT = 6, 28, 18, 0.2
# Design section 3: 1 mm before the first contact, onset within one physics step, 1 s later median 5 mm, at most 50 mm.
BEFORE, ONSET, AFTER_MEDIAN, AFTER_MAX = 0.001, 1, 0.005, 0.05


@pytest.mark.parametrize("drive", ["differential", "ackermann"])
def test_drives_are_those_of_c_mujoco(drive: str) -> None:
    robot = make_coco(drive)  # pyright: ignore[reportArgumentType]
    bank = box_bank(NUM_SCENES)
    drives = truth.aimed_drives(bank, robot, NUM_DRIVES, NUM_STEPS, CONTROL_DT, seed=1)
    models = [truth.truth_model(scene_spec(s), robot) for s in box_scenes(NUM_SCENES)]
    expected = truth.drive_truth(models, robot, drives, CONTROL_DT)
    found = truth.drive_engine(JaxEngine(bank, robot, CONTROL_DT), bank, drives)
    report = truth.compare(expected, found, robot)
    summary = report.summary()
    assert summary["hits"] >= 20, summary
    assert set(drives.scene[report.hit]) == set(range(NUM_SCENES))
    assert report.before.max() <= BEFORE, summary
    assert (report.onset >= 0).all(), summary
    assert report.onset.max() <= ONSET, summary
    assert summary["after_1s_drives"] >= 15, summary
    assert summary["after_1s_median_mm"] <= AFTER_MEDIAN * 1e3, summary
    assert summary["after_1s_max_mm"] <= AFTER_MAX * 1e3, summary
    assert report.objects_agree.all(), summary


def test_compare_finds_what_differs() -> None:
    """Two made-up traces: 100 steps, a touch at 40 and at 43, 2 mm apart before and 7 mm a second later."""
    robot = make_coco()
    qpos = np.zeros((2, 200, 17))
    hit = np.zeros((2, 200), bool)
    hit[0, 40:] = True
    one = truth.Trace(qpos, hit, (frozenset({"bench"}), frozenset()), np.zeros(2, bool))
    moved, later = qpos.copy(), hit.copy()
    moved[0, 10, 0], moved[0, 140, 1] = 0.002, 0.007
    later[0, :43] = False
    later[1, 5] = True
    other = truth.Trace(moved, later, (frozenset({"tree"}), frozenset()), np.zeros(2, bool))
    report = truth.compare(one, other, robot)
    np.testing.assert_allclose(report.before, [0.002, 0.0])
    np.testing.assert_array_equal(report.onset, [3, -1])
    np.testing.assert_allclose(report.after, [0.007, 0.0])
    np.testing.assert_array_equal(report.objects_agree, [False, True])


def test_seams_between_prisms_are_not_felt() -> None:
    """20 m at 1.5 m/s over the seams of the box street, one of them askew, engine and C MuJoCo."""
    robot = make_coco("differential")
    bank = box_bank(1, num_objects=0)
    model = truth.truth_model(scene_spec(box_scenes(1, num_objects=0)[0]), robot)
    qpos = np.array(model.qpos0, np.float32)[None]
    qpos[0, :3] = 2.0, 7.2, 0.15 + robot.spawn_height
    qpos[0, 3:7] = 1.0, 0.0, 0.0, 0.0
    ctrl = np.tile(np.array(robot.command(np.array([1.5, 0.0]))), (72, 1, 1))
    drives = truth.Drives(np.zeros(1, np.int32), qpos, ctrl)
    engine = JaxEngine(bank, robot, CONTROL_DT)
    for trace in (
        truth.drive_truth([model], robot, drives, CONTROL_DT),
        truth.drive_engine(engine, bank, drives),
    ):
        path = trace.qpos[0, 100:]
        assert trace.qpos[0, -1, 0] - qpos[0, 0] > 20.0
        assert np.ptp(path[:, 2]) < 0.002
        assert not trace.hit.any()
