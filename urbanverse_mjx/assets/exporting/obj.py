"""Writes Wavefront OBJ text of one textured mesh, and its material file."""

import io

import numpy as np
from PIL import Image

from urbanverse_mjx.datatypes import AssetMesh

MATERIAL = "surface"


def obj_text(mesh: AssetMesh, material_file: str | None, remark: str) -> str:
    """The mesh as OBJ with nine digits per number, which preserves float32 values.

    Args:
      material_file: name of the MTL file; None names no material.
      remark: one line for the head of the file.
    """
    lines = [f"# {remark}"]
    lines += [f"mtllib {material_file}"] if material_file else []
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"vt {u:.9g} {v:.9g}" for u, v in mesh.uv.tolist()]
    lines += [f"usemtl {MATERIAL}"] if material_file else []
    lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in (mesh.faces + 1).tolist()]
    return "\n".join(lines) + "\n"


def mtl_text(mesh: AssetMesh, texture_file: str) -> str:
    """The material: the texture, and roughness and metalness in the keys of the PBR extension (Pr, Pm)."""
    lines = [f"newmtl {MATERIAL}", "Kd 1 1 1", "illum 2", f"Pr {mesh.roughness:.6g}", f"Pm {mesh.metallic:.6g}"]
    return "\n".join([*lines, f"map_Kd {texture_file}"]) + "\n"


def png_bytes(pixels: np.ndarray) -> bytes:
    """(H, W, 3) uint8 as PNG."""
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()
