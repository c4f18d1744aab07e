"""Packs compiled scene folders into one bank."""

import dataclasses
import hashlib
import os
from collections.abc import Sequence

import numpy as np

from ..assets.appearances.skies import build_sky
from ..assets.meshes.agents import agent_appearances
from ..datatypes import SceneBank
from ..datatypes import validation as v
from .bank import pack, with_agents
from .compiler import CompiledScene
from .geometry import SceneGeometry


def pack_bank(folders: Sequence[str | os.PathLike[str]], splits: Sequence[str]) -> SceneBank:
    """Makes a bank of compiled scenes.

    Args:
      folders: folders that `compile_scene` wrote.
      splits: split of each scene, one of `SPLITS`.

    Raises:
      ValidationError: a folder is not a compiled scene, or an id occurs twice.
    """
    if len(folders) != len(splits):
        raise v.fail("bank splits", f"{len(splits)} for {len(folders)} scenes", "one for each scene")
    # The compiled scenes are gone before the agents' textures join theirs.
    return with_agents(_packed(folders, splits), agent_appearances())


def _packed(folders: Sequence[str | os.PathLike[str]], splits: Sequence[str]) -> SceneBank:
    scenes, hashes = [], {}
    textures: dict[bytes, np.ndarray] = {}
    for folder in folders:
        compiled = CompiledScene.load(folder)
        scenes.append(_lean(compiled.geometry, textures))
        hashes[compiled.layout.id] = compiled.metadata["hashes"]["layout"]
    skies = {name: build_sky(name) for name in {s.sky for s in scenes}}
    return pack(scenes, splits, skies, hashes)


def _lean(scene: SceneGeometry, textures: dict[bytes, np.ndarray]) -> SceneGeometry:
    """Returns the scene in two thirds of its memory: equal textures once, no field of its map that a bank lacks."""
    meshes = []
    for mesh in scene.meshes:
        digest = hashlib.sha256(repr(mesh.texture.shape).encode() + mesh.texture.tobytes()).digest()
        meshes.append(dataclasses.replace(mesh, texture=textures.setdefault(digest, mesh.texture)))
    none = np.broadcast_to(np.float32(0.0), scene.map.kind.shape)
    street_map = dataclasses.replace(scene.map, height=none, clearance=none)
    return dataclasses.replace(scene, meshes=tuple(meshes), map=street_map)
