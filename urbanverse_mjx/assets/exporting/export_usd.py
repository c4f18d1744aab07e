"""An asset as USD: visual meshes with UsdPreviewSurface, convex-hull colliders, mass and friction with UsdPhysics."""

import pathlib
from collections.abc import Sequence

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord

from ..categories.materials import materials
from ..collision.rigid_body import rigid_body
from . import usd_parts

# Restitution where the record's first material is not in the table of materials: that of most rows, stone to plastic.
UNKNOWN_BOUNCINESS = 0.3


def write_usd(
    path: pathlib.Path, record: AssetRecord, mesh: AssetMesh, hulls: Sequence[np.ndarray], texture_file: str
) -> None:
    """Writes a stage (`.usda` or `.usdc`), z up, in metres and kilograms.

    `/asset` is a rigid body with the record's mass, `/asset/visual` is rendered, `/asset/collision` holds the hulls,
    `/asset/looks` the materials. An object that one person cannot move is kinematic: it keeps its mass and its pose.

    Args:
      texture_file: PNG, relative to the stage.

    Raises:
      ValidationError: usd-core is not installed.
    """
    stage, root = usd_parts.new_stage(path, "/asset")
    from pxr import Kind, Usd, UsdGeom

    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    Usd.ModelAPI(root).SetAssetName(record.uid)
    root.GetPrim().SetMetadata("comment", f"{record.description}. Licence: {record.licence}. {record.provenance}")
    usd_parts.add_body(root, rigid_body(record, mesh, hulls), record.movable)
    visual = usd_parts.add_mesh(stage, "/asset/visual", mesh.vertices, mesh.faces, mesh.uv)
    UsdGeom.Scope.Define(stage, "/asset/looks")
    usd_parts.bind(visual, usd_parts.add_surface(stage, "/asset/looks/surface", mesh, texture_file))
    contact = usd_parts.add_contact(
        stage, "/asset/looks/contact", record.friction_coefficient, bounciness(record.materials)
    )
    usd_parts.add_colliders(stage, "/asset/collision", hulls, contact)
    stage.GetRootLayer().Save()


def bounciness(names: Sequence[str]) -> float:
    """Restitution of an asset of these materials, the dominant one first."""
    known = materials().get(names[0])
    return known.bounciness if known else UNKNOWN_BOUNCINESS
