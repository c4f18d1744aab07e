"""A LiDAR on the robot, cast by the renderer's own rays for many steps at once."""

import dataclasses
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from ...datasets.features import IMAGE_AXES, Feature
from ...datatypes import validation as v
from ...geometry import rotations

if TYPE_CHECKING:
    from ...envs import NavEnv

LIDAR = "observation.images.lidar"
#: Of a pattern that is not even: they stand in the renderer's program.
_MOST_ELEVATIONS = 256
#: Options of an even pattern.
_EVEN = ("rings", "upper", "lower")
#: T_lidar_camera for a camera of MuJoCo (-z ahead, y up) that looks along the LiDAR's x.
_TURN = np.array([0.5, 0.5, -0.5, -0.5])


@dataclasses.dataclass(frozen=True)
class LidarOptions:
    """Of `--with lidar`; one revolution at every step, all its rays at the same time."""

    rings: int = 16
    """Rays above one another."""
    azimuths: int = 360
    """Rays in a revolution of each ring."""
    upper: float = 15.0
    """Elevation of the highest ring, degrees."""
    lower: float = -15.0
    """Elevation of the lowest ring, degrees."""
    elevations: tuple[float, ...] = ()
    """Elevation of each ring from the highest down, degrees, for a pattern that is not even, in place of rings, upper
    and lower."""
    range: float = 50.0
    """Longest distance that is measured, m."""
    height: float | None = None
    """Of the sensor above the origin of the robot's root body, m; default: 0.1 above its highest part."""

    def check(self) -> None:
        """Raises an error for numbers out of range.

        Raises:
          ValidationError: see there.
        """
        v.integer(self.rings, "--lidar.rings", 1, 1024)
        v.integer(self.azimuths, "--lidar.azimuths", 1, 4096)
        if len(self.elevations) > _MOST_ELEVATIONS:
            raise v.fail("--lidar.elevations", f"{len(self.elevations)} rings", f"at most {_MOST_ELEVATIONS}")
        if self.elevations:
            for field in dataclasses.fields(self):
                if field.name in _EVEN and getattr(self, field.name) != field.default:
                    raise v.fail(
                        f"--lidar.{field.name}",
                        f"{getattr(self, field.name):g} beside --lidar.elevations",
                        "one of the two",
                        "the elevations are those of all rings",
                    )
        above = 90.0
        for elevation in self.elevations:
            v.number(elevation, "--lidar.elevations", minimum=-90.0, maximum=above)
            above = elevation
        v.number(self.upper, "--lidar.upper", minimum=-90.0, maximum=90.0)
        v.number(self.lower, "--lidar.lower", minimum=-90.0, maximum=self.upper)
        v.number(self.range, "--lidar.range", above=0.0, maximum=65.0)
        if self.height is not None:
            v.number(self.height, "--lidar.height")

    def described(self) -> dict[str, Any]:
        """The options by name, with those of the pattern that is cast: upper and lower of an even one, else the
        elevations of all rings."""
        own = {**dataclasses.asdict(self), "rings": len(self.angles)}
        left_out = ("upper", "lower") if self.elevations else ("elevations",)
        return {name: value for name, value in own.items() if name not in left_out}

    @property
    def angles(self) -> np.ndarray:
        """(rings,) elevations from the upper ring down, rad."""
        even = np.linspace(self.upper, self.lower, self.rings)
        return np.radians(self.elevations if self.elevations else even)

    @property
    def feature(self) -> Feature:
        """Distances as an image in mm: rows are rings from the upper one down, columns go once around."""
        info = {"is_depth_map": True, "depth_unit": "mm"}
        return Feature("image", (len(self.angles), self.azimuths, 1), IMAGE_AXES, info)

    def directions(self) -> np.ndarray:
        """(rings, azimuths, 3) unit vectors in the sensor's frame: x ahead, y to the left, z up; columns go from behind
        over the left side, the front and the right side."""
        azimuth = np.pi - 2 * np.pi * (np.arange(self.azimuths) + 0.5) / self.azimuths
        elevation = self.angles[:, None]
        level = np.cos(elevation)
        up = np.broadcast_to(np.sin(elevation), (len(elevation), self.azimuths))
        return np.stack([level * np.cos(azimuth), level * np.sin(azimuth), up], -1)


class Lidar:
    """Casts scans for steps of episodes.

    Args:
      env: whose robot carries it.
      options: see there.
    """

    def __init__(self, env: "NavEnv", options: LidarOptions) -> None:
        from ...simulation.rendering.renderer import Renderer, Scan

        self.options = options
        self.position = np.array([0.0, 0.0, lidar_height(env, options)])
        self._root = int(env.mj_model.body(env.robot.root_body).id)
        angles = options.angles.tolist()
        scan = Scan(angles[0], angles[-1], options.range, tuple(angles) if options.elevations else ())
        self._renderer = Renderer(
            env.bank,
            env.robot,
            len(angles),
            options.azimuths,
            outputs=("depth", "object"),
            agents=env.agent_appearances,
            bodies=env.num_bodies,
            scan=scan,
        )

    def __call__(self, scene: Any, xpos: Any, xquat: Any, agents: Any, bodies: Any) -> jax.Array:
        """(rings, azimuths) m of one step, 0 where nothing is within range or a ray meets the robot itself; pure, see
        `Renderer`."""
        turn = xquat[self._root]
        at = xpos[self._root] + rotations.rotate(turn, jnp.asarray(self.position, jnp.float32))
        axes = rotations.product(turn, jnp.asarray(_TURN, jnp.float32))
        seen = self._renderer.view(scene, at, axes, jnp.pi / 2, xpos, xquat, 0, agents, bodies)
        return jnp.where(seen["object"] == -2, 0.0, seen["depth"])

    def points(self, ranges: np.ndarray) -> np.ndarray:
        """(n, 3) m in the sensor's frame, of a scan (rings, azimuths)."""
        return (self.options.directions() * ranges[..., None])[ranges > 0].astype(np.float32)


def lidar_height(env: "NavEnv", options: LidarOptions) -> float:
    """m above the origin of the robot's root body."""
    if options.height is not None:
        return options.height
    return top_of(env.mj_model, env.robot.root_body) + 0.1


def top_of(model: mujoco.MjModel, root: str) -> float:
    """m, the highest point of a robot's geoms' boxes above its root body's origin, joints at zero."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    highest = -np.inf
    for geom in range(model.ngeom):
        if model.geom_bodyid[geom] == 0:
            continue
        centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        up = data.geom_xmat[geom].reshape(3, 3)[2]
        highest = max(highest, data.geom_xpos[geom, 2] + up @ centre + np.abs(up) @ half)
    return float(highest - data.xpos[model.body(root).id, 2])
