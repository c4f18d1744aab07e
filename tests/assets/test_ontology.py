"""The category tree and the mapping from a label to a leaf."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.ontology import UnknownLabelError, match_label


def test_tree_has_the_published_sizes() -> None:
    tree = ontology.tree()
    assert len(tree) == 8
    assert sum(len(mids) for mids in tree.values()) == 59
    assert len(ontology.categories()) == 659
    assert sum(n for mids in tree.values() for leaves in mids.values() for n in leaves.values()) == 102_444


@pytest.mark.parametrize("leaf", sorted(ontology.categories()))
def test_every_leaf_is_called_by_its_own_name(leaf: str) -> None:
    assert match_label(leaf) == leaf
    assert match_label(f" {leaf.upper()} ") == leaf


@pytest.mark.parametrize(
    ("label", "leaf"),
    [
        ("trash can", "trash bin"),
        ("Wheelie-Bin", "trash bin"),
        ("kerbside bin", "trash bin"),
        ("street lamp", "street light"),
        ("e-scooter", "scooter"),
        ("motorbike", "motorcycle"),
        ("fire plug", "fire hydrant"),
        ("sandwich board", "advertising board"),
        ("person", "pedestrian adult"),
        ("Benches", "bench"),
        ("traffic_cones", "traffic cone"),
        ("movable_object.trafficcone", "traffic cone"),
        ("static_object.bicycle_rack", "bicycle parking"),
    ],
)
def test_synonyms(label: str, leaf: str) -> None:
    assert match_label(label) == leaf


def test_unknown_label_names_the_three_nearest() -> None:
    with pytest.raises(UnknownLabelError, match="big red bench") as caught:
        match_label("big red bench")
    assert len(set(caught.value.nearest)) == 3
    assert caught.value.nearest[0] == "bench"
    assert all(f"'{leaf}'" in str(caught.value) for leaf in caught.value.nearest)


@given(st.text(max_size=30))
def test_any_text_is_a_leaf_or_an_error_with_three_leaves(label: str) -> None:
    nearest = ontology.nearest_leaves(label)
    assert len(set(nearest)) == 3
    assert set(nearest) <= set(ontology.categories())
    with contextlib.suppress(UnknownLabelError):
        assert match_label(label) in ontology.categories()


def test_category_of_gives_the_path() -> None:
    assert ontology.category_of("bollard") == ("barrier", "access control barrier", "bollard")
    with pytest.raises(UnknownLabelError):
        ontology.category_of("Bollard")  # exact names only
