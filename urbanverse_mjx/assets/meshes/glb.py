"""Reads and writes binary glTF of one textured mesh; z is up in memory, y in the file."""

import io
import os
import pathlib
from collections.abc import Mapping
from typing import Any

import numpy as np
import trimesh
from PIL import Image
from trimesh.exchange import gltf
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

from urbanverse_mjx.datatypes import AssetMesh, ValidationError

# In glTF, y is up and the front is along +z (glTF 2.0, section 3.4): (x front, y left, z up) becomes (left, up, front).
TO_GLTF = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])


def glb_bytes(mesh: AssetMesh, about: Mapping[str, Any] | None = None, copyright_text: str = "") -> bytes:
    """The mesh as one binary glTF file.

    Args:
      about: JSON object for `asset.extras`, where other tools look for metadata.
      copyright_text: for `asset.copyright`; left out when empty.
    """
    # In trimesh v begins at the bottom, as in `AssetMesh`; trimesh flips it for glTF.
    material = PBRMaterial(
        baseColorTexture=Image.fromarray(mesh.texture),
        roughnessFactor=mesh.roughness,
        metallicFactor=mesh.metallic,
        doubleSided=False,
    )
    visual = TextureVisuals(uv=mesh.uv.astype(np.float64), material=material)
    solid = trimesh.Trimesh(mesh.vertices @ TO_GLTF.T, mesh.faces, visual=visual, process=False)

    def describe(tree: dict[str, Any]) -> None:
        if about:
            tree["asset"]["extras"] = dict(about)
        if copyright_text:
            tree["asset"]["copyright"] = copyright_text

    return gltf.export_glb(trimesh.Scene({"asset": solid}), tree_postprocessor=describe)


def read_glb(source: bytes | str | os.PathLike[str]) -> AssetMesh:
    """Reads a GLB of one textured mesh, as `glb_bytes` writes it, in the asset frame.

    Raises:
      ValidationError: there is not exactly one mesh, or it has no base colour texture.
    """
    body = source if isinstance(source, bytes) else pathlib.Path(source).read_bytes()
    scene = trimesh.load_scene(io.BytesIO(body), file_type="glb", process=False)
    solids = [g for g in scene.dump() if isinstance(g, trimesh.Trimesh)]
    if len(solids) != 1:
        raise ValidationError(f"GLB: found {len(solids)} meshes, needed one; join them in the tool that made the file.")
    visual = solids[0].visual
    material = getattr(visual, "material", None)
    if not isinstance(visual, TextureVisuals) or not isinstance(material, PBRMaterial) or visual.uv is None:
        raise ValidationError(
            "GLB: found a mesh without texture coordinates, needed a textured one; bake its colours to a texture."
        )
    if material.baseColorTexture is None:
        raise ValidationError(
            "GLB: found a material without an image, needed a base colour texture; bake its colours to one."
        )
    texture = np.asarray(material.baseColorTexture.convert("RGB"))
    roughness = 1.0 if material.roughnessFactor is None else float(material.roughnessFactor)
    metallic = 1.0 if material.metallicFactor is None else float(material.metallicFactor)
    return AssetMesh(solids[0].vertices @ TO_GLTF, solids[0].faces, visual.uv, texture, roughness, metallic)
