"""Still streets on the Warp device, and the views of a batch of worlds."""

import concurrent.futures
import functools
from collections.abc import Callable, Sequence

import mujoco
import numpy as np
import warp as wp

from ... import settings as process
from ...datatypes import SceneBank
from ...geometry import rotations
from ..threads import run_all
from . import street_coverage, street_draw, street_packets
from .light_bake import Baker, around_scenes, light_tables
from .meshes import RenderMeshes
from .model import FAR_PLANE, RenderModel, images
from .pbr_private import build_dfg_lut, effective_geom_rgba, resolve_geom_materials
from .scenes import build_skies, scene_sun, sky_ambient, slot_boxes, upload_textures
from .settings import COVERAGE, NOWHERE, Settings
from .street_kernels import Street, Views, place
from .street_light import SHADE, place_shades
from .street_shade import Skies
from .street_tree import LEAF, Items, Trees, as_floats, build_over, build_trees, joined, open_large

#: Triangles in a leaf at most.
_LEAF_SIZE = 4
#: Share of the surface of the box around a scene from which an object's box is divided, see `open_large`; smaller ones
#: divide more, at no gain (docs/decisions/renderer.md).
_LARGE = 0.01
#: Triangles whose rows are computed at once by a thread: 60 MB of temporary arrays.
_PART = 1 << 16
#: Rays of a thread whose hits are kept at once: they stay in the processor's cache.
_RAYS = 1 << 16


def _rows(*columns: np.ndarray) -> np.ndarray:
    """(n, 4) f32: columns of one or more numbers side by side."""
    return np.concatenate([np.asarray(c, np.float32).reshape(len(columns[0]), -1) for c in columns], axis=1)


def _table(rows: np.ndarray) -> wp.array:
    return wp.array(np.ascontiguousarray(rows, np.float32).reshape(-1, 4), dtype=wp.vec4)


def _in_parts(work: Callable[[slice], None], count: int) -> None:
    """Calls `work` with slices that make up [0, count), in threads, in which numpy computes at the same time; temporary
    arrays stay small."""
    parts = [slice(first, min(first + _PART, count)) for first in range(0, count, _PART)]
    with concurrent.futures.ThreadPoolExecutor(process.num_threads()) as pool:
        run_all(pool, [functools.partial(work, part) for part in parts])


def _rows_in_parts(find: Callable[[np.ndarray], np.ndarray], faces: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """(n, *shape) f32: the rows that `find` gives for triangles (n,), see `_in_parts`."""
    rows = np.empty((len(faces), *shape), np.float32)

    def work(part: slice) -> None:
        rows[part] = find(faces[part])

    _in_parts(work, len(faces))
    return rows


def inverse_rows(rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
    """(n, 3, 4) rows of T_frame_world from (n, 3, 3) and (n, 3) T_world_frame."""
    turned = np.swapaxes(np.asarray(rotation, np.float64), 1, 2)
    return np.concatenate([turned, -turned @ np.asarray(position, np.float64)[..., None]], -1)


def _triangle_rows(meshes: RenderMeshes, faces: np.ndarray) -> np.ndarray:
    """(n, 3, 4) f32: a corner of each of some triangles, and its two edges there."""
    corners = meshes.vertices[meshes.face[faces]]
    rows = np.zeros((len(faces), 3, 4), np.float32)
    rows[:, 0, :3] = corners[:, 0]
    rows[:, 1, :3] = corners[:, 1] - corners[:, 0]
    rows[:, 2, :3] = corners[:, 2] - corners[:, 0]
    return rows


def _face_rows(meshes: RenderMeshes, faces: np.ndarray) -> np.ndarray:
    """(n, 4, 4) f32: normals and UV of some triangles, by their numbers (n,); see `street_kernels.FACE`."""
    corners = meshes.vertices[meshes.face[faces]].astype(np.float64)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(flat, axis=1)
    flat /= np.maximum(area, 1e-20)[:, None]
    normals = meshes.normals[meshes.face_normal[faces]].astype(np.float64)
    # As in MuJoCo's renderer a corner's normal far off its face is not used.
    usable = (normals * flat[:, None]).sum(-1) >= 0.8
    normals = np.where(usable[..., None], normals, flat[:, None])
    uv, rows = np.zeros((len(faces), 3, 2)), meshes.face_uv[faces]
    textured = rows[:, 0] >= 0
    uv[textured] = meshes.uv[rows[textured]]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    # Texture lengths per metre.
    density = np.sqrt(np.abs(d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1]) / np.maximum(area, 1e-20))
    columns = (normals[:, 0], density, normals[:, 1], uv[:, 0, 0], normals[:, 2], uv[:, 0, 1], uv[:, 1], uv[:, 2])
    return _rows(*columns).reshape(-1, 4, 4)


def _mesh_boxes(bank: SceneBank) -> np.ndarray:
    """(M, 2, 3): centre and half size of the box around each mesh of the bank, m."""
    parts = zip(bank.mesh_vertex_start[:-1], bank.mesh_vertex_start[1:], strict=True)
    ends = np.array([(c.min(0), c.max(0)) for c in (bank.mesh_vertices[i:j] for i, j in parts)], np.float64)
    return np.stack([0.5 * (ends[:, 0] + ends[:, 1]), 0.5 * (ends[:, 1] - ends[:, 0])], 1)


def _mesh_balls(bank: SceneBank) -> np.ndarray:
    """(M, 4) f32: centre and radius of a ball around each mesh of the bank, m."""
    balls = np.zeros((bank.num_meshes, 4), np.float32)
    for ball, first, last in zip(balls, bank.mesh_vertex_start[:-1], bank.mesh_vertex_start[1:], strict=True):
        corners = bank.mesh_vertices[first:last]
        ball[:3] = 0.5 * (corners.min(0) + corners.max(0))
        ball[3] = np.linalg.norm(corners - ball[:3], axis=1).max()
    return balls


class Streets:
    """Everything that does not move: triangles, search trees, materials, skies, the kernel."""

    def __init__(self, bank: SceneBank, model: RenderModel, settings: Settings) -> None:
        self._begin(model, settings)
        self._add_tables(bank, model)
        #: Finds the first hits of a camera's rays on a CPU, before the image is drawn with them; else None.
        self.cast = None
        if wp.get_device().is_cpu and settings.scan is None:
            self.cast = street_packets.build_cast_kernel(settings.bodies > 0)
        self.draw = street_draw.build_draw_kernel(
            settings, FAR_PLANE, self._sky_width, self.cast is not None, self.objects_of_place
        )
        if COVERAGE in settings.outputs:
            ground = self._is_ground[: self.street.num_objects]
            self.columns, self._lists = street_coverage.make_columns(
                self.object_of_slot, ground, model.labels, self.num_parts
            )
            self.num_columns = self.object_of_slot.shape[1] + model.num_agents
            self.count = street_coverage.build_count_kernel(settings, FAR_PLANE)
        self.ready = False

    def _begin(self, model: RenderModel, settings: Settings) -> None:
        self.settings = settings
        self.num_parts = model.model.ngeom + settings.bodies
        self.street, self._tables = Street(), []
        self.street.num_parts, self.street.num_bodies = self.num_parts, settings.bodies
        self.num_shades = 0
        #: Largest number of objects of a scene, where scenes change in places; else 0.
        self.objects_of_place = 0

    @property
    def is_baked(self) -> bool:
        """Whether the streets hide light from one another."""
        return self.settings.light == "baked" and "rgb" in self.settings.outputs

    def _add_tables(self, bank: SceneBank, model: RenderModel) -> None:
        geoms = np.arange(model.model.ngeom)
        self._add_objects(bank, model, self.mesh_tables(model.meshes, self._keep), geoms)
        self._add_parts(model, geoms)
        self._add_light(bank)
        if self.is_baked:
            self._add_baked_light(bank, model)

    def _keep(self, name: str, rows: np.ndarray) -> None:
        """Puts the rows of a table of `Street` on the device, to stay as long as this does."""
        self._tables.append(_table(rows))
        setattr(self.street, name, self._tables[-1].ptr or 0)

    def _keep_bytes(self, name: str, values: np.ndarray) -> None:
        """As `_keep`, for a table of bytes."""
        self._tables.append(wp.array(values, dtype=wp.uint8))
        setattr(self.street, name, self._tables[-1].ptr or 0)

    def _upload(self, texture_images: Sequence[np.ndarray]) -> np.ndarray:
        """Puts textures on the device; returns their (number, 2) widths and heights."""
        textures, sizes = upload_textures(texture_images)
        self._textures: list[object] = [textures]
        self.textures = wp.array(textures, dtype=wp.Texture2D)
        return sizes

    @staticmethod
    def mesh_tables(meshes: RenderMeshes, keep: Callable[[str, np.ndarray], None]) -> Trees:
        """Gives `keep` triangles and faces in the order of the leaves of the meshes' trees; returns the trees."""
        mesh = np.repeat(np.arange(len(meshes.count), dtype=np.int32), meshes.count)
        lower, upper = (np.empty((len(mesh), 3), np.float32) for _ in range(2))

        def find_boxes(part: slice) -> None:
            corners = meshes.vertices[meshes.face[part]]
            lower[part], upper[part] = corners.min(1), corners.max(1)

        _in_parts(find_boxes, len(mesh))
        trees = build_trees(lower, upper, mesh, len(meshes.count), _LEAF_SIZE)
        rows = _rows_in_parts(functools.partial(_triangle_rows, meshes), trees.order, (3, 4))
        rows[:, 0, 3] = trees.last
        keep("triangles", rows)
        del rows
        keep("faces", _rows_in_parts(functools.partial(_face_rows, meshes), trees.order, (4, 4)))
        return trees

    def _add_objects(self, bank: SceneBank, model: RenderModel, meshes: Trees, geoms: np.ndarray) -> None:
        """Objects of all scenes in the order of the leaves of their trees, then the robot's parts."""
        mjm = model.model
        lower, upper = slot_boxes(bank)
        scene, number = np.nonzero(bank.slot_mesh >= 0)
        boxes = lower[scene, number], upper[scene, number]
        # Neighbours are adjacent, and have the numbers by which `street_kernels.factors` tells them apart.
        order = build_trees(*boxes, scene, bank.num_scenes, leaf_size=1).order
        scene, number = scene[order], number[order]
        mesh = bank.slot_mesh[scene, number]
        rotation = rotations.matrix_f64(bank.slot_quaternion[scene, number])
        poses = inverse_rows(rotation, bank.slot_position[scene, number])
        poses = np.concatenate([poses, np.zeros((len(geoms), 3, 4))])
        bank_images = (bank.texture(i) for i in range(len(bank.texture_shape)))
        sizes = self._upload((*bank_images, *images(mjm)))
        material, part = bank.mesh_material[mesh], mjm.geom_dataid[geoms]
        colour = np.concatenate([bank.material_rgba[material, :3], effective_geom_rgba(mjm)[geoms, :3]])
        texture = part_textures(mjm, len(bank.texture_shape))
        texture = np.concatenate([bank.material_texture[material], texture])
        texels = np.where(texture >= 0, sizes.max(1)[texture] if len(sizes) else 1.0, 1.0)
        grounds = np.array([name.startswith("ground:") for name in bank.meta["categories"]])
        self._is_ground = np.zeros(len(texels), bool)
        self._is_ground[: len(mesh)] = grounds[bank.slot_category[scene, number]]
        #: Of these, what light is baked on.
        self._baked_ground = self._is_ground.copy()
        self._baked_ground[: len(mesh)] &= ~around_scenes(bank)[scene, number]
        # Its sign tells the shading; see `street_shade`.
        texels = np.where(self._is_ground, -texels, texels)
        metallic, roughness, _ = resolve_geom_materials(mjm)
        surfaces = _rows(
            texture,
            texels,
            np.concatenate([bank.material_roughness[material], roughness[geoms]]),
            np.concatenate([bank.material_metallic[material], metallic[geoms]]),
        )
        rows = np.concatenate([poses, _rows(colour, np.zeros(len(colour)))[:, None], surfaces[:, None]], axis=1)
        places = rotation, bank.slot_position[scene, number].astype(np.float64)
        objects = Items(np.arange(len(mesh)), meshes.roots[mesh], *(corner[order] for corner in boxes))
        items = open_large(objects, meshes.nodes, *places, scene, _LARGE)
        parts = poses, meshes.roots[np.concatenate([mesh, bank.num_meshes + part])]
        nodes, roots = self._add_entries(items, scene[items.owner], bank.num_scenes, *parts)
        nodes, roots = joined(meshes.nodes, nodes, roots)
        self._keep("nodes", nodes)
        self.roots, self._num_mesh_nodes = wp.array(roots, dtype=int), len(meshes.nodes)
        self._mesh_of_object = mesh
        self._keep("object_rows", rows)
        self.street.num_objects = len(mesh)
        self._keep("balls", _mesh_balls(bank)[mesh])
        object_of_slot = np.full(bank.slot_mesh.shape, -1, np.int32)
        object_of_slot[scene, number] = np.arange(len(mesh))
        self.object_of_slot = wp.array(object_of_slot, dtype=int)
        label = np.stack([number, bank.slot_category[scene, number]], -1)
        self.labels = wp.array(np.concatenate([label, model.labels]), dtype=wp.vec2i)

    def _add_entries(
        self, items: Items, scene: np.ndarray, num_scenes: int, poses: np.ndarray, roots: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Nodes and roots of the trees of the scenes, whose leaves lead to entries; see `street_kernels.ENTRY`.

        Args:
          scene: of each item.
          poses: (n, 3, 4) rows of T_object_world, roots: (n,) of the whole trees of all objects and the robot's parts.
        """
        part = items.root != roots[items.owner]
        leaf = np.where(part, len(roots) + np.cumsum(part) - 1, items.owner)
        owner = np.concatenate([np.arange(len(roots)), items.owner[part]])
        reference = np.concatenate([roots, items.root[part]])
        ends = _rows(as_floats(reference), as_floats(LEAF + owner), np.zeros((len(owner), 2)))
        self._keep("entries", np.concatenate([poses[owner].astype(np.float32), ends[:, None]], axis=1))
        return build_over(items, leaf, scene, num_scenes)

    def _add_parts(self, model: RenderModel, geoms: np.ndarray) -> None:
        mjm = model.model
        count, bodies = len(geoms), self.settings.bodies
        parts = np.zeros((count + bodies, 2, 4), np.float32)
        # `place` turns the balls with the body, so their centres are needed in its frame, not in the geom's.
        middle = np.einsum("nij,nj->ni", model.robot_rotation, model.robot_half[:, 0])
        parts[:count, 0, :3] = model.robot_position + middle
        parts[:count, 0, 3] = np.linalg.norm(model.robot_half[:, 1], axis=1)
        material = mjm.geom_matid[geoms]
        parts[:count, 1, 0] = resolve_geom_materials(mjm)[2][geoms]
        parts[:count, 1, 1] = np.where(material >= 0, mjm.mat_emission[material], 0.0)
        parts[count:, 1, 0] = 0.5  # of what belongs to the street
        self._keep("parts", parts)
        turns = np.concatenate([model.robot_rotation, np.tile(np.eye(3), (bodies, 1, 1))])
        places = np.concatenate([model.robot_position, np.zeros((bodies, 3))])
        self.shapes = _table(inverse_rows(turns, places))
        self.bodies = wp.array(np.concatenate([model.robot_body, model.num_bodies + np.arange(bodies)]), dtype=int)

    def _add_skies(self, radiance: np.ndarray) -> np.ndarray:
        """Puts skies (S, H, W, 3) on the device; returns their spherical harmonics (S, 9, 3)."""
        gloss = self.settings.shading == "pbr"
        skies = build_skies(radiance, glossy=gloss)
        self._textures.append(skies.owners)
        self._sky_width = radiance.shape[2]
        self.skies = Skies()
        self.skies.radiance = skies.radiance
        if gloss:
            assert skies.prefiltered is not None, "skies for gloss are prefiltered"
            self.skies.blurred, self.skies.lobes = skies.prefiltered, build_dfg_lut()
        return skies.sh.numpy()

    def _add_light(self, bank: SceneBank) -> None:
        """Light tables; see `street_kernels.LIGHT`."""
        sun, irradiance = scene_sun(bank)
        harmonics = self._add_skies(bank.sky_radiance)
        lights = np.zeros((bank.num_scenes, 9, 4))
        if self.settings.sky:
            lights[..., :3] = sky_polynomials(harmonics[bank.scene_sky], bank.scene_sky_yaw)
        else:
            lights[:, 0, :3] = sky_ambient(bank)
        lights[:, :3, 3], lights[:, 3:6, 3] = sun, irradiance / np.pi
        lights[:, 6, 3], lights[:, 7, 3] = bank.scene_sky, bank.scene_sky_yaw
        self._keep("lights", lights)

    def _add_baked_light(self, bank: SceneBank, model: RenderModel) -> None:
        """Light that the streets hide, and the boxes of what moves; see `street_light`."""
        baker = Baker(bank, self.street, self.roots.numpy(), self._baked_ground)
        sheets, texels, cells = light_tables(baker.lights())
        self._keep("sheets", sheets)
        self._keep_bytes("texels", texels)
        self._keep_bytes("cells", cells)
        self._add_shades(bank, model)

    def _add_shades(self, bank: SceneBank, model: RenderModel) -> None:
        bodies = self.settings.bodies
        numbers = [*model.shade_body, *(model.num_bodies + np.arange(bodies))]
        boxes = np.concatenate([model.shade_box, np.ones((bodies, 2, 3))])
        self.num_shades = self.street.num_shades = len(numbers)
        self.shade_body, self.shade_box = wp.array(numbers, dtype=int), wp.array(_rounded(boxes), dtype=wp.vec3)
        objects = _mesh_boxes(bank)[self._mesh_of_object] if bodies else np.zeros((0, 2, 3))
        self.object_boxes = wp.array(_rounded(objects), dtype=wp.vec3)


def part_textures(model: mujoco.MjModel, first: int) -> np.ndarray:
    """(R,) texture of each geom of a render model, whose own stand behind `first` others; -1 = none."""
    geoms, role = np.arange(model.ngeom), int(mujoco.mjtTextureRole.mjTEXROLE_RGB)
    own, part = model.geom_matid[geoms], model.geom_dataid[geoms]
    # Meshes without UV have no texture.
    texture = np.where((own >= 0) & (model.mesh_texcoordadr[part] >= 0), model.mat_texid[own, role], -1)
    return np.where(texture >= 0, texture + first, -1)


def _rounded(boxes: np.ndarray) -> np.ndarray:
    """(n, 2, 3) boxes whose inscribed ellipsoids cover as much from above as the boxes given."""
    scale = np.array([[1.0, 1.0, 1.0], [1.13, 1.13, 1.0]])
    return np.maximum(boxes * scale, [[-np.inf] * 3, [0.05] * 3])


def sky_polynomials(harmonics: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    """Light on a matte surface as a polynomial of its normal, for skies turned by `yaw` about z.

    Args:
      harmonics: (n, 9, 3) of `mujoco_warp_pbr`: band 0, then y, z, x, xy, yz, 3zz - 1, xz, xx - yy.

    Returns:
      (n, 9, 3) coefficients of 1, x, y, z, xx, yy, xy, yz, xz.
    """
    # Constants of the real spherical harmonics.
    c0, c1, c2, c3, c4 = 0.282095, 0.488603, 1.092548, 0.315392, 0.546274
    h = np.moveaxis(np.asarray(harmonics, np.float64), 1, 0)
    linear = np.stack([h[3] * c1, h[1] * c1, h[2] * c1], -1)  # (n, 3 colours, xyz)
    square = np.zeros((*linear.shape, 3))
    square[..., 0, 0], square[..., 1, 1], square[..., 2, 2] = h[8] * c4, -h[8] * c4, 3.0 * h[6] * c3
    square[..., 0, 1] = square[..., 1, 0] = 0.5 * c2 * h[4]
    square[..., 1, 2] = square[..., 2, 1] = 0.5 * c2 * h[5]
    square[..., 0, 2] = square[..., 2, 0] = 0.5 * c2 * h[7]
    c, s = np.cos(yaw), np.sin(yaw)
    back = np.zeros((len(yaw), 1, 3, 3))
    back[:, 0, 0, 0], back[:, 0, 0, 1], back[:, 0, 1, 0], back[:, 0, 1, 1], back[:, 0, 2, 2] = c, s, -s, c, 1.0
    linear = (linear[..., None, :] @ back)[..., 0, :]
    square = np.swapaxes(back, -1, -2) @ square @ back
    # zz = 1 - xx - yy.
    zz = square[..., 2, 2]
    one = h[0] * c0 - h[6] * c3 + zz
    rows = [one, linear[..., 0], linear[..., 1], linear[..., 2], square[..., 0, 0] - zz, square[..., 1, 1] - zz]
    rows += [2.0 * square[..., 0, 1], 2.0 * square[..., 1, 2], 2.0 * square[..., 0, 2]]
    return np.stack(rows, 1)


class StreetBatch:
    """Draws a batch of worlds; holds only their cameras and the poses of their robots' parts.

    Args:
      threads: the batch is drawn in so many pieces, which may run at the same time.
    """

    def __init__(self, streets: Streets, num_worlds: int, threads: int) -> None:
        self.streets, self.num_worlds = streets, num_worlds
        ends = np.linspace(0, num_worlds, min(threads, num_worlds) + 1).astype(int)
        self.pieces = list(zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True))
        parts = streets.num_parts
        self._placed = [wp.zeros(num_worlds * rows, dtype=wp.vec4) for rows in (4, 3 * parts, parts + 1)]
        self._placed.append(wp.zeros(num_worlds * (parts + 1), dtype=int))
        self._moved = wp.full(max(num_worlds * streets.settings.bodies, 1), -1, dtype=int)
        self._unmoved = wp.zeros((num_worlds, 0), dtype=int)
        self.views = Views()
        self.views.cameras, self.views.poses, self.views.balls, self.views.seen = (x.ptr or 0 for x in self._placed)
        self.views.moved = self._moved.ptr or 0
        shades = streets.num_shades
        self._shades = wp.zeros(max(num_worlds * SHADE * shades, 1), dtype=wp.vec4)
        self._shaded = wp.zeros(num_worlds * (shades + 1), dtype=int)
        self.views.shades, self.views.shaded = self._shades.ptr or 0, self._shaded.ptr or 0
        settings = streets.settings
        self._image = settings.width * settings.samples, settings.height * settings.samples
        self._packets = street_packets.num_packets(*self._image)
        self._at_once, self._hits = num_worlds, []
        if streets.cast is not None:
            rays = self._packets * street_packets.LANES
            largest = max(last - first for first, last in self.pieces)
            self._at_once = min(max(1, _RAYS // rays), largest)
            size = self._at_once * rays * street_packets.HIT
            self._hits = [wp.empty(size, dtype=int) for _ in self.pieces]
        if COVERAGE in streets.settings.outputs:
            self._shown = wp.zeros((num_worlds, streets.num_columns), dtype=int)

    def jobs(self, inputs: Sequence[wp.array], outputs: dict[str, wp.array]) -> list[Callable[[], None]]:
        """Launches that draw the pieces of the batch; see `Renderer._render` for the arrays."""
        scene, xpos, xquat, camera_position, turn, fovy, appearance_seeds, *moved = inputs
        s, settings = self.streets, self.streets.settings
        aspect = 1.0 if settings.scan else settings.width / settings.height
        robot = [s.street, s.shapes, s.bodies, xpos, xquat]
        views = [*robot, camera_position, turn, fovy, aspect, NOWHERE, *self._placed]
        elsewhere = [scene, *(moved or [self._unmoved]), s.object_of_slot, self._moved, int(settings.scan is not None)]
        wp.launch(place, dim=self.num_worlds, inputs=[*views, *elsewhere])
        if s.num_shades:
            shades = [s.shade_body, s.shade_box, s.object_boxes, xpos, xquat, camera_position]
            inputs = [s.street, self.views, *shades, self._shades, self._shaded]
            wp.launch(place_shades, dim=self.num_worlds, inputs=inputs)
        kept = [s.street, self.views, scene, s.roots, s.textures, s.skies, s.labels, appearance_seeds]
        out = [outputs[name] for name in ("rgb", "depth", "category", "object", "normal")]
        counted = None
        if COVERAGE in settings.outputs:
            counted = scene, outputs["object"], outputs[COVERAGE]
        return [functools.partial(self._draw, piece, [*kept, *out], counted) for piece in range(len(self.pieces))]

    def _draw(self, piece: int, arguments: list[object], counted: tuple[wp.array, wp.array, wp.array] | None) -> None:
        """Draws the worlds of a piece; counted: scenes, labels and coverage, where that is wanted."""
        s, settings = self.streets, self.streets.settings
        first, last = self.pieces[piece]
        pixels = settings.height * settings.width
        hits = self._hits[piece].ptr or 0 if self._hits else 0
        for begin in range(first, last, self._at_once):
            number = min(self._at_once, last - begin)
            if s.cast is not None:
                street, views, scene, roots = arguments[:4]
                inputs = [begin, *self._image, self._packets, FAR_PLANE, street, views, scene, roots, hits]
                wp.launch(s.cast, dim=(number, self._packets), inputs=inputs)
            inputs = [begin, *arguments, hits]
            wp.launch(s.draw, dim=(number, pixels), inputs=inputs, block_dim=street_draw.BLOCK[0])
        if counted is not None:
            self._count(first, last, *counted)
        self.streets.ready = True

    def _count(self, first: int, last: int, scene: wp.array, labels: wp.array, coverage: wp.array) -> None:
        s, settings, number = self.streets, self.streets.settings, last - first
        counts = number, s.num_columns
        wp.launch(street_coverage.clear, dim=counts, inputs=[first, self._shown, coverage])
        pixels = number, settings.height, settings.width
        inputs = [first, s.object_of_slot.shape[1], labels, self._shown]
        wp.launch(street_coverage.find_shown, dim=pixels, inputs=inputs)
        inputs = [first, s.street, self.views, s.columns, scene, self._shown, coverage]
        wp.launch(s.count, dim=(*counts, settings.height), inputs=inputs)
