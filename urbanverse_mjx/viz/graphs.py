"""Draws scene graphs from above, and as boxes over the frames of a recording."""

from collections.abc import Sequence

import numpy as np
import shapely
from PIL import Image, ImageDraw

from ..datatypes import GraphObject, Recording, SceneGraph, ValidationError
from ..geometry.polygons import rectangle

#: sRGB colours of the kinds of ground in all maps.
GROUND_COLOURS = {
    "none": (238, 238, 234),
    "road": (92, 94, 100),
    "road_marking": (215, 215, 205),
    "crosswalk": (168, 160, 120),
    "sidewalk": (196, 186, 170),
    "ground": (150, 172, 128),
}
FOUND, TRUE, PATH = (214, 66, 40), (40, 96, 190), (30, 30, 30)
_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_NEAR_PLANE = 0.2  # m in front of the camera, edges are clipped there


def corners(obj: GraphObject) -> np.ndarray:
    """Returns the corners (8, 3) m of an object's box, the bottom first; corners 0 and 1 are at the front."""
    flat = shapely.get_coordinates(rectangle(*obj.size[:2], obj.yaw, *obj.center[:2]))[:4]
    half = obj.size[2] / 2
    return np.concatenate([np.c_[flat, np.full(4, obj.center[2] + dz)] for dz in (-half, half)])


def plan(
    graph: SceneGraph, ground_truth: Sequence[GraphObject] = (), width: int = 1600, margin: float = 3.0
) -> np.ndarray:
    """Returns an image (H, width, 3) u8 from above: ground, boxes with a tick towards the front, and the camera's path.

    Args:
      ground_truth: additional boxes, drawn in blue below the graph's red ones.
      margin: m around everything.
    """
    rings = [np.array(r.polygon) for r in graph.ground] + [corners(t)[:4, :2] for t in (*graph.objects, *ground_truth)]
    points = np.concatenate(rings)
    low, high = points.min(0) - margin, points.max(0) + margin
    scale = width / (high - low)[0]
    size = width, max(1, round((high - low)[1] * scale))

    def to_pixels(xy: np.ndarray) -> list[tuple[float, float]]:
        return [(float(x), float(y)) for x, y in np.c_[(xy[:, 0] - low[0]) * scale, (high[1] - xy[:, 1]) * scale]]

    image = Image.new("RGB", size, GROUND_COLOURS["none"])
    draw = ImageDraw.Draw(image)
    for region in graph.ground:
        draw.polygon(to_pixels(np.array(region.polygon)), fill=GROUND_COLOURS[region.kind], outline=(120, 120, 120))
    for objects, colour in ((ground_truth, TRUE), (graph.objects, FOUND)):
        for obj in objects:
            box = corners(obj)[:4, :2]
            draw.line(to_pixels(np.concatenate([box, box[:1]])), fill=colour, width=2)
            front = (box[0] + box[1]) / 2
            draw.line(to_pixels(np.stack([np.array(obj.center[:2]), front])), fill=colour, width=1)
    if len(graph.camera_path) > 1:
        draw.line(to_pixels(np.array(graph.camera_path)[:, :2]), fill=PATH, width=2)
    return np.asarray(image)


def overlay(recording: Recording, frame: int, objects: Sequence[GraphObject], reach: float = 40.0) -> np.ndarray:
    """Returns a frame (H, W, 3) u8 with boxes drawn over it, their fronts in blue.

    Args:
      reach: m, objects farther than this are left out.

    Raises:
      ValidationError: the frame has no pose.
    """
    pose = recording.frames[frame].pose
    if pose is None:
        raise ValidationError(
            f"frame {frame}: found no pose, needed one to draw boxes over it; choose a registered frame."
        )
    image = Image.fromarray(recording.rgb(frame))
    draw = ImageDraw.Draw(image)
    camera = recording.camera
    for obj in objects:
        if np.linalg.norm(np.subtract(obj.center, pose[:3, 3])) > reach:
            continue
        local = (corners(obj) - pose[:3, 3]) @ pose[:3, :3]
        for i, j in _EDGES:
            a, b = local[i], local[j]
            if max(a[2], b[2]) < _NEAR_PLANE:
                continue
            if a[2] < _NEAR_PLANE or b[2] < _NEAR_PLANE:
                cut = a + (b - a) * (_NEAR_PLANE - a[2]) / (b[2] - a[2])
                a, b = (cut, b) if a[2] < _NEAR_PLANE else (a, cut)
            line = [(camera.fx * p[0] / p[2] + camera.cx, camera.fy * p[1] / p[2] + camera.cy) for p in (a, b)]
            draw.line(line, fill=TRUE if {i, j} <= {0, 1, 4, 5} else FOUND, width=2)
    return np.asarray(image)
