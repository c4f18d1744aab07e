"""The sets of the scene library: names, folders of graphs, scenes and banks, and the required contents of a bank.

`scenes/library.json` names the sets; `urbanverse scene library` builds them into the cache.
"""

import dataclasses
import pathlib
from collections.abc import Iterable

from .. import settings
from ..datatypes import SPLITS, SceneBank
from ..datatypes import validation as v
from ..datatypes.reach_count import most_objects_in_reach, most_prisms_in_reach
from ..datatypes.scene_layout import HULL_KINDS

TABLE, HASHES, BANK, SCENES, RECORDS = "library.json", "hashes.json", "bank.npz", "scenes", "records"
#: A set's bank as a folder of shards, which stands in place of the file.
SHARDS = "bank.bank"
#: Generators of sets whose graphs are not files: `citygen.craftbench` and `citygen.validation_streets` (hand-made),
#: `citygen.procedural_streets` and `citygen.procedural_places` (from templates).
GENERATORS = ("craft", "validation", "procedural", "places")
_OPTIONAL = ("numbered", "builder", "validation", "regional", "hulls", "exchange", "standing")


@dataclasses.dataclass(frozen=True)
class SceneSet:
    """A set of scenes.

    Attributes:
      name: name of its folder below `scenes/` and in the cache.
      cousins: number of cousins of each layout.
      split: split of its scenes, one of `SPLITS`.
      seed: seed of materialisation and episodes.
      validation: layouts that are held out of `split` for validation, with all their cousins.
      numbered: whether scene ids end in _Cousin_<k>, like those of UrbanVerse's authors.
      builder: "" if graphs are files, otherwise their generator, one of `GENERATORS`.
      regional: whether scenes have the look of each graph's city (`materialisation.regional`).
      hulls: "close" or "close-2" for closer collision hulls, see `SceneLayout.hulls`.
      exchange: whether objects that a country does not have are exchanged (`materialisation.exchange`); needs
        `regional`.
      standing: whether loose objects have assets that stand or lie by themselves (`materialisation.steady`).
    """

    name: str
    cousins: int
    split: str
    seed: int
    numbered: bool = True
    builder: str = ""
    validation: tuple[str, ...] = ()
    regional: bool = False
    hulls: str = ""
    exchange: bool = False
    standing: bool = False

    def scene_id(self, layout: str, cousin: int) -> str:
        """Id of a layout's cousin number `cousin`, from 0."""
        return f"{layout}_Cousin_{cousin + 1:02d}" if self.numbered else layout

    def split_of(self, scene: str) -> str:
        """The split of the scene with an id of this set."""
        held_out = (self.scene_id(layout, k) for layout in self.validation for k in range(self.cousins))
        return "validation" if scene in held_out else self.split

    def graphs(self) -> dict[str, pathlib.Path]:
        """Layout id -> file of its graph, sorted by name; empty if a generator makes the graphs."""
        root = settings.scene_root() / self.name
        return {path.parent.name: path for path in sorted(root.glob("*/graph.json*"))}


def sets() -> dict[str, SceneSet]:
    """All sets, by name.

    Raises:
      ValidationError: the table is damaged.
    """
    rows = v.read_json(settings.scene_root() / TABLE, "table of scene sets")
    if not isinstance(rows, dict):
        raise v.fail(TABLE, v.show(rows), "an object with a set per name")
    found = {}
    for name, row in rows.items():
        row = v.mapping(row, f"{TABLE}: {name}", ("cousins", "split", "seed"), _OPTIONAL)
        v.choice(row["split"], f"{TABLE}: {name}: split", SPLITS)
        v.integer(row["cousins"], f"{TABLE}: {name}: cousins", 1, 64)
        v.choice(row.get("builder", ""), f"{TABLE}: {name}: builder", ("", *GENERATORS))
        v.boolean(row.get("regional", False), f"{TABLE}: {name}: regional")
        v.choice(row.get("hulls", ""), f"{TABLE}: {name}: hulls", HULL_KINDS)
        v.boolean(row.get("exchange", False), f"{TABLE}: {name}: exchange")
        if row.get("exchange", False) and not row.get("regional", False):
            raise v.fail(f"{TABLE}: {name}", '"exchange" without "regional"', "both or neither", "add the other")
        v.boolean(row.get("standing", False), f"{TABLE}: {name}: standing")
        where = f"{TABLE}: {name}: validation"
        layouts = tuple(v.text(x, where) for x in v.items(row.get("validation", ()), where))
        v.unique(layouts, where)
        found[name] = SceneSet(name, **{**row, "validation": layouts})
    return found


def scene_set(name: str) -> SceneSet:
    """Returns a set by name.

    Raises:
      ValidationError: no set has this name.
    """
    known = sets()
    return known[v.choice(name, "set of scenes", tuple(known))]


def held_out(scenes: Iterable[str]) -> list[str]:
    """Selects the scene ids that a set of the library holds out for validation, in their order."""
    known = sets().values()
    return [scene for scene in scenes if any(s.validation and s.split_of(scene) == "validation" for s in known)]


def folder(name: str) -> pathlib.Path:
    """Folder of a built set: `scenes/<id>/`, `records/<id>.json`, `report.json` and `bank.npz` (or `bank.bank`)."""
    return settings.cache_dir("library", scene_set(name).name)


def bank_path(name: str) -> pathlib.Path:
    """Path of the bank of a set, which must have been built.

    Raises:
      ValidationError: the set does not exist or is not built; the message names the command that builds it.
    """
    path = bank_in(folder(name))
    if path is None:
        raise v.fail(f"set {name!r}", f"no {BANK} in the cache", "its bank", f"run `urbanverse scene library {name}`")
    return path


def bank_in(home: pathlib.Path) -> pathlib.Path | None:
    """The bank in the folder of a set, a file or a folder of shards; None if there is none."""
    return next((path for path in (home / BANK, home / SHARDS) if path.exists()), None)


def shipped_hashes(name: str) -> dict[str, dict[str, str]]:
    """Scene id -> the hash of its "graph", of its materialised "layout" and of the compiled "scene", as committed."""
    path = settings.scene_root() / scene_set(name).name / HASHES
    return v.read_json(path, "table of scene hashes") if path.is_file() else {}


def most_in_reach(bank: SceneBank, scene: int) -> dict[str, int]:
    """Largest numbers of "hulls" of objects and of "prisms" of ground within reach of a robot at any allowed position
    of a scene, for the longest reach that the bank's grids support."""
    reach = float(bank.meta["grid_reach"])
    return {
        "hulls": most_objects_in_reach(bank, scene, reach),
        "prisms": most_prisms_in_reach(bank, scene, reach),
    }
