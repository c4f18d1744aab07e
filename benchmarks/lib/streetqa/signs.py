"""Which words stand on which objects, and where: found by building an asset once more without its words.

Recipes write words by `paint.text`. An asset that is built with one of its texts left out differs from the original
exactly at the texels of that text, so that their places in the world, and in an image, follow from the mesh.
"""

import contextlib
import dataclasses
import json
import pathlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from urbanverse_mjx.assets.meshes import mesh_cache, paint
from urbanverse_mjx.assets.meshes.recipe import get_recipe
from urbanverse_mjx.capture.street import slot_vertices
from urbanverse_mjx.datatypes import AssetMesh, SceneBank, SceneLayout, array_file
from urbanverse_mjx.materialisation import index_of

from .facts import Facts, Seen, texel_cells
from .views import View

#: Texts of an asset up to which each of them is located; others carry menus and the like.
MOST_TEXTS = 3
#: A text is legible if a line of it is so many pixels high, a letter so many wide on average, and this share of its
#: places is visible; one that is at least `FAINT` pixels high may be legible to some.
LEAST_HEIGHT, LEAST_LETTER, LEAST_SHARE, FAINT = 7.5, 4.0, 0.95, 3.5
#: Pixels of an object below which nothing on it can be read.
LEAST_PIXELS = 400
#: Points per side of a triangle's grid on which texels are looked up; m of depth within which a point is visible.
_GRID, _DEPTH = 28, 0.06


@dataclasses.dataclass(frozen=True)
class Text:
    """A text as a view shows it.

    Attributes:
      words: of one line, lines joined by a space.
      slot: the object that carries it.
      column: pixels, its middle.
      legible: whether it can be read; else it is only large enough that somebody may.
    """

    words: str
    slot: int
    column: float
    legible: bool


@contextlib.contextmanager
def _observed(replace: Callable[[str], bool]) -> Iterator[list[str]]:
    """Records the words that recipes write; those for which `replace` holds are not drawn."""
    original, written = paint.text, []

    def text(draw: Any, words: str, *args: Any, **options: Any) -> None:
        written.append(words)
        if not replace(words):
            original(draw, words, *args, **options)

    paint.text = text
    try:
        yield written
    finally:
        paint.text = original


def texts_of(build: Callable[[], AssetMesh]) -> dict[str, np.ndarray]:
    """Text -> (H, W) bool, the texels on which it stands, of an asset with at most `MOST_TEXTS` texts; else empty.

    Args:
      build: builds the asset anew.
    """
    with _observed(lambda _: False) as written:
        whole = build().texture
    texts = list(dict.fromkeys(written))
    if len(texts) > MOST_TEXTS:
        return {}
    found = {}
    for words in texts:
        with _observed(lambda other, words=words: other == words):
            without = build().texture
        if without.shape == whole.shape:
            differs = (without != whole).any(-1)
            if differs.any():
                found[words] = differs
    return found


def _cached_texts(recipe: str, leaf: str, variant: int) -> dict[str, np.ndarray]:
    """`texts_of` a recipe's variant, read from the cache beside its mesh, or written to it."""
    path = mesh_cache.path_of(recipe, leaf, variant).with_suffix(".texts.npz")
    arrays = array_file.load_cached(path, "texts of an asset", ("words", "texels"))
    if arrays is None:
        found = texts_of(lambda: get_recipe(recipe, leaf).build(variant).mesh)
        words = np.frombuffer(json.dumps(list(found)).encode(), np.uint8)
        texels = np.stack(list(found.values())) if found else np.zeros((0, 1, 1), bool)
        array_file.save_cached(path, {"words": words, "texels": texels})
        return found
    return dict(zip(json.loads(arrays["words"].tobytes()), arrays["texels"], strict=True))


class Signs:
    """Texts of the objects of scenes.

    Args:
      layouts: scene id -> file of its layout.
    """

    def __init__(self, layouts: Callable[[str], pathlib.Path]) -> None:
        self._layouts = layouts
        self._bases: dict[tuple[str, str, int], dict[str, np.ndarray]] = {}
        self._scenes: dict[str, dict[str, tuple[str, str, int]]] = {}

    def _base_of(self, scene: str, name: str) -> tuple[str, str, int] | None:
        """Recipe, leaf and variant of an object of a scene, None if it is no recipe's."""
        if scene not in self._scenes:
            layout = SceneLayout.load(self._layouts(scene))
            index = index_of(layout)
            rows = {placed.id: index.get(placed.asset_uid) for placed in layout.objects}
            self._scenes[scene] = {
                name: (r.recipe, r.leaf, int(r.params["variant"])) for name, r in rows.items() if "variant" in r.params
            }
        return self._scenes[scene].get(name)

    def _texels(self, scene: str, name: str) -> dict[str, np.ndarray]:
        base = self._base_of(scene, name)
        if base is None:
            return {}
        if base not in self._bases:
            recipe, leaf, variant = base
            self._bases[base] = _cached_texts(recipe, leaf, variant)
        return self._bases[base]

    def in_view(self, facts: Facts) -> list[Text]:
        """The texts of a view that are, or may be, legible."""
        ids = facts.bank.meta["object_ids"][facts.scene]
        found = []
        for seen in facts.seen:
            if seen.pixels < LEAST_PIXELS or not _has_images(
                facts.bank, int(facts.bank.slot_mesh[facts.scene, seen.slot])
            ):
                continue
            for words, texels in self._texels(facts.view.scene, ids[seen.slot]).items():
                text = _shown(facts, seen, words, texels)
                if text is not None:
                    found.append(text)
        return found


def _has_images(bank: SceneBank, mesh: int) -> bool:
    """Whether some triangle of a mesh shows a part of an image instead of one colour."""
    uv = bank.mesh_uv[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]]
    corners = uv[bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]]
    return bool((corners != corners[:, :1]).any())


def _shown(facts: Facts, seen: Seen, words: str, texels: np.ndarray) -> Text | None:
    points = text_points(facts.bank, facts.scene, seen.slot, texels, facts.view.position)
    best = None
    for face in points:
        text = _read(facts.view, seen.slot, words, face)
        if text is not None and (best is None or (text.legible and not best.legible)):
            best = text
    return best


def text_points(bank: SceneBank, scene: int, slot: int, texels: np.ndarray, camera: np.ndarray) -> list[np.ndarray]:
    """Points (n, 3) m of the world at which a text stands, for each direction of the faces that show it to a camera.

    Args:
      texels: (H, W) bool of the mesh's texture.
    """
    mesh = int(bank.slot_mesh[scene, slot])
    texture = int(bank.material_texture[bank.mesh_material[mesh]])
    if texture < 0 or tuple(bank.texture_shape[texture][:2]) != texels.shape:
        return []
    faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
    uv = bank.mesh_uv[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]][faces].astype(np.float64)
    # Only triangles whose part of the texture overlaps the text's can show it.
    marked = np.argwhere(texels)
    (top, left), (bottom, right) = marked.min(0), marked.max(0)
    low, high = uv.min(1) * texels.shape[::-1], uv.max(1) * texels.shape[::-1]
    rows = texels.shape[0] - np.array([bottom + 1, top])
    textured = (uv != uv[:, :1]).any((1, 2)) & (high[:, 0] > left) & (low[:, 0] < right + 1)
    textured &= (high[:, 1] > rows[0]) & (low[:, 1] < rows[1])
    corners = slot_vertices(bank, scene, slot)[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = (normal * (camera - corners.mean(1))).sum(1) > 0.0
    grid = np.array([(i, j) for i in range(_GRID + 1) for j in range(_GRID + 1 - i)], np.float64) / _GRID
    shares = np.column_stack([grid, 1.0 - grid.sum(1)])
    groups: dict[tuple[float, ...], list[np.ndarray]] = {}
    for face in np.flatnonzero(textured & facing):
        rows, columns = texel_cells(shares @ uv[face], texels.shape)
        inside = texels[rows, columns]
        if inside.any():
            unit = normal[face] / max(float(np.linalg.norm(normal[face])), 1e-12)
            groups.setdefault(tuple(np.round(unit, 1).tolist()), []).append((shares @ corners[face])[inside])
    return [np.concatenate(group) for group in groups.values()]


def _read(view: View, slot: int, words: str, points: np.ndarray) -> Text | None:
    pixels, depth = view.project(points)
    h, w = view.slots.shape
    cells = np.floor(pixels).astype(int)
    inside = (depth > 0.2) & np.all((cells >= 0) & (cells < (h, w)), axis=-1)
    if not inside.any():
        return None
    i, j = np.where(inside[:, None], cells, 0).T
    near = np.abs(view.depth[i, j] - depth) < np.maximum(_DEPTH, 0.03 * depth)
    visible = inside & (view.slots[i, j] == slot) & near
    lines = words.split("\n")
    size = np.ptp(pixels[inside], axis=0)
    height, letter = size[0] / len(lines), size[1] / max(len(line) for line in lines)
    if height < FAINT or visible.mean() < 0.1:
        return None
    legible = height >= LEAST_HEIGHT and letter >= LEAST_LETTER and visible.mean() >= LEAST_SHARE
    return Text(" ".join(words.split()), slot, float(pixels[inside, 1].mean()), bool(legible))
