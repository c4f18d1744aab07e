"""Matches objects of a scene graph to assets by the paper's three steps: semantics, geometry, appearance.

1. Semantic: the label's leaves (`semantics.rank_leaves`); a leaf without shapes gets a substitute.
2. Geometric: of their records, the 1,000 whose boxes need the least distortion to fit the object's box.
3. Appearance: of those the ones most similar to the crop, by the built-in descriptor (`descriptors`) computed from the
   records' parameters; `Matcher.rerank` orders the best of them by DINOv2 over thumbnails (`neural.ImageEmbedder`).

Without weights the first step compares letters and words (TF-IDF) instead of CLIP's vectors, and there is no `rerank`.
"""

import dataclasses
import functools
import json
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from urbanverse_mjx.datatypes import AssetRecord, ValidationError

from ..categories.semantics import TextEmbedder, rank_leaves
from ..meshes import instances
from ..meshes.base_shapes import BaseShape, measure, shape_of
from ..meshes.mesh_builder import BuiltAsset
from ..meshes.tints import is_free
from ..records.index import AssetIndex, load_index
from ..records.user_store import FILE_RECIPE, file_mesh
from . import descriptors
from .neural import ImageEmbedder
from .search import ObjectLibrary, library

NUM_CANDIDATES = 1000  # the paper's number of candidates after the geometric step
# Least score relative to the best one, and largest number, of candidate leaves; an exact match of a name has no
# alternatives.
_MIN_SCORE_RATIO, _MAX_LEAVES = 0.9, 3


@dataclasses.dataclass(frozen=True)
class Match:
    """One asset for an object.

    Attributes:
      uid, leaf: uid and leaf of the asset.
      distortion: mean |log| of the factors between the boxes' sides; 0 for equal boxes, 0.1 for 10 % a side.
      appearance_distance: distance of the descriptors, or 1 - cosine of the embeddings; None without a descriptor.
      yaw: rad, rotation of the asset that fits the box best, 0 or pi / 2.
      base: uid of its base shape (its own for a base shape).
    """

    uid: str
    leaf: str
    distortion: float
    appearance_distance: float | None
    yaw: float
    base: str


class Matcher:
    """Matches objects against a library."""

    def __init__(self, objects: ObjectLibrary | None = None, index: AssetIndex | None = None) -> None:
        self._objects = objects or library()
        # Records of the catalogue are made from base shapes of the index; imported assets are their own base shapes.
        self._index = index or AssetIndex((*load_index().records, *self._objects.imported()))
        self._of_leaf: dict[str, _Leaf] = {}
        self._thumbnails: dict[tuple[ImageEmbedder, str], NDArray] = {}

    def match(
        self,
        label: str,
        size: Sequence[float],
        descriptor: Sequence[int] | NDArray | None = None,
        count: int = 5,
        keep: int = NUM_CANDIDATES,
        text: TextEmbedder | None = None,
        slack: float | None = None,
        turn_gain: float = 0.0,
    ) -> list[Match]:
        """The best assets for an object, best first.

        Args:
          label: free text.
          size: (along the heading, across, up) m, as in `SceneGraph`.
          descriptor: descriptor by `descriptors.of_image`; None to rank by the box only.
          count: number of assets.
          keep: number of candidates after the geometric step.
          text: embedding of labels; None for the built-in one.
          slack: largest difference of a candidate's distortion to the least one; None for all.
          turn_gain: least reduction of the distortion for a quarter turn, so that a nearly square box does not change
            the direction of the front.

        Raises: UnknownLabelError: no leaf matches the label. ValidationError: a size not above 0, a descriptor that is
        not ours.
        """
        box = np.asarray(size, dtype=np.float64)
        if box.shape != (3,) or not (np.isfinite(box).all() and (box > 0).all()):
            raise ValidationError(f"size: found {list(size)}, needed three lengths above 0 m.")
        leaves = [self._leaf(leaf) for leaf in self.leaves(label, text)]
        extents = np.concatenate([leaf.extents for leaf in leaves])
        distortion, turned = distortions(box, extents, turn_gain)
        near = np.argsort(distortion, kind="stable")[:keep]
        if slack is not None:
            near = near[distortion[near] <= distortion[near[0]] + slack]
        appearance_distance = None
        if descriptor is not None:
            appearance_distance = np.concatenate([np.zeros(0), _descriptor_table(leaves, near).distances(descriptor)])
            order = np.lexsort((distortion[near], appearance_distance))[:count]
        else:
            order = np.arange(min(count, len(near)))
        owner = np.repeat(np.arange(len(leaves)), [len(leaf.extents) for leaf in leaves])
        start = np.cumsum([0, *(len(leaf.extents) for leaf in leaves)])
        matches = []
        for k in order:
            row = near[k]
            leaf = leaves[owner[row]]
            at = row - start[owner[row]]
            seen = None if appearance_distance is None else float(appearance_distance[k])
            yaw, base = float(turned[row]) * np.pi / 2, leaf.shapes[leaf.base[at]].uid
            matches.append(Match(leaf.uids[at], leaf.name, float(distortion[row]), seen, yaw, base))
        return matches

    def rerank(self, matches: Sequence[Match], crop: np.ndarray, embedder: ImageEmbedder) -> list[Match]:
        """Sorts matches by a neural image embedding of the crop and of their thumbnails.

        Thumbnails are drawn if missing; each is encoded once by an embedder.

        Args:
          crop: (H, W, 3) uint8, the object on a plain background like that of the thumbnails.
        """
        missing = [uid for uid in dict.fromkeys(m.uid for m in matches) if (embedder, uid) not in self._thumbnails]
        images = self._objects.load_thumbnails(missing)
        vectors = embedder([crop, *(images[uid] for uid in missing)])
        self._thumbnails |= {(embedder, uid): x for uid, x in zip(missing, vectors[1:], strict=True)}
        appearance_distance = 1.0 - np.stack([self._thumbnails[embedder, m.uid] for m in matches]) @ vectors[0]
        order = np.argsort(appearance_distance, kind="stable")
        return [dataclasses.replace(matches[k], appearance_distance=float(appearance_distance[k])) for k in order]

    def leaves(self, label: str, text: TextEmbedder | None = None) -> list[str]:
        """The leaves with shapes that a label may denote, best first, at least one."""
        ranked = rank_leaves(label, 659, text)
        best = ranked[0][1]
        alike = [leaf for leaf, score in ranked[:_MAX_LEAVES] if score >= _MIN_SCORE_RATIO * best]
        if best >= 0.9:  # a name or a noun
            alike = [ranked[0][0]]
        found = [name for leaf in alike if (name := self._index.stand_in(leaf))]
        if not found:
            found = [name for leaf, _ in ranked if (name := self._index.stand_in(leaf))][:1]
        if not found:
            raise ValidationError(
                f"label {label!r}: found no leaf with shapes like it, needed one; write a recipe for it."
            )
        return list(dict.fromkeys(found))

    def _leaf(self, name: str) -> "_Leaf":
        if name not in self._of_leaf:
            self._of_leaf[name] = _Leaf.of(name, self._objects, self._index)
        return self._of_leaf[name]


@dataclasses.dataclass(frozen=True)
class _Leaf:
    """The records of a leaf as arrays of n rows."""

    name: str
    uids: list[str]
    extents: NDArray[np.float64]
    shapes: list[BaseShape]
    base: NDArray[np.int64]
    tint: NDArray[np.float64]
    scale: NDArray[np.float64]

    @functools.cached_property
    def descriptor_table(self) -> descriptors.DescriptorTable:
        """Descriptors of all records of the leaf."""
        free = np.full(len(self.base), is_free(self.name))
        return descriptors.of_records(free, self.shapes, self.base, self.tint, self.scale)

    @staticmethod
    def of(name: str, objects: ObjectLibrary, index: AssetIndex) -> "_Leaf":
        table = objects.table.take(objects.rows_of(name))
        shapes = [_measured(r) if r.recipe == FILE_RECIPE else shape_of(r) for r in index.by_leaf(name)]
        place = {shape.uid: k for k, shape in enumerate(shapes)}
        base, tint, scale = [], [], []
        for uid, params in zip(table["uid"].to_pylist(), table["params"].to_pylist(), strict=True):
            inner = json.loads(params).get(instances.KEY, {"base": uid, "tint": (0.0, 1.0, 1.0), "scale": (1.0,) * 3})
            base.append(place[inner["base"]])
            tint.append(inner["tint"])
            scale.append(inner["scale"])
        extents = np.array(table["extent_xyz"].to_pylist())
        return _Leaf(name, table["uid"].to_pylist(), extents, shapes, np.array(base), np.array(tint), np.array(scale))


def _measured(record: AssetRecord) -> BaseShape:
    """Measures an imported asset, which is not in the table."""
    mesh = file_mesh(record)
    return measure(
        record.uid, BuiltAsset(mesh, record.description, {}, record.volume, record.mass, (len(mesh.faces),)), True
    )


def distortions(
    box: NDArray, extents: NDArray, turn_gain: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Distortion between (n, 3) boxes and one box: mean |log| of the factors of the sides for the better of two
    orientations, and that orientation (0 or 1). A quarter turn is used only if it saves more than `turn_gain`."""
    straight = np.abs(np.log(extents / box)).mean(1)
    turned = np.abs(np.log(extents[:, [1, 0, 2]] / box)).mean(1)
    turns = turned < straight - turn_gain
    return np.where(turns, turned, straight), turns.astype(np.int64)


def _descriptor_table(leaves: Sequence[_Leaf], rows: NDArray) -> descriptors.DescriptorTable:
    """Descriptors of rows of the leaves' concatenated records."""
    found = [leaf.descriptor_table for leaf in leaves]
    parts = (np.concatenate([getattr(x, name) for x in found])[rows] for name in ("colors", "layouts", "aspects"))
    return descriptors.DescriptorTable(*parts)
