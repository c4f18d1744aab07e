"""Search over records with a uid, a description and named values: skies, roads, sidewalks.

The names are the official toolkit's (`get_uids_all`, `categories`, `get_uids_conditioned`, `load_annotations`,
`load_thumbnails`, `explain_annotation` ...): filters are joined by AND, the entries of one list by OR.
"""

import dataclasses
import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from urbanverse_mjx.datatypes import validation as v

Value = str | float | bool | None


class Record(Protocol):
    """A record of a collection: a frozen dataclass with at least these fields."""

    @property
    def uid(self) -> str: ...
    @property
    def description(self) -> str: ...


@dataclasses.dataclass(frozen=True)
class Filter:
    """A filter of a search: `name` is the argument (a list of words, a range (low, high), or True/False)."""

    name: str
    field: str
    kind: str  # "words", "range" or "flag"
    meaning: str


class Thumbnails(Protocol):
    """Source of a collection's thumbnails."""

    def load(self, uids: Sequence[str]) -> np.ndarray:
        """(n, h, w, 3) uint8."""
        ...

    def problems(self) -> list[str]:
        """One sentence per file that is missing or damaged."""
        ...

    def repair(self) -> None:
        """Makes the thumbnails again."""
        ...


class Collection[R: Record]:
    """Records in a fixed order with filters, a text query, and thumbnails.

    Args:
      kind: name of one record, for messages.
      records: at least one.
      levels: fields that classify the records, the most general first.
      filters: name -> filter.
      meanings: field -> meaning, for fields without a filter.
      thumbnails: source of the thumbnails.

    Raises:
      ValidationError: a field of the records has neither a filter nor a meaning.
    """

    def __init__(
        self, kind: str, records: Sequence[R], levels: Sequence[str], filters: Sequence[Filter],
        meanings: Mapping[str, str], thumbnails: Thumbnails,
    ) -> None:  # fmt: skip
        self.kind = kind
        self._records = {record.uid: record for record in records}
        self._levels = tuple(levels)
        self._filters = {f.name: f for f in filters}
        self._meanings = dict(meanings)
        self._thumbnails = thumbnails
        known = {f.field for f in filters} | set(meanings)
        stray = [name for name in dataclasses.asdict(records[0]) if name not in known]  # pyright: ignore[reportArgumentType]
        if stray:
            raise v.fail(f"field of a {kind}", repr(stray[0]), "a meaning", "add one next to the filters")

    def get_uids_all(self) -> list[str]:
        """Every uid, in the table's order."""
        return list(self._records)

    def categories(self, level: int = 1) -> list[str]:
        """The names of a level (1 is the most general), in the table's order.

        Raises:
          ValidationError: another level.
        """
        if level not in range(1, len(self._levels) + 1):
            raise v.fail(f"level of a {self.kind}", v.show(level), f"1 to {len(self._levels)}")
        return list(dict.fromkeys(getattr(record, self._levels[level - 1]) for record in self._records.values()))

    def filters(self) -> list[str]:
        """The names that `get_uids_conditioned` takes."""
        return [*self._filters, "query"]

    def record(self, uid: str) -> R:
        """One record.

        Raises:
          ValidationError: no such uid.
        """
        if uid not in self._records:
            raise v.fail(self.kind, repr(uid), "a known uid", f"get_uids_all() lists all {len(self._records)}")
        return self._records[uid]

    def get_uids_conditioned(self, query: str | None = None, top_k: int = 100, **filters: object) -> list[str]:
        """Uids that match every filter; with `query` the `top_k` best matches of its words, best first.

        Raises:
          ValidationError: an unknown filter, an empty range, or a filter of the wrong form.
        """
        found = list(self._records.values())
        for name, wanted in filters.items():
            if wanted is not None:
                found = [record for record in found if self._meets(record, name, wanted)]
        if query is None:
            return [record.uid for record in found]
        scores = rank_descriptions(query, [record.description for record in found])
        order = sorted(range(len(found)), key=lambda i: -scores[i])
        return [found[i].uid for i in order[:top_k]]

    def get_descriptions(self, uids: Sequence[str] | None = None) -> dict[str, str]:
        """uid -> sentence, of all or of those given."""
        return {uid: self.record(uid).description for uid in (self._records if uids is None else uids)}

    def get_descriptions_conditioned(
        self, query: str | None = None, top_k: int = 100, **filters: object
    ) -> dict[str, str]:
        return self.get_descriptions(self.get_uids_conditioned(query, top_k, **filters))

    def load_annotations(self, uids: Sequence[str] | None = None) -> dict[str, dict[str, object]]:
        """uid -> all fields of its record."""
        return {uid: dataclasses.asdict(self.record(uid)) for uid in (self._records if uids is None else uids)}  # pyright: ignore[reportArgumentType]

    def load_thumbnails(self, uids: Sequence[str] | None = None) -> dict[str, np.ndarray]:
        """uid -> (h, w, 3) uint8 image."""
        wanted = list(self._records if uids is None else uids)
        for uid in wanted:
            self.record(uid)
        return dict(zip(wanted, self._thumbnails.load(wanted), strict=True))

    def check_integrity(self) -> list[str]:
        """One sentence per missing or damaged file; empty if there is none."""
        return self._thumbnails.problems()

    def repair(self) -> list[str]:
        """Generates damaged thumbnails again (minutes); returns the remaining faults."""
        if self._thumbnails.problems():
            self._thumbnails.repair()
        return self._thumbnails.problems()

    def explain_annotation(self, name: str | None = None) -> str:
        """Meaning and values of a field or a filter; of all filters without a name.

        Raises:
          ValidationError: no such field and no such filter.
        """
        if name in self._meanings:
            return f"{name}: {self._meanings[name]}"
        by_field = {f.field: f for f in self._filters.values()}
        chosen = list(self._filters.values()) if name is None else [by_field.get(name) or self._filter(name)]
        lines = []
        for f in chosen:
            values = [getattr(record, f.field) for record in self._records.values()]
            if f.kind == "range":
                numbers = [x for x in values if x is not None]
                there = f"from {min(numbers):g} to {max(numbers):g}"
            else:
                there = ", ".join(str(x) for x in dict.fromkeys(values))
            lines.append(f"{f.name if name is None else name}: {f.meaning} ({there})")
        return "\n".join(lines)

    def _filter(self, name: str) -> Filter:
        if name not in self._filters:
            raise v.fail(f"filter of a {self.kind}", repr(name), "one of " + ", ".join(self._filters))
        return self._filters[name]

    def _meets(self, record: R, name: str, wanted: object) -> bool:
        f = self._filter(name)
        value = getattr(record, f.field)
        if f.kind == "flag":
            return value is v.boolean(wanted, name)
        if f.kind == "words":
            words = [wanted] if isinstance(wanted, str) else wanted
            if not isinstance(words, Sequence) or not all(isinstance(word, str) for word in words):
                raise v.fail(name, v.show(wanted), "a word or a list of words")
            return value in words
        if not isinstance(wanted, Sequence) or isinstance(wanted, str) or len(wanted) != 2:
            raise v.fail(name, v.show(wanted), "a range (low, high)", "None leaves an end open")
        low, high = (-math.inf if wanted[0] is None else wanted[0]), (math.inf if wanted[1] is None else wanted[1])
        if not low <= high:
            raise v.fail(name, v.show(wanted), "a range (low, high) with low <= high")
        return value is not None and low <= value <= high


def rank_descriptions(query: str, texts: Sequence[str]) -> list[float]:
    """Similarity of each text to a query: cosine of TF-IDF word vectors; works offline."""
    bags = [Counter(_words(text)) for text in texts]
    seen = Counter(word for bag in bags for word in bag)
    weight = {word: math.log(1 + len(texts) / count) for word, count in seen.items()}
    asked = Counter(_words(query))
    scores = []
    for bag in bags:
        dot = sum(asked[word] * bag[word] * weight[word] ** 2 for word in asked if word in bag)
        length = math.sqrt(sum((count * weight[word]) ** 2 for word, count in bag.items()))
        scores.append(dot / max(length, 1e-9))
    return scores


def _words(text: str) -> list[str]:
    """Lower-case words without a plural s."""
    return [w[:-1] if len(w) > 3 and w.endswith("s") else w for w in re.findall(r"[a-z0-9]+", text.lower())]


def as_filters(rows: Mapping[str, tuple[str, str, str]]) -> tuple[Filter, ...]:
    """{argument: (field, kind, meaning)} -> filters."""
    return tuple(Filter(name, *row) for name, row in rows.items())
