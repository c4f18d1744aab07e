"""The COCO robot's body as MJCF text: masses, wheels, collision spheres and visual geoms.

In:   the drive.
Out:  MJCF text of one free body without ground and light.
When: once, at construction.

Sources of the numbers: "coco.json" = docs/sources/coco.json (public facts on the robot, with its own list of sources).
"""

import dataclasses
import math

import numpy as np

# --- Geometry (coco.json, geometry_from_model; metres in base_link) ---
FRONT_AXLE_X = 0.221  # front_axle_in_base
REAR_AXLE_X = -0.235  # rear_axle_in_base
AXLE_Z = -0.095  # front_axle_in_base, rear_axle_in_base
WHEEL_Y = 0.236  # wheel_centre_in_base
WHEEL_Z = -0.166  # wheel_centre_in_base
WHEELBASE = 0.456  # wheelbase_m
TRACK = 0.472  # track_m
WHEEL_RADIUS = 0.11  # wheel_radius_m
WHEEL_HALF_WIDTH = 0.0332  # hub_cover_outer_x_in_wheel: of the visual geom; the wheel collides as a sphere
BODY_LENGTH, BODY_WIDTH, BODY_HEIGHT = 0.7, 0.5, 0.4  # body_collision_box_full_m
GROUND_CLEARANCE = 0.08  # ground_clearance_visual_offset_m

# --- Masses (coco.json, mass_properties_usd_second_hand; kg, kg m^2) ---
BASE_MASS, BASE_INERTIA = 50.0, 2.5
BODY_MASS, BODY_INERTIA = 25.0, 2.5
WHEEL_MASS, WHEEL_INERTIA = 1.0, 0.1
TOTAL_MASS = BASE_MASS + BODY_MASS + 4 * WHEEL_MASS  # total_mass: 79

# --- Contact (coco.json, friction_usd_second_hand: static 0.7, dynamic 0.6; MuJoCo has one coefficient) ---
TYRE_FRICTION = 0.7
BODY_FRICTION = 0.6

# --- Steering (coco.json, usd_drives_second_hand.steer and urbansim_actuators.axle) ---
MAX_STEER = math.radians(20.053522)  # range_deg
STEER_EFFORT = 64.0  # N m, effort_limit

#: s. coco2play_kinematics.speed_time_constant_s is 0.2, i.e. 10 m/s² at a full start, which exceeds the tyres'
#: friction: they would spin, and the rear wheels would hop at the physics rate. At 0.3 s they hardly do.
SPEED_TIME_CONSTANT = 0.3

# --- Camera (coco.json, urbansim_camera) ---
CAMERA_POSITION = (0.51, 0.0, 0.015)  # pos_in_base
CAMERA_FOVY_DEG = 90.96  # static_env.vfov_deg; 122.1 across at 16:9

# --- Choices without a public source ---
#: m, penetration of the tyres into flat ground at rest with MuJoCo's default contact (tests/robots/test_coco.py).
TYRE_PENETRATION = 0.0003
#: Height of base_link above flat ground at rest.
SPAWN_HEIGHT = WHEEL_RADIUS - WHEEL_Z - TYRE_PENETRATION
#: Half-way between the axles, so that all wheels carry the same load.
CENTRE_X = 0.5 * (FRONT_AXLE_X + REAR_AXLE_X)
#: Centre of the shell: its lower side is `GROUND_CLEARANCE` above the ground.
SHELL_Z = GROUND_CLEARANCE + 0.5 * BODY_HEIGHT - SPAWN_HEIGHT
#: m, radius of the shell's rounded edges.
SHELL_CORNER_RADIUS = 0.155
#: Eight spheres as tall as the shell; no point of the shell is 3 cm outside (tests/robots/test_coco.py).
BODY_SPHERE_RADIUS = 0.5 * BODY_HEIGHT
BODY_SPHERES = tuple((x, y, SHELL_Z) for x in (-0.153, -0.051, 0.051, 0.153) for y in (-0.052, 0.052))

WHEELS = ("front_left", "front_right", "rear_left", "rear_right")


@dataclasses.dataclass(frozen=True)
class Servo:
    """Gains of the joint servos.

    Attributes:
      wheel: N m s/rad, torque of a wheel = wheel * (target speed - speed).
      steer: N m/rad, steer_damping: N m s/rad of the front axle (coco.json, urbansim_actuators.axle.damping).
    """

    wheel: float
    steer: float
    steer_damping: float


def make_servo(drive: str) -> Servo:
    """Gains that follow a speed command with the lag `SPEED_TIME_CONSTANT`.

    coco.json has contradictory wheel gains, 1e6 (USD) and 0.3 (UrbanSim, with commands a hundred times too fast), so
    the gain is computed from the lag: moving inertia at the wheels with friction / (their number * lag). A slope of 1:8
    then reduces the speed by 0.3 m/s. The steering gain is chosen so that the axle turns with a lag of 0.1 s against
    the front wheels' servos.
    """
    gripping = 2 if drive == "differential" else 4
    inertia = TOTAL_MASS * WHEEL_RADIUS**2 + gripping * WHEEL_INERTIA
    return Servo(wheel=inertia / (gripping * SPEED_TIME_CONSTANT), steer=100.0, steer_damping=0.5)


def rounded_box(half: tuple[float, float, float], radius: float, steps: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """A box with rounded edges as a convex mesh.

    Args:
      half: half sizes (m), each at least `radius`.
      radius: m.
      steps: rings per quarter turn.

    Returns:
      vertices (n, 3) f64 m and outward faces (m, 3) i32.
    """
    inner = np.array(half) - radius
    polar = np.linspace(0.0, np.pi, 2 * steps + 2)
    azimuth = np.linspace(0.0, 2 * np.pi, 4 * (steps + 1), endpoint=False) + np.pi / (4 * (steps + 1))
    rows, cols = len(polar), len(azimuth)
    p, a = np.meshgrid(polar, azimuth, indexing="ij")
    unit = np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], axis=-1)
    # The first and last ring are the flat lid and floor, with a small radius so that signs are defined.
    upper = np.where(np.arange(rows) < rows // 2, 1.0, -1.0)
    side = np.stack([np.sign(np.cos(a)), np.sign(np.sin(a)), np.broadcast_to(upper[:, None], a.shape)], -1)
    vertices = (unit * radius + side * inner).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(cols), indexing="ij")
    k = (j + 1) % cols
    quads = np.stack([i * cols + j, (i + 1) * cols + j, (i + 1) * cols + k, i * cols + k], -1).reshape(-1, 4)
    flat = [_fan(0, cols), _fan((rows - 1) * cols, cols)[:, ::-1]]
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], *flat])
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return vertices, faces[area > 1e-10].astype(np.int32)


def _fan(first: int, count: int) -> np.ndarray:
    """Triangles of a convex ring of `count` vertices that starts at vertex `first`."""
    middle = np.arange(1, count - 1)
    return np.stack([np.full(count - 2, first), first + middle, first + middle + 1], -1)


def shell_mesh() -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) m in base_link and faces (m, 3) of the visible shell."""
    vertices, faces = rounded_box((0.5 * BODY_LENGTH, 0.5 * BODY_WIDTH, 0.5 * BODY_HEIGHT), SHELL_CORNER_RADIUS)
    return vertices + (0.0, 0.0, SHELL_Z), faces


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{v:.5g}" for v in np.asarray(values).ravel())


def _mesh(name: str, vertices: np.ndarray, faces: np.ndarray) -> str:
    face_text = " ".join(str(v) for v in faces.ravel())
    return f'<mesh name="{name}" vertex="{_numbers(vertices)}" face="{face_text}"/>'


def _wheel(name: str, position: tuple[float, float, float], gain: float, omni: bool = False) -> str:
    # With the higher priority, the wheel's condim is used regardless of the ground.
    contact = 'condim="1" priority="1"' if omni else f'friction="{TYRE_FRICTION} 0.005 0.0001"'
    return f"""
      <body name="{name}_wheel_link" pos="{_numbers(np.array(position))}">
        <inertial pos="0 0 0" mass="{WHEEL_MASS}" diaginertia="{WHEEL_INERTIA} {WHEEL_INERTIA} {WHEEL_INERTIA}"/>
        <joint name="{name}_wheel_joint" type="hinge" axis="0 1 0" damping="{gain:.9g}"/>
        <geom name="{name}_wheel" class="collision" type="sphere" size="{WHEEL_RADIUS}" {contact}/>
        <geom class="visual" type="cylinder" size="{WHEEL_RADIUS} {WHEEL_HALF_WIDTH}" zaxis="0 1 0" material="tyre"/>
        <geom class="visual" type="cylinder" size="0.0857 {WHEEL_HALF_WIDTH + 0.002}" zaxis="0 1 0" material="hub"/>
      </body>"""


def _axle(end: str, x: float, z: float, gain: float, omni: bool = False) -> str:
    sides = (("left", WHEEL_Y), ("right", -WHEEL_Y))
    return "".join(_wheel(f"{end}_{side}", (x, y, z), gain, omni) for side, y in sides)


def _steered_axle(servo: Servo) -> tuple[str, str]:
    """The front axle of the Ackermann drive, which turns as a whole, and its actuator."""
    limit = f"{-MAX_STEER:.6f} {MAX_STEER:.6f}"
    axle = f"""
      <body name="front_axle_link" pos="{FRONT_AXLE_X} 0 {AXLE_Z}">
        <inertial pos="0 0 0" mass="1e-6" diaginertia="1e-5 1e-5 1e-5"/>
        <joint name="base_to_front_axle_joint" type="hinge" axis="0 0 1" range="{limit}"
               damping="{servo.steer_damping:g}"/>
        {_axle("front", 0.0, WHEEL_Z - AXLE_Z, servo.wheel)}
      </body>"""
    gain, effort = f"{servo.steer:g}", f"{STEER_EFFORT:g}"
    actuator = f"""<general name="steer" joint="base_to_front_axle_joint" ctrlrange="{limit}" biastype="affine"
      gainprm="{gain}" biasprm="0 -{gain} 0" forcerange="-{effort} {effort}"/>"""
    return axle, actuator


def _body_geoms() -> str:
    lines = [
        f'<geom name="body_{i}" class="collision" type="sphere" size="{BODY_SPHERE_RADIUS}"'
        f' pos="{_numbers(np.array(centre))}" friction="{BODY_FRICTION} 0.005 0.0001"/>'
        for i, centre in enumerate(BODY_SPHERES)
    ]
    top = SHELL_Z + 0.5 * BODY_HEIGHT
    box, pole = f"{CENTRE_X} 0 {AXLE_Z - 0.05}", f"-0.27 0.12 {top - 0.08} -0.27 0.12 {top + 0.72}"
    parts = {"shell": "paint", "lid": "lid", "band": "chassis", "visor": "chassis"}
    lines += [f'<geom class="visual" type="mesh" mesh="{m}" material="{material}"/>' for m, material in parts.items()]
    lines += [
        f'<geom class="visual" type="box" size="0.26 0.17 0.045" pos="{box}" material="chassis"/>',
        f'<geom class="visual" type="capsule" size="0.006" fromto="{pole}" material="chassis"/>',
        f'<geom class="visual" type="box" size="0.09 0.002 0.06" pos="-0.365 0.12 {top + 0.66}" material="flag"/>',
    ]
    return "\n      ".join(lines)


def _seen_meshes() -> str:
    """Visual meshes: the shell, a lid slightly above it, and a dark visor with the cameras in front."""
    shell_v, shell_f = shell_mesh()
    lid_v = (shell_v - (0, 0, SHELL_Z)) * 1.012 + (0, 0, SHELL_Z)
    lid_v[:, 2] = np.maximum(lid_v[:, 2], SHELL_Z + 0.075)
    band_v = (shell_v - (0, 0, SHELL_Z)) * 1.006 + (0, 0, SHELL_Z)
    band_v[:, 2] = np.clip(band_v[:, 2], SHELL_Z - 0.2, SHELL_Z - 0.06)
    visor_v, visor_f = rounded_box((0.02, 0.15, 0.035), 0.019)
    meshes = [
        _mesh("shell", shell_v, shell_f),
        _mesh("lid", lid_v, shell_f),
        _mesh("band", band_v, shell_f),
        _mesh("visor", visor_v + (0.34, 0, SHELL_Z + 0.01), visor_f),
    ]
    return "\n    ".join(meshes)


def make_mjcf(drive: str, servo: Servo) -> str:
    """MJCF text of the robot; `drive` is "differential" or "ackermann"."""
    if drive == "differential":
        front, steer = _axle("front", FRONT_AXLE_X, WHEEL_Z, servo.wheel, omni=True), ""
    else:
        front, steer = _steered_axle(servo)
    rear = _axle("rear", REAR_AXLE_X, WHEEL_Z, servo.wheel)
    gain = f'gainprm="{servo.wheel:.9g}"'
    motors = "\n    ".join(f'<general name="{w}_wheel" joint="{w}_wheel_joint" {gain}/>' for w in WHEELS)
    base, shell = (" ".join([f"{inertia}"] * 3) for inertia in (BASE_INERTIA, BODY_INERTIA))
    return f"""<mujoco model="coco_{drive}">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="0.010" integrator="Euler" cone="pyramidal"/>
  <default>
    <default class="collision"><geom group="3" contype="0" conaffinity="1" rgba="0.2 0.6 1 0.3"/></default>
    <default class="visual"><geom group="2" contype="0" conaffinity="0" mass="0"/></default>
  </default>
  <asset>
    <material name="paint" rgba="0.93 0.93 0.91 1"/>
    <material name="lid" rgba="0.94 0.36 0.55 1"/>
    <material name="chassis" rgba="0.09 0.09 0.10 1"/>
    <material name="tyre" rgba="0.05 0.05 0.05 1"/>
    <material name="hub" rgba="0.55 0.57 0.60 1"/>
    <material name="flag" rgba="0.95 0.45 0.10 1"/>
    {_seen_meshes()}
  </asset>
  <worldbody>
    <body name="base_link" pos="0 0 {SPAWN_HEIGHT:.6g}">
      <freejoint name="root"/>
      <inertial pos="{CENTRE_X} 0 {WHEEL_Z}" mass="{BASE_MASS:g}" diaginertia="{base}"/>
      <camera name="front_cam" pos="{_numbers(np.array(CAMERA_POSITION))}" xyaxes="0 -1 0 0 0 1"
              fovy="{CAMERA_FOVY_DEG}"/>
      <body name="body_link">
        <inertial pos="{CENTRE_X} 0 {SHELL_Z:g}" mass="{BODY_MASS:g}" diaginertia="{shell}"/>
      {_body_geoms()}
      </body>{front}{rear}
    </body>
  </worldbody>
  <actuator>
    {motors}
    {steer}
  </actuator>
</mujoco>
"""
