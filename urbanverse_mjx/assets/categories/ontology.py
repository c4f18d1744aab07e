"""The category tree (8 top, 59 middle categories, 659 leaves) and the mapping from free labels to leaves.

The tree (`assets_index/ontology.json`), the synonyms (`assets_index/synonyms.json`: leaf -> other names) and the
substitutes of leaves without records (`assets_index/stand_ins.json`) are data files.
"""

import collections
import functools
import itertools
import json
import re

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root


class UnknownLabelError(ValidationError):
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


@functools.cache
def stand_ins() -> dict[str, tuple[str, ...]]:
    """leaf -> substitute leaves of similar appearance, best first, for leaves without records (a sedan for a car).
    Reviewed data, `assets_index/stand_ins.json`.

    Raises:
      UnknownLabelError: the file names a leaf that does not exist.
    """
    table: dict[str, list[str]] = json.loads((asset_root() / "stand_ins.json").read_text(encoding="utf-8"))
    for leaf in (name for key, others in table.items() for name in (key, *others)):
        category_of(leaf)
    return {leaf: tuple(others) for leaf, others in table.items()}


def normalised(label: str) -> str:
    """The label in lower case, with hyphens, underscores, dots and repeated spaces replaced by one space."""
    return re.sub(r"[\s\-_./]+", " ", label.strip().lower()).strip()


@functools.cache
def _names() -> dict[str, str]:
    """normalised name or synonym -> leaf; a leaf's own name has priority."""
    raw: dict[str, list[str]] = json.loads((asset_root() / "synonyms.json").read_text(encoding="utf-8"))
    names: dict[str, str] = {}
    for leaf, others in raw.items():
        category_of(leaf)
        for other in others:
            key = normalised(other)
            if names.setdefault(key, leaf) != leaf:
                raise ValidationError(
                    f"synonyms.json: found {other!r} under {names[key]!r} and {leaf!r}, needed it once."
                )
    for leaf in categories():
        names[normalised(leaf)] = leaf
    return names


def _singulars(key: str) -> tuple[str, ...]:
    """The name itself, then possible singular forms."""
    forms = [key, key.removesuffix("s"), key.removesuffix("es")]
    if key.endswith("ies"):
        forms.append(key.removesuffix("ies") + "y")
    return tuple(dict.fromkeys(forms))


def _exact(key: str) -> str | None:
    return next((leaf for form in _singulars(key) if (leaf := _names().get(form))), None)


def match_label(label: str) -> str:
    """The leaf that a label names, by exact name or synonym; ignores case, spaces, hyphens and a plural s.

    Raises:
      UnknownLabelError: no leaf has this name; `nearest` holds three similar ones.
    """
    leaf = _exact(normalised(label))
    if leaf is None:
        raise UnknownLabelError(label, nearest_leaves(label))
    return leaf


# Words after which a phrase only qualifies the object before them: "a bench in front of a shop" is a bench.
_AFTERWARDS = re.compile(r"\b(?:with|on|in|at|near|by|under|behind|beside|next to|along|from|for|full of)\b")
# "a row of parked cars" is cars; "a cup of coffee" stays a cup.
_GROUPS = r"row|line|group|pile|heap|stack|bunch|pair|set|couple|number|piece|part|kind|type|lot"
_GROUP = re.compile(rf"^(?:the |an? |two |some |many )?(?:\w+ )?(?:{_GROUPS})s? of ")


def guess_leaf(label: str) -> str:
    """The leaf that a free phrase most likely denotes ("an old red park bench under a tree" -> bench).

    Tries the phrase itself, then its part before "with", "on", "in" and similar words. Of that part, the longest suffix
    that names a leaf is used, because the noun ends an English phrase; otherwise the longest sequence of words that
    names one, the last first.

    Raises:
      UnknownLabelError: no words of the phrase name a leaf; `nearest` holds three similar ones.
    """
    key = normalised(label)
    parts = [key, _GROUP.sub("", key)]
    parts += [head for part in parts if (head := _AFTERWARDS.split(part)[0].strip())]
    for part in parts:
        if leaf := _exact(part):
            return leaf
    for part in reversed(parts):
        words = part.split()
        count = len(words)
        runs = [(start, count) for start in range(count)]
        runs += [(stop - n, stop) for n in range(count - 1, 0, -1) for stop in range(count - 1, n - 1, -1)]
        for start, stop in runs:
            if leaf := _exact(" ".join(words[start:stop])):
                return leaf
    raise UnknownLabelError(label, nearest_leaves(label))


SAME_HEAD = 0.5  # half the weight of identical spelling


def nearest_leaves(label: str, count: int = 3) -> tuple[str, ...]:
    """The leaves whose name or synonym is most similar to the label, best first.

    The similarity is Dice's coefficient of the letter triples, increased by the share of common words and by an equal
    last word ("big red bench" is similar to "bench").
    """
    key = normalised(label)
    words, triples = set(key.split()), _triples(key)
    index = _triple_index()
    shared = collections.Counter(name for triple in triples for name in index.get(triple, ()))
    best: dict[str, float] = {}
    for name, hits in shared.items():
        others = set(name.split())
        score = 2 * hits / (len(triples) + len(_triples(name))) + len(words & others) / len(words | others)
        score += SAME_HEAD if name.split()[-1] == key.split()[-1] else 0.0
        leaf = _names()[name]
        best[leaf] = max(best.get(leaf, 0.0), score)
    for leaf in itertools.islice((leaf for leaf in categories() if leaf not in best), max(count - len(best), 0)):
        best[leaf] = 0.0
    return tuple(sorted(best, key=lambda leaf: (-best[leaf], leaf))[:count])


def _triples(text: str) -> set[str]:
    """The letter triples of a text, with the ends of words marked by spaces."""
    return {f" {text} "[k : k + 3] for k in range(len(text))}


@functools.cache
def _triple_index() -> dict[str, list[str]]:
    index: dict[str, list[str]] = {}
    for name in _names():
        for triple in _triples(name):
            index.setdefault(triple, []).append(name)
    return index
