"""Render contexts: what mujoco-warp-pbr needs to draw n worlds, over meshes and textures that all contexts share."""

import copy
import dataclasses
import functools
from collections.abc import Callable, Sequence
from typing import Any

import mujoco_warp as mjw
import mujoco_warp_pbr as pbr
import numpy as np
import warp as wp
from mujoco_warp._src.bvh import compute_bvh_group_roots
from mujoco_warp_pbr._src import envmap, kernel_inputs

from ..datatypes import SceneBank
from . import render_kernels as kernels
from .render_model import RenderModel
from .render_scenes import build_robot_tables, build_scene_tables, build_skies, upload_textures

#: Label of the robot's own pixels in "object" and "category"; -1 is the sky.
ROBOT_LABEL = -2
#: "pbr": mujoco-warp-pbr's own shading; "matte": the same light without highlights, quicker on a CPU.
SHADINGS = ("pbr", "matte")
OUTPUTS = ("rgb", "depth", "category", "object", "normal")
#: Display colour of the sky where none is drawn (sky=False).
PLAIN_SKY = (0.62, 0.74, 0.88, 1.0)
#: The tone mapper takes off what gloss adds to every surface, and darkens shade by it; this lifts it again. Chosen by
#: eye on the shipped streets.
PBR_EXPOSURE = 1.3


@dataclasses.dataclass(frozen=True)
class Settings:
    """What is drawn and how. outputs: of `OUTPUTS`; samples: rays per pixel along each side; see `Renderer`."""

    height: int
    width: int
    outputs: tuple[str, ...]
    shadows: bool
    sky: bool
    samples: int
    shading: str

    @property
    def shaded(self) -> bool:
        """Whether surfaces are evaluated at all; depth and labels need the first hit alone."""
        return "rgb" in self.outputs or "normal" in self.outputs


class SharedAssets:
    """Meshes, textures, skies and scene tables of one renderer on one Warp device."""

    def __init__(self, bank: SceneBank, model: RenderModel, settings: Settings) -> None:
        self.render_model = model
        self.settings = settings
        self.device = wp.get_device()
        #: Whether a frame was drawn: the first one compiles kernels, which threads must not do at the same time.
        self.ready = False
        mjm = model.model
        self.model = mjw.put_model(mjm)
        self.model.mesh_vert = wp.array(model.vertices, dtype=wp.vec3)
        self.model.mesh_normal = wp.array(model.normals, dtype=wp.vec3)
        self.tables = build_scene_tables(bank, model, settings.sky)
        self.robot = build_robot_tables(model)
        self.context = pbr.create_render_context(
            mjm,
            nworld=1,
            cam_res=(settings.width, settings.height),
            render_rgb=settings.shaded,
            render_depth="depth" in settings.outputs,
            render_seg="object" in settings.outputs or "category" in settings.outputs,
            enabled_geom_groups=[0],
            use_shadows=settings.shadows,
            shadow_light_fraction=0.0,
            use_skybox=False,
            # Leaves and paint have two faces in one place, of which a ray meets either.
            enable_backface_culling=False,
            background_color=PLAIN_SKY,
            samples_per_pixel=settings.samples,
            mesh_bvh_frame="mujoco",
            render_guides="normal" in settings.outputs,
        )
        self._mend_context(bank)

    def _mend_context(self, bank: SceneBank) -> None:
        """Meshes in their authored frames, all textures, the bank's skies, light in the bank's units."""
        mjm, context = self.render_model.model, self.context
        meshes = [self._mesh(i) for i in range(mjm.nmesh)]
        context.base.mesh_registry = {mesh.id: mesh for mesh in meshes}
        context.base.mesh_bvh_id = wp.array([mesh.id for mesh in meshes], dtype=wp.uint64)
        # The context uploads the textures of the geoms' materials at compile time; scenes choose theirs later.
        textures, sizes = upload_textures(self.render_model)
        context.textures_registry = textures
        context.textures = wp.array(textures, dtype=wp.Texture2D)
        context.tex_size = wp.array(sizes, dtype=wp.vec2)
        context.features.base_color_map = context.features.textures = bool((mjm.mat_texid >= 0).any())
        context.features.specular_aa = False
        # Settings as constants of the kernel: 3 % (pbr) to 15 % (matte) more frames on a CPU.
        context.baked = frozenset(kernel_inputs.BAKE_GROUPS)
        # The bank's radiance is relative to the display: 1 is white.
        context.exposure = wp.array([PBR_EXPOSURE], dtype=float)
        context.light_intensity = wp.ones((1, 1), dtype=float)
        if self.settings.sky:
            skies = build_skies(bank.sky_radiance, glossy=True)
            context.env_maps = list(skies.owners)
            assert skies.prefiltered is not None, "glossy skies are prefiltered"
            context.env_radiance, context.env_prefiltered, context.env_sh = skies.radiance, skies.prefiltered, skies.sh
            context.env_texel_angle = envmap.texel_angle(skies.width)
            context.env_intensity = wp.ones(1, dtype=float)
            context.has_env = context.env_background = True

    def _mesh(self, number: int) -> wp.Mesh:
        mjm = self.render_model.model
        corners = slice(mjm.mesh_vertadr[number], mjm.mesh_vertadr[number] + mjm.mesh_vertnum[number])
        faces = slice(mjm.mesh_faceadr[number], mjm.mesh_faceadr[number] + mjm.mesh_facenum[number])
        return wp.Mesh(
            points=wp.array(self.render_model.vertices[corners], dtype=wp.vec3),
            indices=wp.array(mjm.mesh_face[faces].ravel(), dtype=wp.int32),
            bvh_constructor="sah",
            bvh_leaf_size=2,
        )


class WorldBatch:
    """Draws `num_worlds` worlds; keeps which scene stands in each, and moves objects only where that changes."""

    def __init__(self, assets: SharedAssets, num_worlds: int) -> None:
        self.assets = assets
        self.num_worlds = num_worlds
        mjm, settings = assets.render_model.model, assets.settings
        ngeom, pixels = mjm.ngeom, settings.height * settings.width
        self.data = mjw.make_data(mjm, nworld=num_worlds, nconmax=0, njmax=0)
        self.model = dataclasses.replace(
            assets.model,
            geom_dataid=wp.zeros((num_worlds, ngeom), dtype=int),
            geom_matid=wp.array(np.tile(mjm.geom_matid, (num_worlds, 1)), dtype=int),
            cam_fovy=wp.zeros((num_worlds, 1), dtype=float),
            light_diffuse=wp.zeros((num_worlds, 1), dtype=wp.vec3),
        )
        dataid = np.tile(mjm.geom_dataid, (num_worlds, 1))
        self.model.geom_dataid.assign(dataid)
        base = copy.copy(assets.context.base)
        for name in ("rgb_data", "depth_data", "seg_data"):
            array = getattr(base, name)
            setattr(base, name, wp.zeros((num_worlds, array.shape[1]), dtype=array.dtype))
        base.lower = wp.zeros(num_worlds * ngeom, dtype=wp.vec3)
        base.upper = wp.zeros(num_worlds * ngeom, dtype=wp.vec3)
        base.group = wp.array(np.repeat(np.arange(num_worlds), ngeom), dtype=int)
        base.group_root = wp.zeros(num_worlds, dtype=int)
        context = copy.copy(assets.context)
        context.base, context._host_cache = base, {}
        tile = lambda array: np.tile(array.numpy(), (num_worlds, 1))  # noqa: E731
        context.geom_roughness = wp.array(tile(assets.context.geom_roughness), dtype=float)
        context.geom_metallic = wp.array(tile(assets.context.geom_metallic), dtype=float)
        context.env_id = wp.zeros(num_worlds, dtype=int)
        context.env_yaw = wp.zeros(num_worlds, dtype=float)
        context.ambient_radiance = wp.zeros(num_worlds, dtype=wp.vec3)
        if "normal" in settings.outputs:
            context.guide_albedo = wp.zeros((num_worlds, pixels), dtype=wp.vec3)
            context.guide_normal = wp.zeros((num_worlds, pixels), dtype=wp.vec3)
        self.context = context
        self.scene = wp.full(num_worlds, -1, dtype=int)
        self.worlds = self._worlds()

    def _worlds(self) -> Any:
        worlds, data, context = kernels.Worlds(), self.data, self.context
        worlds.geom_xpos, worlds.geom_xmat = data.geom_xpos, data.geom_xmat
        worlds.geom_dataid, worlds.geom_matid = self.model.geom_dataid, self.model.geom_matid
        worlds.geom_roughness, worlds.geom_metallic = context.geom_roughness, context.geom_metallic
        worlds.lower, worlds.upper, worlds.group = context.base.lower, context.base.upper, context.base.group
        worlds.light_xdir, worlds.light_diffuse = data.light_xdir, self.model.light_diffuse
        worlds.ambient, worlds.env_id, worlds.env_yaw = context.ambient_radiance, context.env_id, context.env_yaw
        worlds.cam_xpos, worlds.cam_xmat, worlds.cam_fovy = data.cam_xpos, data.cam_xmat, self.model.cam_fovy
        worlds.ngeom = self.assets.render_model.model.ngeom
        return worlds

    def render(self, scene, xpos, xquat, eye, turn, fovy, outputs: dict[str, wp.array]) -> None:
        """Draws one frame of every world into `outputs` (Warp arrays with a leading world axis).

        Args (Warp arrays): scene (n,) int; xpos (n, nbody) vec3, xquat (n, nbody) vec4: the robot's bodies;
          eye (n,) vec3, turn (n,) vec4, fovy (n,) float: the cameras.
        """
        self.place(scene, xpos, xquat, eye, turn, fovy)
        assets = self.assets
        # The kernel is the same for all batches: the first to draw builds it.
        shared = assets.context
        self.context._megakernel, self.context._megakernel_key = shared._megakernel, shared._megakernel_key
        pbr.render(self.model, self.data, self.context)
        shared._megakernel, shared._megakernel_key = self.context._megakernel, self.context._megakernel_key
        self._unpack(scene, outputs)
        assets.ready = True

    def place(self, scene, xpos, xquat, eye, turn, fovy) -> None:
        """Brings objects, robots, cameras and the search tree to where they stand in this frame; see `render`."""
        n, assets, worlds = self.num_worlds, self.assets, self.worlds
        num_slots, robots = assets.render_model.num_slots, len(assets.render_model.robot_body)
        if robots:
            wp.launch(
                kernels.place_robot,
                dim=(n, robots),
                inputs=[assets.robot, xpos, xquat, num_slots, worlds],
            )
        wp.launch(kernels.place_camera, dim=n, inputs=[eye, turn, fovy, worlds])
        self._update_tree(scene)

    def _update_tree(self, scene) -> None:
        base, inputs = self.context.base, [self.assets.tables, scene, self.scene, self.worlds]
        on_host = self.assets.device.is_cpu
        changed = not on_host or bool((scene.numpy() != self.scene.numpy()).any())
        if changed:
            wp.launch(kernels.place_slots, dim=(self.num_worlds, self.assets.render_model.num_slots), inputs=inputs)
            wp.launch(kernels.place_light, dim=self.num_worlds, inputs=inputs)
        if base.bvh is None or base.bvh.lowers is not base.lower:
            base.bvh = wp.Bvh(base.lower, base.upper, groups=base.group, constructor=None)
            base.bvh_id = base.bvh.id
        elif changed:
            base.bvh.rebuild()
        else:
            base.bvh.refit()
            return
        wp.launch(compute_bvh_group_roots, dim=self.num_worlds, inputs=[base.bvh.id, base.group_root])

    def _unpack(self, scene, outputs: dict[str, wp.array]) -> None:
        base, settings = self.context.base, self.assets.settings
        dim = (self.num_worlds, settings.height * settings.width)
        if "rgb" in outputs:
            wp.launch(kernels.unpack_colour, dim=dim, inputs=[base.rgb_data, outputs["rgb"]])
        if "depth" in outputs:
            wp.launch(kernels.unpack_depth, dim=dim, inputs=[base.depth_data, outputs["depth"]])
        if "normal" in outputs:
            wp.launch(kernels.unpack_normal, dim=dim, inputs=[self.context.guide_normal, outputs["normal"]])
        if "category" in outputs or "object" in outputs:
            nothing = wp.zeros((self.num_worlds, 0, 0), dtype=int)
            wp.launch(
                kernels.unpack_labels,
                dim=dim,
                inputs=[
                    self.assets.tables,
                    scene,
                    base.seg_data,
                    self.assets.render_model.num_slots,
                    ROBOT_LABEL,
                    outputs.get("category", nothing),
                    outputs.get("object", nothing),
                ],
            )


class WorldBatches:
    """A batch of worlds in as many pieces as there are threads, each piece a context of its own."""

    def __init__(self, assets: SharedAssets, num_worlds: int, threads: int) -> None:
        count = min(threads, num_worlds)
        sizes = [num_worlds // count + (i < num_worlds % count) for i in range(count)]
        self.pieces = [WorldBatch(assets, size) for size in sizes]

    def jobs(self, inputs: Sequence[wp.array], outputs: dict[str, wp.array]) -> list[Callable[[], None]]:
        """What draws the pieces of the batch; see `Renderer._render` for the arrays."""
        jobs: list[Callable[[], None]] = []
        start = 0
        for piece in self.pieces:
            part = slice(start, start + piece.num_worlds)
            wanted = {name: x[part] for name, x in outputs.items() if x.shape[1] > 0}
            jobs.append(functools.partial(piece.render, *(x[part] for x in inputs), wanted))
            start += piece.num_worlds
        return jobs
