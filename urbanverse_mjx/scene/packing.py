"""Compiled scene folders -> one bank."""

import os
from collections.abc import Sequence

from ..assets.appearances.skies import build_sky
from ..assets.meshes.agents import agent_appearances
from ..datatypes import SceneBank
from ..datatypes import validation as v
from .bank import pack, with_agents
from .compiler import CompiledScene


def pack_bank(folders: Sequence[str | os.PathLike[str]], splits: Sequence[str]) -> SceneBank:
    """The bank of compiled scenes.

    Args:
      folders: what `compile_scene` wrote.
      splits: of each, one of `SPLITS`.

    Raises:
      ValidationError: a folder is no compiled scene, or an id comes twice.
    """
    if len(folders) != len(splits):
        raise v.fail("bank splits", f"{len(splits)} for {len(folders)} scenes", "one for each scene")
    compiled = [CompiledScene.load(folder) for folder in folders]
    scenes = [c.geometry for c in compiled]
    skies = {name: build_sky(name) for name in {s.sky for s in scenes}}
    hashes = {c.layout.id: c.metadata["hashes"]["layout"] for c in compiled}
    return with_agents(pack(scenes, splits, skies, hashes), agent_appearances())
