"""Annotations of a frame: objects with boxes in the image and in space, and a caption; stored beside the data files.

LeRobot's features have a fixed shape, so these lists stand in files of their own, which its readers ignore.
"""

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pyarrow as pa


@dataclasses.dataclass(frozen=True)
class SeenObject:
    """One object of which a frame shows at least some pixels.

    Attributes:
      label: in the instance image; of moving people and vehicles 2.
      name: its id in the scene graph, or agent_K.
      category: of the bank.
      box: left, top, right, bottom in pixels, the last two exclusive, around the visible pixels.
      pixels: number of visible pixels.
      visible: share that these are of the pixels that the object would have if nothing else were in the image.
      size: m, of the box in space along its own x, y, z.
      position_world, quaternion_world: (3,) m, (4,) wxyz of the box's centre and axes in the scene.
      position_camera, quaternion_camera: the same in the camera's frame (x right, y down, z ahead).
    """

    label: int
    name: str
    category: str
    box: tuple[int, int, int, int]
    pixels: int
    visible: float
    size: tuple[float, ...]
    position_world: tuple[float, ...]
    quaternion_world: tuple[float, ...]
    position_camera: tuple[float, ...]
    quaternion_camera: tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class Annotation:
    """Of one frame. runs: of each object the lengths of its mask's runs, columns first, beginning with pixels outside
    (COCO's uncompressed RLE); empty where the format does not store masks."""

    caption: str
    objects: tuple[SeenObject, ...]
    runs: tuple[list[int], ...] = ()


_FLOATS = pa.list_(pa.float32())
_OBJECT = (
    [("label", pa.int64()), ("name", pa.string()), ("category", pa.string()), ("box", pa.list_(pa.int64()))]
    + [("pixels", pa.int64()), ("visible", pa.float32())]
    + [(f.name, _FLOATS) for f in dataclasses.fields(SeenObject)[6:]]
)


def _schema(fields: list[tuple[str, pa.DataType]]) -> pa.Schema:
    objects = pa.list_(pa.struct(fields))
    return pa.schema([("index", pa.int64()), ("caption", pa.string()), ("objects", objects)])


SCHEMA = _schema(_OBJECT)
#: Of datasets that were recorded before the visible share of objects was measured.
WITHOUT_VISIBLE = _schema([field for field in _OBJECT if field[0] != "visible"])


def annotations_table(annotations: Sequence[Annotation], first: int) -> pa.Table:
    """One row a frame; first: index of the first."""
    rows = [
        {"index": first + k, "caption": a.caption, "objects": [dataclasses.asdict(o) for o in a.objects]}
        for k, a in enumerate(annotations)
    ]
    return pa.Table.from_pylist(rows, SCHEMA)


def check_annotations(table: pa.Table, first: int, rows: int, size: tuple[int, int], where: str) -> Iterator[str]:
    """Checks a file of annotations, also one of `WITHOUT_VISIBLE`; size: height and width of the image.

    Yields:
      a sentence for each problem.
    """
    if table.schema not in (SCHEMA, WITHOUT_VISIBLE):
        found = ", ".join(table.column_names)
        yield f"{where}: found columns {found}, needed index, caption and objects as this version writes them"
        return
    if table.num_rows < rows:
        yield f"{where}: found {table.num_rows} rows, needed {rows}"
        return
    body: list[dict[str, Any]] = table.slice(0, rows).to_pylist()
    for k, row in enumerate(body):
        if row["index"] != first + k:
            yield f"{where}: row {k}: found index {row['index']}, needed {first + k}"
            return
        for seen in row["objects"]:
            left, top, right, bottom = seen["box"]
            inside = 0 <= left < right <= size[1] and 0 <= top < bottom <= size[0]
            if not inside or not 0 < seen["pixels"] <= (right - left) * (bottom - top):
                yield f"{where}: row {k}: found a box {seen['box']} of {seen['pixels']} pixels, needed one in the image"
            if not 0.0 < seen.get("visible", 1.0) <= 1.0:
                yield f"{where}: row {k}: found {seen['name']} visible by {seen['visible']}, needed a share above 0"
            if min(seen["size"]) < 0 or not np.isfinite(seen["position_camera"]).all():
                yield f"{where}: row {k}: found {seen['name']} without size or place, needed numbers"


def runs_of(mask: np.ndarray) -> list[int]:
    """COCO's uncompressed RLE of a mask (H, W) bool: lengths of runs, columns first, beginning with zeros."""
    flat = np.concatenate([[False], mask.ravel(order="F"), [False]])
    edges = np.flatnonzero(flat[1:] != flat[:-1])
    runs = np.diff(np.concatenate([[0], edges, [mask.size]])).tolist()
    return runs if runs[-1] else runs[:-1]
