"""A robot in a compiled scene, stepped in C MuJoCo and seen by either renderer, under the shifts of `lib.shifts`.

One `World` is one robot in one scene; `World.begin` puts it at a start under drawn conditions, `World.drive` obeys a
velocity for one tick, and `World.image` is what its camera sees. The scene is that of `scene.xml`, the contacts that
count are those that count in `envs.navigation`.
"""

import atexit
import math
import pathlib
import weakref
from typing import Any

import mujoco
import numpy as np

from benchmarks.lib import shifts as s
from urbanverse_mjx.datatypes import AgentMotion, AgentShapes, RobotSpec, traversable
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots.gait import Gait, sensor_frame
from urbanverse_mjx.scene import CompiledScene
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.simulation.parity.c_mujoco import reference_model

#: s, between two commands to the motors; that of the gait.
TICK = 0.02
#: s, of the other contact model.
FINE_STEP = 0.004
GRAVITY = 9.81  # m/s2
#: cos of the tilt at which a robot counts as fallen, as in `envs.navigation`.
MIN_UP = 0.5
_ROBOT, _GROUND, _AGENT = "robot/", "ground/", "agent_"
_AWAY = -50.0  # m, height of agents that are absent
#: m: MuJoCo's renderer: nearest and farthest surface drawn, where fog begins and where it hides everything.
_NEAR, _FAR, _FOG = 0.03, 250.0, (25.0, 160.0)
_FOG_COLOUR = (0.78, 0.81, 0.84, 1.0)
#: Pixels of a side of its shadow map.
_SHADOW = 2048


def make_robot(name: str) -> tuple[RobotSpec, Gait | None]:
    """The robot "coco" or "go2", and its gait."""
    from urbanverse_mjx import robots
    from urbanverse_mjx.robots.go2 import load_gait

    if v.choice(name, "robot", ("coco", "go2")) == "go2":
        return robots.make_go2(), load_gait()
    return robots.make_coco(), None


class World:
    """One robot in one scene.

    Args:
      geometry: of the scene.
      robot: "coco" or "go2".
      shifts: those that hold for all episodes count here: contact, renderer, distortion, fisheye.
      size: (height, width) of the images; None for a robot without camera.
      vision: of the environment's config, for our renderer: shading, sky, shadows.
      folder: of the compiled scene, for images.
      agents: collision bodies of people and vehicles, which `place_agents` moves; None for none.
      appearances: row of the bank's agents for each of them, for our renderer.

    Attributes:
      model, data: of MuJoCo; qpos[:7] is the robot's body.
      hit: what the robot has touched since `begin`: the id of an object, "ground", or None.
      time: s since `begin`.
    """

    def __init__(
        self,
        geometry: SceneGeometry,
        robot: str,
        shifts: s.Shifts,
        size: tuple[int, int] | None = None,
        vision: dict[str, Any] | None = None,
        folder: pathlib.Path | None = None,
        agents: AgentShapes | None = None,
        appearances: tuple[int, ...] = (),
    ) -> None:
        import jax

        self.shifts, self.geometry = shifts, geometry
        self.robot, self.gait = make_robot(robot)
        if shifts.renderer and size is not None and folder is not None:
            spec = mujoco.MjSpec.from_file(str(folder / "scene.xml"))
        else:
            spec = scene_spec(geometry)
        self.agents, self.appearances = agents, appearances
        self.people: AgentMotion | None = None
        _add_agents(spec, agents)
        self.model = reference_model(spec, self.robot)
        if shifts.contact:
            _other_contact(self.model)
        self.data = mujoco.MjData(self.model)
        self._substeps = round(TICK / self.model.opt.timestep)
        if abs(self._substeps * self.model.opt.timestep - TICK) > 1e-9:
            raise v.fail("robot", f"a time step of {self.model.opt.timestep:g} s", f"one that divides {TICK:g} s")
        self._nominal = {name: getattr(self.model, name).copy() for name in _CHANGED}
        self._kinds()
        self.root = self.model.body(_ROBOT + self.robot.root_body).id
        self._map = geometry.map
        self._open = traversable(self._map.kind)
        self._command = jax.jit(self.robot.command)
        own = mujoco.MjModel.from_xml_string(self.robot.mjcf)
        self._stand = np.array(own.key_qpos[0] if own.nkey else own.qpos0)
        self.hit: str | None = None
        self.time = 0.0
        self._action, self._history = np.zeros(self.model.nu), None
        self._fastest: np.ndarray | None = None
        self._renderer = None
        if size is not None and folder is not None:
            self._renderer = _OpenGl(self, size) if shifts.renderer else _Ours(self, size, vision or {}, folder)

    @staticmethod
    def load(folder: pathlib.Path, *args: Any, **more: Any) -> "World":
        """The world of a compiled scene; the other arguments from `robot` on."""
        return World(CompiledScene.load(folder).geometry, *args, folder=folder, **more)

    def _kinds(self) -> None:
        """What each geom is in a contact."""
        names = [self.model.geom(g).name for g in range(self.model.ngeom)]
        feet = {_ROBOT + name for name in self.robot.foot_geoms}
        self._own = np.array([n.startswith(_ROBOT) for n in names])
        self._foot = np.array([n in feet for n in names])
        self._ground = np.array([n.startswith(_GROUND) for n in names])
        self._names = names

    # Episodes.

    def begin(self, start: np.ndarray, conditions: s.Conditions) -> None:
        """Puts the robot at rest at (x, y, z of the ground, yaw) under drawn conditions."""
        for name, value in self._nominal.items():
            getattr(self.model, name)[:] = value
        mujoco.mj_resetData(self.model, self.data)
        self.model.opt.gravity[:] = GRAVITY * np.array(conditions.gravity)
        self._grip(conditions.grip)
        self._battery(conditions.battery)
        self.data.qpos[:] = self._stand
        self.data.qpos[:3] = start[0], start[1], start[2] + self.robot.spawn_height
        self.data.qpos[3:7] = rotations.from_yaw(np.float64(start[3]))
        mujoco.mj_forward(self.model, self.data)
        self.hit, self.time, self.people = None, 0.0, None
        self.data.mocap_pos[:] = 0.0, 0.0, _AWAY
        self._action, self._history = np.zeros(self.model.nu), None

    def _grip(self, share: float) -> None:
        if share == 1.0:
            return
        ground = float(self.model.geom_friction[self._ground, 0].max())
        for g in np.flatnonzero(self._foot & (self.model.geom_condim > 1)):
            # MuJoCo takes the larger coefficient of two surfaces, unless one has priority.
            self.model.geom_friction[g, 0] = share * max(ground, float(self.model.geom_friction[g, 0]))
            self.model.geom_priority[g] = 2

    def _battery(self, share: float) -> None:
        model, self._fastest = self.model, None
        if share == 1.0:
            return
        limited = model.actuator_forcelimited.astype(bool)
        model.actuator_forcerange[limited] *= share
        driven = np.flatnonzero(~limited & (model.actuator_biastype == mujoco.mjtBias.mjBIAS_NONE))
        # A wheel's torque is gain (told speed - speed), the second part as damping of its joint.
        model.actuator_gainprm[driven, 0] *= share
        model.dof_damping[model.jnt_dofadr[model.actuator_trnid[driven, 0]]] *= share
        straight = np.asarray(self._command(np.array([self.robot.max_speed, 0.0], np.float32)))
        if len(driven):
            self._fastest = np.full(model.nu, np.inf)
            self._fastest[driven] = share * np.abs(straight[driven])

    def drive(self, velocity: tuple[float, float]) -> None:
        """Obeys (m/s ahead, rad/s to the left) for one `TICK`."""
        told = np.asarray(self._command(np.array(velocity, np.float32)), np.float64)
        ctrl = told if self.gait is None else self._walk(self.gait, told)
        if self._fastest is not None:
            ctrl = np.clip(ctrl, -self._fastest, self._fastest)
        self.data.ctrl[:] = ctrl
        for _ in range(self._substeps):
            mujoco.mj_step(self.model, self.data)
            self._touch()
        mujoco.mj_kinematics(self.model, self.data)
        self.time += TICK

    def _walk(self, gait: Gait, command: np.ndarray) -> np.ndarray:
        gravity = -self.data.xmat[self.root].reshape(3, 3)[2]
        bend = self.data.qpos[7:] - gait.stand
        frame = sensor_frame(np, self.data.qvel[3:6], gravity, bend, self.data.qvel[6:], command, self._action)
        if self._history is None:
            # A robot that stands, as in `simulation.gait_engine`.
            still = sensor_frame(
                np, self.data.qvel[3:6], gravity, bend, self.data.qvel[6:], 0.0 * command, self._action
            )
            self._history = np.tile(still, (gait.history, 1))
        self._history = np.concatenate([frame[None], self._history[:-1]])
        self._action = gait.action(np, self._history.reshape(-1))
        return gait.target(self._action)

    def _touch(self) -> None:
        if self.hit is not None or not self.data.ncon:
            return
        pairs = self.data.contact.geom[self.data.contact.dist < 0.0]
        for a, b in pairs:
            own, other = (a, b) if self._own[a] else (b, a)
            if not self._own[own] or (self._ground[other] and self._foot[own]):
                continue
            self.hit = "ground" if self._ground[other] else self._names[other].rsplit("/", 1)[0]
            return

    def place_agents(self, people: AgentMotion) -> None:
        """Moves people and vehicles to their poses at the beginning of a step; absent ones are far below."""
        self.people = people
        self.data.mocap_pos[:] = np.where(people.present[:, None], people.position, [0.0, 0.0, _AWAY])
        self.data.mocap_quat[:] = rotations.from_yaw(np.asarray(people.heading, np.float64))

    # State.

    @property
    def pose(self) -> np.ndarray:
        """(3,) x, y (m), yaw (rad)."""
        w, x, y, z = self.data.qpos[3:7]
        return np.array([*self.data.qpos[:2], math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))])

    @property
    def velocity(self) -> tuple[float, float, float]:
        """m/s ahead, m/s to the left, rad/s, of the body."""
        yaw, (x, y) = self.pose[2], self.data.qvel[:2]
        c, sin = math.cos(yaw), math.sin(yaw)
        return float(c * x + sin * y), float(c * y - sin * x), float(self.data.qvel[5])

    @property
    def fallen(self) -> bool:
        """Whether the robot lies, or its state is not finite."""
        _w, x, y, _z = self.data.qpos[3:7]
        return not (np.isfinite(self.data.qpos).all() and 1.0 - 2.0 * (x * x + y * y) >= MIN_UP)

    @property
    def off_traversable(self) -> bool:
        """Whether the ground under the robot is of a kind on which it may not be."""
        i, j = np.floor((self.data.qpos[:2] - self._map.origin) / self._map.resolution).astype(int)
        inside = 0 <= i < self._open.shape[0] and 0 <= j < self._open.shape[1]
        return not (inside and bool(self._open[i, j]))

    # Images.

    def image(self) -> np.ndarray:
        """(H, W, 3) u8 through the robot's camera and the shifted lens."""
        if self._renderer is None:
            raise v.fail("world", "no image size", "one for a robot with a camera")
        return self._renderer.image()

    def close(self) -> None:
        """Frees the OpenGL context, if there is one."""
        if self._renderer is not None:
            self._renderer.close()


#: Fields of a model that conditions change.
_CHANGED = (
    "geom_friction", "geom_priority", "actuator_forcerange", "actuator_gainprm", "dof_damping",
)  # fmt: skip


def _add_agents(spec: mujoco.MjSpec, agents: AgentShapes | None) -> None:
    """A body for each agent, that is placed and not pushed: an upright prism over a disc extended along the heading."""
    for k in range(0 if agents is None else len(agents.radius)):
        assert agents is not None
        radius, half, height = (float(getattr(agents, f)[k]) for f in ("radius", "half_length", "height"))
        body = spec.worldbody.add_body(name=f"{_AGENT}{k}", mocap=True, pos=[0.0, 0.0, _AWAY])
        middle = [0.0, 0.0, height / 2]
        for number, x in enumerate((-half, half) if half > 0.0 else (0.0,)):
            body.add_geom(
                name=f"{_AGENT}{k}/end_{number}",
                type=mujoco.mjtGeom.mjGEOM_CYLINDER,
                size=[radius, height / 2, 0.0],
                pos=[x, 0.0, height / 2],
            )
        if half > 0.0:
            size = [half, radius, height / 2]
            body.add_geom(name=f"{_AGENT}{k}/middle", type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=middle)


def _other_contact(model: mujoco.MjModel) -> None:
    """The contact model of `Shifts.contact`."""
    model.opt.timestep = FINE_STEP
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = 10.0
    model.geom_solref[:] = 0.04, 1.0
    model.geom_solimp[:] = 0.8, 0.9, 0.003, 0.5, 2.0


class _Camera:
    """The robot's camera and the shifted lens; a subclass draws one pinhole view."""

    def __init__(self, world: World, size: tuple[int, int]) -> None:
        self.world = world
        self.camera = world.model.camera(_ROBOT + world.robot.camera).id
        fovy = math.radians(float(world.model.cam_fovy[self.camera]))
        if world.shifts.fisheye:
            self.lens: s.Lens | None = s.Lens(s.fisheye_rays(*size, fovy))
        elif world.shifts.distortion:
            factors = tuple(world.shifts.distortion * k for k in s.BROWN)
            self.lens = s.Lens(s.brown_rays(*size, fovy, factors))
        else:
            self.lens = None
        self.views = [s.View(0.0, fovy, *size)] if self.lens is None else self.lens.views

    def image(self) -> np.ndarray:
        frames = [self.draw(view) for view in self.views]
        return frames[0] if self.lens is None else self.lens.image(frames)

    def draw(self, view: s.View) -> np.ndarray:
        """(height, width, 3) u8."""
        raise NotImplementedError

    def close(self) -> None:
        """Frees what drawing needs."""


class _OpenGl(_Camera):
    """MuJoCo's own renderer, with shadows and fog."""

    def __init__(self, world: World, size: tuple[int, int]) -> None:
        super().__init__(world, size)
        model = world.model
        extent = float(model.stat.extent)
        model.vis.map.znear, model.vis.map.zfar = _NEAR / extent, _FAR / extent
        model.vis.map.fogstart, model.vis.map.fogend = (x / extent for x in _FOG)
        model.vis.rgba.fog[:] = _FOG_COLOUR
        # A directional light's place matters for its shadows alone: they are drawn around its line.
        model.light_pos[:] = model.stat.center - 2.0 * extent * model.light_dir
        model.vis.quality.shadowsize = _SHADOW
        model.vis.global_.offwidth = max(view.width for view in self.views)
        model.vis.global_.offheight = max(view.height for view in self.views)
        self._options = mujoco.MjvOption()
        self._options.geomgroup[:] = 0
        self._options.geomgroup[2] = 1
        self._quat, self._fovy = model.cam_quat[self.camera].copy(), float(model.cam_fovy[self.camera])
        self._contexts: dict[tuple[int, int], mujoco.Renderer] = {}

    def draw(self, view: s.View) -> np.ndarray:
        model, data = self.world.model, self.world.data
        key = view.height, view.width
        if key not in self._contexts:
            self._contexts[key] = mujoco.Renderer(model, *key, max_geom=20_000)
            # At Python's own end EGL is gone: MuJoCo ends it by a function that it has registered by now, so this one
            # is called before. It keeps nothing alive.
            atexit.register(_close, weakref.ref(self))
        context = self._contexts[key]
        half = view.yaw / 2.0
        turned = np.array([math.cos(half), 0.0, math.sin(half), 0.0])
        model.cam_quat[self.camera] = rotations.product(self._quat, turned)
        model.cam_fovy[self.camera] = math.degrees(view.fovy)
        mujoco.mj_camlight(model, data)
        context.update_scene(data, self.camera, self._options)
        context.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 1
        context.scene.flags[mujoco.mjtRndFlag.mjRND_FOG] = 1
        frame = context.render().copy()
        model.cam_quat[self.camera], model.cam_fovy[self.camera] = self._quat, self._fovy
        return frame

    def close(self) -> None:
        for context in self._contexts.values():
            context.close()
        self._contexts.clear()


def _close(camera: "weakref.ref[_OpenGl]") -> None:
    found = camera()
    if found is not None:
        found.close()


class _Ours(_Camera):
    """The renderer of this project."""

    def __init__(self, world: World, size: tuple[int, int], vision: dict[str, Any], folder: pathlib.Path) -> None:
        super().__init__(world, size)
        import jax

        from urbanverse_mjx.scene import pack_bank
        from urbanverse_mjx.simulation.rendering.renderer import Renderer

        bank = pack_bank([folder], ["test"])
        chosen = {k: vision[k] for k in ("shading", "sky", "shadows") if k in vision}
        self._draw: dict[tuple[int, int], Any] = {}
        for view in self.views:
            key = view.height, view.width
            if key not in self._draw:
                renderer = Renderer(bank, world.robot, *key, threads=1, agents=world.appearances, **chosen)
                self._draw[key] = jax.jit(lambda a, people, r=renderer: r.view(0, *a, agents=people)["rgb"])
        own = mujoco.MjModel.from_xml_string(world.robot.mjcf)
        names = [own.body(b).name for b in range(1, own.nbody)]
        self._bodies = np.array([0, *(world.model.body(_ROBOT + name).id for name in names)])

    def draw(self, view: s.View) -> np.ndarray:
        model, data = self.world.model, self.world.data
        mujoco.mj_camlight(model, data)
        turn = np.zeros(4)
        mujoco.mju_mat2Quat(turn, data.cam_xmat[self.camera])
        half = view.yaw / 2.0
        turn = rotations.product(turn, np.array([math.cos(half), 0.0, math.sin(half), 0.0]))
        places = [data.cam_xpos[self.camera], turn, view.fovy, data.xpos[self._bodies], data.xquat[self._bodies]]
        arrays = tuple(np.asarray(x, np.float32) for x in places)
        return np.asarray(self._draw[view.height, view.width](arrays, self.world.people))
