"""The robots of the catalogue: properties of every row, and drives of a few in C MuJoCo and in an engine."""

import math
import os
import pathlib
import re

import jax
import mujoco
import numpy as np
import pytest

from benchmarks import robots as figures_of
from benchmarks.lib.robot_drives import LevelGround, drive_figures, image_of, parity_figures
from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import Response, RobotSpec, ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.evaluation.planner import DEFAULT, motion_of
from urbanverse_mjx.robots import catalogue, gait_of, load, make_coco
from urbanverse_mjx.robots.catalogue import balance, mjcf
from urbanverse_mjx.robots.catalogue.rows import Box, read_rows
from urbanverse_mjx.robots.stance import stance
from urbanverse_mjx.robots.start import start
from urbanverse_mjx.robots.wheel_drive import Wheel, WheelTable, largest_curvature, skid_factor

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "robots.md"
HUSKY = catalogue.row("husky")
#: As MuJoCo Warp solves fastest, and the Go2's number of spheres.
MOST_VELOCITIES, MOST_SPHERES = 32, 43


@pytest.fixture(scope="module")
def robots() -> dict[str, RobotSpec]:
    return {name: load(name) for name in catalogue.NAMES}


def response_of(name: str) -> Response:
    response = load(name).response
    assert response is not None
    return response


# The table.


def test_every_row_makes_a_robot_of_its_numbers(robots: dict[str, RobotSpec]) -> None:
    assert len(robots) >= 20
    for name, robot in robots.items():
        row, model = catalogue.row(name), mujoco.MjModel.from_xml_string(robot.mjcf)
        data = mujoco.MjData(model)
        data.qpos[2] = robot.spawn_height
        mujoco.mj_forward(model, data)
        assert model.body_mass.sum() == pytest.approx(row.mass, rel=1e-4), name
        centre = data.subtree_com[1]
        np.testing.assert_allclose(centre[[0, 2]], row.centre, atol=2e-3, err_msg=name)
        assert abs(centre[1]) < 1e-6
        solid = np.flatnonzero(model.geom_conaffinity)
        assert (model.geom_type[solid] == mujoco.mjtGeom.mjGEOM_SPHERE).all()
        assert model.nv <= MOST_VELOCITIES, name
        assert len(solid) <= MOST_SPHERES, name
        reach = np.linalg.norm(data.geom_xpos[solid] - data.xpos[1], axis=1) + model.geom_size[solid, 0]
        assert reach.max() <= robot.circumradius + 1e-6, name
        # Wheels that carry touch the ground at rest, and the body does not.
        assert (data.geom_xpos[solid, 2] - model.geom_size[solid, 0]).min() == pytest.approx(0.0, abs=1e-3), name
        assert (stance(robot).clearance or 0.0) >= 0.03, name
        # Its body is within the size of the row; the sphere of a wheel is wider than the wheel.
        body = [g for g in solid if model.geom(g).name.startswith("body_")]
        top = (data.geom_xpos[body, 2] + model.geom_size[body, 0]).max()
        assert top <= row.size[2] + 0.06, name
        assert (np.abs(data.geom_xpos[body, 0]) + model.geom_size[body, 0]).max() <= 0.5 * row.size[0] + 0.06, name
        assert robot.max_speed == min(row.top_speed, catalogue.PAVEMENT_SPEED)


def test_no_robot_falls_over_when_it_starts_and_stops(robots: dict[str, RobotSpec]) -> None:
    for name, robot in robots.items():
        found = start(robot)
        if catalogue.row(name).drive == "balance":
            assert found is None
            continue
        assert found is not None
        assert found.touches is None, name
        assert found.speed == pytest.approx(robot.max_speed, rel=0.03), name


def test_every_row_has_a_source_a_task_and_its_lines_on_the_page() -> None:
    page = PAGE.read_text(encoding="utf-8")
    for name in catalogue.NAMES:
        row, environment = catalogue.row(name), catalogue.environment_name(name)
        assert environment in registry.ALL_ENVS
        config = registry.get_default_config(environment, "cpu")
        assert config.robot == name
        assert f"| `{name}` | `{environment}` | {row.title}: {row.kind} |" in page, (
            "run python -m benchmarks.robots --page"
        )
        assert f"* `{name}`: {row.source}. Typical: {row.typical}." in page
        # A source names a place: an address, or a repository with the file in it.
        assert re.search(r"\.(com|org|ch|ls|xacro|urdf|yaml|py)\b", row.source), name


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('drive = "skid"', 'drive = "hover"', "one of differential, skid"),
        ("mass = 56.6", "mass = 9.0", "of which 10.56 kg are wheels"),
        ("mass = 56.6", "mass = -1", "greater than 0"),
        ("driven = true", "caster = true", "a caster, or a wheel with a mass"),
        ('drive = "skid"', 'drive = "ackermann"', "0 rows of steered wheels"),
        ('drive = "skid"', 'drive = "balance"', "one pair of wheels"),
        ("z = [0.13, 0.38]", "z = [0.38, 0.13]", "growing pairs"),
        ("z = [0.13, 0.38]", "z = [-0.1, 0.38]", "parts above it"),
        ("size = [0.99, 0.67, 0.38]", "size = [0.99, 0.67]", "size"),
        ('style = "rover"', 'style = "blimp"', "one of rover"),
        ("source = ", "origin = ", "origin|source"),
        ("mass = 56.6", "mass = ", "found no TOML"),
    ],
)
def test_a_wrong_row_is_a_sentence(tmp_path: pathlib.Path, old: str, new: str, words: str) -> None:
    text = (pathlib.Path(catalogue.__file__).parent / "robots.toml").read_text(encoding="utf-8")
    one = text[text.index("[husky]") : text.index("[jackal]")]
    (tmp_path / "robots.toml").write_text(one, encoding="utf-8")
    assert read_rows(tmp_path / "robots.toml") == {"husky": HUSKY}
    (tmp_path / "robots.toml").write_text(one.replace(old, new), encoding="utf-8")
    with pytest.raises(ValidationError, match=words):
        read_rows(tmp_path / "robots.toml")


def test_an_unknown_robot_is_a_sentence() -> None:
    with pytest.raises(ValidationError, match=r"robot: found 'huskie'.*husky, jackal"):
        catalogue.row("huskie")


# Shapes.


@pytest.mark.parametrize("box", [Box((-0.4, 0.4), 0.2, (0.1, 0.4)), Box((0.0, 0.1), 0.3, (0.8, 0.9)), HUSKY.body[0]])
def test_spheres_fill_a_box_up_to_its_edges(box: Box) -> None:
    spheres = np.array(mjcf.fill(box))
    centre, radius = spheres[:, :3], spheres[:, 3]
    low, high = np.array([box.x[0], -box.y, box.z[0]]), np.array([box.x[1], box.y, box.z[1]])
    assert (centre - radius[:, None] >= low - 1e-9).all()
    assert (centre + radius[:, None] <= high + 1e-9).all()
    # Faces between the rounded edges are nowhere farther from a sphere than the largest gap.
    edge = radius[0]
    side = np.linspace(low[0] + edge, high[0] - edge, 60)
    face = np.column_stack([side, np.full(60, high[1]), np.full(60, 0.5 * (low[2] + high[2]))])
    distance = (np.linalg.norm(face[:, None] - centre, axis=-1) - radius).min(1)
    assert distance.max() <= mjcf.GAP + 1e-6


@pytest.mark.skipif(os.environ.get("MUJOCO_GL") not in ("egl", "osmesa"), reason="needs off-screen OpenGL")
def test_robots_look_different() -> None:
    """An image of each of three is its own, and shows more than the ground."""
    images = [image_of(load(name), 60, 80).astype(int) for name in ("courier", "mobility", "guard")]
    for i, image in enumerate(images):
        assert image.std() > 20
        assert all(np.abs(image - other).mean() > 5 for other in images[i + 1 :])


# Kinematics.


def test_the_makers_own_factors_of_skid_steering() -> None:
    """clearpath_common: wheel_separation_multiplier 1.875 of the Husky, 1.5 of the Jackal."""
    for name, makers in (("husky", 1.875), ("jackal", 1.5)):
        assert mjcf.factor_of(catalogue.row(name)) == pytest.approx(makers, rel=0.02)
    assert skid_factor([0.3, 0.0, -0.3], 0.3) == pytest.approx(2.0)


def test_steered_wheels_roll_about_one_centre() -> None:
    """Lines through the hubs of the Ackermann car and of the base with four steered wheels meet in one point, and every
    wheel rolls at the speed of its place; an arc too tight for the car becomes its tightest."""
    for name, v, omega in (("hunter", 1.0, 0.5), ("vogui", 0.6, 0.9), ("vogui", 0.0, -0.7), ("hunter", 0.5, 5.0)):
        drive = load(name).command
        assert isinstance(drive, WheelTable)
        command = np.asarray(drive(np.array([v, omega])), np.float64)
        turn = min(omega, drive.max_yaw_rate, drive.curvature * v) if math.isfinite(drive.curvature) else omega
        for wheel in drive.wheels:
            velocity = np.array([v - turn * wheel.y, turn * (wheel.x - drive.axle)])
            angle = 0.0 if wheel.steer is None else command[wheel.steer]
            rolls = np.array([math.cos(angle), math.sin(angle)])
            assert abs(velocity @ [-rolls[1], rolls[0]]) < 1e-5, "no tyre slides"
            if wheel.motor is not None:
                assert command[wheel.motor] * wheel.radius == pytest.approx(velocity @ rolls, abs=1e-5)
            assert abs(angle) <= wheel.max_steer + 1e-6
    # At rest a car turns its wheels only.
    still = np.asarray(load("hunter").command(np.array([0.0, 0.5])))
    motors = load("hunter").command.motors
    assert np.abs(still[list(motors)]).max() == 0.0
    assert np.abs(still).max() > 0.5


def test_the_tightest_arc_is_that_of_the_inner_wheel() -> None:
    assert largest_curvature([(0.5, 0.3, 0.6), (0.5, -0.3, 0.6)], 0.0) == pytest.approx(
        1.0 / (0.5 / math.tan(0.6) + 0.3)
    )
    assert largest_curvature([], 0.0) == math.inf


def test_commands_have_derivatives_at_rest() -> None:
    for name in ("hunter", "vogui", "husky"):
        drive = load(name).command
        slope = jax.jacobian(drive)(np.zeros(2, np.float32))
        assert np.isfinite(np.asarray(slope)).all(), name


def test_the_planner_knows_how_a_robot_answers() -> None:
    car, base = motion_of(load("hunter")), motion_of(load("mir"))
    assert car.curvature == pytest.approx(response_of("hunter").curvature)
    assert (car.pivot, base.pivot) == (0.2744, -0.0376)
    assert motion_of(make_coco("ackermann")).curvature < 1.0
    assert motion_of(load("wheelchair")) == DEFAULT
    # Above its sideways acceleration a mobility scooter slows down, in the planner's model as on its wheels.
    v, omega = motion_of(load("mobility")).obeyed(1.79, 1.0)
    assert (float(v), omega) == (pytest.approx(1.2), 1.0)


# Drives.


@pytest.mark.parametrize("name", ["courier", "mobility", "mir", "vogui", "tracked"])
def test_a_robot_drives_straight_in_arcs_and_brakes(name: str) -> None:
    robot, found = load(name), drive_figures(name)
    assert found["speed"] == pytest.approx(robot.max_speed, rel=0.02)
    assert found["drift"] < 0.05
    assert found["lag"] == pytest.approx(response_of(name).speed_lag, abs=0.06)
    # From full speed at the largest deceleration of its motors, and its lag.
    shortest = robot.max_speed**2 / (2.0 * mjcf.acceleration(catalogue.row(name)))
    assert 0.8 * shortest < found["brake_distance"] < 1.3 * shortest + 0.1 * robot.max_speed
    assert found["touched"] == []
    low, high = found["yaw_ratio"]
    if catalogue.row(name).drive == "skid":  # tyres slide, and friction depends on their direction
        assert 0.8 < low < high < 1.25
    else:
        assert low == pytest.approx(high, rel=0.03)
        assert low == pytest.approx(1.0, abs=0.03)
    if found["turning_radius"]:
        measured, kinematic = found["turning_radius"]
        assert measured == pytest.approx(kinematic, rel=0.02)


def test_the_balancer_stays_upright_and_falls_without_its_controller() -> None:
    ground = LevelGround("balancer")
    speed, _ = ground.drive(1.0, 0.0, 4.0)
    assert speed[-1] == pytest.approx(1.0, abs=0.02)
    _, turned = ground.drive(0.5, -0.6, 3.0)
    assert turned[-1] == pytest.approx(-0.6, rel=0.05)
    assert ground.touched == set()
    assert ground.data.xmat[1].reshape(3, 3)[2, 2] > 0.98
    limp = LevelGround("balancer")
    limp.gait = None
    limp.robot = load("mir")
    limp.data.qvel[4] = 0.2
    for _ in range(600):
        limp.data.ctrl[:] = 0.0
        mujoco.mj_step(limp.model, limp.data)
    assert limp.data.xmat[1].reshape(3, 3)[2, 2] < 0.8


def test_the_controller_of_the_balancer_is_stable() -> None:
    """The poles of the plant with the gains of the gait, and those of the plant alone."""
    row = catalogue.row("balancer")
    a, b, _ = balance.plant(row)
    assert np.real(np.linalg.eigvals(a)).max() > 1.0
    kernel, radius = gait_of(load("balancer")).kernels[0], row.wheels[0].radius
    speed = -kernel[10].mean()
    rate = kernel[1].mean() * balance.RATE_UNIT - speed * radius
    gains = np.array([kernel[3].mean(), rate, speed])
    assert np.real(np.linalg.eigvals(a + np.outer(b, gains))).max() < -0.5


@pytest.mark.extended
@pytest.mark.parametrize(
    ("name", "impl"),
    [
        ("tracked", "warp"),
        ("mobility", "warp"),
        ("balancer", "warp"),
        pytest.param("courier", "jax", marks=pytest.mark.slow),
        pytest.param("vogui", "jax", marks=pytest.mark.slow),
    ],
)
def test_an_engine_drives_a_robot_as_c_mujoco_does(name: str, impl: str) -> None:
    found = parity_figures(name, impl, 8)
    # Twice COCO's tolerance: roots are up to twice as high, and a hair of tilt shows as much more.
    assert found["before_contact_max_mm"] <= 2.0, found
    assert (found["onset_max_steps"] or 0) <= 1, found
    assert found["ends_differ"] == 0, found


def test_a_task_of_the_catalogue_is_cocos_with_another_robot() -> None:
    config = registry.get_default_config("MobilityNav", "cpu")
    coco = registry.get_default_config("CocoNav", "cpu").to_dict()
    assert {k: x for k, x in coco.items() if k not in ("robot", "drive")} == {
        k: x for k, x in config.to_dict().items() if k != "robot"
    }
    overrides = {"preset": "cpu", "vision": False, "scenes": "all", "impl": "warp"}
    env = registry.load_nav_env(
        "BalancerNav",
        registry.with_overrides(
            registry.get_default_config("BalancerNav", "cpu"),
            {key: x for key, x in overrides.items() if key != "preset"},
        ),
        box_bank(1),
    )
    assert env.robot.name == "balancer"
    assert env.action_size == 2
    with pytest.raises(ValidationError, match="'dynamic' or clutter for a robot with a gait"):
        registry.load("BalancerNav", config_overrides={**overrides, "scenario": "dynamic"}, bank=box_bank(1))


def test_wheels_of_a_table_are_data() -> None:
    one = Wheel(0.0, 0.1, 0.1, motor=0)
    table = WheelTable((one,), 0.0, 1.0, 1, 1.0, 1.0)
    assert table.motors == (0,)
    np.testing.assert_allclose(table(np.array([0.5, 1.0])), [4.0], rtol=1e-6)


# Figures.


def test_figures_are_kept_and_shown(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "robots.csv"
    planner = {"success": 0.75, "interval": [0.5, 0.9], "ends": {"goal": 12, "hit": 4}}
    drive = {"speed": 1.0, "brake_distance": 0.15, "yaw_ratio": [0.9, 1.1], "turning_radius": None}
    for figures in ({**planner, "success": 0.0}, planner):
        figures_of.keep("husky", "planner", figures, path)
    figures_of.keep("husky", "drive", drive, path)
    assert figures_of.kept(path)["husky"] == {"planner": planner, "drive": drive}
    row = "| `husky` | 1.00 | 0.15 | 0.90-1.10 | on the spot |  |  | 75 % [50, 90] | 12 goal, 4 hit |"
    assert row in figures_of.measured_text(path)
    with pytest.raises(ValidationError, match="--robots: found huskie"):
        figures_of.main(["--drive", "--robots", "huskie"])
