"""The 8/59/659 category tree and the way from a free label to one of its leaves.

The tree is data (`assets_index/ontology.json`); the synonyms are data too (`assets_index/synonyms.json`: leaf -> other
names).
"""

import difflib
import functools
import json
import re

from urbanverse_mjx.datatypes import NounError
from urbanverse_mjx.settings import asset_root


class UnknownLabelError(NounError):
    """A label that matches no leaf; `nearest` holds the three nearest leaves, best first."""

    def __init__(self, label: str, nearest: tuple[str, ...]) -> None:
        self.label, self.nearest = label, nearest
        options = ", ".join(repr(n) for n in nearest)
        super().__init__(
            f"label: found {label!r}, needed one of the ontology's leaves or their synonyms; the nearest are {options}."
        )


@functools.cache
def tree() -> dict[str, dict[str, dict[str, int]]]:
    """top -> middle -> {leaf: number of assets in UrbanVerse-100K}."""
    return json.loads((asset_root() / "ontology.json").read_text(encoding="utf-8"))["tree"]


@functools.cache
def categories() -> dict[str, tuple[str, str, str]]:
    """leaf -> (top, middle, leaf), all 659."""
    return {leaf: (top, mid, leaf) for top, mids in tree().items() for mid, leaves in mids.items() for leaf in leaves}


def category_of(leaf: str) -> tuple[str, str, str]:
    """(top, middle, leaf) of an exact leaf name.

    Raises:
      UnknownLabelError: no such leaf.
    """
    if leaf not in categories():
        raise UnknownLabelError(leaf, nearest_leaves(leaf))
    return categories()[leaf]


def normalised(label: str) -> str:
    """Lower case, with hyphens, underscores, dots and runs of spaces as one space."""
    return re.sub(r"[\s\-_./]+", " ", label.strip().lower()).strip()


@functools.cache
def _names() -> dict[str, str]:
    """normalised name or synonym -> leaf; a leaf's own name always wins."""
    raw: dict[str, list[str]] = json.loads((asset_root() / "synonyms.json").read_text(encoding="utf-8"))
    names: dict[str, str] = {}
    for leaf, others in raw.items():
        category_of(leaf)
        for other in others:
            key = normalised(other)
            if names.setdefault(key, leaf) != leaf:
                raise NounError(f"synonyms.json: found {other!r} under {names[key]!r} and {leaf!r}, needed it once.")
    for leaf in categories():
        names[normalised(leaf)] = leaf
    return names


def match_label(label: str) -> str:
    """The leaf that a label names, by exact name or synonym; case, spaces and hyphens do not matter, a plural s is
    forgiven.

    Raises:
      UnknownLabelError: no leaf is called so; its `nearest` offers three.
    """
    names, key = _names(), normalised(label)
    for candidate in (key, key.removesuffix("s"), key.removesuffix("es")):
        if candidate in names:
            return names[candidate]
    raise UnknownLabelError(label, nearest_leaves(label))


def nearest_leaves(label: str, count: int = 3) -> tuple[str, ...]:
    """The leaves whose name or synonym reads most like the label, best first.

    Likeness is difflib's ratio, raised by the share of whole words in common ("big red bench" is near "bench").
    """
    names, key = _names(), normalised(label)
    words = set(key.split())
    best: dict[str, float] = {}
    for name, leaf in names.items():
        common = len(words & set(name.split())) / max(len(words | set(name.split())), 1)
        score = difflib.SequenceMatcher(None, key, name).ratio() + common
        best[leaf] = max(best.get(leaf, 0.0), score)
    return tuple(sorted(best, key=lambda leaf: (-best[leaf], leaf))[:count])
