"""Exports a scene as USD for Isaac Sim: rigid bodies with mass and friction, convex colliders, ground, light of the
sky.

z up, metres, kilograms; `/World` is the default prim. Each distinct asset is stored once as a class below
`/World/Assets`, which its objects reference.
"""

import os
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..assets.collision.rigid_body import even_body
from ..assets.exporting import usd_parts
from ..datatypes import validation as v
from ..work_folder import MADE, replacing_folder
from .geometry import SceneGeometry, Sky
from .mjcf import png_bytes

#: File names of the stage and of the sky in the folder.
STAGE, SKY = "scene.usdc", "sky.hdr"
#: Intensity for a radiance of 1, at which a white surface in the open is nearly white: Isaac Sim's default light.
INTENSITY = 1000.0
#: Angle of the sun's disc, degrees.
SUN_ANGLE = 0.53
GRAVITY = 9.81  # m/s^2
#: Restitution of ground and objects: stone to plastic (`assets.exporting.export_usd.UNKNOWN_BOUNCINESS`).
RESTITUTION = 0.3


def export_usd(scene: SceneGeometry, sky: Sky, folder: str | os.PathLike[str]) -> pathlib.Path:
    """Writes a folder with `scene.usdc`, its textures and the sky atomically; returns the stage's path.

    Raises:
      ValidationError: usd-core is not installed, or the folder holds other files but no exported scene.
    """
    folder = pathlib.Path(folder)
    exported = (folder / STAGE).is_file() or (folder / MADE).is_file()
    if folder.is_dir() and not exported and any(folder.iterdir()):
        raise v.fail(str(folder), "a folder with other files", "a new name or an exported scene", "choose another")
    with replacing_folder(folder) as work:
        (work / "textures").mkdir()
        _write(scene, sky, work)
    return folder / STAGE


def _write(scene: SceneGeometry, sky: Sky, folder: pathlib.Path) -> None:
    stage, world = usd_parts.new_stage(folder / STAGE, "/World")
    from pxr import Gf, Kind, Usd, UsdGeom, UsdPhysics

    Usd.ModelAPI(world).SetKind(Kind.Tokens.assembly)
    Usd.ModelAPI(world).SetAssetName(scene.scene_id)
    physics = UsdPhysics.Scene.Define(stage, "/World/PhysicsScene")
    physics.CreateGravityDirectionAttr(Gf.Vec3f(0.0, 0.0, -1.0))
    physics.CreateGravityMagnitudeAttr(GRAVITY)
    UsdGeom.Scope.Define(stage, "/World/Looks")
    surfaces = _Surfaces(stage, scene, folder)
    _add_ground(stage, scene, surfaces)
    _add_objects(stage, scene, surfaces)
    _add_light(stage, scene, sky, folder)
    stage.GetRootLayer().Save()


class _Surfaces:
    """Materials of meshes and physics materials, each written once."""

    def __init__(self, stage: Any, scene: SceneGeometry, folder: pathlib.Path) -> None:
        self._stage, self._meshes, self._folder = stage, scene.meshes, folder
        self._textures: dict[bytes, str] = {}
        self._surfaces: dict[tuple[str, float, float], Any] = {}
        self._contacts: dict[float, Any] = {}

    def surface(self, mesh: int) -> Any:
        """The visual material of a mesh."""
        shown = self._meshes[mesh]
        key = shown.texture.tobytes()
        if key not in self._textures:
            self._textures[key] = name = f"textures/texture_{len(self._textures)}.png"
            (self._folder / name).write_bytes(png_bytes(shown.texture))
        kind = (self._textures[key], shown.roughness, shown.metallic)
        if kind not in self._surfaces:
            where = f"/World/Looks/surface_{len(self._surfaces)}"
            self._surfaces[kind] = usd_parts.add_surface(self._stage, where, shown, kind[0])
        return self._surfaces[kind]

    def contact(self, friction: float) -> Any:
        """The physics material of a friction coefficient."""
        if friction not in self._contacts:
            where = f"/World/Looks/contact_{len(self._contacts)}"
            self._contacts[friction] = usd_parts.add_contact(self._stage, where, friction, RESTITUTION)
        return self._contacts[friction]


def _add_ground(stage: Any, scene: SceneGeometry, surfaces: _Surfaces) -> None:
    from pxr import UsdGeom

    UsdGeom.Xform.Define(stage, "/World/Ground")
    for number, name in enumerate(_names(scene.region_ids)):
        where = f"/World/Ground/{name}"
        UsdGeom.Xform.Define(stage, where)
        mesh = scene.meshes[scene.region_mesh[number]]
        at = scene.region_position[number]
        shape = usd_parts.add_mesh(stage, f"{where}/visual", mesh.vertices + at, mesh.faces, mesh.uv)
        usd_parts.bind(shape, surfaces.surface(int(scene.region_mesh[number])))
        rows = np.flatnonzero(scene.prism_region == number)
        if len(rows):
            prisms = [scene.hulls[scene.prism_hull[p]] + scene.prism_position[p] for p in rows]
            contact = surfaces.contact(round(float(scene.prism_material_friction[rows[0]]), 4))
            usd_parts.add_colliders(stage, f"{where}/collision", prisms, contact)


def _add_objects(stage: Any, scene: SceneGeometry, surfaces: _Surfaces) -> None:
    from pxr import Gf, Sdf, UsdGeom

    stage.CreateClassPrim("/World/Assets")
    UsdGeom.Xform.Define(stage, "/World/Objects")
    for number, name in enumerate(_names(scene.object_ids)):
        mesh = int(scene.object_mesh[number])
        hulls = [scene.hulls[h] for h in scene.inst_hull[scene.inst_object == number]]
        asset = f"/World/Assets/asset_{mesh}"
        if not stage.GetPrimAtPath(asset):
            _add_asset(stage, asset, scene, mesh, hulls, surfaces)
        body = UsdGeom.Xform.Define(stage, f"/World/Objects/{name}")
        prim = body.GetPrim()
        prim.GetReferences().AddInternalReference(Sdf.Path(asset))
        prim.SetCustomDataByKey("urbanverse:id", scene.object_ids[number])
        prim.SetCustomDataByKey("urbanverse:category", scene.object_categories[number])
        body.AddTranslateOp().Set(Gf.Vec3d(*scene.object_position[number].tolist()))
        w, *xyz = scene.object_quaternion[number].tolist()
        body.AddOrientOp().Set(Gf.Quatf(w, Gf.Vec3f(*xyz)))
        solid = even_body(float(scene.object_mass[number]), scene.meshes[mesh], hulls)
        usd_parts.add_body(body, solid, bool(scene.object_movable[number]))
        usd_parts.bind_contact(body, surfaces.contact(round(float(scene.object_friction[number]), 4)))


def _add_asset(
    stage: Any, where: str, scene: SceneGeometry, mesh: int, hulls: Sequence[np.ndarray], surfaces: _Surfaces
) -> None:
    from pxr import UsdGeom

    UsdGeom.Xform.Define(stage, where)
    shown = scene.meshes[mesh]
    shape = usd_parts.add_mesh(stage, f"{where}/visual", shown.vertices, shown.faces, shown.uv)
    usd_parts.bind(shape, surfaces.surface(mesh))
    usd_parts.add_colliders(stage, f"{where}/collision", hulls, None)


def _add_light(stage: Any, scene: SceneGeometry, sky: Sky, folder: pathlib.Path) -> None:
    """Adds the panorama as dome light and the sun as distant light.

    In a dome light's latitude-longitude image the middle column is the direction +z, columns run towards -x, and +y is
    up (UsdLux, OpenEXR). After a rotation by 90° about x the middle is -y and columns run clockwise seen from above;
    ours run counter-clockwise with the middle along +x: mirrored, and turned by 90° about z, they agree.
    """
    from pxr import Gf, Sdf, UsdLux

    (folder / SKY).write_bytes(hdr_bytes(sky.radiance[:, ::-1]))
    dome = UsdLux.DomeLight.Define(stage, "/World/Sky")
    dome.CreateTextureFileAttr(Sdf.AssetPath(f"./{SKY}"))
    dome.CreateTextureFormatAttr(UsdLux.Tokens.latlong)
    dome.CreateIntensityAttr(INTENSITY)
    dome.AddRotateZOp().Set(float(np.degrees(scene.sky_yaw)) + 90.0)
    dome.AddRotateXOp().Set(90.0)
    irradiance = np.asarray(sky.sun_irradiance, np.float64)
    strongest = float(irradiance.max())
    if strongest <= 0.0:
        return
    sun = UsdLux.DistantLight.Define(stage, "/World/Sun")
    sun.CreateAngleAttr(SUN_ANGLE)
    sun.CreateNormalizeAttr(True)  # the intensity is then the irradiance of a surface that faces the sun
    sun.CreateIntensityAttr(INTENSITY * strongest)
    sun.CreateColorAttr(Gf.Vec3f(*(irradiance / strongest).tolist()))
    x, y, z = np.asarray(sky.sun_direction, np.float64)
    # Light is emitted along the prim's -z, which is rotated by the sun's zenith angle and then to its azimuth.
    sun.AddRotateZOp().Set(float(np.degrees(np.arctan2(y, x) + scene.sky_yaw)))
    sun.AddRotateYOp().Set(float(np.degrees(np.arccos(np.clip(z, -1.0, 1.0)))))


def hdr_bytes(radiance: np.ndarray) -> bytes:
    """Encodes (H, W, 3) linear radiance as an uncompressed Radiance image (.hdr) with 8-bit mantissas and a common
    exponent per pixel.

    The format: G. Ward, "Real Pixels", Graphics Gems II, 1991.
    """
    height, width = radiance.shape[:2]
    mantissa, exponent = np.frexp(np.asarray(radiance, np.float64).max(-1))
    scale = np.where(mantissa > 0, np.ldexp(256.0, -exponent), 0.0)
    pixels = np.zeros((height, width, 4), np.uint8)
    pixels[..., :3] = np.clip(np.floor(radiance * scale[..., None]), 0, 255)
    pixels[..., 3] = np.where(mantissa > 0, exponent + 128, 0)
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    return head.encode("ascii") + pixels.tobytes()


def _names(ids: Sequence[str]) -> list[str]:
    """Valid and unique USD names for ids."""
    from pxr import Tf

    names: list[str] = []
    taken: set[str] = set()
    for text in ids:
        name = base = Tf.MakeValidIdentifier(text)
        number = 2
        while name in taken:
            name, number = f"{base}_{number}", number + 1
        taken.add(name)
        names.append(name)
    return names
