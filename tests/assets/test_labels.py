"""Labels of public vocabularies and free phrases -> leaves."""

import csv
import itertools
import pathlib

import pytest

from urbanverse_mjx.assets import load_index, match_label
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.labels import (
    DECISION,
    FILES,
    NAME,
    leaf_of_label,
    map_labels,
    mapped_labels,
    read_vocabularies,
    save_labels,
    stored_vocabularies,
)
from urbanverse_mjx.assets.categories.ontology import UnknownLabelError, guess_leaf
from urbanverse_mjx.assets.categories.priors import prior
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root

FREE = pathlib.Path(__file__).with_name("free_labels.csv")
#: Distinct labels of each vocabulary as published (ADE20K's list has "screen" twice).
SIZES = {"cityscapes": 30, "nuscenes": 23, "ade20k": 149, "lvis": 1203, "openimages": 601, "osm": 1001}


#: Substitutes from another top-level category than their leaf's, because of their similar appearance.
ACROSS = {("bulletin board", "advertising board"), ("information point", "kiosk"), ("toll booth", "kiosk")}


def free_labels() -> list[tuple[str, set[str]]]:
    with FREE.open(encoding="utf-8", newline="") as file:
        return [(row["label"], set(row["leaves"].split("|"))) for row in csv.DictReader(file)]


def test_every_label_is_covered_exactly_once() -> None:
    assert {name: len(labels) for name, labels in stored_vocabularies().items()} == SIZES
    assert len(mapped_labels()) == sum(SIZES.values())
    assert all(row.leaf is None or row.leaf in ontology.categories() for row in mapped_labels().values())


def test_the_stored_table_is_what_the_command_makes(tmp_path) -> None:
    rows = map_labels(stored_vocabularies())
    assert rows == list(mapped_labels().values())
    stored = (asset_root() / "labels.csv").read_text(encoding="utf-8")
    assert save_labels(rows, tmp_path / "labels.csv").read_text(encoding="utf-8") == stored


def test_only_decisions_leave_a_label_without_a_leaf() -> None:
    assert all(row.how == DECISION for row in mapped_labels().values() if row.leaf is None)
    for row in mapped_labels().values():
        text = row.label.rpartition("=")[2] if row.vocabulary == "osm" else row.label
        assert (row.how != NAME) or ontology.normalised(text).removesuffix("s") in ontology.normalised(row.leaf or "")


@pytest.mark.parametrize(
    ("vocabulary", "label", "leaf"),
    [
        ("cityscapes", "rider", "cyclist"),
        ("cityscapes", "sky", None),
        ("nuscenes", "vehicle.construction", "excavator"),
        ("nuscenes", "human.pedestrian.personal_mobility", "electric scooter rider"),
        ("ade20k", "ashcan", "trash bin"),
        ("ade20k", "tank", "storage tank"),
        ("lvis", "zebra", "wildlife"),
        ("lvis", "trash_can", "trash bin"),
        ("lvis", "sock", None),
        ("openimages", "Tank", "combat tactical  vehicle"),
        ("openimages", "Fast food", "hamburger"),
        ("openimages", "Human ear", None),
        ("osm", "amenity=police", "police station"),
        ("osm", "shop=bicycle", "bicycle shop"),
        ("osm", "barrier=bollard", "bollard"),
        ("osm", "railway=crossing", "railway track"),
        ("osm", "surface=asphalt", None),
    ],
)
def test_labels_that_names_alone_would_get_wrong(vocabulary: str, label: str, leaf: str | None) -> None:
    assert leaf_of_label(vocabulary, label) == leaf


def test_unknown_labels_are_refused() -> None:
    with pytest.raises(ValidationError, match="'no_such_thing' of 'lvis'"):
        leaf_of_label("lvis", "no_such_thing")
    with pytest.raises(ValidationError, match=r"1 without a leaf.*cityscapes 'xyzzy'"):
        map_labels(stored_vocabularies() | {"cityscapes": [*stored_vocabularies()["cityscapes"], "xyzzy"]})
    with pytest.raises(ValidationError, match=r"label_decisions\.csv: found \('cityscapes'"):
        map_labels(stored_vocabularies() | {"cityscapes": []})


def test_vocabularies_are_read_from_their_files(tmp_path) -> None:
    for file in FILES.values():
        text = "key,value,geometry\namenity,bench,point\n" if file.endswith(".csv") else "a\n\nb\na\n"
        (tmp_path / file).write_text(text, encoding="utf-8")
    read = read_vocabularies(tmp_path)
    assert read["osm"] == ["amenity=bench"]
    assert read["lvis"] == ["a", "b"]
    (tmp_path / "lvis_v1.txt").unlink()
    with pytest.raises(ValidationError, match="lvis_v1"):
        read_vocabularies(tmp_path)


def test_there_are_a_hundred_free_labels() -> None:
    labels = free_labels()
    assert len(labels) == len({label for label, _ in labels}) >= 100
    assert set(itertools.chain.from_iterable(leaves for _, leaves in labels)) <= set(ontology.categories())


@pytest.mark.parametrize(("label", "leaves"), free_labels(), ids=[label for label, _ in free_labels()])
def test_a_free_label_finds_a_sensible_leaf(label: str, leaves: set[str]) -> None:
    assert guess_leaf(label) in leaves


@pytest.mark.parametrize(
    ("phrase", "leaf"),
    [
        ("an old red park bench under a tree", "bench"),
        ("a row of parked bicycles", "bicycle"),
        ("two people waiting at the bus stop", "pedestrian adult"),
        ("Trash Can.", "trash bin"),
        ("cup of coffee", "cup"),
        ("cherries", "cherry"),
    ],
)
def test_phrases(phrase: str, leaf: str) -> None:
    assert guess_leaf(phrase) == leaf


def test_a_phrase_without_any_name_is_unknown() -> None:
    with pytest.raises(UnknownLabelError, match="qwertz uiop"):
        guess_leaf("qwertz uiop")


def test_a_name_that_matches_exactly_is_never_guessed_otherwise() -> None:
    for leaf in ontology.categories():
        assert guess_leaf(leaf) == match_label(leaf) == leaf


def test_every_leaf_has_other_names_and_none_is_shared() -> None:
    import json

    table = json.loads((asset_root() / "synonyms.json").read_text(encoding="utf-8"))
    assert set(table) == set(ontology.categories())
    names = [ontology.normalised(name) for names in table.values() for name in names]
    assert len(names) == len(set(names))
    assert not set(names) & {ontology.normalised(leaf) for leaf in ontology.categories()}


def test_a_car_has_records_through_its_stand_in() -> None:
    index = load_index()
    assert {r.leaf for r in index.by_label("car")} <= {"car", "sedan"}
    assert index.by_label("vehicle.car") == index.by_label("automobile") != ()
    assert index.by_label("bollards") == index.by_leaf("bollard")
    assert index.by_label("toothpaste") == () or index.by_leaf("toothpaste")
    with pytest.raises(UnknownLabelError):
        index.by_label("qwertz")


def test_stand_ins_are_of_the_same_kind_and_size() -> None:
    for leaf, others in ontology.stand_ins().items():
        row = prior(leaf)
        assert leaf not in others
        for other in others:
            same = ontology.category_of(other)[0] == ontology.category_of(leaf)[0]
            assert same or (leaf, other) in ACROSS, (leaf, other)
            ratio = max(prior(other).length[1], prior(other).height[1]) / max(row.length[1], row.height[1])
            assert 0.3 < ratio < 3.3, (leaf, other)
    assert sum(load_index().stand_in(leaf) is not None for leaf in ontology.stand_ins()) >= 90
