"""Reads and writes maps in the files of CraftBench-Nav (docs/sources/reference_systems.md b.2): `map.json` and
`layers.npz`.

CraftBench-Nav stores images: row 0 at y_max, column 0 at x_min. Arrays here begin at the lower corner, x first.
"""

import dataclasses
import os
import pathlib
import zipfile
from typing import Any

import numpy as np

from ..datatypes import validation as v
from ..datatypes.ground import GROUND_KINDS, LIMIT
from ..geometry import rotations
from .geometry import SceneGeometry, SceneMap
from .maps import tops

LAYERS = ("ground", "clearance", "top", "kind")
#: Cells along a side of a map that is read: 2 km at 5 cm.
MAX_SIDE = 40_000
_GRID = ("x_min", "y_max", "res", "width", "height")


@dataclasses.dataclass(frozen=True)
class ExchangeMap:
    """A scene's map with all fields of CraftBench-Nav's files.

    Attributes:
      scene: id.
      map: ground height, kind and clearance.
      top: (X, Y) float32 m, height of the highest object in a cell, NaN without ground.
      info: further fields of `map.json` about the origin of the map.
    """

    scene: str
    map: SceneMap
    top: np.ndarray
    info: dict[str, Any] = dataclasses.field(default_factory=dict)

    @property
    def grid(self) -> dict[str, Any]:
        """The field `grid` of `map.json`: x_min, y_max, res in m, width and height in cells."""
        x, y = (round(float(c), 9) for c in self.map.origin)
        width, height = self.map.kind.shape
        res = self.map.resolution
        return {"x_min": x, "y_max": round(y + height * res, 9), "res": res, "width": width, "height": height}


def exchange_map(geometry: SceneGeometry) -> ExchangeMap:
    """The map of a compiled scene."""
    hulls = [geometry.hulls[h] for h in geometry.inst_hull]
    turns = rotations.matrix(geometry.object_quaternion)[geometry.inst_object]
    top = tops(geometry.map, hulls, turns, geometry.object_position[geometry.inst_object])
    return ExchangeMap(geometry.scene_id, geometry.map, top, {"made_by": "urbanverse_mjx"})


def save_map(folder: str | os.PathLike[str], exchange: ExchangeMap) -> None:
    """Writes `map.json` and `layers.npz` into a folder."""
    folder = pathlib.Path(folder)
    m = exchange.map
    layers = dict(zip(LAYERS, (m.height, m.clearance, exchange.top, m.kind), strict=True))
    images = {name: np.ascontiguousarray(layer.T[::-1]) for name, layer in layers.items()}
    v.write_atomically(folder / "layers.npz", lambda p: np.savez_compressed(p, allow_pickle=False, **images))
    body = {"scene": exchange.scene, "grid": exchange.grid, "kinds": list(GROUND_KINDS), **exchange.info}
    v.write_json(folder / "map.json", body)


def load_map(folder: str | os.PathLike[str]) -> ExchangeMap:
    """Reads a map of this package or of CraftBench-Nav.

    Raises:
      ValidationError: a file is missing or damaged, or its layers do not fit the grid.
    """
    folder = pathlib.Path(folder)
    path = folder / "map.json"
    body = v.read_json(path, "map")
    if not isinstance(body, dict):
        raise v.fail(str(path), v.show(body), "a JSON object")
    info = {k: x for k, x in body.items() if k not in ("scene", "grid", "kinds")}
    scene = v.text(body.get("scene"), f"{path}: scene")
    kinds = v.items(body.get("kinds"), f"{path}: kinds", 1)
    for i, name in enumerate(kinds):
        v.choice(name, f"{path}: kinds[{i}]", GROUND_KINDS)
    grid = v.mapping(body.get("grid"), f"{path}: grid", _GRID)
    width, height = (v.integer(grid[k], f"{path}: grid.{k}", 1, MAX_SIDE) for k in ("width", "height"))
    res = v.number(grid["res"], f"{path}: grid.res", minimum=0.01, maximum=1.0)
    x, y = (v.number(grid[k], f"{path}: grid.{k}", -LIMIT, LIMIT) for k in ("x_min", "y_max"))
    layers = _layers(folder / "layers.npz", (height, width), len(kinds))
    kind = np.array([GROUND_KINDS.index(k) for k in kinds], np.uint8)[layers["kind"]]
    # Cells without a kind are never occupied by a robot.
    ground = np.where(kind == 0, np.float32(np.nan), layers["ground"])
    kind = np.where(np.isnan(ground), np.uint8(0), kind)
    origin = np.array([x, round(y - height * res, 9)])
    scene_map = SceneMap(origin, res, ground, kind, layers["clearance"])
    return ExchangeMap(scene, scene_map, layers["top"], info)


def _layers(path: pathlib.Path, shape: tuple[int, int], kinds: int) -> dict[str, np.ndarray]:
    """The layers (X, Y) of a file of images of `shape`."""
    if not path.is_file():
        raise v.fail(str(path), "no such file", "the layers of a map", "keep layers.npz beside map.json")
    try:
        with np.load(path, allow_pickle=False) as file:
            images = {name: file[name] for name in LAYERS if name in file.files}
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise v.fail(str(path), f"a file that cannot be read ({error})", "the layers of a map as npz") from error
    for name in LAYERS:
        if name not in images:
            raise v.fail(f"{path}: {name}", "no such layer", "the layers " + ", ".join(LAYERS))
        if images[name].shape != shape:
            raise v.fail(
                f"{path}: {name}", f"shape {images[name].shape}", f"{shape}, the height and width of map.json's grid"
            )
    kind = images["kind"]
    if kind.dtype.kind not in "ui" or kind.max(initial=0) >= kinds or kind.min(initial=0) < 0:
        raise v.fail(f"{path}: kind", f"{kind.dtype} up to {kind.max()}", f"whole numbers below {kinds}")
    wrong = [name for name in LAYERS[:3] if images[name].dtype.kind != "f"]
    if wrong:
        raise v.fail(f"{path}: {wrong[0]}", str(images[wrong[0]].dtype), "32-bit floats, metres")
    ground = images["ground"]
    if np.isinf(ground).any() or np.abs(np.nan_to_num(ground)).max() > LIMIT or np.isnan(images["clearance"]).any():
        raise v.fail(f"{path}", "infinite ground or clearance that is not a number", "finite heights in metres")
    return {
        name: np.ascontiguousarray(image[::-1].T).astype(np.uint8 if name == "kind" else np.float32)
        for name, image in images.items()
    }
