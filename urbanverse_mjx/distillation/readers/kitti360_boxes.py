"""Reads KITTI-360's annotated 3D boxes: `data_3d_bboxes/*/<sequence>.xml`, an OpenCV storage with a node per object.

A node holds `index`, `semanticId` (numbered as in `Kitti360Class.box_id`), `instanceId`, `start_frame`, `end_frame`,
`timestamp` (-1 = static), `transform` (4 x 4, with the size in its columns) and `vertices` (n x 3) before it.
"""

import dataclasses
import os
import pathlib
from xml.etree import ElementTree as ET

import numpy as np

from ...datatypes import GraphObject
from ...datatypes import validation as v
from ...geometry import rotations
from .kitti360_labels import BY_BOX_ID, Kitti360Class, object_id


@dataclasses.dataclass(frozen=True)
class Kitti360Box:
    """One annotated object; a moving object has one box per time.

    Attributes:
      kind: its class.
      instance: its number within the class.
      timestamp: the frame for which it is valid, -1 = all.
      corners: (n, 3) m in KITTI-360's world, z up.
      heading: rad, of its own x axis seen from above.
    """

    kind: Kitti360Class
    instance: int
    timestamp: int
    corners: np.ndarray
    heading: float

    @property
    def id(self) -> str:
        """The object's id, which also identifies its pixels in the instance images."""
        return object_id(self.kind, self.instance)

    def upright(self, origin: np.ndarray) -> GraphObject:
        """The upright box around the object with its heading, relative to `origin` (3,) m."""
        turn = rotations.about_z(-self.heading)
        local = (self.corners - origin) @ turn.T
        low, high = local.min(0), local.max(0)
        center, size = turn.T @ ((low + high) / 2), np.maximum(high - low, 1e-3)
        return GraphObject(self.id, self.kind.label or self.kind.name, tuple(center), tuple(size), self.heading)


def read_boxes(path: str | os.PathLike[str]) -> list[Kitti360Box]:
    """Reads a sequence's file; classes that are not in the label images are skipped.

    Raises:
      ValidationError: the file does not exist, is not XML, or has a node of another structure.
    """
    path = pathlib.Path(path)
    try:
        root = ET.parse(path).getroot()
    except FileNotFoundError as error:
        raise v.fail(str(path), "no such file", "KITTI-360's 3D boxes", "download data_3d_bboxes") from error
    except ET.ParseError as error:
        raise v.fail(str(path), f"no XML ({error})", "KITTI-360's 3D boxes", "download it again") from error
    return [box for node in root if (box := _box(node, f"{path}: {node.tag}")) is not None]


def _box(node: ET.Element, where: str) -> Kitti360Box | None:
    if node.find("transform") is None:
        return None
    kind = BY_BOX_ID.get(_integer(node, "semanticId", where))
    if kind is None:
        return None
    transform = _matrix(node, "transform", where)
    vertices = _matrix(node, "vertices", where)
    if transform.shape != (4, 4) or vertices.shape[1:] != (3,) or len(vertices) < 4:
        found = f"shapes {transform.shape} and {vertices.shape}"
        raise v.fail(where, found, "a transform of 4 x 4 and vertices of n x 3", "download it again")
    return Kitti360Box(
        kind=kind,
        instance=_integer(node, "instanceId", where),
        timestamp=_integer(node, "timestamp", where),
        corners=vertices @ transform[:3, :3].T + transform[:3, 3],
        heading=float(np.arctan2(transform[1, 0], transform[0, 0])),
    )


def _text(node: ET.Element, name: str, where: str) -> str:
    child = node.find(name)
    if child is None or child.text is None:
        raise v.fail(where, f"no {name}", f"one with a {name}", "download it again")
    return child.text


def _integer(node: ET.Element, name: str, where: str) -> int:
    text = _text(node, name, where)
    try:
        return int(text)
    except ValueError as error:
        raise v.fail(f"{where}: {name}", repr(text), "a whole number", "download it again") from error


def _matrix(node: ET.Element, name: str, where: str) -> np.ndarray:
    """An `opencv-matrix` (rows, cols, data)."""
    child = node.find(name)
    if child is None:
        raise v.fail(where, f"no {name}", f"one with {name}", "download it again")
    shape = _integer(child, "rows", where), _integer(child, "cols", where)
    try:
        numbers = np.array(_text(child, "data", where).split(), np.float64)
    except ValueError as error:
        raise v.fail(f"{where}: {name}", "text", "numbers", "download it again") from error
    if numbers.size != shape[0] * shape[1] or not np.isfinite(numbers).all():
        found = f"{numbers.size} numbers"
        raise v.fail(f"{where}: {name}", found, f"{shape[0]} x {shape[1]} finite ones", "download it again")
    return numbers.reshape(shape)
