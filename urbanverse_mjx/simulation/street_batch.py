"""Still streets on the Warp device, and the robot's parts of a batch of worlds."""

import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import warp as wp
from mujoco_warp._src.bvh import compute_bvh_group_roots
from mujoco_warp_pbr._src.material import effective_geom_rgba

from ..datatypes import SceneBank
from .render_context import ROBOT_LABEL, Settings
from .render_kernels import NOWHERE
from .render_model import FAR, RenderModel, rotation_matrices
from .render_scenes import build_skies, scene_sun, sky_ambient, slot_boxes, upload_textures
from .street_draw import build_draw_kernel
from .street_kernels import Face, Light, Look, Part, Slot, place_parts


def records(struct: Any, rows: int, **columns: np.ndarray) -> wp.array:
    """A Warp array of structs from one numpy array per field."""
    table: Any = np.zeros(rows, struct.numpy_dtype())
    for name, column in columns.items():
        table[name] = column
    return wp.array(table, dtype=struct)


def _face_table(model: RenderModel) -> wp.array:
    """One record per triangle of every mesh, in the order of `model.mesh_face`."""
    mjm = model.model
    faces, count = mjm.mesh_face, len(mjm.mesh_face)
    mesh = np.repeat(np.arange(mjm.nmesh), mjm.mesh_facenum)
    corners = model.vertices[faces + mjm.mesh_vertadr[mesh, None]].astype(np.float64)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(flat, axis=1)
    flat /= np.maximum(area, 1e-20)[:, None]
    normals = model.normals[mjm.mesh_facenormal + mjm.mesh_normaladr[mesh, None]].astype(np.float64)
    # As in MuJoCo's renderer a corner's normal far off its face is not used.
    usable = (normals * flat[:, None]).sum(-1) >= 0.8
    normals = np.where(usable[..., None], normals, flat[:, None])
    uv, density = np.zeros((count, 3, 2)), np.zeros(count)
    textured = mjm.mesh_texcoordadr[mesh] >= 0
    start = mjm.mesh_texcoordadr[mesh[textured], None]
    uv[textured] = mjm.mesh_texcoord[mjm.mesh_facetexcoord[textured] + start]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    density = np.sqrt(np.abs(d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1]) / np.maximum(area, 1e-20))
    return records(
        Face,
        count,
        normal0=normals[:, 0],
        normal1=normals[:, 1],
        normal2=normals[:, 2],
        uv0=uv[:, 0],
        uv1=uv[:, 1],
        uv2=uv[:, 2],
        density=density,
    )


class Streets:
    """Everything that does not move: meshes, search trees of all scenes, materials, skies, the kernel."""

    def __init__(self, bank: SceneBank, model: RenderModel, settings: Settings) -> None:
        self.settings = settings
        mjm = model.model
        self.meshes = [
            wp.Mesh(
                points=wp.array(model.vertices[v : v + nv], dtype=wp.vec3),
                indices=wp.array(mjm.mesh_face[f : f + nf].ravel(), dtype=wp.int32),
                bvh_constructor="sah",
                bvh_leaf_size=2,
            )
            for v, nv, f, nf in zip(mjm.mesh_vertadr, mjm.mesh_vertnum, mjm.mesh_faceadr, mjm.mesh_facenum, strict=True)
        ]
        self.mesh_ids = np.array([mesh.id for mesh in self.meshes], np.uint64)
        self.faces = _face_table(model)
        self._place_slots(bank, model)
        self.textures_kept, sizes = upload_textures(model)
        self._add_looks(bank, model, sizes)
        self._add_light(bank)
        self.num_parts = len(model.robot_body)
        self.draw = build_draw_kernel(
            settings.height,
            settings.width,
            settings.outputs,
            settings.shadows,
            settings.sky,
            settings.samples,
            FAR,
            self.num_parts > 0,
        )
        self.ready = False

    def _place_slots(self, bank: SceneBank, model: RenderModel) -> None:
        scene, number = np.nonzero(bank.slot_mesh >= 0)
        mesh = bank.slot_mesh[scene, number]
        lower, upper = slot_boxes(bank)
        self.slots = records(
            Slot,
            len(scene),
            position=bank.slot_position[scene, number],
            rotation=rotation_matrices(bank.slot_quaternion[scene, number]),
            mesh=self.mesh_ids[mesh],
            face=model.model.mesh_faceadr[mesh],
            look=bank.mesh_material[mesh],
            number=number,
            category=bank.slot_category[scene, number],
        )
        self.boxes = [wp.array(x[scene, number], dtype=wp.vec3) for x in (lower, upper)]
        groups = wp.array(scene.astype(np.int32), dtype=int)
        self.tree = wp.Bvh(*self.boxes, groups=groups, constructor="sah")
        self.roots = wp.zeros(bank.num_scenes, dtype=int)
        wp.launch(compute_bvh_group_roots, dim=bank.num_scenes, inputs=[self.tree.id, self.roots])

    def _add_looks(self, bank: SceneBank, model: RenderModel, sizes: np.ndarray) -> None:
        mjm, num_slots = model.model, model.num_slots
        role = 1  # mujoco.mjtTextureRole.mjTEXROLE_RGB
        geoms = np.arange(num_slots, mjm.ngeom)
        material = mjm.geom_matid[geoms]
        colour = np.concatenate([mjm.mat_rgba[:, :3], effective_geom_rgba(mjm)[geoms, :3]])
        texture = np.concatenate([mjm.mat_texid[:, role], np.where(material >= 0, mjm.mat_texid[material, role], -1)])
        texels = np.where(texture >= 0, sizes.max(1)[texture] if len(sizes) else 1.0, 1.0)
        self.looks = records(Look, len(colour), colour=colour, texture=texture, texels=texels)
        self.textures = wp.array(self.textures_kept, dtype=wp.Texture2D)
        mesh = np.where(mjm.geom_dataid[geoms] >= 0, mjm.geom_dataid[geoms], 0)
        self.parts = records(
            Part,
            len(geoms),
            position=model.robot_position,
            rotation=model.robot_rotation,
            centre=model.robot_half[:, 0],
            radius=np.linalg.norm(model.robot_half[:, 1], axis=1),
            size=mjm.geom_size[geoms],
            mesh=self.mesh_ids[mesh],
            kind=mjm.geom_type[geoms],
            body=model.robot_body,
            face=mjm.mesh_faceadr[mesh],
            look=len(mjm.mat_rgba) + np.arange(len(geoms)),
        )

    def _add_light(self, bank: SceneBank) -> None:
        sun, irradiance = scene_sun(bank)
        self.lights = records(
            Light,
            bank.num_scenes,
            sun=sun,
            sunlight=irradiance / np.pi,
            even=sky_ambient(bank),
            sky=bank.scene_sky,
            yaw=bank.scene_sky_yaw,
        )
        self.skies = build_skies(bank.sky_radiance, glossy=False)


class StreetBatch:
    """Draws a batch of worlds; holds the poses of their robots' parts, and nothing else.

    Args:
      threads: the batch is drawn in so many pieces, which may run at the same time.
    """

    def __init__(self, streets: Streets, num_worlds: int, threads: int) -> None:
        self.streets, self.num_worlds = streets, num_worlds
        ends = np.linspace(0, num_worlds, min(threads, num_worlds) + 1).astype(int)
        self.pieces = list(zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True))
        self.position = wp.zeros((num_worlds, streets.num_parts), dtype=wp.vec3)
        self.rotation = wp.zeros((num_worlds, streets.num_parts), dtype=wp.mat33)
        self.balls = wp.zeros((num_worlds, streets.num_parts + 1), dtype=wp.vec4)

    def jobs(self, inputs: Sequence[wp.array], outputs: dict[str, wp.array]) -> list[Callable[[], None]]:
        """What draws the pieces of the batch; see `Renderer._render` for the arrays."""
        scene, xpos, xquat, eye, turn, fovy = inputs
        s, settings = self.streets, self.streets.settings
        if s.num_parts:
            wp.launch(
                place_parts,
                dim=self.num_worlds,
                inputs=[s.parts, xpos, xquat, NOWHERE, self.position, self.rotation, self.balls],
            )
        kept = [
            s.tree.id,
            s.roots,
            s.slots,
            s.faces,
            s.looks,
            s.textures,
            s.lights,
            s.skies.radiance,
            s.skies.sh,
            s.parts,
            self.position,
            self.rotation,
            self.balls,
            scene,
            eye,
            turn,
            fovy,
            ROBOT_LABEL,
        ]
        pixels = settings.height * settings.width

        def draw(first: int, last: int) -> None:
            out = [outputs[name] for name in ("rgb", "depth", "category", "object", "normal")]
            wp.launch(s.draw, dim=(last - first, pixels), inputs=[first, *kept, *out], block_dim=64)
            s.ready = True

        return [functools.partial(draw, *piece) for piece in self.pieces]
