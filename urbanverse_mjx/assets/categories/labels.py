"""Maps labels of public vocabularies (Cityscapes, nuScenes, ADE20K, LVIS, Open Images, OSM street tags) to leaves.

`assets_index/labels.csv` holds one row per label; `python -m urbanverse_mjx.assets labels` makes it from three sources:
the vocabularies' lists, the names and synonyms of the leaves, and `label_decisions.csv` with manual corrections and
additions ("zebra" in a photo of animals is not a crosswalk). An empty leaf means that the label is not urban, or
denotes a property of the ground or a part of a building that no asset represents.
"""

import csv
import dataclasses
import functools
import io
import pathlib
from collections.abc import Iterator, Mapping, Sequence

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.settings import asset_root

from . import ontology
from .materials import read_rows

#: vocabulary -> file of its labels, one per line; OSM's are rows of key, value and more.
FILES: Mapping[str, str] = {
    "cityscapes": "cityscapes.txt",
    "nuscenes": "nuscenes.txt",
    "ade20k": "ade20k_150.txt",
    "lvis": "lvis_v1.txt",
    "openimages": "openimages_v7_600.txt",
    "osm": "osm_tags.csv",
}
NAME, SYNONYM, DECISION = "name", "synonym", "decision"
COLUMNS = ("vocabulary", "label", "leaf", "how")


@dataclasses.dataclass(frozen=True)
class Mapped:
    """The mapping of a label: `leaf` is None if no leaf matches, `how` names the rule that found it."""

    vocabulary: str
    label: str
    leaf: str | None
    how: str


@functools.cache
def mapped_labels() -> dict[tuple[str, str], Mapped]:
    """(vocabulary, label) -> mapping, all of the stored table.

    Raises:
      ValidationError: a row is not valid or occurs twice.
    """
    table: dict[tuple[str, str], Mapped] = {}
    for where, row in read_rows(asset_root() / "labels.csv", COLUMNS):
        key = row["vocabulary"], row["label"]
        if row["vocabulary"] not in FILES or key in table:
            raise ValidationError(f"{where}: found {key}, needed each label of a known vocabulary once.")
        if row["leaf"]:
            ontology.category_of(row["leaf"])
        table[key] = Mapped(*key, row["leaf"] or None, row["how"])
    return table


def leaf_of_label(vocabulary: str, label: str) -> str | None:
    """The leaf of a vocabulary's label, or None. OSM labels have the form "key=value".

    Raises:
      ValidationError: no such vocabulary or label.
    """
    if (vocabulary, label) not in mapped_labels():
        raise ValidationError(
            f"label: found {label!r} of {vocabulary!r}, needed a label of one of {', '.join(FILES)}; "
            "free text goes through `match_label`."
        )
    return mapped_labels()[vocabulary, label].leaf


def read_vocabularies(folder: pathlib.Path) -> dict[str, list[str]]:
    """vocabulary -> its labels in order, each once.

    Raises:
      ValidationError: a file is missing.
    """
    return {name: list(dict.fromkeys(_read(folder / file))) for name, file in FILES.items()}


def stored_vocabularies() -> dict[str, list[str]]:
    """The labels of the stored table, used if the vocabularies' files are missing."""
    labels: dict[str, list[str]] = {name: [] for name in FILES}
    for vocabulary, label in mapped_labels():
        labels[vocabulary].append(label)
    return labels


def map_labels(vocabularies: Mapping[str, Sequence[str]]) -> list[Mapped]:
    """Maps every label by a manual decision, otherwise by a leaf's name, otherwise by a synonym.

    Raises:
      ValidationError: a label has none of these, or a decision refers to a label that does not exist.
    """
    decisions = _decisions()
    known = {(name, label) for name, labels in vocabularies.items() for label in labels}
    stray = sorted(set(decisions) - known)
    if stray:
        raise ValidationError(f"label_decisions.csv: found {stray[0]}, needed labels of the vocabularies.")
    rows, open_labels = [], []
    for name, labels in vocabularies.items():
        for label in labels:
            text = label.rpartition("=")[2] if name == "osm" else label
            if (name, label) in decisions:
                rows.append(Mapped(name, label, decisions[name, label], DECISION))
                continue
            try:
                leaf = ontology.match_label(text)
            except ontology.UnknownLabelError as error:
                open_labels.append(f"{name} {label!r} (near {', '.join(error.nearest)})")
                continue
            how = NAME if ontology.normalised(text) == ontology.normalised(leaf) else SYNONYM
            rows.append(Mapped(name, label, leaf, how))
    if open_labels:
        raise ValidationError(
            f"labels: found {len(open_labels)} without a leaf, needed a synonym or a row in label_decisions.csv "
            f"for each: {'; '.join(open_labels[:5])}."
        )
    return rows


def save_labels(rows: Sequence[Mapped], path: pathlib.Path) -> pathlib.Path:
    """Writes the table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows((r.vocabulary, r.label, r.leaf or "", r.how) for r in rows)
    return write_atomically(path, lambda p: p.write_text(text.getvalue(), encoding="utf-8"))


def _read(path: pathlib.Path) -> Iterator[str]:
    if not path.is_file():
        raise ValidationError(f"{path}: found no such file, needed the list of labels of a vocabulary.")
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".csv":
        for row in csv.DictReader(io.StringIO(text)):
            yield f"{row['key']}={row['value']}"
    else:
        yield from (line.strip() for line in text.splitlines() if line.strip())


def _decisions() -> dict[tuple[str, str], str | None]:
    decisions: dict[tuple[str, str], str | None] = {}
    for where, row in read_rows(asset_root() / "label_decisions.csv", ("vocabulary", "label", "leaf")):
        key = row["vocabulary"], row["label"]
        if key in decisions:
            raise ValidationError(f"{where}: found {key} twice, needed one decision.")
        if row["leaf"]:
            ontology.category_of(row["leaf"])
        decisions[key] = row["leaf"] or None
    return decisions
