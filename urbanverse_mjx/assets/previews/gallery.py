"""Renders images of assets with MuJoCo: a tile per leaf with its variants, and contact sheets."""

import contextlib
import os
import pathlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import mujoco
import numpy as np
from PIL import Image

from urbanverse_mjx.datatypes import AssetMesh, ValidationError
from urbanverse_mjx.datatypes.validation import write_atomically

from ...geometry import rotations
from ..categories import ontology
from ..meshes import paint
from ..records.index import AssetIndex, build_mesh

LABEL_HEIGHT = 22  # pixels
ELEVATION = 14.0  # degrees, of the camera over the horizon
#: Height over length below which a leaf (courts, crossings, knives) is seen from a higher elevation on a sheet, and
#: that elevation in degrees.
MAX_FLAT_ASPECT, FLAT_ELEVATION = 0.2, 42.0


def scene_of(meshes: Sequence[AssetMesh], yaw: float = 0.0, gap: float = 0.12) -> tuple[mujoco.MjModel, np.ndarray]:
    """A model with meshes in a row along y on a grey floor.

    Args:
      meshes: at least one.
      yaw: rad, rotation of each mesh about its own z.
      gap: space between two meshes, as a share of the widest one, and at least half that share of the highest one.

    Returns:
      the model, and (2, 3) least and greatest corner of the row, m.
    """
    spec = mujoco.MjSpec()
    spec.visual.headlight.ambient = [0.42, 0.42, 0.42]
    spec.visual.headlight.diffuse = [0.25, 0.25, 0.25]
    spec.visual.headlight.specular = [0.0, 0.0, 0.0]
    spec.visual.quality.shadowsize = 2048
    spec.visual.quality.offsamples = 8
    spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=[-0.5, 0.45, -1.0], diffuse=[0.62, 0.6, 0.56], castshadow=True
    )
    # Without gloss, because highlights would show the edges of the plane's few, large faces.
    spec.add_material(name="floor", rgba=[0.62, 0.64, 0.66, 1], specular=0.0, shininess=0.0)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], material="floor")
    # The row runs from left to right in the image of the camera on the +x side: along +y; every mesh is rotated
    # separately.
    turned = [_turned_box(m, yaw) for m in meshes]
    step = gap * max(max(high[1] - low[1], 0.5 * (high[2] - low[2])) for low, high in turned)
    y = 0.0
    for k, (mesh, (low, high)) in enumerate(zip(meshes, turned, strict=True)):
        _add_visual(spec, f"asset{k}", mesh, (0.0, y - low[1], 0.0), yaw)
        y += high[1] - low[1] + step
    corners = np.array([(min(b[0][0] for b in turned), 0, 0), (max(b[1][0] for b in turned), y - step, 0)])
    corners[1, 2] = max(float(m.extent[2]) for m in meshes)
    return spec.compile(), corners


def _turned_box(mesh: AssetMesh, yaw: float) -> tuple[np.ndarray, np.ndarray]:
    points = mesh.vertices @ rotations.about_z(-yaw)
    return points.min(0), points.max(0)


def _add_visual(spec: mujoco.MjSpec, name: str, mesh: AssetMesh, position: Sequence[float], yaw: float) -> None:
    height, width = mesh.texture.shape[:2]
    texture = spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, width=width, height=height, nchannel=3)
    texture.data = mesh.texture.tobytes()
    material = spec.add_material(name=name, specular=0.5 * (1 - mesh.roughness), shininess=1 - mesh.roughness)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    # The v axis of MuJoCo begins at the first row of the image, that of `AssetMesh` at the last.
    uv = mesh.uv * np.array([1.0, -1.0], np.float32) + np.array([0.0, 1.0], np.float32)
    spec.add_mesh(
        name=name,
        uservert=mesh.vertices.ravel(),
        userface=mesh.faces.ravel(),
        usertexcoord=uv.ravel(),
        userfacetexcoord=mesh.faces.ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        material=name,
        pos=position,
        quat=rotations.from_yaw(yaw),
        contype=0,
        conaffinity=0,
    )


def render_row(
    meshes: Sequence[AssetMesh], size: tuple[int, int], yaw_deg: float = -32.0, elevation_deg: float = ELEVATION
) -> np.ndarray:
    """An image of meshes side by side, seen obliquely from the front.

    Args:
      size: (width, height) pixels.
      yaw_deg: rotation of each mesh away from the camera.
      elevation_deg: elevation of the camera above the horizon.

    Returns:
      (height, width, 3) uint8.
    """
    with _seen(meshes, size, yaw_deg, elevation_deg) as renderer:
        return renderer.render()


def render_masked(mesh: AssetMesh, size: tuple[int, int], yaw_deg: float = -32.0) -> tuple[np.ndarray, np.ndarray]:
    """An image of one mesh, (height, width, 3) uint8, and the mask of the mesh in it, (height, width) bool."""
    with _seen([mesh], size, yaw_deg) as renderer:
        image = renderer.render()
        renderer.enable_segmentation_rendering()
        geom = renderer.render()[:, :, 0]
    return image, geom == 1  # the floor is geom 0


@contextlib.contextmanager
def _seen(
    meshes: Sequence[AssetMesh], size: tuple[int, int], yaw_deg: float, elevation_deg: float = ELEVATION
) -> Iterator[mujoco.Renderer]:
    """A renderer of meshes in a row."""
    model, bounds = scene_of(meshes, np.radians(yaw_deg))
    model.vis.global_.fovy = 20.0
    width, height = size
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    camera = mujoco.MjvCamera()
    camera.azimuth, camera.elevation = 180.0, -elevation_deg
    camera.lookat = bounds.mean(0)
    camera.distance = _distance(bounds, camera, np.radians(model.vis.global_.fovy), width / height)
    model.vis.map.znear = 0.02 / max(model.stat.extent, 1e-3)
    model.vis.map.zfar = 10 * (camera.distance + 10) / model.stat.extent
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with mujoco.Renderer(model, height, width) as renderer:
        renderer.update_scene(data, camera)
        yield renderer


def _distance(bounds: np.ndarray, camera: mujoco.MjvCamera, fovy: float, aspect: float) -> float:
    """Distance at which the box just fits into the image, m."""
    azimuth, elevation = np.radians(camera.azimuth), np.radians(camera.elevation)
    forward = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    corners = np.array([[bounds[i, 0], bounds[j, 1], bounds[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    offset = corners - bounds.mean(0)
    tangent = np.tan(fovy / 2)
    across = np.abs(offset @ right) / (tangent * aspect)
    up = np.abs(offset @ np.cross(right, forward)) / tangent
    return float((np.maximum(across, up) - offset @ forward).max() * 1.06)


def leaf_tile(name: str, meshes: Sequence[AssetMesh], size: tuple[int, int]) -> Image.Image:
    """A row of a leaf's variants with a name underneath."""
    width, height = size
    tile, pen = paint.canvas(size, "white")
    flat = all(m.extent[2] < MAX_FLAT_ASPECT * max(m.extent[:2]) for m in meshes)
    elevation = FLAT_ELEVATION if flat else ELEVATION
    row = render_row(meshes, (width, height - LABEL_HEIGHT), elevation_deg=elevation)
    tile.paste(Image.fromarray(row), (0, 0))
    paint.text(pen, name, (4, height - LABEL_HEIGHT + 3, width - 4, height - 5), "black", limit=14)
    return tile


def contact_sheet(
    index: AssetIndex,
    path: str | os.PathLike[str],
    names: Mapping[str, str],
    columns: int,
    tile: tuple[int, int] = (340, 200),
    variants: int = 4,
    progress: Callable[[Sequence[str]], Iterable[str]] = iter,
) -> pathlib.Path:
    """Writes one PNG with a tile for each of the given leaves, in their order.

    Args:
      path: PNG to write.
      names: leaf -> caption of its tile.
      columns: tiles in a row.
      tile: (width, height) of a tile in pixels.
      variants: largest number of base shapes in a tile.
      progress: wraps the list of leaves, e.g. in a progress bar.
    """
    rows = -(-len(names) // columns)
    sheet = Image.new("RGB", (columns * tile[0], rows * tile[1]), "white")
    for k, leaf in enumerate(progress(list(names))):
        meshes = [build_mesh(r) for r in index.by_leaf(leaf)[:variants]]
        sheet.paste(leaf_tile(names[leaf], meshes, tile), ((k % columns) * tile[0], (k // columns) * tile[1]))
    # Six bits per channel reduce the size of the file; a palette of 256 colours would distort greens.
    reduced = Image.fromarray(np.asarray(sheet) // 4 * 4 + 2)
    return write_atomically(path, lambda p: reduced.save(p, optimize=True))


def middle_sheets(
    index: AssetIndex,
    folder: str | os.PathLike[str],
    middles: Sequence[str] | None = None,
    progress: Callable[[Sequence[str]], Iterable[str]] = iter,
) -> list[pathlib.Path]:
    """Writes a contact sheet per middle category (59 of them, or those given) that has leaves with shapes.

    Args:
      folder: folder for the files `<top>-<middle>.png`.
      progress: wraps the list of categories, e.g. in a progress bar.

    Raises:
      ValidationError: no such middle category.
    """
    leaves: dict[str, list[str]] = {}
    tops: dict[str, str] = {}
    for leaf, (top, middle, _) in ontology.categories().items():
        tops[middle] = top
        if index.by_leaf(leaf):
            leaves.setdefault(middle, []).append(leaf)
    stray = [name for name in middles or () if name not in tops]
    if stray:
        raise ValidationError(f"middle category: found {stray[0]!r}, needed one of {', '.join(tops)}.")
    paths = []
    for middle in progress([name for name in middles or tops if name in leaves]):
        path = pathlib.Path(folder) / f"{tops[middle]}-{middle}.png".replace(" ", "_")
        names = {leaf: leaf for leaf in sorted(leaves[middle])}
        paths.append(contact_sheet(index, path, names, columns=min(4, len(names))))
    return paths


def overview_leaves(index: AssetIndex) -> dict[str, str]:
    """leaf -> name of its middle category and its own: of every middle category the leaf with the most records that
    has base shapes."""
    best: dict[str, tuple[int, str]] = {}
    for middles in ontology.tree().values():
        for middle, counts in middles.items():
            known = [(-count, leaf) for leaf, count in counts.items() if index.by_leaf(leaf)]
            if known:
                best[middle] = min(known)
    return {leaf: f"{middle}: {leaf}" for middle, (_, leaf) in best.items()}
