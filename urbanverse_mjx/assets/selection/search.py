"""Search over all records, with the names of the official toolkit.

    from urbanverse_mjx.assets.selection.search import library

    objects = library()
    uids = objects.get_uids_conditioned(categories=["bench"], mass_range=(20, 80), dominant_materials=["wood", "steel"])
    annotations = objects.load_annotations(uids[:5])

Filters are joined by AND, the entries of a list by OR. Ranges are (least, greatest) in SI units, both ends included,
None for no bound. (The official tables disagree on two units; here `youngs_modulus` is in MPa, as in their files.)
"""

import functools
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from urbanverse_mjx.datatypes import AssetRecord, ValidationError
from urbanverse_mjx.settings import imported_assets

from ..categories import ontology
from ..categories.semantics import TextEmbedder, rank_leaves
from ..records import annotations
from ..records.store import load_joined_store, load_store, record_of
from ..records.user_store import CATALOGUE, FILE_RECIPE
from . import integrity

Range = tuple[float | None, float | None]
Mask = NDArray[np.bool_]
BUILT_IN = "built-in"  # name of the embedding that needs no download
LEVELS = ("class_name_l1", "class_name_l2", "class_name_l3")
#: Filter by a range -> column.
RANGES = {
    f"{name}_range": name
    for name in (
        *("height", "length", "width", "max_dimension", "mass", "required_force", "surface_roughness", "reflectivity"),
        *("index_of_refraction", "youngs_modulus", "friction_coefficient", "bounciness", "recommended_clearance"),
    )
}
FLAGS = ("receptacle", "movable", "walkable", "enterable", "support_surface")
WORDS = ("surface_hardness", "surface_finish", "asset_composition_type")
#: Filter by a list over a column of lists -> column, and number of its first entries to use (None: all).
LISTS: Mapping[str, tuple[str, int | None]] = {
    "dominant_materials": ("materials", 2),
    "affordances": ("affordances", None),
    "interactive_parts": ("interactive_parts", None),
    "dominant_colors": ("colors", 2),
}
#: Official filters that the catalogue does not support, with the reason.
UNANSWERED = {"quality_range": "these meshes have no quality rating; omit this filter"}


class ObjectLibrary:
    """The records of the catalogue."""

    def __init__(self, table: pa.Table | None = None) -> None:
        self.table = load_store() if table is None else table
        uids = self.table["uid"].to_pylist()
        self._rows = {uid: k for k, uid in enumerate(uids)}
        self._made: dict[str, AssetRecord] = {}
        self._all = np.array(uids, dtype=object)  # converted once, because the conversion costs more than any filter
        self._filters: dict[str, Callable[[Any], Mask]] = {
            **{name: functools.partial(self._in_range, column, name) for name, column in RANGES.items()},
            **{name: functools.partial(self._is, name) for name in FLAGS},
            **{name: functools.partial(self._one_of, name) for name in WORDS},
            **{name: functools.partial(self._any_of, name) for name in LISTS},
            "categories": self._of_categories,
        }

    # What there is ----------------------------------------------------------------------------------------------------

    def get_uids_all(self) -> list[str]:
        """Every uid, leaf by leaf in the ontology's order."""
        return list(self._rows)

    def categories(self, level: int | str = 3) -> list[str]:
        """The names of a level of the tree: 1 (8 of them), 2 (59) or 3 (659), in the ontology's order.

        Raises:
          ValidationError: another level.
        """
        digit = str(level).strip().lower().removeprefix("class_name_").removeprefix("l")
        if digit not in ("1", "2", "3"):
            raise ValidationError(f"level: found {level!r}, needed 1, 2 or 3.")
        return list(dict.fromkeys(levels[int(digit) - 1] for levels in ontology.categories().values()))

    def words(self, name: str) -> list[str]:
        """The words that a filter of `LISTS` takes, in alphabetical order."""
        return sorted(self._entries(name)[2])

    def filters(self) -> list[str]:
        """The names that `get_uids_conditioned` takes."""
        return [*self._filters, "query"]

    # Finding ----------------------------------------------------------------------------------------------------------

    def get_uids_conditioned(
        self,
        *,
        query: str | None = None,
        top_k: int = 100,
        embedding_model: str = BUILT_IN,
        **conditions: Any,
    ) -> list[str]:
        """The uids that meet all conditions, in the order of the table; with a query the `top_k` nearest, best first.

        Args:
          query: free text, e.g. "an old wooden bench".
          top_k: number of results of a query.
          embedding_model: "built-in" (letters and words, offline), or the name of a sentence-transformers model.
          conditions: filters by name (see `filters`); None disables one. `categories` takes names of any level,
            including synonyms.

        Raises:
          ValidationError: an unknown filter or value, a range that is empty, a query without a match.
        """
        mask = self.mask(**conditions)
        if query is None:
            return self._all[mask].tolist()
        rows = np.flatnonzero(mask)
        score = self._query_scores(query, embedding_model)[rows]
        best = rows[np.argsort(-score, kind="stable")[:top_k]]
        return [uid for uid, s in zip(self._all[best], np.sort(-score)[:top_k], strict=True) if s < 0.0]

    def mask(self, **conditions: Any) -> Mask:
        """(n,) which records meet all conditions.

        Raises:
          ValidationError: an unknown filter or value.
        """
        mask = np.ones(self.table.num_rows, bool)
        for name, value in conditions.items():
            if value is None:
                continue
            if name in UNANSWERED:
                raise ValidationError(f"filter {name!r}: found {value!r}, needed another filter: {UNANSWERED[name]}.")
            if name not in self._filters:
                raise ValidationError(f"filter: found {name!r}, needed one of {', '.join(self.filters())}.")
            mask &= self._filters[name](value)
        return mask

    # Taking out -------------------------------------------------------------------------------------------------------

    def load_annotations(self, uids: Sequence[str]) -> dict[str, dict[str, Any]]:
        """uid -> official field -> value.

        Raises:
          ValidationError: no such uid.
        """
        return {row["uid"]: annotations.annotation(row) for row in self._take(uids)}

    def record(self, uid: str) -> AssetRecord:
        """Returns the record of a uid, with which the asset is built, placed and exported.

        Raises:
          ValidationError: no such uid, or one without a mesh.
        """
        return self.records([uid])[0]

    def records(self, uids: Sequence[str]) -> list[AssetRecord]:
        """The records of several uids, in their order.

        Raises:
          ValidationError: no such uid, or one without a mesh.
        """
        # Making a cousin asks for the same hundreds of records for every object of a kind.
        new = [uid for uid in dict.fromkeys(uids) if uid not in self._made]
        if new:
            self._made |= {row["uid"]: record_of(row) for row in self._take(new)}
        return [self._made[uid] for uid in uids]

    def imported(self) -> list[AssetRecord]:
        """The records whose meshes are files that the user imported."""
        rows = pc.equal(self.table["recipe"], FILE_RECIPE)  # pyright: ignore[reportAttributeAccessIssue]
        return [record_of(row) for row in self.table.filter(rows).to_pylist()]

    def load_thumbnails(self, uids: Sequence[str]) -> dict[str, np.ndarray]:
        """uid -> (H, W, 3) uint8 image, drawn where the cache has none (needs an OpenGL that renders off screen).

        Raises:
          ValidationError: no such uid, or one without a mesh.
        """
        from ..previews.thumbnails import thumbnail

        return {record.uid: thumbnail(record) for record in self.records(uids)}

    def explain_annotation(self, field: str) -> str:
        """Meaning, unit and source of a field.

        Raises:
          ValidationError: no such field.
        """
        return annotations.explain(field)

    def check_integrity(self) -> list[str]:
        """One sentence per file that is missing or damaged."""
        return integrity.problems()

    def repair(self) -> list[str]:
        """Rebuilds all parts that derive from the shipped tables; returns the remaining faults."""
        left = integrity.repair()
        self.__init__()
        return left

    # Filters ----------------------------------------------------------------------------------------------------------

    def _in_range(self, column: str, name: str, bounds: Range) -> Mask:
        if not isinstance(bounds, Sequence) or len(bounds) != 2:
            raise ValidationError(f"filter {name!r}: found {bounds!r}, needed (least, greatest).")
        low, high = (-np.inf if bounds[0] is None else bounds[0]), (np.inf if bounds[1] is None else bounds[1])
        if not low <= high:
            raise ValidationError(f"filter {name!r}: found {bounds!r}, needed least <= greatest.")
        values = self.column(column)
        return (values >= low) & (values <= high)

    def _is(self, name: str, wanted: bool) -> Mask:
        if not isinstance(wanted, bool):
            raise ValidationError(f"filter {name!r}: found {wanted!r}, needed True or False.")
        return self.column(name) == wanted

    def _one_of(self, name: str, wanted: str | Sequence[str]) -> Mask:
        codes, names = self._codes(name)
        return np.isin(codes, [names[word] for word in self._known(name, wanted, names)])

    def _any_of(self, name: str, wanted: str | Sequence[str]) -> Mask:
        codes, parents, names = self._entries(name)
        mask = np.zeros(self.table.num_rows, bool)
        mask[parents[np.isin(codes, [names[word] for word in self._known(name, wanted, names)])]] = True
        return mask

    def _of_categories(self, wanted: str | Sequence[str]) -> Mask:
        mask = np.zeros(self.table.num_rows, bool)
        for word in [wanted] if isinstance(wanted, str) else wanted:
            levels = [name for name in LEVELS if word in self._codes(name)[1]]
            # A name may exist at two levels ("road"); both are used.
            if not levels:
                levels, word = [LEVELS[2]], ontology.match_label(word)
            for name in levels:
                codes, names = self._codes(name)
                mask |= codes == names[word]
        return mask

    @staticmethod
    def _known(name: str, wanted: str | Sequence[str], names: Mapping[str, int]) -> list[str]:
        words = [wanted] if isinstance(wanted, str) else list(wanted)
        stray = [word for word in words if word not in names]
        if stray or not words:
            found = repr(stray[0]) if stray else "an empty list"
            raise ValidationError(f"filter {name!r}: found {found}, needed some of {', '.join(sorted(names))}.")
        return words

    # Columns, decoded once --------------------------------------------------------------------------------------------

    @functools.lru_cache(maxsize=64)  # noqa: B019 (a library lives as long as its process)
    def column(self, name: str) -> NDArray:
        """A column of numbers or flags as an array."""
        return self.table[name].to_numpy(zero_copy_only=False)

    @functools.lru_cache(maxsize=16)  # noqa: B019
    def _codes(self, name: str) -> tuple[NDArray[np.int64], dict[str, int]]:
        encoded = self.table[name].combine_chunks().dictionary_encode()
        return encoded.indices.to_numpy(), {word: k for k, word in enumerate(encoded.dictionary.to_pylist())}

    @functools.lru_cache(maxsize=8)  # noqa: B019
    def _entries(self, name: str) -> tuple[NDArray[np.int64], NDArray[np.int64], dict[str, int]]:
        """Code and row of every entry of a column of lists that a filter uses, and the codes of the words."""
        column, first = LISTS[name]
        lists = self.table[column].combine_chunks()
        parents = pc.list_parent_indices(lists).to_numpy()  # pyright: ignore[reportAttributeAccessIssue]
        encoded = pc.list_flatten(lists).dictionary_encode()  # pyright: ignore[reportAttributeAccessIssue]
        codes, words = encoded.indices.to_numpy(), encoded.dictionary.to_pylist()
        keep = np.array([word != "air" for word in words], bool)[codes] if words else np.zeros(len(codes), bool)
        codes, parents = codes[keep], parents[keep]
        if first is not None:
            starts = np.flatnonzero(np.diff(parents, prepend=-1))
            rank = np.arange(len(parents)) - np.repeat(starts, np.diff(np.append(starts, len(parents))))
            codes, parents = codes[rank < first], parents[rank < first]
        return codes, parents, {word: k for k, word in enumerate(words) if word != "air"}

    # Rows -------------------------------------------------------------------------------------------------------------

    def rows_of(self, leaf: str) -> NDArray[np.int64]:
        """Rows of a leaf's records.

        Raises:
          UnknownLabelError: no such leaf.
        """
        ontology.category_of(leaf)
        codes, names = self._codes("category")
        return np.flatnonzero(codes == names[leaf]) if leaf in names else np.zeros(0, np.int64)

    def _take(self, uids: Sequence[str]) -> list[dict[str, Any]]:
        stray = [uid for uid in uids if uid not in self._rows]
        if stray:
            raise ValidationError(
                f"asset uid: found {stray[0]!r}, needed one of the catalogue's {len(self._rows)}; "
                "`get_uids_all` lists them."
            )
        return self.table.take(pa.array([self._rows[uid] for uid in uids], pa.int64())).to_pylist()

    def _query_scores(self, query: str, model: str) -> NDArray[np.float64]:
        """(n,) score of the leaf, plus a bonus for each colour or material of the record that the query names."""
        codes, names = self._codes("category")
        by_leaf = np.zeros(len(names))
        for leaf, score in rank_leaves(query, len(names), _embedder(model)):
            if leaf in names:
                by_leaf[names[leaf]] = score
        scores = by_leaf[codes]
        words_of_query = [MATERIAL_WORDS.get(word, word) for word in ontology.normalised(query).split()]
        text = f" {' '.join(words_of_query)} "
        for column in ("dominant_colors", "dominant_materials"):
            entries, parents, words = self._entries(column)
            said = [k for word, k in words.items() if f" {word} " in text]
            bonus = np.zeros(len(scores))
            bonus[parents[np.isin(entries, said)]] = NAMED_LEAF_BONUS
            scores = scores + np.where(scores > 0.0, bonus, 0.0)
        return scores


#: Names of materials in queries.
MATERIAL_WORDS = {"wooden": "wood", "metal": "steel", "metallic": "steel", "woollen": "wool"}
NAMED_LEAF_BONUS = 0.05  # less than the difference between a named leaf and a similarly spelled one


def _embedder(model: str) -> TextEmbedder | None:
    if model == BUILT_IN:
        return None
    from .neural import SentenceEmbedder

    return SentenceEmbedder.load(model)


@functools.cache
def library() -> ObjectLibrary:
    """The objects of the catalogue, loaded (and built if needed) on first use."""
    return ObjectLibrary()


def full_library() -> ObjectLibrary:
    """The objects of the catalogue and the assets that the user has imported."""
    path = imported_assets() / CATALOGUE
    return _joined(path, path.stat().st_mtime_ns) if path.is_file() else library()


@functools.lru_cache(maxsize=1)
def _joined(path: pathlib.Path, changed: int) -> ObjectLibrary:
    return ObjectLibrary(load_joined_store())
