"""`Renderer`: camera images of robots, for many envs at once and each in its own scene, inside jitted JAX code.

Warp renders on the CPU and on CUDA, with this package's traversal of search trees that are built once (`street_*.py`)
and the materials of mujoco-warp-pbr. Other modules use both through this module only.
"""

import concurrent.futures
import functools
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import warp as wp

from ... import settings as process
from ...datatypes import AgentMotion, Bodies, CameraMount, PlacedBank, RobotSpec, SceneBank, ValidationError
from ...geometry import rotations
from ...precision import full_precision
from .. import host_memory
from ..segments import staged
from ..threads import run_all
from ..warp_bridge import DeviceStore, batched_call, device_lock, jax_callable, register
from .model import RenderModel, RobotCamera, build_render_model
from .settings import AGENT_LABEL, COVERAGE, LIGHTS, NOWHERE, OUTPUTS, ROBOT_LABEL, SHADINGS, SKY_LABEL, Scan, Settings
from .street_batch import StreetBatch, Streets
from .street_places import PlacedStreets

#: m, and 1 - cos of half the angle, from which an object counts as moved from its pose in the bank.
_MIN_SHIFT, _MIN_TURN = 1e-3, 1e-6

__all__ = ["AGENT_LABEL", "OUTPUTS", "ROBOT_LABEL", "SKY_LABEL", "Renderer", "Scan"]


#: Inputs and outputs, in the order of `Renderer._render`.
_INPUTS = {
    "scene": wp.array[wp.int32],
    "xpos": wp.array2d[wp.vec3],
    "xquat": wp.array2d[wp.vec4],
    "eye": wp.array[wp.vec3],
    "turn": wp.array[wp.vec4],
    "fovy": wp.array[wp.float32],
    "appearance_seeds": wp.array[wp.int32],
}
_MOVED_INPUT = {"moved": wp.array2d[wp.int32]}
_FLOATS, _NUMBERS = wp.array3d[wp.float32], wp.array3d[wp.int32]
_IMAGE_TYPES = wp.array4d[wp.uint8], _FLOATS, _NUMBERS, _NUMBERS, wp.array3d[wp.vec3]
_IMAGES: dict[str, Any] = dict(zip(OUTPUTS, _IMAGE_TYPES, strict=True))
_COVERAGE_OUTPUT = {COVERAGE: wp.array2d[wp.int32]}


@functools.cache
def _call_into_warp(moved: bool, coverage: bool) -> Any:
    """The functions that JAX calls; moved: with moved objects; coverage: with that output."""
    inputs, outputs = _INPUTS | (_MOVED_INPUT if moved else {}), _IMAGES | (_COVERAGE_OUTPUT if coverage else {})
    return jax_callable("Renderer.draw", Renderer._render, inputs, outputs)


class Renderer:
    """Draws scenes of a bank, with or without a robot in them.

    Pixel rows go from top to bottom. Depth is planar: the distance along the camera's axis, 0 where no ray hit.
    "object" is the visual slot and "category" the row of `bank.meta["categories"]`; -1 is the sky, -2 the robot; agents
    are -3, -4, ... in "object" and have a category. Normals are unit and in the world's frame, 0 for the sky. Colours
    are sRGB, and depend only on the scene, the robot's pose and the camera.

    Args:
      bank: the scenes.
      robot: robot whose visual geoms (MJCF group 2) are rendered and whose camera is used; None for empty streets.
      height, width: pixels.
      outputs: any of "rgb", "depth", "category", "object", "normal", and beside "object" "coverage": how many pixels
        each object would have if nothing else were in the image, (slots + agents) i32; 0 for one that the image does
        not show, and for ground.
      shadows: whether the sun casts shadows.
      sky: whether the sky is drawn and lights the street by direction; else a flat colour and an even light.
      threads: on the CPU worlds are split over this many threads; default: `settings.num_threads()`.
      camera: name of the robot's camera; default `robot.camera`.
      samples: rays per pixel along each side (2 = four rays).
      shading: "pbr" (glTF materials, mirrored sky, tone mapping) or "matte" (the same light without highlights,
        a third more frames on a CPU).
      appearance: range of random appearances: a frame with an `appearance_seed` other than 0 changes brightness and hue
        of every object, and of the light, by up to this share. 0 disables it.
      agents: row of the bank's agents (`SceneBank.agents`) for each moving agent.
      bodies: largest number of objects moved from their poses in the bank, see `Bodies`.
      scan: rays of a LiDAR, for `view` with a field of view of pi / 2: "depth" is then the distance along the ray.
      light: "direct" (nothing hides the sky, nor the sun without `shadows`) or "baked" (shadows of the sun and
        occlusion of the sky by everything that stands in the bank, computed when the first frame is drawn and kept in
        the cache folder; robots, agents and moved objects shade what is near them). With `shadows` the sun's are traced
        instead.

    Raises:
      ValidationError: an unknown output or camera, a size below one, an appearance outside [0, 1), colours, normals or
        coverage of a scan, or coverage without "object".
    """

    def __init__(
        self,
        bank: SceneBank,
        robot: RobotSpec | None,
        height: int,
        width: int,
        outputs: Sequence[str] = ("rgb",),
        shadows: bool = False,
        sky: bool = True,
        threads: int | None = None,
        camera: str | None = None,
        samples: int = 1,
        shading: str = "pbr",
        appearance: float = 0.0,
        agents: Sequence[int] = (),
        bodies: int = 0,
        scan: Scan | None = None,
        light: str = "direct",
    ) -> None:
        wanted = tuple(dict.fromkeys(outputs))
        for name in wanted:
            if name not in (*OUTPUTS, COVERAGE):
                known = ", ".join((*OUTPUTS, COVERAGE))
                raise ValidationError(f"outputs: found {name!r}; needed some of {known}; fix its spelling")
        if COVERAGE in wanted and "object" not in wanted:
            raise ValidationError(f"outputs: found {COVERAGE!r} without 'object'; needed both; add it")
        if shading not in SHADINGS:
            raise ValidationError(f"shading: found {shading!r}; needed one of {', '.join(SHADINGS)}; fix its spelling")
        if light not in LIGHTS:
            raise ValidationError(f"light: found {light!r}; needed one of {', '.join(LIGHTS)}; fix its spelling")
        if not wanted or min(height, width, samples) < 1:
            raise ValidationError(
                f"renderer: found outputs {wanted}, {height}x{width} pixels, {samples} samples; needed at least one of "
                "each; fix the numbers"
            )
        if not 0.0 <= appearance < 1.0:
            raise ValidationError(f"appearance: found {appearance}; needed 0 to below 1; fix the number")
        if scan is not None and ({"rgb", "normal", COVERAGE} & set(wanted) or samples > 1):
            raise ValidationError(
                f"scan: found outputs {wanted}, {samples} samples; needed depth and labels, one sample"
            )
        self.bank = bank
        self.settings = Settings(height, width, wanted, shadows, sky, samples, shading, appearance, bodies, scan, light)
        self.threads = threads or process.num_threads()
        placed = isinstance(bank, PlacedBank)
        if placed and (agents or bodies or scan or COVERAGE in wanted or shadows):
            raise ValidationError(
                "renderer: found agents, moved objects, a scan, coverage or traced shadows with scenes that come and "
                "go; needed a camera in still streets; set config.schedule.places to 0"
            )
        self._build_model = functools.partial(build_render_model, bank, robot, tuple(agents), streets=not placed)
        self._model: RenderModel | None = self._build_model()
        host_memory.give_back()
        self._num_agents = self._model.num_agents
        self.num_bodies = self._model.num_bodies - len(agents)
        self._homes = jnp.asarray(bank.slot_position), jnp.asarray(bank.slot_quaternion)
        self.camera = None if robot is None else _find_camera(self._model, camera or robot.camera)
        self._devices: DeviceStore[Streets, StreetBatch] = DeviceStore()
        self._pool: concurrent.futures.ThreadPoolExecutor | None = None
        self._number = register(self)
        columns = bank.slot_mesh.shape[1] + len(agents)
        self._view = batched_call(_batch_function(self._number, self.settings, columns))

    @full_precision
    def __call__(
        self,
        scene: Any,
        xpos: Any,
        xquat: Any,
        appearance_seed: Any = 0,
        agents: AgentMotion | None = None,
        bodies: Bodies | None = None,
        mount: CameraMount | None = None,
    ) -> dict[str, jax.Array]:
        """One frame through the robot's camera; pure, works alone, under jit and any nesting of vmap.

        Args:
          scene: () i32 row of the bank; xpos (nbody, 3) m, xquat (nbody, 4) wxyz: T_world_body (`SimState`).
          appearance_seed: () i32, 0 = that of the bank; other numbers select other appearances, see `appearance`.
          agents: their poses (position, heading, present); None leaves them out.
          bodies: moved objects; None = all in their places of the bank.
          mount: offset of the camera from the robot's description; None for none.

        Returns:
          the outputs asked for: "rgb" (H, W, 3) u8, "depth" (H, W) f32 m, "category" and "object" (H, W) i32,
          "normal" (H, W, 3) f32.
        """
        if self.camera is None:
            raise ValidationError("renderer: found no robot; needed one with a camera; call `view` instead")
        xpos, xquat = jnp.asarray(xpos, jnp.float32), jnp.asarray(xquat, jnp.float32)
        body = self.camera.body
        place, turn, fovy = (jnp.asarray(x) for x in (self.camera.position, self.camera.quaternion, self.camera.fovy))
        if mount is not None:
            place, turn = place + mount.offset, rotations.product(turn, mount.rotation)
            fovy = fovy * mount.fovy_scale
        camera_position = xpos[body] + rotations.rotate(xquat[body], place)
        turn = rotations.product(xquat[body], turn)
        return self.view(scene, camera_position, turn, fovy, xpos, xquat, appearance_seed, agents, bodies)

    def view(
        self,
        scene: Any,
        position: Any,
        quaternion: Any,
        fovy: Any,
        xpos: Any = None,
        xquat: Any = None,
        appearance_seed: Any = 0,
        agents: AgentMotion | None = None,
        bodies: Bodies | None = None,
    ) -> dict[str, jax.Array]:
        """One frame through a free camera.

        Args:
          scene: () i32. position (3,) m, quaternion (4,) wxyz: T_world_camera; the view is along -z, +y is up.
          fovy: () vertical field of view, rad.
          xpos, xquat: the robot's bodies; None leaves the robot out of the image, far below the ground.
          appearance_seed: () i32, agents, bodies: see `__call__`.
        """
        own = self.num_bodies
        if xpos is None:
            xpos, xquat = np.tile([0.0, 0.0, NOWHERE], (own, 1)), np.tile([1.0, 0.0, 0.0, 0.0], (own, 1))
        arrays = [jnp.asarray(x, jnp.float32) for x in (xpos, xquat, position, quaternion, fovy)]
        wanted = ((own, 3), (own, 4), (3,), (4,), ())
        for name, array, shape in zip(("xpos", "xquat", "position", "quaternion", "fovy"), arrays, wanted, strict=True):
            if array.shape != shape:
                raise ValidationError(
                    f"{name}: found shape {array.shape}; needed {shape} for one env; use jax.vmap for more"
                )
        if self._num_agents:
            arrays[:2] = [jnp.concatenate(x) for x in zip(arrays[:2], self._agent_bodies(agents), strict=True)]
        # Warp does not check indices; JAX's own gathers clamp them.
        scene = jnp.clip(jnp.asarray(scene, jnp.int32), 0, self.bank.num_scenes - 1)
        moved = ()
        if self.settings.bodies:
            moved, *poses = self._moved(scene, bodies)
            moved, arrays[:2] = (moved,), [jnp.concatenate(x) for x in zip(arrays[:2], poses, strict=True)]
        return self._view(scene, *arrays, jnp.asarray(appearance_seed, jnp.int32), *moved)

    def _moved(self, scene: Any, bodies: Bodies | None) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Slots (M,) of the moved objects, -1 = none, and T_world_object: places (M, 3), quaternions."""
        number = self.settings.bodies
        if bodies is None:
            still = jnp.tile(jnp.array([1.0, 0.0, 0.0, 0.0]), (number, 1))
            return jnp.full(number, -1, jnp.int32), jnp.zeros((number, 3)), still
        slot = jnp.clip(bodies.object_index, 0, self.bank.slot_mesh.shape[1] - 1)
        place, turn = (home[scene, slot] for home in self._homes)
        gone = jnp.max(jnp.abs(bodies.position - place), axis=-1) > _MIN_SHIFT
        gone |= jnp.abs(jnp.sum(bodies.quaternion * turn, axis=-1)) < 1.0 - _MIN_TURN
        return jnp.where(gone & (bodies.object_index >= 0), bodies.object_index, -1), bodies.position, bodies.quaternion

    def _agent_bodies(self, agents: AgentMotion | None) -> tuple[jax.Array, jax.Array]:
        """Positions (A, 3) and quaternions (A, 4); absent agents are far below the ground."""
        number = self._num_agents
        hidden = jnp.tile(jnp.array([0.0, 0.0, NOWHERE]), (number, 1))
        if agents is None:
            return hidden, jnp.tile(jnp.array([1.0, 0.0, 0.0, 0.0]), (number, 1))
        place = jnp.where(agents.present[:, None], agents.position, hidden)
        return place, rotations.from_yaw(agents.heading)

    @property
    def num_contexts(self) -> int:
        """Number of batches with a render context; one is made when a batch of a new size is first rendered."""
        return self._devices.num_batches

    def _render(self, inputs: Sequence[wp.array], outputs: Sequence[wp.array]) -> None:
        """Draws a batch of worlds, on the CPU in several threads; called by Warp with its device set.

        Args:
          inputs: scene (n,) int, xpos (n, nbody) vec3, xquat (n, nbody) vec4, and the cameras' positions (n,) vec3,
            quaternions (n,) vec4, vertical fields of view (n,) float and seeds of appearances (n,) int; slots of moved
            objects (n, bodies) int, -1 = none, if `bodies` is above 0.
          outputs: of `OUTPUTS`, with a leading axis of n, without pixels where not requested; then any coverage.
        """
        scene = inputs[0]
        if scene.shape[0] == 0:
            return
        with device_lock(scene.device):
            self._draw_all(scene.device, inputs, dict(zip((*OUTPUTS, COVERAGE), outputs, strict=False)))

    def _draw_all(self, device: Any, inputs: Sequence[wp.array], outputs: dict[str, wp.array]) -> None:
        assets, batch = self._batch(device, inputs[0].shape[0])
        jobs = batch.jobs(inputs, outputs)
        # The first launch compiles the kernel, which threads must not do at the same time.
        while jobs and (len(jobs) == 1 or not assets.ready):
            jobs.pop(0)()
        if jobs:
            if self._pool is None:
                self._pool = concurrent.futures.ThreadPoolExecutor(self.threads, "render")
            run_all(self._pool, jobs)

    def _batch(self, device: Any, total: int) -> tuple[Streets, StreetBatch]:
        assets, batches = self._devices.get_or_make(device, self._build_streets)
        threads = self.threads if device.is_cpu else 1
        return assets, batches.get_or_make(total, lambda: StreetBatch(assets, total, threads))

    def _take_model(self) -> RenderModel:
        """Builds the render model, which is not kept, because it is as large as the tables made from it."""
        model, self._model = self._model or self._build_model(), None
        return model

    def _build_streets(self) -> Streets:
        bank, model = self.bank, self._take_model()
        placed = isinstance(bank, PlacedBank)
        streets = PlacedStreets(bank, model, self.settings) if placed else Streets(bank, model, self.settings)
        host_memory.give_back()
        return streets

    @property
    def placed_bytes(self) -> tuple[int, int]:
        """Bytes of the scenes on the device, where they change in places: of tables, and of textures without their
        smaller copies."""
        device = wp.device_from_jax(jax.devices()[0])
        with wp.ScopedDevice(device):
            streets, _ = self._devices.get_or_make(device, self._build_streets)
            return (streets.num_bytes, streets.texture_bytes) if isinstance(streets, PlacedStreets) else (0, 0)

    def stage(self, place: int, scene: Mapping[str, Any]) -> Generator[None, None, Callable[[], None]]:
        """Copies the looks of a scene to the device, a few megabytes at a time, while the others are in use.

        Args:
          place: row of the bank, of which the scenes change (`PlacedBank`).
          scene: of `street_places.scene_looks`.

        Returns:
          A function that puts the scene in its place, to be called while no program runs.
        """
        device = wp.device_from_jax(jax.devices()[0])
        with wp.ScopedDevice(device):
            streets, _ = self._devices.get_or_make(device, self._build_streets)
        assert isinstance(streets, PlacedStreets), "scenes change in places"
        return (yield from staged(device, streets.stage(place, scene)))


def _find_camera(model: RenderModel, name: str) -> RobotCamera:
    if name not in model.cameras:
        known = ", ".join(model.cameras) or "none"
        raise ValidationError(f"camera: found {name!r}; needed a camera of the robot ({known}); fix its spelling")
    return model.cameras[name]


def _batch_function(number: int, settings: Settings, columns: int) -> Any:
    """(scene (n,), xpos (n, nbody, 3), ...) -> outputs with a leading axis n. Holds the renderer by its number.

    columns: of the coverage.
    """
    height, width = settings.height, settings.width
    names = (*OUTPUTS, COVERAGE) if COVERAGE in settings.outputs else OUTPUTS
    function = _call_into_warp(settings.bodies > 0, COVERAGE in settings.outputs)

    def batch(scene: jax.Array, *arrays: jax.Array) -> dict[str, jax.Array]:
        n = scene.shape[0]
        shapes = {"rgb": (n, height, width, 3)} | dict.fromkeys(OUTPUTS[1:], (n, height, width))
        shapes = {k: s if k in settings.outputs else (n, *[0] * (len(s) - 1)) for k, s in shapes.items()}
        if COVERAGE in names:
            shapes[COVERAGE] = n, columns
        out = function(number, scene, *arrays, output_dims=shapes)
        return {name: x for name, x in zip(names, out, strict=True) if name in settings.outputs}

    return batch
