"""Common parts of USD stages: the stage itself, meshes, surfaces, physics materials, mass.

Stages are z up, in metres and kilograms, as Isaac Sim requires.
"""

import importlib.util
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, ValidationError

from ..collision.rigid_body import RigidBody, convex_surface


def new_stage(path: pathlib.Path, root: str) -> tuple[Any, Any]:
    """A stage (`.usda` or `.usdc`) with its units, and its default prim, an Xform at `root`.

    Raises:
      ValidationError: usd-core is not installed.
    """
    if importlib.util.find_spec("pxr") is None:
        raise ValidationError("USD: found no module named pxr, needed usd-core; `pip install usd-core`.")
    from pxr import Usd, UsdGeom, UsdPhysics

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    top = UsdGeom.Xform.Define(stage, root)
    stage.SetDefaultPrim(top.GetPrim())
    return stage, top


def add_mesh(stage: Any, where: str, vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray | None = None) -> Any:
    """A triangle mesh: (V, 3) m, (F, 3), and (V, 2) texture coordinates or None."""
    from pxr import Sdf, UsdGeom, Vt

    shape = UsdGeom.Mesh.Define(stage, where)
    points = np.ascontiguousarray(vertices, np.float32)
    shape.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    shape.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
    shape.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(faces, np.int32).ravel()))
    shape.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    shape.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(0), points.max(0)])))
    if uv is not None:
        types = Sdf.ValueTypeNames
        st = UsdGeom.PrimvarsAPI(shape).CreatePrimvar("st", types.TexCoord2fArray, UsdGeom.Tokens.vertex)
        st.Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(uv, np.float32)))
    return shape


def add_surface(stage: Any, where: str, mesh: AssetMesh, texture_file: str) -> Any:
    """A UsdPreviewSurface with the mesh's roughness and a texture, a file relative to the stage."""
    from pxr import Sdf, UsdShade

    types = Sdf.ValueTypeNames
    material = UsdShade.Material.Define(stage, where)
    reader = UsdShade.Shader.Define(stage, f"{where}/st")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", types.String).Set("st")
    image = UsdShade.Shader.Define(stage, f"{where}/texture")
    image.CreateIdAttr("UsdUVTexture")
    image.CreateInput("file", types.Asset).Set(Sdf.AssetPath(f"./{texture_file}"))
    image.CreateInput("sourceColorSpace", types.Token).Set("sRGB")
    for side in ("wrapS", "wrapT"):
        image.CreateInput(side, types.Token).Set("repeat")
    image.CreateInput("st", types.Float2).ConnectToSource(reader.CreateOutput("result", types.Float2))
    shader = UsdShade.Shader.Define(stage, f"{where}/preview")
    shader.CreateIdAttr("UsdPreviewSurface")
    colour = image.CreateOutput("rgb", types.Float3)
    shader.CreateInput("diffuseColor", types.Color3f).ConnectToSource(colour)
    shader.CreateInput("roughness", types.Float).Set(mesh.roughness)
    shader.CreateInput("metallic", types.Float).Set(mesh.metallic)
    material.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("surface", types.Token))
    return material


def bind(shape: Any, material: Any) -> None:
    """Binds a surface to a mesh."""
    from pxr import UsdShade

    UsdShade.MaterialBindingAPI.Apply(shape.GetPrim()).Bind(material)


def add_contact(stage: Any, where: str, friction: float, restitution: float) -> Any:
    """A physics material with equal static and dynamic friction.

    PhysX takes the smaller coefficient of two such materials, the rule of `friction="materials"` (its default is their
    mean). Its schema is no part of usd-core, so its name and attribute are written as they are.
    """
    from pxr import Sdf, UsdPhysics, UsdShade

    material = UsdShade.Material.Define(stage, where)
    contact = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    contact.CreateStaticFrictionAttr(friction)
    contact.CreateDynamicFrictionAttr(friction)
    contact.CreateRestitutionAttr(restitution)
    material.GetPrim().AddAppliedSchema("PhysxMaterialAPI")
    combine = material.GetPrim().CreateAttribute("physxMaterial:frictionCombineMode", Sdf.ValueTypeNames.Token, False)
    combine.Set("min")
    return material


def add_colliders(stage: Any, where: str, hulls: Sequence[np.ndarray], contact: Any | None) -> list[Any]:
    """Convex colliders `where`/hull_0 ... of (n, 3) corners, bound to a physics material where one is given."""
    from pxr import UsdGeom, UsdPhysics

    shapes = UsdGeom.Xform.Define(stage, where)
    shapes.CreatePurposeAttr(UsdGeom.Tokens.guide)
    added = []
    for k, corners in enumerate(hulls):
        solid = convex_surface(corners)
        hull = add_mesh(stage, f"{where}/hull_{k}", solid.vertices, solid.faces)
        UsdPhysics.CollisionAPI.Apply(hull.GetPrim())
        UsdPhysics.MeshCollisionAPI.Apply(hull.GetPrim()).CreateApproximationAttr(UsdPhysics.Tokens.convexHull)
        if contact is not None:
            bind_contact(hull, contact)
        added.append(hull)
    return added


def bind_contact(shape: Any, contact: Any) -> None:
    """Binds a physics material to a collider, or to all colliders below a prim."""
    from pxr import UsdShade

    strength = UsdShade.Tokens.weakerThanDescendants
    UsdShade.MaterialBindingAPI.Apply(shape.GetPrim()).Bind(contact, strength, "physics")


def add_body(root: Any, solid: RigidBody, movable: bool) -> None:
    """A rigid body with its mass; an immovable object is kinematic: it keeps its mass and its pose."""
    from pxr import Gf, UsdPhysics

    body = UsdPhysics.RigidBodyAPI.Apply(root.GetPrim())
    if not movable:
        body.CreateKinematicEnabledAttr(True)
    moments, axes = solid.principal
    quaternion = Gf.Matrix3d(*axes.T.ravel().tolist()).ExtractRotation().GetQuat()
    mass = UsdPhysics.MassAPI.Apply(root.GetPrim())
    mass.CreateMassAttr(solid.mass)
    mass.CreateCenterOfMassAttr(Gf.Vec3f(*solid.centre.tolist()))
    mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments.tolist()))
    mass.CreatePrincipalAxesAttr(Gf.Quatf(quaternion))
