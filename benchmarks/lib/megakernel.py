"""The original mujoco-warp-pbr: its kernel over MuJoCo Warp's data and trees, one tree per world.

Tests compare the images of our renderer with `shading="pbr"` with it, and benchmarks.render its speed.
"""

import copy
import dataclasses
from typing import Any

import mujoco_warp as mjw
import mujoco_warp_pbr as pbr
import numpy as np
import warp as wp

from benchmarks.lib import megakernel_kernels as kernels
from benchmarks.lib.megakernel_kernels import RobotTables, SceneTables
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.simulation.rendering.model import RenderModel, images
from urbanverse_mjx.simulation.rendering.pbr_private import BAKE_GROUPS, texel_angle
from urbanverse_mjx.simulation.rendering.scenes import build_skies, scene_sun, sky_ambient, slot_boxes, upload_textures
from urbanverse_mjx.simulation.rendering.settings import PBR_EXPOSURE, PLAIN_SKY, Settings
from urbanverse_mjx.simulation.warp_engine.mujoco_warp_private import (
    compute_bvh_group_roots,  # pyright: ignore[reportAttributeAccessIssue] (its package is untyped)
)


def build_scene_tables(bank: SceneBank, model: RenderModel, sky: bool) -> Any:
    """Moves the renderer's data of every scene to the current Warp device, as `SceneTables`.

    Args:
      sky: whether skies are drawn.
    """
    mesh = np.maximum(bank.slot_mesh, 0)
    material = bank.mesh_material[mesh]
    empty = bank.slot_mesh < 0
    lower, upper = slot_boxes(bank)
    # An empty slot gets a point inside the box of the slot before it, so that no node of the search tree grows.
    for z, n in zip(*np.nonzero(empty), strict=True):
        lower[z, n] = upper[z, n] = (lower[z, n - 1] + upper[z, n - 1]) / 2 if n else bank.slot_position[z, 0]
    sun, irradiance = scene_sun(bank)
    tables = SceneTables()
    tables.position = wp.array(bank.slot_position, dtype=wp.vec3)
    tables.rotation = wp.array(rotations.matrix_f64(bank.slot_quaternion), dtype=wp.mat33)
    tables.lower = wp.array(lower, dtype=wp.vec3)
    tables.upper = wp.array(upper, dtype=wp.vec3)
    tables.mesh = wp.array(mesh, dtype=int)
    tables.material = wp.array(np.where(empty, model.model.material("absent").id, material), dtype=int)
    tables.roughness = wp.array(bank.material_roughness[material], dtype=float)
    tables.metallic = wp.array(bank.material_metallic[material], dtype=float)
    tables.sun_direction = wp.array(sun, dtype=wp.vec3)
    tables.sun_irradiance = wp.array(irradiance, dtype=wp.vec3)
    # Uniform light replaces the sky and is not added to it.
    tables.ambient = wp.array(sky_ambient(bank) * (not sky), dtype=wp.vec3)
    tables.sky = wp.array(bank.scene_sky if sky else np.zeros_like(bank.scene_sky), dtype=int)
    tables.sky_yaw = wp.array(bank.scene_sky_yaw, dtype=float)
    return tables


def build_robot_tables(model: RenderModel) -> Any:
    """`RobotTables` of the model on the current Warp device."""
    tables = RobotTables()
    tables.body = wp.array(model.robot_body, dtype=int)
    tables.position = wp.array(model.robot_position, dtype=wp.vec3)
    tables.rotation = wp.array(model.robot_rotation, dtype=wp.mat33)
    tables.centre = wp.array(model.robot_half[:, 0], dtype=wp.vec3)
    tables.half = wp.array(model.robot_half[:, 1], dtype=wp.vec3)
    return tables


class SharedAssets:
    """Meshes, textures, skies and scene tables of one renderer on one Warp device."""

    def __init__(self, bank: SceneBank, model: RenderModel, settings: Settings) -> None:
        self.render_model = model
        self.settings = settings
        self.device = wp.get_device()
        mjm = model.model
        self.model = mjw.put_model(mjm)
        self.model.mesh_vert = wp.array(model.meshes.vertices, dtype=wp.vec3)
        self.model.mesh_normal = wp.array(model.meshes.normals, dtype=wp.vec3)
        self.tables = build_scene_tables(bank, model, settings.sky)
        self.robot = build_robot_tables(model)
        self.context = pbr.create_render_context(
            mjm,
            nworld=1,
            cam_res=(settings.width, settings.height),
            render_rgb=True,
            render_depth=False,
            render_seg=False,
            enabled_geom_groups=[0],
            use_shadows=settings.shadows,
            shadow_light_fraction=0.0,
            use_skybox=False,
            # Leaves and paint have two coincident faces, and a ray may hit either.
            enable_backface_culling=False,
            background_color=PLAIN_SKY,
            samples_per_pixel=settings.samples,
            mesh_bvh_frame="mujoco",
        )
        self._fix_context(bank)

    def _fix_context(self, bank: SceneBank) -> None:
        """Meshes in their authored frames, all textures, the bank's skies, light in the bank's units."""
        mjm, context = self.render_model.model, self.context
        meshes = [self._mesh(i) for i in range(mjm.nmesh)]
        context.base.mesh_registry = {mesh.id: mesh for mesh in meshes}
        context.base.mesh_bvh_id = wp.array([mesh.id for mesh in meshes], dtype=wp.uint64)
        # The context uploads the textures of the geoms' materials at compile time; scenes choose theirs later.
        textures, sizes = upload_textures(tuple(images(mjm)))
        context.textures_registry = textures
        context.textures = wp.array(textures, dtype=wp.Texture2D)
        context.tex_size = wp.array(sizes, dtype=wp.vec2)
        context.features.base_color_map = context.features.textures = bool((mjm.mat_texid >= 0).any())
        context.features.specular_aa = False
        # Settings as constants of the kernel: 3 % (pbr) to 15 % (matte) more frames on a CPU.
        context.baked = frozenset(BAKE_GROUPS)
        # The bank's radiance is relative to the display: 1 is white.
        context.exposure = wp.array([PBR_EXPOSURE], dtype=float)
        context.light_intensity = wp.ones((1, 1), dtype=float)
        if self.settings.sky:
            skies = build_skies(bank.sky_radiance, glossy=True)
            context.env_maps = list(skies.owners)
            assert skies.prefiltered is not None, "glossy skies are prefiltered"
            context.env_radiance, context.env_prefiltered, context.env_sh = skies.radiance, skies.prefiltered, skies.sh
            context.env_texel_angle = texel_angle(skies.width)
            context.env_intensity = wp.ones(1, dtype=float)
            context.has_env = context.env_background = True

    def _mesh(self, number: int) -> wp.Mesh:
        mjm = self.render_model.model
        corners = slice(mjm.mesh_vertadr[number], mjm.mesh_vertadr[number] + mjm.mesh_vertnum[number])
        faces = slice(mjm.mesh_faceadr[number], mjm.mesh_faceadr[number] + mjm.mesh_facenum[number])
        return wp.Mesh(
            points=wp.array(self.render_model.meshes.vertices[corners], dtype=wp.vec3),
            indices=wp.array(mjm.mesh_face[faces].ravel(), dtype=wp.int32),
            bvh_constructor="sah",
            bvh_leaf_size=2,
        )


class WorldBatch:
    """Renders `num_worlds` worlds; objects are moved only in worlds whose scene changed."""

    def __init__(self, assets: SharedAssets, num_worlds: int) -> None:
        self.assets = assets
        self.num_worlds = num_worlds
        mjm = assets.render_model.model
        ngeom = mjm.ngeom
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

    def render(self, scene, xpos, xquat, camera_position, turn, fovy, rgb: wp.array) -> None:
        """Draws one frame of every world into `rgb` (n, H, W, 3) u8.

        Args (Warp arrays): scene (n,) int; xpos (n, nbody) vec3, xquat (n, nbody) vec4: the robot's bodies;
          eye (n,) vec3, turn (n,) vec4, fovy (n,) float: the cameras.
        """
        self.place(scene, xpos, xquat, camera_position, turn, fovy)
        pbr.render(self.model, self.data, self.context)
        pixels = rgb.shape[1] * rgb.shape[2]
        wp.launch(kernels.unpack_colour, dim=(self.num_worlds, pixels), inputs=[self.context.base.rgb_data, rgb])

    def place(self, scene, xpos, xquat, camera_position, turn, fovy) -> None:
        """Updates objects, robots, cameras and the search tree for this frame; see `render`."""
        n, assets, worlds = self.num_worlds, self.assets, self.worlds
        num_slots, robots = assets.render_model.num_slots, len(assets.render_model.robot_body)
        if robots:
            wp.launch(
                kernels.place_robot,
                dim=(n, robots),
                inputs=[assets.robot, xpos, xquat, num_slots, worlds],
            )
        wp.launch(kernels.place_camera, dim=n, inputs=[camera_position, turn, fovy, worlds])
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
