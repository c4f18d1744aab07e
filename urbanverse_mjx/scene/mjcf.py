"""Converts `SceneGeometry` to MJCF that stock MuJoCo loads without this package.

Group 2: visual meshes, no contact. Group 3: CoACD hulls of objects and ground prisms. One body per object, named by its
id, static or (movable ones, on request) with a free joint; ground prisms belong to the world.
"""

import functools
import io
import struct
from collections.abc import Sequence
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
from PIL import Image

from .. import srgb
from ..datatypes import AssetMesh
from .geometry import SceneGeometry, Sky
from .hulls import convex_part

#: Physics step, s. Sphere wheels jump by 12 mm on oblique seams at 20 ms, and by 0.6 mm at 10 ms
#: (docs/sources/measured.md).
TIMESTEP = 0.01
#: Side of a face of the skybox, pixels.
_SKY_FACE = 64
#: m, near clipping plane of cameras; MuJoCo's default of 1 % of the scene's extent would be a metre in a street.
_NEAR = 0.02
#: The sun's distance from the scene's centre over the scene's extent. MuJoCo draws the shadows of a directional light
#: within one extent of the line through its position, and of nothing behind it.
_SUN_DISTANCE = 1.5
#: Face of MuJoCo's skybox -> directions in the world (z-up) of its centre, of the image's right and of its lower side.
#: As MuJoCo shows them: the faces around are seen from outside, mirrored, and "front" is at -y.
_SKY_FACES = {
    "right": ((1, 0, 0), (0, 1, 0), (0, 0, -1)),
    "left": ((-1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "up": ((0, 0, 1), (1, 0, 0), (0, -1, 0)),
    "down": ((0, 0, -1), (1, 0, 0), (0, 1, 0)),
    "front": ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    "back": ((0, 1, 0), (-1, 0, 0), (0, 0, -1)),
}


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    """Shortest text that is parsed to the same float32 numbers."""
    return " ".join(np.ravel(values).astype(np.float32).astype("U16").tolist())


def scene_mjcf(
    scene: SceneGeometry, sky: Sky | None = None, visuals: bool = True, free: bool = False, comment: str = ""
) -> tuple[str, dict[str, bytes]]:
    """Converts the scene to MJCF text and the files that it references.

    Args:
      sky: defines the skybox and the sun; without it there is no light.
      visuals: whether to include visual meshes, which do not affect physics.
      free: whether movable objects have a free joint; otherwise all objects are fixed to the world.
      comment: comment in the first line of the file; must not contain "--", which XML forbids.

    Returns:
      XML, and file contents by path relative to it (`meshes/`, `textures/`).
    """
    root = ET.Element("mujoco", model=scene.scene_id)
    if comment:
        root.append(ET.Comment(f" {comment} "))
    ET.SubElement(root, "compiler", angle="radian", autolimits="true", meshdir="meshes", texturedir="textures")
    ET.SubElement(root, "option", timestep=f"{TIMESTEP:g}", integrator="Euler")
    center, extent = _extent(scene)
    statistic = {"center": _numbers(center), "extent": _numbers([extent])}
    ET.SubElement(root, "statistic", statistic)
    asset, world = ET.SubElement(root, "asset"), ET.SubElement(root, "worldbody")
    files: dict[str, bytes] = {}
    if sky is not None:
        files |= _add_sky(root, asset, world, scene, sky)
    used = np.unique(np.concatenate([scene.inst_hull, scene.prism_hull]))
    for i in used:
        ET.SubElement(asset, "mesh", name=f"hull_{i}", vertex=_numbers(scene.hulls[i]), inertia="convex")
    if visuals:
        files |= _add_meshes(asset, scene)
    _add_ground(world, scene, visuals)
    _add_objects(world, scene, visuals, free)
    ET.indent(root, " ")
    return ET.tostring(root, encoding="unicode") + "\n", files


def scene_spec(scene: SceneGeometry, sky: Sky | None = None, visuals: bool = False) -> mujoco.MjSpec:
    """The same scene as an `MjSpec` in memory; a robot can be attached to it."""
    text, files = scene_mjcf(scene, sky, visuals)
    # MjSpec finds files by their names without folders.
    return mujoco.MjSpec.from_string(text, assets={path.split("/")[-1]: body for path, body in files.items()})


def _extent(scene: SceneGeometry) -> tuple[np.ndarray, float]:
    corners = [p + scene.hulls[h] for p, h in zip(scene.prism_position, scene.prism_hull, strict=True)]
    low, high = np.min([c.min(0) for c in corners], 0), np.max([c.max(0) for c in corners], 0)
    return (low + high) / 2, float(np.linalg.norm(high - low) / 2)


def _add_ground(world: ET.Element, scene: SceneGeometry, visuals: bool) -> None:
    counts: dict[int, int] = {}
    for hull, position, region, friction in zip(
        scene.prism_hull, scene.prism_position, scene.prism_region, scene.prism_friction, strict=True
    ):
        number = counts[int(region)] = counts.get(int(region), -1) + 1
        name = f"ground/{scene.region_ids[region]}/{number}"
        ET.SubElement(world, "geom", _hull_geom(name, hull, friction, 0.0) | {"pos": _numbers(position)})
    if visuals:
        for name, mesh, position in zip(scene.region_ids, scene.region_mesh, scene.region_position, strict=True):
            ET.SubElement(world, "geom", _visual_geom(f"ground/{name}", mesh) | {"pos": _numbers(position)})


def _add_objects(world: ET.Element, scene: SceneGeometry, visuals: bool, free: bool) -> None:
    volumes = np.array([convex_part(scene.hulls[h]).volume for h in scene.inst_hull])
    for o, name in enumerate(scene.object_ids):
        body = ET.SubElement(
            world,
            "body",
            name=name,
            pos=_numbers(scene.object_position[o]),
            quat=_numbers(scene.object_quaternion[o]),
        )
        if free and scene.object_movable[o]:
            ET.SubElement(body, "freejoint", name=name)
        rows = np.flatnonzero(scene.inst_object == o)
        shares = volumes[rows] / volumes[rows].sum() * scene.object_mass[o]
        for number, (row, mass) in enumerate(zip(rows, shares, strict=True)):
            geom = _hull_geom(f"{name}/hull_{number}", scene.inst_hull[row], scene.object_friction[o], mass)
            ET.SubElement(body, "geom", geom)
        if visuals:
            ET.SubElement(body, "geom", _visual_geom(f"{name}/visual", scene.object_mesh[o]))


def _hull_geom(name: str, hull: int, friction: float, mass: float) -> dict[str, str]:
    # Torsional and rolling friction at MuJoCo's defaults.
    slide = f"{_numbers([friction])} 0.005 0.0001"
    return {
        "name": name,
        "type": "mesh",
        "mesh": f"hull_{hull}",
        "group": "3",
        "friction": slide,
        "mass": _numbers([mass]),
        "rgba": "0.6 0.6 0.6 1",
    }


def _visual_geom(name: str, mesh: int) -> dict[str, str]:
    return {
        "name": name,
        "type": "mesh",
        "mesh": f"visual_{mesh}",
        "material": f"visual_{mesh}",
        "group": "2",
        "contype": "0",
        "conaffinity": "0",
        "mass": "0",
    }


def _add_meshes(asset: ET.Element, scene: SceneGeometry) -> dict[str, bytes]:
    files: dict[str, bytes] = {}
    textures: dict[bytes, str] = {}
    for i in np.unique(np.concatenate([scene.object_mesh, scene.region_mesh])):
        mesh = scene.meshes[i]
        files[f"meshes/visual_{i}.msh"] = msh_bytes(mesh)
        ET.SubElement(asset, "mesh", name=f"visual_{i}", file=f"visual_{i}.msh", inertia="shell")
        image = mesh.texture.tobytes()
        if image not in textures:
            textures[image] = name = f"texture_{len(textures)}"
            files[f"textures/{name}.png"] = png_bytes(mesh.texture)
            ET.SubElement(asset, "texture", name=name, type="2d", file=f"{name}.png")
        shine = 1.0 - mesh.roughness
        ET.SubElement(
            asset,
            "material",
            name=f"visual_{i}",
            texture=textures[image],
            roughness=_numbers([mesh.roughness]),
            metallic=_numbers([mesh.metallic]),
            specular=_numbers([0.5 * shine]),
            shininess=_numbers([shine]),
        )
    return files


def msh_bytes(mesh: AssetMesh) -> bytes:
    """MuJoCo's binary mesh: counts, then positions, texture coordinates and faces (float32 is kept exactly).

    MuJoCo's texture coordinates begin at the image's top row, those of `VisualMesh` at the lowest.
    """
    uv = np.column_stack([mesh.uv[:, 0], 1.0 - mesh.uv[:, 1]]).astype("<f4")
    head = struct.pack("<4i", len(mesh.vertices), 0, len(uv), len(mesh.faces))
    return head + mesh.vertices.astype("<f4").tobytes() + uv.tobytes() + mesh.faces.astype("<i4").tobytes()


def png_bytes(pixels: np.ndarray) -> bytes:
    """(H, W, 3) uint8 as PNG."""
    return _png_bytes(pixels.tobytes(), pixels.shape[0], pixels.shape[1])


# Cached, because a scene's MJCF, its USD and further cousins use the same textures.
@functools.lru_cache(maxsize=512)
def _png_bytes(content: bytes, height: int, width: int) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(np.frombuffer(content, np.uint8).reshape(height, width, 3)).save(buffer, "PNG", compress_level=4)
    return buffer.getvalue()


def _add_sky(
    root: ET.Element, asset: ET.Element, world: ET.Element, scene: SceneGeometry, sky: Sky
) -> dict[str, bytes]:
    files = {}
    names = {}
    for face, axes in _SKY_FACES.items():
        files[f"textures/sky_{face}.png"] = png_bytes(_sky_face(sky.radiance, scene.sky_yaw, axes))
        names[f"file{face}"] = f"sky_{face}.png"
    ET.SubElement(asset, "texture", {"name": "sky", "type": "skybox", **names})
    # MuJoCo adds display values, whereas radiance is linear. The ambient light is the sky's display value; the sun's is
    # the difference to that of sky and sun together.
    rows = (np.arange(len(sky.radiance)) + 0.5) / len(sky.radiance) * np.pi
    weight = np.where(rows < np.pi / 2, np.cos(rows) * np.sin(rows), 0.0)
    shade = (sky.radiance.mean(1) * weight[:, None]).sum(0) / weight.sum()
    ambient = srgb.encoded(shade)
    sun = srgb.encoded(shade + np.asarray(sky.sun_irradiance) / np.pi) - ambient
    c, s = np.cos(scene.sky_yaw), np.sin(scene.sky_yaw)
    x, y, z = sky.sun_direction
    to_sun = np.array([c * x - s * y, s * x + c * y, z])
    center, extent = _extent(scene)
    ET.SubElement(
        world,
        "light",
        name="sun",
        type="directional",
        dir=_numbers(-to_sun),
        pos=_numbers(center + _SUN_DISTANCE * extent * to_sun),
        diffuse=_numbers(sun),
        ambient="0 0 0",
        specular="0.2 0.2 0.2",
        castshadow="true",
    )
    visual = ET.SubElement(root, "visual")
    ET.SubElement(visual, "headlight", ambient=_numbers(ambient), diffuse="0 0 0", specular="0 0 0")
    ET.SubElement(visual, "global", offwidth="1920", offheight="1080")
    ET.SubElement(visual, "quality", shadowsize="8192")
    ET.SubElement(visual, "map", znear=_numbers([_NEAR / extent]))
    return files


def _sky_face(radiance: np.ndarray, yaw: float, axes: Sequence[Sequence[int]]) -> np.ndarray:
    """One (F, F, 3) uint8 sRGB face of the skybox."""
    middle, right, down = (np.array(a, np.float64) for a in axes)
    step = (np.arange(_SKY_FACE) + 0.5) / _SKY_FACE * 2 - 1
    ray = middle + step[None, :, None] * right + step[:, None, None] * down
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    height, width = radiance.shape[:2]
    azimuth = np.arctan2(ray[..., 1], ray[..., 0]) - yaw
    column = np.floor(((azimuth + np.pi) / (2 * np.pi) % 1.0) * width).astype(int) % width
    row = np.minimum((np.arccos(np.clip(ray[..., 2], -1, 1)) / np.pi * height).astype(int), height - 1)
    return np.round(srgb.encoded(radiance[row, column]) * 255).astype(np.uint8)
