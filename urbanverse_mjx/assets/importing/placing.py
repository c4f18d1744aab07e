"""Transforms a mesh to the asset frame: upright, in metres, with its front along +x, on the ground.

Sizes come from the file's annotation if there is one, otherwise from the leaf's prior.
"""

import dataclasses
import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..categories.priors import Prior
from ..meshes.glb import TO_GLTF

#: Possible units of a file in metres, likeliest first.
UNITS = {
    "metres": 1.0,
    "centimetres": 0.01,
    "millimetres": 0.001,
    "inches": 0.0254,
    "feet": 0.3048,
    "decimetres": 0.1,
    "tenths of a metre's inverse": 10.0,
    "hundredfold": 100.0,
    "thousandfold": 1000.0,
}
SLACK = math.log(1.25)  # log factor beyond the leaf's least and greatest sizes up to which the scale is not changed
MAX_STRETCH_LOG = math.log(2.0)  # log factor at the best scale that indicates another object
# Least advantage (log of a side) of the fit of z up over y up, by the file's own statement. glTF defines y as up, most
# OBJ files state no axis, and a file that states z up is believed unless y up fits far better.
Z_UP = {True: math.log(2.0), None: math.log(1.1), False: -math.log(2.0)}
MEDIAN_WEIGHT = 0.25  # weight of the distance from the leaf's median sizes beside the misfit
# Least ratio of the horizontal sides for a quarter turn, of the leaf's median and of the mesh. Assets about as long as
# wide (people, letter boxes) may have either orientation.
MIN_LEAF_ASPECT, MIN_MESH_ASPECT = 1.5, 1.2
MAX_SCALE_DIFFERENCE = 0.1  # largest relative difference of the scales from two annotated sides


@dataclasses.dataclass(frozen=True)
class Placement:
    """Transformation of a file to the asset frame.

    Attributes:
      rotation: (3, 3), file frame to asset frame.
      scale: metres per unit of the file.
      misfit: log of the factor by which a side is still outside the leaf's sizes.
      scaled, steps: the changes, in words; `scaled` is empty where the file was in metres.
    """

    rotation: np.ndarray
    scale: float
    misfit: float
    scaled: str
    steps: tuple[str, ...]

    def apply(self, vertices: np.ndarray) -> np.ndarray:
        """(V, 3) in the asset frame, m, the footprint's centre on the origin, the lowest point on the ground."""
        placed = self.scale * (vertices @ self.rotation.T)
        low, high = placed.min(0), placed.max(0)
        return placed - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]


def quarter_turns(count: int) -> np.ndarray:
    """(3, 3) rotation about z by `count` quarters, counter-clockwise."""
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][count % 4]
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def place(
    vertices: np.ndarray,
    y_up: bool | None,
    row: Prior,
    sizes: Mapping[str, float] | None = None,
    front_view: int | None = None,
) -> Placement:
    """Finds the placement of a mesh.

    Args:
      vertices: (V, 3) that faces use, in the file's frame.
      y_up: stated by the file; None where it states none.
      row: prior of its leaf.
      sizes: annotated `height`, `length`, `width` in m, any of them.
      front_view: annotated view (0 to 3) that shows the front; view k is from k quarters counter-clockwise.
    """
    steps: list[str] = []
    upright, lying = TO_GLTF.T, np.eye(3)
    fits = {}
    for name, rotation in (("y up", upright), ("z up", lying)):
        extent = np.ptp(vertices @ rotation.T, axis=0)
        scale, misfit, scaled = _scale(extent, row, sizes)
        likely = misfit + MEDIAN_WEIGHT * float(np.abs(_off_median(scale * extent, row)).mean())
        fits[name] = (rotation, extent, scale, misfit, scaled, likely)
    chosen = "z up" if fits["y up"][5] - fits["z up"][5] > Z_UP[y_up] else "y up"
    rotation, extent, scale, misfit, scaled, _ = fits[chosen]
    if (chosen == "y up") is not y_up:
        steps.append(f"read with {chosen[0]} up" if y_up is None else f"stood up: its {chosen[0]} axis points up")
    turns = _front(extent, row) if front_view is None else -front_view
    if turns % 4:
        steps.append(f"turned by {90 * (turns % 4)} degrees to face +x")
    return Placement(quarter_turns(turns) @ rotation, scale, misfit, scaled, tuple(steps))


def _sorted_sides(extent: Sequence[float] | np.ndarray) -> np.ndarray:
    """(length, width, height): the longer ground side first."""
    x, y, z = extent
    return np.array([max(x, y), min(x, y), z])


def _off_median(extent: np.ndarray, row: Prior) -> np.ndarray:
    """(3,) log of each side over the leaf's median."""
    return np.log(np.maximum(_sorted_sides(extent), 1e-9)) - np.log([row.length[1], row.width[1], row.height[1]])


def _misfit(sides: np.ndarray, row: Prior) -> float:
    """Log of the factor by which the worst side is outside the leaf's sizes and the slack; 0 inside."""
    logs = np.log(np.maximum(sides, 1e-9))
    low, high = (np.log([row.length[k], row.width[k], row.height[k]]) for k in (0, 2))
    return float(np.maximum(np.maximum(low - SLACK - logs, logs - high - SLACK), 0.0).max())


def misfit_of_proportions(extent: np.ndarray, row: Prior) -> float:
    """Log of the factor by which the worst side is outside the leaf's sizes at the best scale."""
    free = float(np.exp(-_off_median(extent, row).mean()))
    return _misfit(_sorted_sides(extent * free), row)


def _scale(extent: np.ndarray, row: Prior, sizes: Mapping[str, float] | None) -> tuple[float, float, str]:
    """(metres per unit, misfit, the change)."""
    sides = _sorted_sides(np.maximum(extent, 1e-12))
    if sizes:
        return _annotated_scale(sides, sizes, row)
    fits = {unit: _misfit(sides * factor, row) for unit, factor in UNITS.items()}
    if fits["metres"] == 0.0:
        return 1.0, 0.0, ""
    medians = np.log([row.length[1], row.width[1], row.height[1]])
    free = float(np.exp((medians - np.log(sides)).mean()))
    good = [unit for unit, misfit in fits.items() if misfit == 0.0]
    if good:
        unit = min(good, key=lambda name: abs(math.log(UNITS[name] / free)))
        return UNITS[unit], 0.0, f"scaled by {UNITS[unit]:g} to the sizes of a {row.leaf}{_unit_words(unit)}"
    misfit = _misfit(sides * free, row)
    if fits["metres"] <= max(misfit, SLACK):  # unusual proportions, but metres fit as well as any unit
        return 1.0, fits["metres"], ""
    return free, misfit, f"scaled by {free:.4g} to the sizes of a {row.leaf}, in no unit"


def _unit_words(unit: str) -> str:
    return f" (it was in {unit})" if UNITS[unit] < 1 else ""


def _annotated_scale(sides: np.ndarray, sizes: Mapping[str, float], row: Prior) -> tuple[float, float, str]:
    wanted = {k: sizes[name] for k, name in enumerate(("length", "width", "height")) if name in sizes}
    factors = [value / sides[k] for k, value in wanted.items()]
    # Annotators agree best on the height; without one, the first annotated side is used.
    factor = wanted[2] / sides[2] if 2 in wanted else factors[0]
    misfit = max(abs(math.log(f / factor)) for f in factors) - math.log(1 + MAX_SCALE_DIFFERENCE)
    if abs(factor - 1.0) < MAX_SCALE_DIFFERENCE:
        return 1.0, max(misfit, 0.0), ""
    return float(factor), max(misfit, 0.0), f"scaled by {factor:.4g} to the annotated size"


def _front(extent: np.ndarray, row: Prior) -> int:
    """Quarter turns that bring the leaf's front to +x: the long side along x (a car) or along y (a bench)."""
    x, y, _ = extent
    if row.front == "none" or row.length[1] < MIN_LEAF_ASPECT * row.width[1]:
        return 0
    wrong = y > MIN_MESH_ASPECT * x if row.front == "end" else x > MIN_MESH_ASPECT * y
    return 3 if wrong else 0
