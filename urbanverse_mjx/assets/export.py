"""GLB files of assets, texture inside, for other tools; z up becomes glTF's y up."""

import io
import os
import pathlib

import numpy as np
import trimesh
from PIL import Image
from trimesh.exchange import gltf
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, NounError
from urbanverse_mjx.datatypes.validation import write_atomically

from .index import build_mesh

# glTF's frame is y up with its front along +z (glTF 2.0, section 3.4): our (x front, y left, z up) becomes (left, up,
# front).
_TO_GLTF = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])


def glb_bytes(mesh: AssetMesh) -> bytes:
    """The mesh as one binary glTF file."""
    # trimesh counts v from the bottom, as `AssetMesh` does, and turns it over for glTF itself.
    material = PBRMaterial(
        baseColorTexture=Image.fromarray(mesh.texture),
        roughnessFactor=mesh.roughness,
        metallicFactor=mesh.metallic,
        doubleSided=False,
    )
    visual = TextureVisuals(uv=mesh.uv.astype(np.float64), material=material)
    solid = trimesh.Trimesh(mesh.vertices @ _TO_GLTF.T, mesh.faces, visual=visual, process=False)
    return gltf.export_glb(trimesh.Scene({"asset": solid}))


def export_glb(record: AssetRecord, path: str | os.PathLike[str]) -> pathlib.Path:
    """Writes an asset of the index as GLB."""
    body = glb_bytes(build_mesh(record))
    return write_atomically(path, lambda temporary: temporary.write_bytes(body))


def read_glb(source: bytes | str | os.PathLike[str]) -> AssetMesh:
    """Reads a GLB of one textured mesh, as `export_glb` writes it, back into the asset frame.

    Raises:
      NounError: not exactly one mesh, or a mesh without a base colour texture.
    """
    body = source if isinstance(source, bytes) else pathlib.Path(source).read_bytes()
    scene = trimesh.load_scene(io.BytesIO(body), file_type="glb", process=False)
    solids = [g for g in scene.dump() if isinstance(g, trimesh.Trimesh)]
    if len(solids) != 1:
        raise NounError(f"GLB: found {len(solids)} meshes, needed one; join them in the tool that made the file.")
    visual = solids[0].visual
    material = getattr(visual, "material", None)
    if not isinstance(visual, TextureVisuals) or not isinstance(material, PBRMaterial) or visual.uv is None:
        raise NounError(
            "GLB: found a mesh without texture coordinates, needed a textured one; bake its colours to a texture."
        )
    if material.baseColorTexture is None:
        raise NounError(
            "GLB: found a material without an image, needed a base colour texture; bake its colours to one."
        )
    texture = np.asarray(material.baseColorTexture.convert("RGB"))
    roughness = 1.0 if material.roughnessFactor is None else float(material.roughnessFactor)
    metallic = 1.0 if material.metallicFactor is None else float(material.metallicFactor)
    return AssetMesh(solids[0].vertices @ _TO_GLTF, solids[0].faces, visual.uv, texture, roughness, metallic)
