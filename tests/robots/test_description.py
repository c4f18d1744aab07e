"""Robots from files: one from outside the repository drives the streets; the wheelchair that comes with the package."""

import contextlib
import json
import pathlib
import re
import struct
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.robots.test_coco_drive import Controller, ground
from tests.support.box_bank import box_bank, box_scenes
from urbanverse_mjx.datatypes import Response, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, registry
from urbanverse_mjx.robots import load, make_coco, make_go2
from urbanverse_mjx.robots.model_limits import check_size
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco
from urbanverse_mjx.simulation.physics_model import make_physics_model

TUTORIAL = pathlib.Path(__file__).parents[2] / "docs" / "tutorials" / "own_robot.md"
WHEELCHAIR = "wheelchair"


def blocks(language: str) -> list[str]:
    """The tutorial's blocks of code of a language."""
    parts = TUTORIAL.read_text(encoding="utf-8").split("```" + language + "\n")[1:]
    return [part.split("```")[0] for part in parts]


@pytest.fixture
def folder(tmp_path: pathlib.Path) -> pathlib.Path:
    """The tutorial's robot, written somewhere else, with a mesh in a folder of its own for its appearance."""
    (tmp_path / "tug.xml").write_text(blocks("xml")[0])
    (tmp_path / "robot.json").write_text(blocks("json")[0])
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "crate.obj").write_text(blocks("obj")[0])
    return tmp_path


def change(folder: pathlib.Path, **fields: Any) -> pathlib.Path:
    path = folder / "robot.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | fields))
    return path


def test_what_is_not_said_is_worked_out(folder: pathlib.Path) -> None:
    robot = load(folder)
    assert robot.mjcf == load(str(folder / "robot.json")).mjcf
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    assert robot.physics_timestep == model.opt.timestep == 0.005
    # Wheels of 0.12 m whose axle is at the root's height; the farthest sphere: the bumper's at 0.3 m with 0.1 m.
    assert robot.spawn_height == pytest.approx(0.12)
    assert robot.circumradius == pytest.approx(0.4)
    assert (model.geom_contype == 0).all(), "its parts never touch each other"
    np.testing.assert_allclose(robot.command(np.array([0.6, 0.0])), [5.0, 5.0], rtol=1e-6)
    # 0.5 rad/s with a track of 0.4 m: 0.1 m/s more and less; faster commands are clipped to its limits.
    np.testing.assert_allclose(robot.command(np.array([0.6, 0.5])), np.array([0.5, 0.7]) / 0.12, rtol=1e-6)
    np.testing.assert_allclose(robot.command(np.array([9.0, 0.0])), [10.0, 10.0], rtol=1e-6)
    described = change(folder, spawn_height=0.2, circumradius=0.9)
    assert (load(described).spawn_height, load(described).circumradius) == (0.2, 0.9)


def test_a_bound_on_the_reach_holds_for_every_robot() -> None:
    """The computed bound is no smaller than the built-in robots' geometric one."""
    from urbanverse_mjx.robots.description import reach

    for robot, slack in ((make_coco("differential"), 1e-6), (make_go2(), 0.2)):
        model = mujoco.MjModel.from_xml_string(robot.mjcf)
        bound = reach(model, model.body(robot.root_body).id)
        assert robot.circumradius - 1e-6 <= bound <= robot.circumradius + slack


@pytest.mark.extended
@pytest.mark.mjx
def test_a_robot_from_outside_drives_to_its_waypoints(folder: pathlib.Path, small_bank: SceneBank) -> None:
    options = {"preset": "cpu", "scenes": "all", "vision_config.height": 18, "vision_config.width": 32, "impl": "jax"}
    free = {"terminate_on_hit": False, "terminate_off_traversable": False, "success_radius": 1e-3}
    with pytest.raises(ValidationError, match="sim_dt"):
        registry.load("CocoNav", config_overrides={**options, "robot": str(folder)}, bank=small_bank)
    options |= {"robot": str(folder), "sim_dt": 0.005, **free}
    env: NavEnv = registry.load("CocoNav", config_overrides=options, bank=small_bank)
    state = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 2))
    assert state.obs["pixels/front"].shape == (2, 18, 32, 3)
    step, first = jax.jit(jax.vmap(env.step)), np.asarray(state.data.sim.xpos[:, 1])
    for _ in range(10):
        state = step(state, jnp.tile(jnp.array([0.5, 0.0]), (2, 1)))
    # 2 s at half of 1.2 m/s, less the start.
    gone = np.linalg.norm(np.asarray(state.data.sim.xpos[:, 1]) - first, axis=1)
    assert (gone > 0.8).all()
    assert (gone < 1.25).all()
    # Its crate, from a file, is in the visual model.
    model = mujoco.MjModel.from_xml_string(env.robot.mjcf)
    assert model.nmesh == 1


def test_an_axle_that_steers(folder: pathlib.Path) -> None:
    xml = (folder / "tug.xml").read_text()
    steering = '<position name="steer" joint="swivel" kp="10" ctrlrange="-0.4 0.4"/></actuator>'
    swivel = '<body name="nose" pos="0.2 0 0"><joint name="swivel" axis="0 0 1"/><geom size="0.02" mass="1"'
    swivel += ' contype="0" conaffinity="0"/></body><camera'
    (folder / "tug.xml").write_text(xml.replace("</actuator>", steering).replace("<camera", swivel, 1))
    drive = json.loads((folder / "robot.json").read_text())["drive"]
    with pytest.raises(ValidationError, match=r"found 2 actuators named, needed each of the 3"):
        load(folder)
    change(folder, drive={**drive, "kind": "ackermann", "steer": "steer", "wheelbase": 0.5})
    # The nose keeps its mass when its visual geoms are removed.
    assert make_physics_model(load(folder)).model.body("nose").mass[0] == pytest.approx(1.0)
    left, right, angle = np.asarray(load(folder).command(np.array([1.0, 0.5])), np.float64)
    assert angle == pytest.approx(np.arctan(0.5 * 0.5))
    np.testing.assert_allclose([left, right], np.array([0.9, 1.1]) / 0.12, rtol=1e-5)
    # Sharper than it can: at the end of its range, and the wheels turn as that circle asks.
    left, right, angle = np.asarray(load(folder).command(np.array([0.5, 1.0])), np.float64)
    turn = 0.5 * np.tan(0.4) / 0.5
    assert angle == pytest.approx(0.4)
    np.testing.assert_allclose([left, right], np.array([0.5 - 0.2 * turn, 0.5 + 0.2 * turn]) / 0.12, rtol=1e-5)


def test_a_table_of_wheels(folder: pathlib.Path) -> None:
    """The tug with its wheels in a table drives as with two sides; every wheel rolls at its own place's speed."""
    wheels = [
        {"x": 0.0, "y": y, "radius": 0.12, "motor": f"{side}_motor"} for side, y in (("left", 0.2), ("right", -0.2))
    ]
    sides = load(folder)
    change(folder, drive={"kind": "wheels", "wheels": wheels}, response={"speed_lag": 0.4})
    table = load(folder)
    for velocity in ((0.6, 0.5), (0.0, -0.8), (9.0, 9.0)):
        np.testing.assert_allclose(table.command(np.array(velocity)), sides.command(np.array(velocity)), rtol=1e-6)
    assert table.response == Response(speed_lag=0.4)
    assert sides.response is None
    change(folder, drive={"kind": "wheels", "wheels": wheels, "axle": -0.3, "lateral": 0.1, "skid": 1.5})
    table = load(folder)
    assert table.response == Response(speed_lag=0.4, pivot=0.3, lateral=0.1)
    # At 0.5 rad/s it slows down to 0.2 m/s, and the sides differ by 1.5 times as much.
    np.testing.assert_allclose(
        table.command(np.array([1.0, 0.5])), np.array([0.2 - 0.15, 0.2 + 0.15]) / 0.12, rtol=1e-5
    )
    for wrong, words in (
        (wheels[:1], "found 1 actuators named, needed each of the 2"),
        ([*wheels, {"x": 0.0, "y": 0.0, "radius": 0.1}], r"wheels\[2\]: found neither a motor nor a steer"),
        ([{**wheels[0], "motor": "wing"}, wheels[1]], r"wheels\[0\]\.motor: found 'wing'"),
        ([{**wheels[0], "steer": "right_motor"}], "upper end of the ctrlrange"),
    ):
        with pytest.raises(ValidationError, match=words):
            load(change(folder, drive={"kind": "wheels", "wheels": wrong}))


def test_a_robot_told_by_a_gait(folder: pathlib.Path) -> None:
    change(folder, drive={"kind": "gait"})
    np.testing.assert_allclose(load(folder).command(np.array([0.7, -0.2])), [0.7, 0.0, -0.2], rtol=1e-6)
    options = {"preset": "cpu", "robot": str(folder), "sim_dt": 0.005, "vision": False}
    with pytest.raises(ValidationError, match="walks by a gait"):
        registry.load("CocoNav", config_overrides=options, bank=box_bank(1))
    with pytest.raises(ValidationError, match="one for 12 joints, needed one for the 2"):
        registry.load("Go2Nav", config_overrides=options, bank=box_bank(1))


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"mjcf": "none.xml"}, "found no file"),
        ({"camera": "eye"}, r"camera: found 'eye', needed a camera of the MJCF; it has front"),
        ({"feet": ["left_tyre", "paw"]}, r"feet\[1\]: found 'paw'"),
        ({"max_speed": -1.0}, "greater than 0"),
        ({"drive": {"kind": "tracks"}}, "one of differential, ackermann, wheels, gait"),
        ({"response": {"speed_lag": 0.0}}, r"response\.speed_lag: found 0"),
        ({"response": {"delay": 1.0}}, "delay"),
        ({"planner": {"radius": 0.3}}, "height"),
        ({"colour": "red"}, "colour"),
        ({"schema": "urbanverse.robot/9"}, "urbanverse.robot/1"),
    ],
)
def test_what_is_wrong_is_said(folder: pathlib.Path, fields: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        load(change(folder, **fields))


def test_what_is_wrong_in_the_mjcf_is_said(folder: pathlib.Path) -> None:
    xml = (folder / "tug.xml").read_text()
    for old, new, words in (
        ("<worldbody>", '<worldbody><geom type="plane" size="1 1 1"/>', "the robot alone"),
        ("</mujoco>", "", "does not read"),
    ):
        (folder / "tug.xml").write_text(xml.replace(old, new, 1))
        with pytest.raises(ValidationError, match=words):
            load(folder)
    with pytest.raises(ValidationError, match=r"coco, go2, wheelchair, husky, .*, or a robot\.json"):
        load(folder / "nowhere")


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ('<replicate count="2000000" offset="0 0 1"><body><geom size=".1"/></body></replicate>', "makes 40000"),
        ('<replicate count="1e9"/>', "makes 10000000.. elements"),
        ('<replicate count="900"><replicate count="900"><site/></replicate></replicate>', "elements"),
        ('<flexcomp name="f" type="grid" count="2000 2000 2000" spacing=".1 .1 .1"/>', "makes 80000000.. elements"),
        ('<geom type="hfield" hfield="h"/></worldbody><asset><hfield name="h" nrow="40000" ncol="40000" '
         'size="1 1 1 1"/></asset><worldbody>', "hfield of 40000 x 40000"),
        ('</worldbody><asset><texture name="t" type="2d" builtin="flat" width="60000" height="60000"/></asset>'
         "<worldbody>", "texture of 60000 x 60000"),
        ('</worldbody><asset><hfield name="h" file="large.png" size="1 1 1 1"/></asset><worldbody>', "50000 x 50000"),
        ('<include file="part.xml"/>', "include itself"),
    ],
)  # fmt: skip
def test_a_robot_that_asks_for_all_memory_is_refused_before_it_is_made(
    folder: pathlib.Path, inside: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mujoco.MjSpec, "from_file", lambda path: pytest.fail("MuJoCo was asked"))
    xml = (folder / "tug.xml").read_text()
    (folder / "tug.xml").write_text(xml.replace("<worldbody>", f"<worldbody>{inside}", 1))
    (folder / "part.xml").write_text('<mujoco><include file="part.xml"/></mujoco>')
    header = struct.pack(">I4sII", 13, b"IHDR", 50_000, 50_000)
    (folder / "large.png").write_bytes(b"\x89PNG\r\n\x1a\n" + header + bytes(9))
    with pytest.raises(ValidationError, match=words) as caught:
        load(folder)
    assert "\n" not in str(caught.value)


def test_what_a_robot_includes_counts_as_often_as_it_is_made(folder: pathlib.Path) -> None:
    (folder / "part.xml").write_text("<mujocoinclude>" + "<site/>" * 150 + "</mujocoinclude>")
    for count, large in ((100, False), (150, True)):
        (folder / "all.xml").write_text(
            f'<mujoco><replicate count="{count}"><include file="part.xml"/></replicate></mujoco>'
        )
        with pytest.raises(ValidationError, match="elements") if large else contextlib.nullcontext():
            check_size(folder / "all.xml", "robot.mjcf")


# The wheelchair.


def test_the_wheelchair_is_as_the_planner_has_it() -> None:
    """docs/sources/reference_systems.md b.2: radius 0.45 m, height 1.4 m, step 0.05 m."""
    robot = load(WHEELCHAIR)
    assert (robot.planner_radius, robot.planner_height, robot.step_height) == (0.45, 1.4, 0.05)
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    spheres = np.flatnonzero(model.geom_conaffinity)
    centre, radius = data.geom_xpos[spheres] - data.xpos[1], model.geom_size[spheres, 0]
    assert (np.linalg.norm(centre[:, :2], axis=1) + radius).max() <= 0.45 + 1e-3
    assert (centre[:, 2] + radius).max() + robot.spawn_height == pytest.approx(1.4, abs=0.01)


@pytest.mark.parametrize(("speed", "yaw_rate"), [(0.3, 1.0), (1.0, 0.3), (1.0, -1.0), (0.0, -0.8)])
def test_the_wheelchair_follows_its_commands(speed: float, yaw_rate: float) -> None:
    controller = Controller(load(WHEELCHAIR), ground([(-30.0, 30.0, 0.0, 0.0)], half_width=30.0))
    controller.drive(speed, yaw_rate, 3.0)
    v, w = controller.velocity()
    assert abs(v - speed) < 0.02
    # In a fast bend the mass in front of the axle holds against the motors.
    assert abs(w - yaw_rate) < 0.15 * abs(yaw_rate)
    assert controller.data.qpos[2] == pytest.approx(load(WHEELCHAIR).spawn_height, abs=1e-3)


def test_the_wheelchair_takes_its_step_a_ramp_and_no_kerb() -> None:
    robot = load(WHEELCHAIR)
    for step, passes in ((robot.step_height, True), (0.15, False)):
        controller = Controller(robot, ground([(-3.0, 1.0, 0.0, 0.0), (1.0, 40.0, step, step)]))
        controller.drive(0.8, 0.0, 6.0)
        assert (controller.data.qpos[0] > 2.0) == passes, f"step of {step} m"
    controller = Controller(robot, ground([(-3.0, 1.0, 0.0, 0.0), (1.0, 3.0, 0.0, 0.25), (3.0, 30.0, 0.25, 0.25)]))
    controller.drive(0.5, 0.0, 14.0)
    assert controller.data.qpos[0] > 4.0


@pytest.mark.extended
@pytest.mark.parametrize("impl", [pytest.param("jax", marks=pytest.mark.slow), "warp"])
def test_engines_drive_the_wheelchair_as_c_mujoco_does(impl: str) -> None:
    robot, bank, control_dt = load(WHEELCHAIR), box_bank(2), 0.2
    drives = c_mujoco.mixed_drives(bank, robot, 8, 10, control_dt, seed=2)
    models = [c_mujoco.reference_model(scene_spec(s), robot) for s in box_scenes(2)]
    expected = c_mujoco.drive_reference(models, robot, drives, control_dt)
    found = c_mujoco.drive_engine(make_engine(bank, robot, impl=impl, control_dt=control_dt), bank, drives)
    report = c_mujoco.compare(expected, found, robot)
    summary = report.summary()
    # Twice COCO's tolerance: the root is twice as high above the ground, and a hair of tilt shows twice as much.
    assert report.before.max() <= 0.002, summary
    assert report.onset.max() <= 1, summary
    assert (report.onset >= 0).all(), summary
    assert report.ends_agree.all(), summary


def test_every_robot_that_an_unknown_name_is_answered_with_is_loaded() -> None:
    with pytest.raises(ValidationError, match=r"found 'coca', needed coco, go2, ") as told:
        load("coca")
    listed = re.split(", or | needed ", str(told.value).split(";")[0])[1]
    names = listed.split(", ")
    assert len(names) > 25
    assert [load(name).name for name in ("coco", "go2")] == ["coco_differential", "go2"]
    for name in names[2:]:
        assert load(name).name == name
