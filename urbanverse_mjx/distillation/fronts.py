"""Decides which end of a vehicle is its front.

Depth and masks give the axis of a vehicle and hardly its direction. Two cues do: traffic keeps to one side of the road,
and only tails have red lamps. Each adds log odds to those of the heading that the box has.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..datatypes import GroundRegion, Recording
from ..datatypes.traffic_side import keeps_left
from .colour import is_colourless


@dataclasses.dataclass(frozen=True)
class FrontOptions:
    """Weights of the cues, as log odds; chosen manually.

    Attributes:
      sharp, blurred: of the box's own heading where the depth shows shapes, and where it only faces the camera.
      side: of the side of the road, of vehicles at its edge. Some park against the traffic.
      middle, edge: offsets from the middle of the road, as shares of half its width, up to which the side says nothing
        and from which it says most.
      road_width: m, least and largest width of a carriageway whose sides are told apart; more is a junction.
      gap: m, gaps in the carriageway that are closed: vehicles hide the ground under and behind them.
      off_road: m, largest distance from the carriageway of a vehicle that parks beside it.
      tail, no_tail: of red lamps in a view from behind, and of their absence.
      lamp_shares: of a view's pixels: red is no lamp below the first, and the body's colour above the second.
      view_cosine: least cosine of a view to the vehicle's axis; others show its side, and lamps reach round corners.
      min_pixels: least pixels of a view.
      views: largest number of views of a vehicle.
    """

    sharp: float = 3.0
    blurred: float = 0.4
    side: float = 1.8
    middle: float = 0.15
    edge: float = 0.5
    road_width: tuple[float, float] = (4.5, 24.0)
    gap: float = 2.5
    off_road: float = 3.0
    tail: float = 3.0
    no_tail: float = 0.8
    lamp_shares: tuple[float, float] = (0.004, 0.12)
    view_cosine: float = 0.8
    min_pixels: int = 150
    views: int = 3


_OPTIONS = FrontOptions()


@dataclasses.dataclass(frozen=True)
class Vehicle:
    """A vehicle: center (2,) m, yaw rad; whether depth showed its shape; and its views: frame numbers and detections
    (k, 2), camera positions (k, 2) m, pixels (k,)."""

    center: np.ndarray
    yaw: float
    sharp: bool
    origin: np.ndarray
    viewpoint: np.ndarray
    pixels: np.ndarray


def log_odds(
    vehicles: Sequence[Vehicle], ground: Sequence[GroundRegion], recording: Recording
) -> tuple[np.ndarray, np.ndarray]:
    """(n,) log odds that each vehicle's front is where its heading points; below 0 it is at the other end. (n,) the
    part of them that the image and the road give."""
    road = shapely.union_all([shapely.Polygon(r.polygon) for r in ground if r.kind in ("road", "crosswalk")])
    left = keeps_left(recording.source.country)
    own = np.array([_OPTIONS.sharp if vehicle.sharp else _OPTIONS.blurred for vehicle in vehicles])
    cues = np.zeros(len(vehicles))
    if left is not None:
        cues += [side_of_road(vehicle.center, vehicle.yaw, road, left) for vehicle in vehicles]
    cues += _lamps(vehicles, recording)
    return own + cues, cues


def side_of_road(center: np.ndarray, yaw: float, road: BaseGeometry, left: bool) -> float:
    """Log odds of a heading by the vehicle's place between the edges of its road.

    Args:
      center: (2,) m; yaw: rad.
      road: the carriageways.
      left: whether traffic keeps left.
    """
    across = np.array([-np.sin(yaw), np.cos(yaw)])
    reach = _OPTIONS.road_width[1] + _OPTIONS.off_road
    line = shapely.LineString([center - reach * across, center + reach * across])
    spans: list[tuple[float, float]] = []
    for part in shapely.get_parts(line.intersection(road)):
        if part.is_empty:
            continue
        low, high = sorted(((shapely.get_coordinates(part) - center) @ across)[[0, -1]].tolist())
        spans.append((low, high))
    joined: list[tuple[float, float]] = []
    for low, high in sorted(spans):
        if joined and low - joined[-1][1] <= _OPTIONS.gap:
            low, high = joined[-1][0], max(high, joined.pop()[1])
        joined.append((low, high))
    low, high = min(joined, key=lambda ends: max(ends[0], -ends[1], 0.0), default=(np.inf, np.inf))
    if max(low, -high) > _OPTIONS.off_road:
        return 0.0
    width = high - low
    if not _OPTIONS.road_width[0] <= width <= _OPTIONS.road_width[1]:
        return 0.0
    # 1 where the vehicle is at the right edge with respect to its heading, -1 at the left one.
    offset = (high + low) / width
    strength = np.clip((abs(offset) - _OPTIONS.middle) / (_OPTIONS.edge - _OPTIONS.middle), 0.0, 1.0)
    return float((-1.0 if left else 1.0) * np.sign(offset) * strength * _OPTIONS.side)


def _lamps(vehicles: Sequence[Vehicle], recording: Recording) -> np.ndarray:
    """(n,) log odds of the headings by the lamps in the largest views from the ends of each vehicle."""
    wanted: dict[int, list[tuple[int, int, bool]]] = {}
    for k, vehicle in enumerate(vehicles):
        towards = vehicle.viewpoint - vehicle.center
        cosine = towards @ [np.cos(vehicle.yaw), np.sin(vehicle.yaw)]
        cosine /= np.maximum(np.linalg.norm(towards, axis=1), 1e-6)
        usable = (np.abs(cosine) > _OPTIONS.view_cosine) & (vehicle.pixels >= _OPTIONS.min_pixels)
        best = np.flatnonzero(usable)[np.argsort(-vehicle.pixels[usable], kind="stable")][: _OPTIONS.views]
        for row in best:
            frame, detection = vehicle.origin[row].tolist()
            wanted.setdefault(frame, []).append((k, detection, bool(cosine[row] < 0)))
    found: list[list[float]] = [[] for _ in vehicles]
    for frame, views in sorted(wanted.items()):
        image, masks = recording.rgb(frame), recording.masks(frame)
        if is_colourless(image):
            continue
        for k, detection, from_behind in views:
            odds = tail_log_odds(image[masks == detection])
            found[k].append(odds if from_behind else -odds)
    # Views of one vehicle show the same lamps and are not independent.
    return np.array([float(np.mean(odds)) if odds else 0.0 for odds in found]).reshape(len(vehicles))


def tail_log_odds(pixels: np.ndarray) -> float:
    """Log odds that the pixels (p, 3) u8 of a vehicle show its tail; 0 where the body itself is red."""
    red, green, blue = pixels.astype(np.float32).T
    share = float(((red > 80) & (red > 1.7 * green) & (red > 1.7 * blue)).mean())
    least, most = _OPTIONS.lamp_shares
    if share > most:
        return 0.0
    if share >= least:
        return _OPTIONS.tail
    return -_OPTIONS.no_tail if share < least / 4 else 0.0
