"""Draws the street from above: the recording's depth points with the graph's ground, boxes and headings."""

import html
import math
from collections.abc import Sequence

import numpy as np

from ....datatypes import Recording, SceneGraph
from ....viz.graphs import GROUND_COLOURS, corners

#: m, cell of the image from above; stride in pixels, and largest number of frames, with which the recording is read.
CELL, PIXEL_STRIDE, MAX_FRAMES = 0.1, 3, 60
#: m; points farther from the camera are too coarse for cells of 10 cm, and points higher above it hide the street.
MAX_DISTANCE, MAX_HEIGHT_OVER_CAMERA = 25.0, 1.0
_MARGIN = 2.0  # m around the ground


def extent(graph: SceneGraph) -> tuple[float, float, float, float]:
    """Lower and upper x and y of the ground, all boxes and the trajectory, with a margin."""
    points = [p for region in graph.ground for p in region.polygon] + [p[:2] for p in graph.camera_path]
    points += [corner for obj in graph.objects for corner in corners(obj)[:4, :2]]
    low, high = np.min(points, 0) - _MARGIN, np.max(points, 0) + _MARGIN
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def seen_from_above(recording: Recording, area: Sequence[float]) -> np.ndarray:
    """(rows, columns, 4) uint8: mean colour of the depth points in each cell of an area, y upwards, alpha 0 without
    points."""
    x0, y0, x1, y1 = area
    columns, rows = math.ceil((x1 - x0) / CELL), math.ceil((y1 - y0) / CELL)
    colour, count = np.zeros((rows * columns, 3)), np.zeros(rows * columns)
    rays = recording.camera.rays()[::PIXEL_STRIDE, ::PIXEL_STRIDE]
    chosen = recording.registered[:: max(1, len(recording.registered) // MAX_FRAMES)]
    for number in chosen.tolist():
        depth, pose = recording.depth(number), recording.frames[number].pose
        if depth is None or pose is None:
            continue
        near = depth[::PIXEL_STRIDE, ::PIXEL_STRIDE]
        points = (rays * near[..., None]) @ pose[:3, :3].T + pose[:3, 3]
        column = np.floor((points[..., 0] - x0) / CELL).astype(int)
        row = np.floor((y1 - points[..., 1]) / CELL).astype(int)
        keep = (near > 0) & (near < MAX_DISTANCE) & (points[..., 2] < pose[2, 3] + MAX_HEIGHT_OVER_CAMERA)
        keep &= (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        cell = row[keep] * columns + column[keep]
        pixels = recording.rgb(number)[::PIXEL_STRIDE, ::PIXEL_STRIDE][keep]
        count += np.bincount(cell, minlength=len(count))
        for k in range(3):
            colour[:, k] += np.bincount(cell, pixels[:, k], len(count))
    mean = colour / np.maximum(count, 1.0)[:, None]
    return np.column_stack([mean, np.where(count > 0, 255, 0)]).astype(np.uint8).reshape(rows, columns, 4)


def svg(graph: SceneGraph, colours: dict[str, str], image: str | None = None) -> str:
    """Draws the graph from above as SVG, which the page's script completes by the camera and the chosen object.

    Args:
      colours: label -> CSS colour.
      image: address of the image of `seen_from_above` over the graph's `extent`, hidden until the page shows it.
    """
    x0, y0, x1, y1 = extent(graph)
    lines = [f'<svg id="map" viewBox="{x0:.2f} {-y1:.2f} {x1 - x0:.2f} {y1 - y0:.2f}">']
    for region in graph.ground:
        outline = " ".join(f"{x:.2f},{-y:.2f}" for x, y in region.polygon)
        style = f'fill="rgb{GROUND_COLOURS[region.kind]}" stroke="#3a3f46" stroke-width="0.06"'
        name = html.escape(f"{region.id}: {region.kind}")
        lines.append(f'<polygon class="ground" points="{outline}" {style}><title>{name}</title></polygon>')
    if image:
        size = f'width="{x1 - x0:.2f}" height="{y1 - y0:.2f}"'
        lines.append(
            f'<image id="depth" href="{image}" x="{x0:.2f}" y="{-y1:.2f}" {size} preserveAspectRatio="none" hidden/>'
        )
    if graph.camera_path:
        line = " ".join(f"{p[0]:.2f},{-p[1]:.2f}" for p in graph.camera_path)
        lines.append(f'<polyline points="{line}" fill="none" stroke="#d0342c" stroke-width="0.2"/>')
    for obj in graph.objects:
        along, across, _ = obj.size
        x, y, _ = obj.center
        title = html.escape(f"{obj.id}: {obj.label}, {along:.2f} x {across:.2f} x {obj.size[2]:.2f} m")
        colour = colours.get(obj.label, "#888888")
        style = f'fill="{colour}" fill-opacity="0.55" stroke="{colour}" stroke-width="0.08"'
        lines.append(
            f'<g class="object" data-id="{html.escape(obj.id)}" '
            f'transform="translate({x:.3f} {-y:.3f}) rotate({-math.degrees(obj.yaw):.2f})">'
            f'<rect x="{-along / 2:.3f}" y="{-across / 2:.3f}" width="{along:.3f}" height="{across:.3f}" {style}>'
            f'<title>{title}</title></rect><line x1="0" y1="0" x2="{along / 2:.3f}" y2="0" {style}/></g>'
        )
    lines.append('<path id="camera" d="M 1.6 0 L -0.8 0.8 L -0.8 -0.8 Z" hidden/>')
    return "\n".join([*lines, "</svg>"])
