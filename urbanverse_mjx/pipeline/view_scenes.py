"""Opens scenes by name for a viewer: shipped streets, the built library, graphs, compiled scenes and banks."""

import pathlib
import re
from collections.abc import Sequence

from .. import settings
from ..datatypes import BankShards, SceneBank, ValidationError
from ..datatypes import validation as v
from ..datatypes.bank_shards import SUFFIX as SHARDS
from ..work_folder import work_folder

#: Number of digital cousins of a graph.
COUSINS = 64
#: Number of banks kept in memory, each with the meshes and textures of its scenes.
_KEPT = 4
_NUMBERED = re.compile(r"(.+)_Cousin_(\d+)$")


class ViewScenes:
    """Scenes by name, opened on demand.

    Args:
      given: names, graph.json files, compiled scene folders or banks to list together with the shipped and cached
        scenes.

    Raises:
      ValidationError: a given scene does not exist.
    """

    def __init__(self, given: Sequence[str] = ()) -> None:
        self._shipped = _shipped_graphs()
        self._graphs = dict(self._shipped)
        self._folders = _built_folders()
        self._banks: dict[str, tuple[pathlib.Path, str]] = {}
        self._opened: dict[tuple[str, int], tuple[SceneBank, int]] = {}
        #: Banks of several scenes by file, None for the shipped streets; scenes of one bank share compiled programs.
        self._whole: dict[pathlib.Path | None, SceneBank] = {}
        self.first: list[str] = []
        self.first += [self._add(text) for text in given]

    @property
    def names(self) -> list[str]:
        """Names of all scenes: given, shipped, then built ones."""
        return list(dict.fromkeys([*self.first, *self._banks, *self._graphs, *self._folders]))

    def cousins(self, name: str) -> int:
        """Number of cousins of a scene."""
        if name in self._graphs:
            return COUSINS
        return len(self._folders.get(name, ())) or 1

    def open(self, name: str, cousin: int = 0) -> tuple[SceneBank, int]:
        """A bank with a cousin of a scene, and its row in it.

        Raises:
          ValidationError: the scene or cousin does not exist, or its graph cannot be compiled.
        """
        if name not in self.names:
            raise ValidationError(self._unknown(name))
        if not 0 <= cousin < self.cousins(name):
            raise ValidationError(f"cousin: found {cousin}, needed one of 0 to {self.cousins(name) - 1} of {name!r}.")
        key = name, cousin
        if key not in self._opened:
            while len(self._opened) >= _KEPT:
                self._opened.pop(next(iter(self._opened)))
            self._opened[key] = self.load(name, cousin)
        return self._opened[key]

    def load(self, name: str, cousin: int = 0) -> tuple[SceneBank, int]:
        """Like `open` for a known scene, without keeping it."""
        from ..scene import pack_bank

        if name in self._banks:
            path, scene = self._banks[name]
            if path.is_dir():
                shards = BankShards(path)
                return SceneBank.take(shards, shards.rows_of([scene])), 0
            if path not in self._whole:
                self._whole[path] = SceneBank.load(path)
            return self._whole[path], self._whole[path].scene_ids.index(scene)
        if name in self._folders:
            return pack_bank([self._folders[name][cousin]], ["test"]), 0
        # A graph of the user may have the name of a shipped street.
        shipped = self._graphs[name] == self._shipped.get(name)
        if cousin == 0 and shipped and settings.chosen_bank_path() is None:
            from .banks import ensure_default_bank

            if None not in self._whole:
                self._whole[None] = ensure_default_bank()
            return self._whole[None], self._whole[None].scene_ids.index(name)
        return _compiled(self._graphs[name], cousin), 0

    def _unknown(self, text: str) -> str:
        hint = v.did_you_mean(text, self.names, 3, 0.4) or "`urbanverse scene library` builds more."
        return (
            f"scene: found no {text!r}, needed a shipped street ({', '.join(self._shipped)}), a scene of the built "
            f"library, a graph.json, a compiled scene's folder or a bank (.npz, .bank); {hint}"
        )

    def _add(self, text: str) -> str:
        """Adds a scene that a user named; returns its name."""
        path = pathlib.Path(text).expanduser()
        if text in self.names:
            return text
        if (path / "metadata.json").is_file():
            name = path.resolve().name
            self._folders[name] = [path]
            self._graphs.pop(name, None)
            return name
        if path.suffix == ".npz" or (path.suffix == SHARDS and path.is_dir()):
            bank = BankShards(path) if path.is_dir() else SceneBank.load(path)
            self._banks |= {f"{path.stem}/{scene}": (path, scene) for scene in bank.scene_ids}
            return f"{path.stem}/{bank.scene_ids[0]}"
        if path.is_file():
            # `graph.json` is named by its folder, `corner.graph.json` by its file name.
            name = path.name.split(".")[0]
            name = path.resolve().parent.name if name == "graph" else name
            self._graphs[name] = path
            self._folders.pop(name, None)
            return name
        found = _NUMBERED.fullmatch(text)
        if found and found[1] in self._folders and 0 < int(found[2]) <= len(self._folders[found[1]]):
            self._folders[text] = [self._folders[found[1]][int(found[2]) - 1]]
            return text
        raise ValidationError(self._unknown(text))


def _shipped_graphs() -> dict[str, pathlib.Path]:
    """Graphs of the shipped streets by name, the test streets first."""
    from .banks import shipped_scenes

    ordered = sorted(zip(*shipped_scenes(), strict=True), key=lambda row: row[1] != "test")
    return {path.parent.name: path for path, _ in ordered}


def _built_folders() -> dict[str, list[pathlib.Path]]:
    """Scene -> folders of its cousins, of all sets of the library that were built on this machine."""
    folders: dict[str, list[pathlib.Path]] = {}
    for path in sorted(settings.cache_dir("library").glob("*/scenes/*/metadata.json")):
        found = _NUMBERED.fullmatch(path.parent.name)
        folders.setdefault(found[1] if found else path.parent.name, []).append(path.parent)
    return folders


def _compiled(graph: pathlib.Path, cousin: int) -> SceneBank:
    """The bank of one cousin of a graph, compiled in a temporary folder."""
    from ..assets.records.store import ensure_store
    from ..scene import pack_bank
    from .scenes import compile_graph

    ensure_store()
    with work_folder("urbanverse-view-") as work:
        compile_graph(graph, work / "scene", cousin=cousin)
        return pack_bank([work / "scene"], ["test"])
