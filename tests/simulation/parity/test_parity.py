"""Three engines, one reference: MJX and MuJoCo Warp against C MuJoCo on the scenes' own MJCF, all drives in one
batch."""

import dataclasses
import functools

import mujoco
import numpy as np
import pytest

from tests.support.box_bank import box_bank, box_scenes
from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco

NUM_STEPS, CONTROL_DT = 18, 0.2
# Design section 3: 1 mm before the first contact, onset within one physics step, 1 s later median 5 mm, at most 50 mm.
BEFORE, ONSET, AFTER_MEDIAN, AFTER_MAX = 0.001, 1, 0.005, 0.05


@functools.cache
def driven(drive: str, scenes: int, count: int) -> tuple[RobotSpec, SceneBank, c_mujoco.Drives, c_mujoco.Trace]:
    """Drives of all kinds in box streets, and what C MuJoCo makes of them."""
    robot = make_coco(drive)  # pyright: ignore[reportArgumentType]
    bank = box_bank(scenes)
    drives = c_mujoco.mixed_drives(bank, robot, count, NUM_STEPS, CONTROL_DT, seed=1)
    models = [c_mujoco.reference_model(scene_spec(s), robot) for s in box_scenes(scenes)]
    return robot, bank, drives, c_mujoco.drive_reference(models, robot, drives, CONTROL_DT)


def report_of(impl: str, drive: str, scenes: int, count: int) -> c_mujoco.ParityReport:
    """The report of an engine, found within the design's tolerances."""
    robot, bank, drives, expected = driven(drive, scenes, count)
    found = c_mujoco.drive_engine(make_engine(bank, robot, impl=impl, control_dt=CONTROL_DT), bank, drives)
    report = c_mujoco.compare(expected, found, robot)
    summary = report.summary()
    assert set(drives.kind) == set(c_mujoco.KINDS)
    assert set(drives.scene) == set(range(scenes))
    assert report.before.max() <= BEFORE, summary
    assert (report.onset >= 0).all(), summary
    assert report.onset.max() <= ONSET, summary
    assert summary["after_1s_median_mm"] <= AFTER_MEDIAN * 1e3, summary
    assert summary["after_1s_max_mm"] <= AFTER_MAX * 1e3, summary
    assert report.objects_agree.all(), summary
    assert report.ends_agree.all(), summary
    return report


@pytest.mark.parametrize(
    ("impl", "drive"),
    [
        ("jax", "differential"),
        pytest.param("jax", "ackermann", marks=pytest.mark.slow),
        ("warp", "differential"),
        pytest.param("warp", "ackermann", marks=pytest.mark.slow),
        ("warp-fused", "differential"),
        ("warp-fused", "ackermann"),
    ],
)
def test_drives_are_those_of_c_mujoco(impl: str, drive: str) -> None:
    report = report_of(impl, drive, scenes=6, count=35)
    assert report.hit.sum() >= 14
    assert (~np.isnan(report.after)).sum() >= 10


@pytest.mark.extended
@pytest.mark.parametrize("impl", [pytest.param("jax", marks=pytest.mark.slow), "warp", "warp-fused"])
def test_heavy_robots_on_slippery_ground_are_those_of_c_mujoco(impl: str) -> None:
    """Mass and friction of the env, not of the bank: the same drives, another path, in all engines alike."""
    robot, bank, drives, light = driven("differential", 3, 14)
    models = [c_mujoco.reference_model(scene_spec(s), robot) for s in box_scenes(3)]
    for model in models:
        c_mujoco.scale_model(model, friction_scale=0.3, mass_scale=1.6)
    expected = c_mujoco.drive_reference(models, robot, drives, CONTROL_DT)
    engine = make_engine(bank, robot, impl=impl, control_dt=CONTROL_DT)
    found = c_mujoco.drive_engine(engine, bank, drives, friction_scale=0.3, mass_scale=1.6)
    report = c_mujoco.compare(expected, found, robot)
    summary = report.summary()
    assert np.abs(expected.qpos - light.qpos).max() > 0.05, "heavier robots drive elsewhere"
    assert report.before.max() <= BEFORE, summary
    assert report.onset.max() <= ONSET, summary
    assert summary["after_1s_max_mm"] <= AFTER_MAX * 1e3, summary
    assert report.ends_agree.all(), summary


def with_materials(scene: SceneGeometry) -> mujoco.MjSpec:
    """The scene's MJCF with the friction of its materials on the ground."""
    spec, counts = scene_spec(scene), {}
    for region, friction in zip(scene.prism_region.tolist(), scene.prism_material_friction, strict=True):
        number = counts[region] = counts.get(region, -1) + 1
        spec.geom(f"ground/{scene.region_ids[region]}/{number}").friction[0] = friction
    return spec


@functools.cache
def driven_on_materials() -> tuple[c_mujoco.Trace, c_mujoco.Trace]:
    """Drives in C MuJoCo where the smaller of two coefficients counts, by pairs; and with uniform friction."""
    robot, _, drives, uniform = driven("differential", 3, 14)
    models = [c_mujoco.reference_model(with_materials(s), robot, least=True) for s in box_scenes(3)]
    return c_mujoco.drive_reference(models, robot, drives, CONTROL_DT), uniform


@pytest.mark.extended
@pytest.mark.parametrize("impl", [pytest.param("jax", marks=pytest.mark.slow), "warp", "warp-fused"])
def test_friction_of_materials_is_that_of_c_mujoco(impl: str) -> None:
    """Roads, crossings and pavements with coefficients below and above the tyres'."""
    robot, bank, drives, _ = driven("differential", 3, 14)
    expected, uniform = driven_on_materials()
    engine = make_engine(bank, robot, impl=impl, control_dt=CONTROL_DT, friction="materials")
    report = c_mujoco.compare(expected, c_mujoco.drive_engine(engine, bank, drives), robot)
    summary = report.summary()
    assert len(np.unique(bank.prism_material_friction[bank.prism_hull >= 0])) == 3
    assert np.abs(expected.qpos - uniform.qpos).max() > 0.02, "other friction drives elsewhere"
    assert report.before.max() <= BEFORE, summary
    assert report.onset.max() <= ONSET, summary
    assert summary["after_1s_max_mm"] <= AFTER_MAX * 1e3, summary
    assert report.ends_agree.all(), summary


def test_a_robot_starts_slower_on_slippery_ground() -> None:
    """m that COCO covers in 1 s from rest at full speed: its tyres' 0.7 limits it on anything that grips better."""
    robot, bank = make_coco(), box_bank(1, num_objects=1)
    ahead = np.asarray(robot.command(np.array([robot.max_speed, 0.0])), np.float32)
    covered = {}
    for friction in (1.0, 0.7, 0.65, 0.35):
        ground = np.full_like(bank.prism_material_friction, friction)
        street = dataclasses.replace(bank, prism_material_friction=ground)
        engine = make_engine(street, robot, impl="warp", control_dt=CONTROL_DT, friction="materials")
        model = engine.physics.model
        start = np.array(model.qpos0, np.float32)
        start[:3] = 3.0, 0.0, robot.spawn_height
        state = engine.init(np.int32(0), start, np.zeros(model.nv, np.float32))
        for _ in range(5):
            state = engine.step(state, ahead)
        covered[friction] = float(state.qpos[0]) - 3.0
    assert covered[1.0] == pytest.approx(covered[0.7], abs=1e-4)
    assert 0.0 < covered[0.7] - covered[0.65] < 0.03, "dry asphalt and dry concrete"
    assert covered[0.7] - covered[0.35] > 0.3


def test_an_unknown_friction_is_refused() -> None:
    robot, bank, _, _ = driven("differential", 3, 14)
    with pytest.raises(ValidationError, match=r"engine.friction: found 'ice'.*uniform, materials"):
        make_engine(bank, robot, friction="ice")


@pytest.mark.slow
@pytest.mark.parametrize("impl", ["jax", "warp", "warp-fused"])
def test_sixty_drives_in_twenty_scenes_at_once(impl: str) -> None:
    report = report_of(impl, "differential", scenes=20, count=60)
    assert report.hit.sum() >= 25


def test_drives_meet_what_they_are_meant_to() -> None:
    """Contacts in C MuJoCo of each kind; robots between two objects touch both and stay in place."""
    _, _, drives, trace = driven("differential", 6, 35)
    kind = np.array(drives.kind)
    climbed = np.ptp(trace.qpos[..., 2], axis=1)
    moved = np.linalg.norm(trace.qpos[:, -1, :2] - trace.qpos[:, -100, :2], axis=1)
    touched = trace.hit.any(1)
    assert not touched[kind == "free"].any()
    # On a slope the front tyres, which slide, let the robot drift off its path.
    assert touched[kind == "ramp"].mean() < 0.5
    assert (climbed[kind == "free"] < 0.005).all()
    assert (climbed[kind == "ramp"] > 0.04).any()
    # Down from the pavement, or up against it.
    assert trace.met is not None
    assert ((climbed > 0.1) | trace.met.any(1))[kind == "kerb"].all()
    assert (climbed > 0.1)[kind == "kerb"].any()
    assert touched[kind == "head_on"].all()
    assert touched[kind == "wedge"].all()
    assert touched[kind == "graze"].any()
    both = np.array([len(objects) >= 2 for objects in trace.objects])
    assert (both & (moved < 0.05))[kind == "wedge"].any()


def test_compare_finds_what_differs() -> None:
    """Two made-up traces: 100 steps, a touch at 40 and at 43, 2 mm apart before and 7 mm a second later."""
    robot = make_coco()
    qpos = np.zeros((2, 200, 17))
    hit = np.zeros((2, 200), bool)
    hit[0, 40:] = True
    one = c_mujoco.Trace(qpos, hit, (frozenset({"bench"}), frozenset()), np.zeros(2, bool))
    moved, later = qpos.copy(), hit.copy()
    moved[0, 10, 0], moved[0, 140, 1] = 0.002, 0.007
    later[0, :43] = False
    later[1, 5] = True
    other = c_mujoco.Trace(moved, later, (frozenset({"tree"}), frozenset()), np.zeros(2, bool))
    report = c_mujoco.compare(one, other, robot)
    np.testing.assert_allclose(report.before, [0.002, 0.0])
    np.testing.assert_array_equal(report.onset, [3, -1])
    np.testing.assert_allclose(report.after, [0.007, 0.0])
    np.testing.assert_array_equal(report.objects_agree, [False, True])
    np.testing.assert_array_equal(report.ends_agree, [True, False])
    np.testing.assert_allclose(report.before_time, [0.11, 0.01])
    # A wheel is at a kerb before that, so the difference follows that contact.
    met = hit.copy()
    met[0, 5:] = True
    report = c_mujoco.compare(dataclasses.replace(one, met=met), other, robot)
    np.testing.assert_allclose(report.before, [0.0, 0.0])
    np.testing.assert_array_equal(report.onset, [3, -1])
    assert report.after[0] == 0.0


@pytest.mark.parametrize("impl", [pytest.param("jax", marks=pytest.mark.slow), "warp", "warp-fused"])
def test_seams_between_prisms_are_not_felt(impl: str) -> None:
    """20 m at 1.5 m/s over the seams of the box street, one of them askew, engine and C MuJoCo.

    The quick drives above hold the MJX engine to within 1 mm of C MuJoCo over such seams.
    """
    robot = make_coco("differential")
    bank = box_bank(1, num_objects=0)
    model = c_mujoco.reference_model(scene_spec(box_scenes(1, num_objects=0)[0]), robot)
    qpos = np.array(model.qpos0, np.float32)[None]
    qpos[0, :3] = 2.0, 7.2, 0.15 + robot.spawn_height
    qpos[0, 3:7] = 1.0, 0.0, 0.0, 0.0
    ctrl = np.tile(np.array(robot.command(np.array([1.5, 0.0]))), (72, 1, 1))
    drives = c_mujoco.Drives(np.zeros(1, np.int32), qpos, ctrl)
    engine = make_engine(bank, robot, impl=impl, control_dt=CONTROL_DT)
    for trace in (
        c_mujoco.drive_reference([model], robot, drives, CONTROL_DT),
        c_mujoco.drive_engine(engine, bank, drives),
    ):
        path = trace.qpos[0, 100:]
        assert trace.qpos[0, -1, 0] - qpos[0, 0] > 20.0
        assert np.ptp(path[:, 2]) < 0.002
        assert not trace.hit.any()
