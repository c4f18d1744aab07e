"""Layout -> MJCF and USD, ground prisms, maps, routes, episode tables; many compiled scenes -> one bank."""

from .bank import pack
from .compiler import CompiledScene, compile_scene
from .drive import Controller
from .episodes import EpisodeRules, NoRoomError
from .geometry import SceneGeometry
from .mjcf import scene_mjcf, scene_spec
from .packing import pack_bank
from .stability import Displacement, displacements
from .usd import export_usd

__all__ = [
    "CompiledScene",
    "Controller",
    "Displacement",
    "EpisodeRules",
    "NoRoomError",
    "SceneGeometry",
    "compile_scene",
    "displacements",
    "export_usd",
    "pack",
    "pack_bank",
    "scene_mjcf",
    "scene_spec",
]
