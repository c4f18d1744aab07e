"""A compiled street with a robot as one stock MuJoCo model, and the drive that all peers make in it."""

import dataclasses
import pathlib

import mujoco
import numpy as np

from urbanverse_mjx.datatypes import RobotSpec, ValidationError

#: Prefix of the robot's names, and groups of a scene's visual meshes and of its hulls, as `scene compile` writes them.
ROBOT, SEEN, HIT = "robot/", 2, 3
#: Prefix of the names of the ground's geoms in a compiled scene.
GROUND = "ground/"


@dataclasses.dataclass(frozen=True)
class Cut:
    """A part of a street: the geoms nearest to a place.

    Attributes:
      place: (2,) m.
      hulls: number of objects' hulls that are kept.
      prisms: number of the ground's prisms that are kept.
    """

    place: np.ndarray
    hulls: int
    prisms: int


def street_spec(folder: pathlib.Path, seen: bool, cut: Cut | None = None) -> mujoco.MjSpec:
    """Reads `scene.xml` of a compiled scene.

    Args:
      seen: with visual meshes, materials and textures; without them their files need not be there.
      cut: keeps a part of the street alone.

    Raises:
      ValidationError: the folder has no scene.xml that MuJoCo can read.
    """
    path = folder / "scene.xml"
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except (OSError, ValueError) as error:
        raise ValidationError(
            f"{path}: found no scene that MuJoCo reads ({error}), needed one of `urbanverse scene compile`."
        ) from error
    if not seen:
        for geom in [geom for geom in spec.geoms if geom.group == SEEN]:
            spec.delete(geom)
        for unused in (*spec.materials, *spec.textures):
            spec.delete(unused)
        _drop_unused_meshes(spec)
    if cut is not None:
        kept = _nearest(spec, cut)
        for geom in [geom for geom in spec.geoms if geom.group == HIT and geom.name not in kept]:
            spec.delete(geom)
        _drop_unused_meshes(spec)
    # Objects do not move: without this each of them is a body whose pose every engine computes again in every step.
    spec.compiler.fusestatic = True
    return spec


def _drop_unused_meshes(spec: mujoco.MjSpec) -> None:
    used = {geom.meshname for geom in spec.geoms}
    for mesh in [mesh for mesh in spec.meshes if mesh.name not in used]:
        spec.delete(mesh)


def _nearest(spec: mujoco.MjSpec, cut: Cut) -> set[str]:
    """Names of the geoms whose bounding spheres are nearest to the place."""
    model = spec.copy().compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rows = np.flatnonzero(model.geom_group == HIT)
    away = np.linalg.norm(data.geom_xpos[rows, :2] - cut.place, axis=1) - model.geom_rbound[rows]
    names = [model.geom(row).name for row in rows[np.argsort(away, kind="stable")]]
    ground = [name for name in names if name.startswith(GROUND)]
    return {*[name for name in names if not name.startswith(GROUND)][: cut.hulls], *ground[: cut.prisms]}


def with_robot(
    spec: mujoco.MjSpec,
    robot: RobotSpec,
    timestep: float,
    size: tuple[int, int] | None = None,
    numeric: dict[str, float] | None = None,
) -> mujoco.MjModel:
    """Compiles a street with the robot under the prefix `ROBOT`, the world's only moving body.

    Args:
      timestep: s.
      size: height and width of the images; None without.
      numeric: custom numbers, by which MJX takes its limits.
    """
    body = mujoco.MjSpec.from_string(robot.mjcf)
    for option in ("integrator", "cone"):
        setattr(spec.option, option, getattr(body.option, option))
    spec.option.timestep = timestep
    if size is not None:
        spec.visual.global_.offheight, spec.visual.global_.offwidth = size
    for name, value in (numeric or {}).items():
        spec.add_numeric(name=name, data=[value], size=1)
    spec.attach(body, prefix=ROBOT, frame=spec.worldbody.add_frame())
    return spec.compile()


def hulls_of(model: mujoco.MjModel) -> int:
    """Returns the number of geoms of the street that the robot can hit."""
    return int(((model.geom_group == HIT) & (model.geom_conaffinity != 0) & (model.geom_contype != 0)).sum())


@dataclasses.dataclass(frozen=True)
class Drive:
    """What all peers do: n robots start at episodes of the street, are sent forward with random turns, and begin again.

    Attributes:
      timestep: s.
      substeps: physics steps per control step.
      qpos: (n, nq) starts.
      ctrl: (T, n, nu) commands of the control steps, repeated after T.
      episode: control steps of an episode; env i begins again before step t where (t + i) is a multiple of it.
      scene: (n,) which of the streets an env is in.
    """

    timestep: float
    substeps: int
    qpos: np.ndarray
    ctrl: np.ndarray
    episode: int
    scene: np.ndarray

    @property
    def count(self) -> int:
        """Returns the number of envs."""
        return len(self.qpos)

    def begins(self, step: int) -> np.ndarray:
        """Returns (n,) bool: the envs that begin again before a control step."""
        return (np.arange(self.count) + step) % self.episode == 0

    def commands(self, step: int) -> np.ndarray:
        """Returns (n, nu) commands of a control step."""
        return self.ctrl[step % len(self.ctrl)]


def make_drive(
    folders: list[pathlib.Path],
    robot: RobotSpec,
    count: int,
    *,
    substeps: int,
    control: float,
    episode: int,
    steps: int = 20,
    seed: int = 0,
) -> Drive:
    """Returns the drive of `count` robots, env i in street i modulo their number, at its episodes in turn.

    Args:
      folders: compiled scenes with `episodes.npz`.
      control: s, a control step.
      episode: control steps.
      steps: number of different commands of an env.

    Raises:
      ValidationError: a scene has no episodes.
    """
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    scene = np.arange(count) % len(folders)
    qpos = np.tile(model.qpos0, (count, 1))
    for number, folder in enumerate(folders):
        try:
            with np.load(folder / "episodes.npz") as file:
                start = file["start"]
        except (OSError, KeyError) as error:
            raise ValidationError(
                f"{folder}: found no episodes.npz with starts ({error}), needed a folder of `urbanverse scene compile`."
            ) from error
        rows = np.flatnonzero(scene == number)
        taken = start[np.arange(len(rows)) % len(start)]
        qpos[rows, :3] = taken[:, :3] + (0.0, 0.0, robot.spawn_height)
        qpos[rows, 3], qpos[rows, 4:6], qpos[rows, 6] = np.cos(taken[:, 3] / 2), 0.0, np.sin(taken[:, 3] / 2)
    return Drive(control / substeps, substeps, qpos, commands(robot, steps, count, control, seed), episode, scene)


def commands(robot: RobotSpec, steps: int, count: int, control: float, seed: int) -> np.ndarray:
    """Returns (steps, count, nu) f32 actuator commands towards waypoints ahead with random turns."""
    import jax
    import jax.numpy as jnp

    waypoint = np.random.default_rng(seed).uniform(-1, 1, (steps, count, 2)).astype(np.float32)
    waypoint[..., 0] = 0.5 + 0.5 * waypoint[..., 0]

    def command(waypoint: jax.Array) -> jax.Array:
        return robot.command(jnp.stack(robot.waypoint_to_velocity(waypoint, control)))

    return np.asarray(jax.vmap(jax.vmap(command))(jnp.asarray(waypoint)))
