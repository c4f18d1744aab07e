"""Collision shapes covered by spheres: the reported error against arithmetic and against C MuJoCo's own contacts."""

import json
import pathlib

import mujoco
import numpy as np
import pytest
import trimesh

from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.robots import load
from urbanverse_mjx.robots.collision import Fit
from urbanverse_mjx.robots.description import load_with_fits
from urbanverse_mjx.robots.sphere_fit import Cover, FitOptions, cover, wheel

#: A cart as a CAD program gives it: a hull with a nose and cylinders for wheels as meshes, a bumper, a caster.
CART = """
<mujoco model="cart">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="0.005" integrator="Euler" cone="pyramidal"/>
  <asset>
    <mesh name="chassis" file="chassis.obj"/>
    <mesh name="tyre" file="tyre.obj"/>
  </asset>
  <worldbody>
    <body name="base" pos="0 0 0.12">
      <freejoint/>
      <camera name="front" pos="0.32 0 0.15" xyaxes="0 -1 0 0 0 1" fovy="75"/>
      <geom name="chassis" type="mesh" mesh="chassis" pos="0 0 0.12" euler="0 0 0.1" mass="20"/>
      <geom name="bumper" type="capsule" fromto="0.33 -0.15 0.05 0.33 0.15 0.05" size="0.03" mass="0.5"/>
      <geom name="battery" type="box" size="0.1 0.08 0.05" pos="-0.05 0 0.03" mass="3"/>
      <geom name="caster" type="cylinder" size="0.05 0.02" pos="0.22 0 -0.07" euler="1.5707963 0 0" condim="1"
        priority="1" mass="0.2"/>
      <body name="left" pos="0 0.2 0">
        <joint name="left_axle" axis="0 1 0" damping="2" armature="0.02"/>
        <geom name="left_tyre" type="mesh" mesh="tyre" mass="1" friction="0.8 0.005 0.0001"/>
      </body>
      <body name="right" pos="0 -0.2 0">
        <joint name="right_axle" axis="0 1 0" damping="2" armature="0.02"/>
        <geom name="right_tyre" type="mesh" mesh="tyre" mass="1" friction="0.8 0.005 0.0001"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <general name="left_motor" joint="left_axle" gainprm="2"/>
    <general name="right_motor" joint="right_axle" gainprm="2"/>
  </actuator>
</mujoco>
"""
WHEEL = 0.12
ABOUT = {
    "schema": "urbanverse.robot/1",
    "name": "cart",
    "mjcf": "cart.xml",
    "root_body": "base",
    "camera": "front",
    "feet": ["left_tyre", "right_tyre", "caster"],
    "max_speed": 1.0,
    "max_yaw_rate": 1.0,
    "drive": {
        "kind": "differential",
        "left": ["left_motor"],
        "right": ["right_motor"],
        "wheel_radius": WHEEL,
        "track": 0.4,
    },
    "planner": {"radius": 0.4, "height": 0.5, "step": 0.02},
}


def write(folder: pathlib.Path, **fields: object) -> pathlib.Path:
    """The cart's files in a folder."""
    sections = ((-0.25, 0.15, 0.1), (0.1, 0.15, 0.1), (0.3, 0.08, 0.04))
    corners = [(x, y, z) for x, w, h in sections for y in (-w, w) for z in (-h, h)]
    chassis = trimesh.convex.convex_hull(np.array(corners))
    chassis.export(folder / "chassis.obj")
    tyre = trimesh.creation.cylinder(WHEEL, 0.06, sections=64)
    tyre.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    tyre.export(folder / "tyre.obj")
    (folder / "cart.xml").write_text(CART)
    (folder / "robot.json").write_text(json.dumps(ABOUT | fields))
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    return write(tmp_path_factory.mktemp("cart"))


@pytest.fixture(scope="module")
def fits(folder: pathlib.Path) -> dict[str, Fit]:
    return {fit.geom: fit for fit in load_with_fits(folder)[1]}


def deviations(made: Cover, points: np.ndarray) -> tuple[float, float]:
    """m: how far spheres stand out of the hull of points, and how far its surface lies outside them, by sampling."""
    hull = trimesh.convex.convex_hull(points)
    surface = np.asarray(trimesh.sample.sample_surface(hull, 4000, seed=1)[0])
    short = (np.linalg.norm(surface[:, None] - made.centre[None], axis=2) - made.radius).min(1).max()
    ball = trimesh.creation.icosphere(subdivisions=2).vertices
    shell = (made.centre[:, None] + made.radius[:, None, None] * ball).reshape(-1, 3)
    planes = np.c_[hull.face_normals, -np.einsum("ij,ij->i", hull.face_normals, hull.triangles[:, 0])]
    # Beyond the nearest plane is at most beyond the hull.
    return float((shell @ planes[:, :3].T + planes[:, 3]).max(1).max()), float(short)


@pytest.mark.parametrize("size", [(0.6, 0.4, 0.3), (0.6, 0.3, 0.02), (0.2, 0.2, 0.9)])
def test_a_cover_errs_by_no_more_than_it_says(size: tuple[float, float, float]) -> None:
    points = trimesh.creation.box(size).vertices + [3.0, -1.0, 0.5]
    few, many = (cover(points, FitOptions(0.005, n)) for n in (8, 40))
    for made, most in ((few, 8), (many, 40)):
        assert len(made.radius) <= most
        stands_out, short = deviations(made, points)
        assert stands_out <= made.protrudes + 1e-9
        assert short <= made.falls_short + 0.002
        assert stands_out >= 0.5 * made.protrudes, "it claims an error that it does not have"
    assert many.error < 0.75 * few.error


def test_few_spheres_are_taken_where_few_are_enough() -> None:
    # The tolerance bounds the error, and of the spheres within it the closest is taken: for a ball that ball.
    ball = cover(trimesh.creation.icosphere(3, 0.05).vertices + [1.0, 0.0, 0.0], FitOptions(0.02))
    np.testing.assert_allclose(ball.centre, [[1.0, 0.0, 0.0]], atol=1e-6)
    assert ball.radius == pytest.approx([0.05], abs=5e-4)
    assert ball.error < 1e-3
    capsule = trimesh.creation.capsule(0.3, 0.1, count=[32, 32]).vertices
    made = cover(capsule, FitOptions(0.02))
    assert len(made.radius) <= 3
    assert made.error <= 0.02
    with pytest.raises(ValidationError, match="enclose no volume"):
        cover(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]]))


def test_a_wheel_rolls_on_its_own_radius() -> None:
    tyre = trimesh.creation.cylinder(0.1, 0.06, sections=64).vertices
    made = wheel(tyre, np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 0.5]))
    np.testing.assert_allclose(made.centre, [[0.0, 0.0, 0.0]], atol=1e-9)
    assert made.radius == pytest.approx([0.1], abs=1e-4)
    # A ball as wide as the wheel is high stands out of a flat wheel by the rest of its radius.
    assert made.protrudes == pytest.approx(0.1 - 0.03, abs=0.004)
    drum = trimesh.creation.cylinder(0.1, 0.5, sections=64).vertices
    wide = wheel(drum, np.array([0.0, 0.0, 1.0]), np.zeros(3))
    assert len(wide.radius) == 3
    assert wide.falls_short == pytest.approx(np.hypot(0.1, 0.25 / 3) - 0.1, abs=0.005)


@pytest.mark.extended
def test_every_shape_is_replaced_and_weighs_what_it_weighed(folder: pathlib.Path, fits: dict[str, Fit]) -> None:
    robot = load(folder)
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    original = mujoco.MjModel.from_xml_path(str(folder / "cart.xml"))
    assert {name: fit.shape for name, fit in fits.items()} == {
        "chassis": "mesh",
        "bumper": "capsule",
        "battery": "box",
        "caster": "cylinder",
        "left_tyre": "mesh",
        "right_tyre": "mesh",
    }
    assert [name for name, fit in fits.items() if fit.rolls] == ["caster", "left_tyre", "right_tyre"]
    colliding = np.flatnonzero(model.geom_conaffinity)
    assert (model.geom_type[colliding] == mujoco.mjtGeom.mjGEOM_SPHERE).all()
    assert len(colliding) == sum(len(fit.spheres) for fit in fits.values())
    assert set(robot.foot_geoms) == {s for foot in ABOUT["feet"] for s in fits[foot].spheres}  # type: ignore[attr-defined]
    for body in ("base", "left"):
        np.testing.assert_allclose(model.body(body).mass, original.body(body).mass)
        np.testing.assert_allclose(model.body(body).inertia, original.body(body).inertia, rtol=1e-5)
    # The shapes themselves are what cameras see; friction goes with the spheres.
    assert model.geom("chassis").group[0] == 2
    np.testing.assert_allclose(model.geom(fits["left_tyre"].spheres[0]).friction, [0.8, 0.005, 0.0001])
    # Wheels and caster reach as low as they did: the radius of the wheels below their axle.
    assert robot.spawn_height == pytest.approx(WHEEL, abs=1e-3)


@pytest.mark.extended
def test_distances_to_an_obstacle_are_c_mujocos_within_the_reported_error(
    folder: pathlib.Path, fits: dict[str, Fit]
) -> None:
    """C MuJoCo's distance from the cart's own shapes to a box, and from the spheres, over random poses of the box."""
    robot = load(folder)
    rng = np.random.default_rng(0)

    def with_box(spec: mujoco.MjSpec) -> mujoco.MjModel:
        body = spec.worldbody.add_body(name="obstacle", mocap=True)
        body.add_geom(name="obstacle", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.15, 0.3])
        return spec.compile()

    models = [
        with_box(s) for s in (mujoco.MjSpec.from_file(str(folder / "cart.xml")), mujoco.MjSpec.from_string(robot.mjcf))
    ]
    data = [mujoco.MjData(m) for m in models]

    def distance(side: int, geoms: tuple[str, ...]) -> float:
        m, d = models[side], data[side]
        box = m.geom("obstacle").id
        return min(mujoco.mj_geomDistance(m, d, m.geom(g).id, box, 5.0, np.zeros(6)) for g in geoms)

    checked = 0
    for _ in range(60):
        place = np.r_[rng.uniform(-0.9, 0.9, 2), rng.uniform(0.1, 0.6)]
        turn = rng.normal(size=4)
        for m, d in zip(models, data, strict=True):
            d.mocap_pos[0], d.mocap_quat[0] = place, turn / np.linalg.norm(turn)
            mujoco.mj_forward(m, d)
        for fit in fits.values():
            reference, found = distance(0, (fit.geom,)), distance(1, fit.spheres)
            if reference < 0.02:
                continue  # depths inside each other are measured otherwise
            assert -fit.cover.protrudes - 0.002 <= found - reference <= fit.cover.falls_short + 0.002, fit.geom
            checked += 1
    assert checked > 150


@pytest.mark.extended
def test_it_stops_at_a_wall_where_c_mujoco_stops_its_own_shapes(folder: pathlib.Path, fits: dict[str, Fit]) -> None:
    robot = load(folder)
    stops, passed = [], []
    for spec in (mujoco.MjSpec.from_file(str(folder / "cart.xml")), mujoco.MjSpec.from_string(robot.mjcf)):
        for geom in spec.geoms:
            if geom.contype or geom.conaffinity:
                geom.contype, geom.conaffinity = 0, 1
        solid = {"contype": 1, "conaffinity": 0}
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9, 9, 1], **solid)
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 2, 1], pos=[1.6, 0, 0.5], **solid)
        model = spec.compile()
        data = mujoco.MjData(model)
        for step in range(800):
            # A joint's speed servo, as the description gives it: 0.8 m/s straight on.
            data.ctrl[:] = 0.8 / WHEEL
            mujoco.mj_step(model, data)
            if step == 200:
                passed.append(float(data.qpos[0]))
        stops.append(float(data.qpos[0]))
    front = max(fits["bumper"].cover.error, fits["chassis"].cover.error)
    assert abs(stops[0] - stops[1]) < front + 0.01
    assert 1.0 < stops[0] < 1.3
    # Before, it drives as its own wheels do, at up to 0.8 m/s.
    assert passed[0] == pytest.approx(passed[1], abs=0.1)
    assert 0.2 < passed[0] < 0.85


@pytest.mark.extended
def test_the_command_reports_the_fit_and_draws_it(folder: pathlib.Path, tmp_path: pathlib.Path, capsys) -> None:
    drawing = tmp_path / "fit.png"
    assert cli.main(["robot", str(folder), "--picture", str(drawing)]) == 0
    *lines, wheels, clearance, stability, start, last = capsys.readouterr().out.splitlines()
    lines = [line for line in lines if "fit.tolerance" not in line]
    assert [line.split()[0] for line in lines] == ["chassis", "bumper", "battery", "caster", "left_tyre", "right_tyre"]
    said = json.loads(last)
    protrude = max(fit.cover.protrudes for fit in load_with_fits(folder)[1] if fit.rolls)
    assert wheels.startswith("wheels: their spheres have the wheel's radius")
    assert f"to {protrude:.3f} m" in wheels
    assert clearance == f"lowest part that is no foot: {said['clearance']:.3f} m above the ground"
    assert stability.endswith(f"tips over at {said['tips_at']:.1f} m/s²")
    assert start.startswith("full speed from rest on level ground, then a stop: ")
    assert (said["start_touches"] or "only its feet") in start
    assert (said["fitted"], said["robot"]) == (6, "cart")
    assert 0.0 < said["largest_error"] < 0.1
    from PIL import Image

    with Image.open(drawing) as image:
        assert image.size == (1260, 420)
        assert len(image.convert("RGB").getcolors(100_000) or []) > 10


@pytest.mark.extended
@pytest.mark.parametrize(
    ("fit", "missed", "remedy"),
    [
        ({"tolerance": 0.001, "spheres": 4}, ["chassis", "bumper", "battery"], '"fit": {"spheres": 64}'),
        ({"tolerance": 0.001, "spheres": 64}, ["chassis"], "to come closer, make it of several smaller shapes"),
        ({"tolerance": 0.5}, [], ""),
    ],
)
def test_a_fit_worse_than_the_tolerance_says_what_to_do(
    fit: dict[str, float], missed: list[str], remedy: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not of wheels, whose spheres protrude to their sides by design."""
    write(tmp_path, fit=fit)
    assert cli.main(["robot", str(tmp_path)]) == 0
    said = [line for line in capsys.readouterr().out.splitlines() if "fit.tolerance" in line]
    assert set(missed) <= {line.partition(":")[0] for line in said} <= {"chassis", "bumper", "battery", "caster"}
    assert all(remedy in line for line in said)
    assert bool(said) == bool(missed)


@pytest.mark.extended
def test_names_in_errors_are_those_of_the_file(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, feet=["left_tyre", "right_tyre", "castor"])
    assert cli.main(["robot", str(tmp_path)]) != 0
    said = capsys.readouterr().err
    assert "found 'castor', needed a geom of the MJCF" in said
    assert said.rstrip().endswith("it has chassis, bumper, battery, caster, left_tyre, right_tyre.")


@pytest.mark.extended
def test_the_fit_can_be_finer_and_its_options_are_checked(tmp_path: pathlib.Path) -> None:
    rough, fine = (
        load_with_fits(write(tmp_path, fit={"tolerance": 0.005, "spheres": n}))[1][0].cover.error for n in (3, 12)
    )
    assert fine < 0.8 * rough
    with pytest.raises(ValidationError, match=r"fit\.spheres"):
        load(write(tmp_path, fit={"spheres": 0}))
