"""Summary of the catalogue for a free label, in one dictionary."""

from typing import Any

import numpy as np

from ..categories.semantics import rank_leaves
from .search import WORDS, ObjectLibrary, library

SIDES = ("length", "width", "height", "mass")


def overview(label: str, objects: ObjectLibrary | None = None) -> dict[str, Any]:
    """The leaf of a label, its records, their medians and ranges, and the words for filters.

    Raises:
      UnknownLabelError: no leaf matches the label.
    """
    objects = objects or library()
    (leaf, score), *others = rank_leaves(label, 4)
    rows = objects.rows_of(leaf)
    table = objects.table.take(rows)
    values = {name: np.asarray(table[name].to_numpy()) for name in SIDES}
    words: dict[str, dict[str, int]] = {}
    for name in ("materials", "colors", "affordances", "interactive_parts"):
        entries = [word for cell in table[name].to_pylist() for word in cell or () if word != "air"]
        words[name] = _counts(entries)
    for name in WORDS:
        words[name] = _counts(table[name].to_pylist())
    for flag in ("movable", "receptacle", "support_surface", "walkable", "enterable"):
        words[flag] = _counts([str(x).lower() for x in table[flag].to_pylist()])
    return {
        "label": label,
        "leaf": leaf,
        "score": round(score, 3),
        "category": [table[name][0].as_py() for name in ("class_name_l1", "class_name_l2", "class_name_l3")],
        "records": table.num_rows,
        "base_shapes": sum("/prior/" not in uid for uid in table["uid"].to_pylist()),
        "median": {name: float(np.median(x)) for name, x in values.items()},
        "ranges": {name: (float(x.min()), float(x.max())) for name, x in values.items()},
        "values": {name: counts for name, counts in words.items() if counts},
        "others": [(name, round(near, 3)) for name, near in others],
        "filters": objects.filters(),
    }


def _counts(words: list[str]) -> dict[str, int]:
    """The eight most frequent words with their counts."""
    found: dict[str, int] = {}
    for word in words:
        found[word] = found.get(word, 0) + 1
    return dict(sorted(found.items(), key=lambda item: (-item[1], item[0]))[:8])
