"""MuJoCo Warp with whole streets in its model, called without JAX; mjlab's way of calling it; its batch renderer."""

import gc
import pathlib
from collections.abc import Callable
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

from benchmarks.lib.peers import warp_kernels as kernels
from benchmarks.lib.peers.street import HIT, ROBOT, SEEN, Drive, hulls_of, street_spec, with_robot
from urbanverse_mjx.datatypes import RobotSpec, ValidationError

#: Contacts and constraint rows that are allocated per world. The robot has 12 spheres; more contacts were never seen.
CONTACTS, ROWS = 64, 256
#: Fields of MuJoCo Warp's model that differ between streets, with a leading axis of worlds.
_BY_WORLD = ("geom_pos", "geom_quat", "geom_size", "geom_aabb", "geom_rbound", "geom_friction", "geom_dataid")


class MujocoWarp:
    """MuJoCo Warp's steps and, where a size is given, its renderer.

    Attributes:
      does, hulls: see `timed.Peer`.
      rgb: (n, height * width, 3) uint8, the last images on the device; None without.
    """

    def __init__(
        self,
        folders: list[pathlib.Path],
        robot: RobotSpec,
        drive: Drive,
        size: tuple[int, int] | None,
        calls: str,
    ) -> None:
        """calls: "control": one CUDA graph is a whole control step; "mjlab": one graph each for new beginnings, a
        physics step, the forward pass after the last one, and the images, as mjlab launches them."""
        if len(folders) > 1 and size is not None:
            raise ValidationError("MuJoCo Warp: found images of several streets, needed one street: not built.")
        self._drive, self._step = drive, 0
        self.rgb: Any = None
        poses = None
        if len(folders) == 1:
            self._mj_model = with_robot(street_spec(folders[0], seen=size is not None), robot, drive.timestep, size)
            self._model = mjw.put_model(self._mj_model)
            self.hulls = hulls_of(self._mj_model)
            self.does = "one street for all envs"
        else:
            self._mj_model, self._model, poses = several_streets(folders, robot, drive.timestep)
            self.hulls = poses[0].shape[1]
            self.does = "the geoms of an env's street as fields per world"
        # mjlab leaves both numbers to MuJoCo Warp's own guess, which is too small where a robot drives into objects.
        self._data = mjw.make_data(self._mj_model, nworld=drive.count, nconmax=CONTACTS, njmax=ROWS)
        if poses is not None:
            _place(self._data, poses, drive.scene)
        self._start = wp.array(drive.qpos, dtype=float)
        wp.copy(self._data.qpos, self._start)
        self._begins = wp.zeros(drive.count, dtype=bool)
        self._command = wp.zeros((drive.count, drive.ctrl.shape[2]), dtype=float)
        self._masks = [wp.array(drive.begins(t), dtype=bool) for t in range(drive.episode)]
        self._ctrl = [wp.array(u, dtype=float) for u in drive.ctrl]
        self._context: Any = None if size is None else self._make_context(size)
        parts = self._parts(calls)
        for part, _ in parts:  # kernels are compiled outside of a capture
            part()
        wp.copy(self._data.qpos, self._start)
        self._data.qvel.zero_()
        self._data.qacc_warmstart.zero_()
        self._launches = [(_captured(part) if wp.get_device().is_cuda else part, times) for part, times in parts]
        self.does += "; no observations, rewards or hits"

    def _make_context(self, size: tuple[int, int]) -> Any:
        height, width = size
        self.rgb = wp.zeros((self._drive.count, height * width, 3), dtype=wp.uint8)
        self.does += "; MuJoCo Warp's renderer, textures, sky, no shadows"
        return mjw.create_render_context(
            self._mj_model,
            nworld=self._drive.count,
            cam_res=(width, height),
            render_rgb=True,
            render_depth=False,
            use_shadows=False,
            enabled_geom_groups=[SEEN],
            cam_active=[name == ROBOT + self._camera() for name in self._cameras()],
            render_skybox=True,
        )

    def _cameras(self) -> list[str]:
        return [self._mj_model.camera(i).name for i in range(self._mj_model.ncam)]

    def _camera(self) -> str:
        """The robot's camera; a scene has none."""
        return next(name for name in self._cameras() if name.startswith(ROBOT)).removeprefix(ROBOT)

    def _parts(self, calls: str) -> list[tuple[Callable[[], None], int]]:
        """Returns the launches of a control step and how often each comes."""

        def begin() -> None:
            mjw.reset_data(self._model, self._data, reset=self._begins)
            wp.launch(kernels.begin_again, self._start.shape, [self._begins, self._start], [self._data.qpos])
            wp.copy(self._data.ctrl, self._command)  # the reset clears those of its envs

        def step() -> None:
            mjw.step(self._model, self._data)

        def forward() -> None:
            mjw.forward(self._model, self._data)

        def poses() -> None:
            mjw.kinematics(self._model, self._data)
            mjw.camlight(self._model, self._data)

        def draw() -> None:
            mjw.refit_bvh(self._model, self._data, self._context)
            mjw.render(self._model, self._data, self._context)
            wp.launch(kernels.channels, self.rgb.shape[:2], [self._context.rgb_data], [self.rgb])

        seen = self._context is not None
        if calls == "mjlab":
            return [(begin, 1), (step, self._drive.substeps), (forward, 1), *[(draw, 1)] * seen]

        def whole() -> None:
            begin()
            for _ in range(self._drive.substeps):
                step()
            if seen:
                poses()
                draw()

        return [(whole, 1)]

    def run(self, steps: int) -> None:
        for _ in range(steps):
            wp.copy(self._begins, self._masks[self._step % len(self._masks)])
            wp.copy(self._command, self._ctrl[self._step % len(self._ctrl)])
            for launch, times in self._launches:
                for _ in range(times):
                    launch()
            self._step += 1
        wp.synchronize()

    def qpos(self) -> np.ndarray:
        return self._data.qpos.numpy()

    def image(self, env: int) -> np.ndarray:
        """Returns (height * width, 3) uint8: the last image of an env."""
        return self.rgb.numpy()[env]

    def close(self) -> None:
        """Nothing to end."""


def _captured(call: Callable[[], None]) -> Callable[[], None]:
    """Returns the same launches as one CUDA graph."""
    gc.disable()  # arrays freed within a capture become a part of the graph
    try:
        with wp.ScopedCapture() as capture:
            call()
    finally:
        gc.enable()
    graph: Any = capture.graph
    return lambda: wp.capture_launch(graph)


def several_streets(
    folders: list[pathlib.Path], robot: RobotSpec, timestep: float
) -> tuple[mujoco.MjModel, Any, tuple[np.ndarray, np.ndarray]]:
    """A model with the meshes of all streets and as many geoms as the largest has; world i gets the geoms of street i
    modulo their number by MuJoCo Warp's fields per world.

    Returns:
      a model for the sizes of the data, MuJoCo Warp's model, and the geoms' places (streets, most hulls, 3) m and
      rotations (streets, most hulls, 3, 3).
    """
    spec, models = mujoco.MjSpec(), []
    names: list[list[str]] = []
    for number, folder in enumerate(folders):
        street = street_spec(folder, seen=False)
        vertices = {mesh.name: np.array(mesh.uservert) for mesh in street.meshes}
        model = with_robot(street, robot, timestep)
        models.append(model)
        used = [model.mesh(i).name for i in range(model.nmesh)]
        names.append([f"{number}/{name}" for name in used])
        for name, points in vertices.items():
            mesh = spec.add_mesh(name=f"{number}/{name}", uservert=points)
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
    most = max(hulls_of(model) for model in models)
    for _ in range(most):
        geom = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=names[0][0], group=HIT)
        geom.mass = 0.0
    base = with_robot(spec, robot, timestep)
    number_of = {base.mesh(i).name: i for i in range(base.nmesh)}
    fields = {name: np.repeat(np.array(getattr(base, name))[None], len(models), 0) for name in _BY_WORLD}
    places, rotations = np.zeros((len(models), most, 3)), np.tile(np.identity(3), (len(models), most, 1, 1))
    for world, model in enumerate(models):
        count, data = hulls_of(model), mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        places[world, :count], rotations[world, :count] = (
            data.geom_xpos[:count],
            data.geom_xmat[:count].reshape(-1, 3, 3),
        )
        if (model.geom_group[:count] != HIT).any() or model.geom_bodyid[:count].any():
            raise ValidationError(f"{folders[world]}: found geoms of bodies that move, needed a street without any.")
        for name in _BY_WORLD:
            fields[name][world, :count] = getattr(model, name)[:count]
        mesh = model.geom_dataid[:count]
        fields["geom_dataid"][world, :count] = [number_of[names[world][i]] for i in mesh]
        fields["geom_dataid"][world, count:most] = -1
    device = mjw.put_model(base)
    for name, value in fields.items():
        array = getattr(device, name)
        shaped = value.reshape(len(models), *array.numpy().shape[1:])
        setattr(device, name, wp.array(shaped, dtype=array.dtype))
    return base, device, (places, rotations)


def _place(data: Any, poses: tuple[np.ndarray, np.ndarray], scene: np.ndarray) -> None:
    """Writes where the geoms of each env's street are: MuJoCo Warp computes those that do not move once, from the model
    of one world."""
    for array, value in zip((data.geom_xpos, data.geom_xmat), poses, strict=True):
        written = array.numpy()
        written[:, : value.shape[1]] = value[scene]
        array.assign(written)
