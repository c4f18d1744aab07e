"""An asset as USD: what is seen with UsdPreviewSurface, convex-hull colliders, mass and friction with UsdPhysics."""

import pathlib
from collections.abc import Sequence

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, NounError

from .materials import materials
from .rigid_body import RigidBody, convex_surface, rigid_body

# Restitution where the record's first material is not in the table of materials: that of most rows, stone to plastic.
UNKNOWN_BOUNCINESS = 0.3


def write_usd(
    path: pathlib.Path, record: AssetRecord, mesh: AssetMesh, hulls: Sequence[np.ndarray], texture_file: str
) -> None:
    """Writes a stage (`.usda` or `.usdc`), z up, in metres and kilograms.

    `/asset` is a rigid body with the record's mass, `/asset/visual` is seen, `/asset/collision` holds the hulls,
    `/asset/looks` the materials. What one person cannot move is kinematic: it keeps its mass and its place.

    Args:
      texture_file: PNG, relative to the stage.

    Raises:
      NounError: usd-core is not installed.
    """
    try:
        from pxr import Kind, Usd, UsdGeom, UsdPhysics, Vt
    except ImportError as error:
        raise NounError("USD: found no module named pxr, needed usd-core; `pip install usd-core`.") from error

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, "/asset")
    stage.SetDefaultPrim(root.GetPrim())
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    Usd.ModelAPI(root).SetAssetName(record.uid)
    root.GetPrim().SetMetadata("comment", f"{record.description}. Licence: {record.licence}. {record.provenance}")
    body = UsdPhysics.RigidBodyAPI.Apply(root.GetPrim())
    if not record.movable:
        body.CreateKinematicEnabledAttr(True)
    _add_mass(root, rigid_body(record, mesh, hulls))
    visual = _add_mesh(stage, "/asset/visual", mesh.vertices, mesh.faces)
    st = UsdGeom.PrimvarsAPI(visual).CreatePrimvar("st", _types().TexCoord2fArray, UsdGeom.Tokens.vertex)
    st.Set(Vt.Vec2fArray.FromNumpy(mesh.uv))
    UsdGeom.Scope.Define(stage, "/asset/looks")
    _add_surface(stage, visual, mesh, texture_file)
    contact = _add_contact(stage, record)
    shapes = UsdGeom.Xform.Define(stage, "/asset/collision")
    shapes.CreatePurposeAttr(UsdGeom.Tokens.guide)
    for k, corners in enumerate(hulls):
        solid = convex_surface(corners)
        hull = _add_mesh(stage, f"/asset/collision/hull_{k}", solid.vertices, solid.faces)
        UsdPhysics.CollisionAPI.Apply(hull.GetPrim())
        UsdPhysics.MeshCollisionAPI.Apply(hull.GetPrim()).CreateApproximationAttr(UsdPhysics.Tokens.convexHull)
        contact(hull)
    stage.GetRootLayer().Save()


def _types():
    from pxr import Sdf

    return Sdf.ValueTypeNames


def _add_mesh(stage, where: str, vertices: np.ndarray, faces: np.ndarray):
    from pxr import UsdGeom, Vt

    shape = UsdGeom.Mesh.Define(stage, where)
    points = np.ascontiguousarray(vertices, np.float32)
    shape.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    shape.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
    shape.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(faces, np.int32).ravel()))
    shape.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    shape.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(0), points.max(0)])))
    return shape


def _add_mass(root, solid: RigidBody) -> None:
    from pxr import Gf, UsdPhysics

    moments, axes = solid.principal
    quaternion = Gf.Matrix3d(*axes.T.ravel().tolist()).ExtractRotation().GetQuat()
    mass = UsdPhysics.MassAPI.Apply(root.GetPrim())
    mass.CreateMassAttr(solid.mass)
    mass.CreateCenterOfMassAttr(Gf.Vec3f(*solid.centre.tolist()))
    mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments.tolist()))
    mass.CreatePrincipalAxesAttr(Gf.Quatf(quaternion))


def _add_surface(stage, visual, mesh: AssetMesh, texture_file: str) -> None:
    from pxr import Sdf, UsdShade

    types, where = _types(), "/asset/looks/surface"
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
    UsdShade.MaterialBindingAPI.Apply(visual.GetPrim()).Bind(material)


def _add_contact(stage, record: AssetRecord):
    """Defines the physics material; returns what binds it to a hull."""
    from pxr import UsdPhysics, UsdShade

    material = UsdShade.Material.Define(stage, "/asset/looks/contact")
    contact = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    contact.CreateStaticFrictionAttr(record.friction_coefficient)
    contact.CreateDynamicFrictionAttr(record.friction_coefficient)
    known = materials().get(record.materials[0])
    contact.CreateRestitutionAttr(known.bounciness if known else UNKNOWN_BOUNCINESS)

    def bind(hull) -> None:
        strength = UsdShade.Tokens.weakerThanDescendants
        UsdShade.MaterialBindingAPI.Apply(hull.GetPrim()).Bind(material, strength, "physics")

    return bind
