"""Reads skinned glTF meshes in the pose of the joints in the file's nodes.

A vertex is the weighted sum of its positions under each joint's frame times the inverse bind matrix; the frame of the
mesh's own node is ignored (glTF 2.0, section 3.7.3.3). trimesh reads attributes whose names begin with an underscore,
but no joints, so the tree given to it holds joints, weights and matrices under such names.
"""

import copy
import json
import struct
from typing import Any

import numpy as np
import trimesh

from .screening import RefusedFileError

_SKIN, _JOINTS, _WEIGHTS, _BIND = "urbanverse_skin", "_UV_JOINTS_", "_UV_WEIGHTS_", "_UV_BIND"


def readable(tree: dict[str, Any]) -> dict[str, Any]:
    """Converts the tree of a glTF file with skins to one that trimesh can read; nodes are named by their numbers."""
    tree = copy.deepcopy(tree)
    for k, node in enumerate(tree.get("nodes", [])):
        node["name"] = _node_name(k)
        if "skin" in node and "mesh" in node:
            mesh, skin = tree["meshes"][node["mesh"]], tree["skins"][node["skin"]]
            mesh["extras"] = {_SKIN: node["skin"]}
            for primitive in mesh["primitives"]:
                attributes = primitive["attributes"]
                for name in tuple(attributes):
                    for kind, other in (("JOINTS_", _JOINTS), ("WEIGHTS_", _WEIGHTS)):
                        if name.startswith(kind):
                            attributes[other + name.removeprefix(kind)] = attributes[name]
                if "inverseBindMatrices" in skin:
                    attributes[_BIND] = skin["inverseBindMatrices"]
    return tree


def glb_with(tree: dict[str, Any], body: bytes) -> bytes:
    """A screened GLB file's bytes with another tree in its JSON chunk."""
    length = struct.unpack("<I", body[12:16])[0]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = body[20 + length :]
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON")
    return head + text + rest


def posed(scene: trimesh.Scene, tree: dict[str, Any]) -> list[trimesh.Trimesh]:
    """The triangles of a scene that was read from a `readable` tree, in the world, skinned ones in the rest pose.

    Raises:
      RefusedFileError: joints or weights do not fit the skin.
    """
    solids = []
    for name in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[name]
        solid = scene.geometry[geometry].copy()
        if not isinstance(solid, trimesh.Trimesh):
            continue
        skin = solid.metadata.get(_SKIN)
        if skin is None:
            solid.apply_transform(matrix)
        else:
            solid.vertices = _skinned(solid, _frames(scene, tree["skins"][skin], solid))
        solids.append(solid)
    return solids


def _node_name(k: int) -> str:
    return f"node_{k}"


def _frames(scene: trimesh.Scene, skin: dict[str, Any], solid: trimesh.Trimesh) -> np.ndarray:
    """(J, 4, 4) of each joint: from the mesh's own frame to the world."""
    try:
        frames = np.array([scene.graph[_node_name(k)][0] for k in skin["joints"]]).reshape(-1, 4, 4)
    except (KeyError, ValueError) as error:
        raise RefusedFileError("malformed", "has a skin whose joints are no nodes of its scene") from error
    if _BIND not in solid.vertex_attributes:
        return frames
    # Stored column by column (glTF 2.0, section 3.6.2.4).
    bind = np.asarray(solid.vertex_attributes[_BIND], np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
    if len(bind) < len(frames):
        raise RefusedFileError("malformed", f"has a skin of {len(frames)} joints and {len(bind)} bind matrices")
    return frames @ bind[: len(frames)]


def _skinned(solid: trimesh.Trimesh, frames: np.ndarray) -> np.ndarray:
    found = solid.vertex_attributes
    joints, weights = (
        [np.asarray(found[k], np.float64) for k in sorted(found) if k.startswith(kind)] for kind in (_JOINTS, _WEIGHTS)
    )
    if not joints or len(joints) != len(weights):
        raise RefusedFileError("malformed", "has a skinned mesh without joints or weights")
    joint, weight = np.concatenate(joints, 1).astype(int), np.concatenate(weights, 1)
    total = weight.sum(1, keepdims=True)
    if not (np.isfinite(weight).all() and (weight >= 0).all() and (total > 0).all()):
        raise RefusedFileError("not finite", "has a skinned mesh whose weights are no shares")
    if joint.min() < 0 or joint[weight > 0].max() >= len(frames):
        raise RefusedFileError("absurd numbers", f"has a skinned mesh with a joint beyond the skin's {len(frames)}")
    weight, joint = weight / total, np.minimum(joint, len(frames) - 1)
    points = np.column_stack([solid.vertices, np.ones(len(solid.vertices))])
    result = np.zeros((len(points), 3))
    for k in range(joint.shape[1]):
        result += weight[:, k, None] * np.einsum("nij,nj->ni", frames[joint[:, k], :3], points)
    return result
