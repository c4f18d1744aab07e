"""Packs compiled scene folders into one bank."""

import os
from collections.abc import Sequence

from ..assets.appearances.skies import build_sky
from ..assets.meshes.agents import agent_appearances
from ..datatypes import SceneBank
from ..datatypes import validation as v
from .bank import pack, with_agents
from .compiler import CompiledScene


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
    compiled = [CompiledScene.load(folder) for folder in folders]
    scenes = [c.geometry for c in compiled]
    skies = {name: build_sky(name) for name in {s.sky for s in scenes}}
    hashes = {c.layout.id: c.metadata["hashes"]["layout"] for c in compiled}
    return with_agents(pack(scenes, splits, skies, hashes), agent_appearances())
