"""Layout -> MJCF, ground prisms, maps, routes, episode tables; many compiled scenes -> one bank."""

from .bank import pack
from .compiler import CompiledScene, compile_scene
from .drive import Driver
from .geometry import SceneGeometry
from .mjcf import scene_mjcf, scene_spec
from .packing import pack_bank

__all__ = [
    "CompiledScene",
    "Driver",
    "SceneGeometry",
    "compile_scene",
    "pack",
    "pack_bank",
    "scene_mjcf",
    "scene_spec",
]
