"""What a view shows for certain: its objects, their share that is visible, distance, colour, ground and place."""

import dataclasses
import functools
import pathlib
from collections.abc import Sequence

import numpy as np
from PIL import Image
from scipy import ndimage

from urbanverse_mjx.capture.street import StreetGrid, slot_vertices, street_grid
from urbanverse_mjx.datatypes import GROUND_KINDS, SceneBank

from . import colours
from .views import View, is_ground
from .words import Word, words

#: Pixels (of 320 x 480) and share of its pixels from which an object is clearly visible; below so few it is as good as
#: invisible. Between both it is doubtful, and nothing is asked whose answer depends on it.
CLEAR_PIXELS, CLEAR_SHARE, INVISIBLE_PIXELS = 300, 0.5, 10
#: Pixels that an object at the image's border needs, as it may continue outside of it.
BORDER_PIXELS = 2000
#: An object is "the nearest" if the next one is farther by this factor.
NEARER = 1.3
#: Share of an object's nearest pixels that its distance leaves out, as single pixels on outlines are not certain.
_NEAREST_SHARE = 0.02


@dataclasses.dataclass(frozen=True)
class Seen:
    """An object of a view.

    Attributes:
      slot: visual slot; leaf: category.
      pixels: visible ones; share: of those that it would have if nothing stood before it.
      box: (4,) first row, first column, last row, last column of its visible pixels.
      distance: m from the camera to its nearest visible point.
      cut: whether it reaches the image's left, right or lower border.
    """

    slot: int
    leaf: str
    pixels: int
    share: float
    box: tuple[int, int, int, int]
    distance: float
    cut: bool

    @property
    def clear(self) -> bool:
        return self.pixels >= (BORDER_PIXELS if self.cut else CLEAR_PIXELS) and self.share >= CLEAR_SHARE

    @property
    def hidden(self) -> bool:
        return self.pixels <= INVISIBLE_PIXELS


class Facts:
    """Facts of one view.

    Attributes:
      view, bank, scene: the view, and its scene's row in a bank.
      rgb: (H, W, 3) u8, its image.
      seen: every object with at least one visible pixel.
    """

    def __init__(self, view: View, bank: SceneBank, rgb: np.ndarray, street: StreetGrid) -> None:
        self.view, self.bank, self.rgb, self.street = view, bank, rgb, street
        self.scene = bank.scene_ids.index(view.scene)
        self.grounds = is_ground(bank, self.scene)
        self.seen = tuple(self._objects())

    @staticmethod
    def of(view: View, bank: SceneBank, image: pathlib.Path, streets: dict[str, StreetGrid]) -> "Facts":
        """Facts of a view and its image's file; `streets` keeps what scenes share."""
        if view.scene not in streets:
            streets[view.scene] = street_grid(bank, bank.scene_ids.index(view.scene))
        return Facts(view, bank, np.asarray(Image.open(image).convert("RGB")), streets[view.scene])

    def leaf(self, slot: int) -> str:
        """Category of a slot."""
        return self.bank.meta["categories"][self.bank.slot_category[self.scene, slot]]

    def _objects(self) -> Sequence[Seen]:
        slots, view = self.view.slots.astype(np.int64), self.view
        h, w = slots.shape
        x, y = (np.arange(w) + 0.5 - w / 2) / view.focal, (np.arange(h) + 0.5 - h / 2) / view.focal
        distance = view.depth * np.sqrt(1.0 + x[None] ** 2 + y[:, None] ** 2)
        found = []
        boxes = ndimage.find_objects(slots + 1)
        for slot, box in enumerate(boxes):
            if box is None or self.grounds[slot]:
                continue
            own = slots[box] == slot
            ranges = np.sort(distance[box][own])
            corners = box[0].start, box[1].start, box[0].stop - 1, box[1].stop - 1
            pixels = int(own.sum())
            share = min(pixels / max(int(view.coverage[slot]), pixels, 1), 1.0)
            away = float(ranges[int(_NEAREST_SHARE * len(ranges))])
            cut = corners[1] == 0 or corners[2] == h - 1 or corners[3] == w - 1
            found.append(Seen(slot, self.leaf(slot), pixels, share, corners, away, cut))
        return found

    def of_word(self, word: Word) -> tuple[list[Seen], bool]:
        """Clearly visible objects of a word, nearest first, and whether nothing else in the view could be one."""
        clear = sorted((s for s in self.seen if s.leaf in word.leaves and s.clear), key=lambda s: s.distance)
        unclear = any(s.leaf in word.leaves and not s.clear and not s.hidden for s in self.seen)
        alike = any(s.leaf in word.doubtful and not s.hidden for s in self.seen)
        return clear, not (unclear or alike)

    @functools.cached_property
    def named(self) -> dict[str, Seen]:
        """Phrase -> the one object of the view that it can mean: "the bench", or "the nearest bench"."""
        found = {}
        for word in words().values():
            clear, certain = self.of_word(word)
            if not certain or not clear:
                continue
            if len(clear) == 1:
                found[f"the {word.name}"] = clear[0]
            elif clear[1].distance > NEARER * clear[0].distance:
                found[f"the nearest {word.name}"] = clear[0]
        return found

    def colour(self, seen: Seen) -> str | None:
        """Name of an object's main colour: that of the paint on its sides that face the camera, if its pixels in the
        lit image agree; else None."""
        paint, weight = _facing_paint(self.bank, self.scene, seen.slot, self.view.position)
        name = colours.main_colour(paint, weight)
        own = self.view.slots == seen.slot
        return name if name and colours.shown_as(self.rgb[own], name) else None

    def kind_at(self, points: np.ndarray) -> np.ndarray:
        """Kind of ground (`GROUND_KINDS`, by number) at points (n, 2) m; 0 outside the map."""
        cells = np.floor((points - self.bank.map_origin[self.scene]) / float(self.bank.map_resolution)).astype(int)
        kinds = self.bank.map_kind[self.scene]
        inside = np.all((cells >= 0) & (cells < kinds.shape), axis=-1)
        i, j = np.where(inside[..., None], cells, 0).T
        return np.where(inside, kinds[i, j], 0)

    def ground_under(self, seen: Seen) -> str | None:
        """The one kind of ground below an object's lowest 20 cm, or None if there are several."""
        corners = slot_vertices(self.bank, self.scene, seen.slot)
        foot = corners[corners[:, 2] < corners[:, 2].min() + 0.2, :2]
        kinds = set(self.kind_at(foot).tolist())
        return GROUND_KINDS[kinds.pop()] if len(kinds) == 1 else None


def _facing_paint(bank: SceneBank, scene: int, slot: int, camera: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Colours (n, 3) 0-255 of a mesh's triangles that face a camera, and their size (n,) as seen from there."""
    mesh = int(bank.slot_mesh[scene, slot])
    faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
    corners = slot_vertices(bank, scene, slot)[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    middle = corners.mean(1)
    towards = camera - middle
    away = np.maximum(np.linalg.norm(towards, axis=1), 1e-3)
    weight = np.maximum((normal * towards).sum(1), 0.0) / away**3
    uv = bank.mesh_uv[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]][faces]
    # Three points inside of each triangle: most are in one colour, some show an image.
    shares = np.array([[2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]])
    places = np.einsum("kc,fcd->fkd", shares, uv).reshape(-1, 2)
    return texels(bank, mesh, places), np.repeat(weight / 3, 3)


def texels(bank: SceneBank, mesh: int, uv: np.ndarray) -> np.ndarray:
    """Colours (n, 3) 0-255 of a mesh at texture coordinates (n, 2), v upwards."""
    material = int(bank.mesh_material[mesh])
    texture = int(bank.material_texture[material])
    tint = bank.material_rgba[material, :3].astype(np.float64)
    if texture < 0:
        return np.tile(255.0 * tint, (len(uv), 1))
    image = bank.texture(texture)
    rows, columns = texel_cells(uv, image.shape[:2])
    return image[rows, columns] * tint


def texel_cells(uv: np.ndarray, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns (n,) of a texture of `shape` (h, w) at coordinates (n, 2), repeated outside of [0, 1)."""
    h, w = shape
    rows = np.floor((1.0 - uv[:, 1]) * h).astype(int) % h
    return rows, np.floor(uv[:, 0] * w).astype(int) % w
