"""What objects are called: colours, phrases that are true of all they mean, and vectors of phrases."""

import dataclasses

import numpy as np
import pytest
from skimage.color import rgb2lab

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs.navigation.tasks import colours, object_names
from urbanverse_mjx.envs.navigation.tasks.object_names import (
    EMBEDDING_SIZE,
    LEAST_HEIGHT,
    MOST_MEANT,
    MOST_WIDTH,
    OBJECT_SIZE,
    STREET_USERS,
    StreetObject,
    embedding,
    gap,
    objects_of,
    phrases_of,
)


def street_object(name: str, colour: str | None, x: float, y: float = 0.0, yaw: float = 0.0) -> StreetObject:
    return StreetObject(0, name, colour, (x, y, 0.5, 0.25, yaw))


def said(objects: list[StreetObject]) -> dict[str, tuple[int, ...]]:
    return {p.text: p.meant for p in phrases_of(objects)}


def test_colours_are_those_of_cie_lab() -> None:
    rgb = np.random.default_rng(0).integers(0, 256, (500, 3)).astype(float)
    np.testing.assert_allclose(colours.lab(rgb), rgb2lab(rgb[None] / 255.0)[0], atol=1e-9)
    for name, examples in colours.EXAMPLES.items():
        assert colours.main_colour(np.array(examples[:1]), np.ones(1)) == name
    half = np.array([colours.EXAMPLES["red"][0], colours.EXAMPLES["blue"][0]])
    assert colours.main_colour(half, np.ones(2)) is None
    between = [[143.0, 43.0, 90.0], [240.5, 183.5, 132.5], [137.5, 158.5, 204.5]]
    assert colours.name_rows(np.array(between)).tolist() == [-1, -1, -1], (
        "purple or red, orange or white, blue or white"
    )
    assert colours.main_colour(np.array(between[:1]), np.ones(1)) is None
    assert colours.main_colour(half, np.array([4.0, 1.0])) == "red"


def test_people_animals_and_robots_are_those_of_the_ontology() -> None:
    assert {leaf for leaf, row in ontology.categories().items() if row[0] == "street user"} == STREET_USERS


def test_one_of_a_kind_is_the_and_one_of_several_is_a() -> None:
    found = said(
        [street_object("postbox", "red", 0), street_object("bench", "green", 20), street_object("bench", "green", 40)]
    )
    assert found == {"the red postbox": (0,), "a green bench": (1, 2)}


def test_of_several_the_one_next_to_a_single_object_is_named_by_it() -> None:
    objects = [
        street_object("postbox", "red", 0),
        street_object("bench", "green", 2.0),
        street_object("bench", "green", 40),
    ]
    found = said(objects)
    assert found["the green bench next to the red postbox"] == (1,)
    assert found["a green bench"] == (1, 2)
    both = said([*objects, street_object("bench", "green", -2.0)])
    assert "the green bench next to the red postbox" not in both, "two of them are"


def test_a_class_without_colour_is_true_of_the_coloured_ones_too() -> None:
    objects = [
        street_object("scooter", None, 0),
        street_object("scooter", "black", 20),
        street_object("bench", "green", 2.0),
    ]
    found = said(objects)
    assert found["a scooter"] == (0, 1)
    assert found["the black scooter"] == (1,)
    assert "the scooter" not in found
    assert not any(text.endswith("next to the scooter") for text in found)


def test_a_phrase_never_means_too_many() -> None:
    found = said([street_object("chair", "white", 10.0 * k) for k in range(MOST_MEANT + 1)])
    assert found == {}


def test_the_gap_is_between_boxes_not_centres() -> None:
    assert gap(street_object("a", None, 0.0), street_object("b", None, 3.0)) == pytest.approx(2.0)
    assert gap(street_object("a", None, 0.0), street_object("b", None, 0.0, 3.0)) == pytest.approx(2.5)
    assert gap(street_object("a", None, 0.0), street_object("b", None, 0.1)) == 0.0


def test_objects_of_a_bank_have_their_boxes_and_none_is_too_small_or_high(small_bank: SceneBank) -> None:
    objects = objects_of(small_bank, 0, 0.0)
    assert {o.name for o in objects} <= {"box", "wedge", "cylinder"}
    assert len(objects) > 10
    for o in objects:
        mesh = int(small_bank.slot_mesh[0, o.slot])
        corners = small_bank.mesh_vertices[small_bank.mesh_vertex_start[mesh] : small_bank.mesh_vertex_start[mesh + 1]]
        assert np.ptp(corners[:, 2]) >= LEAST_HEIGHT
        np.testing.assert_allclose(2 * np.array(o.box[2:4]), np.ptp(corners[:, :2], axis=0), atol=1e-4)
        np.testing.assert_allclose(o.box[:2], small_bank.slot_position[0, o.slot, :2], atol=1e-4)
        assert 2 * max(o.box[2:4]) <= MOST_WIDTH
    assert objects_of(small_bank, 0, -5.0) == [], "five metres above the pavement"


def test_the_colour_of_an_object_is_that_of_its_sides(small_bank: SceneBank) -> None:
    red = np.tile(np.array(colours.EXAMPLES["red"][0], np.uint8), len(small_bank.texture_data) // 3)
    painted = dataclasses.replace(small_bank, texture_data=red)
    assert {o.colour for o in objects_of(painted, 0, 0.0)} == {"red"}


def test_what_faces_up_or_down_has_no_part_in_the_colour(small_bank: SceneBank) -> None:
    """The sides of a mesh count by their area as seen from the side, half of it from either: that of its outline."""
    for mesh in range(len(small_bank.mesh_material)):
        start, end = small_bank.mesh_face_start[mesh : mesh + 2]
        first = small_bank.mesh_vertex_start[mesh]
        corners = small_bank.mesh_vertices[first:][small_bank.mesh_faces[start:end]].astype(float)
        edges = corners[:, 1:] - corners[:, :1]
        normal = np.cross(edges[:, 0], edges[:, 1])
        area = np.linalg.norm(normal, axis=1) / 2
        # The cosine of the angle between a triangle and the vertical.
        steep = np.sqrt(1.0 - (normal[:, 2] / (2.0 * area)) ** 2)
        paint, weights = object_names._paint(small_bank, mesh)
        np.testing.assert_allclose(weights, area * steep, atol=1e-6)
        assert paint.shape == (len(weights), 3)


def test_vectors_know_colour_class_and_relation() -> None:
    texts = ("the red postbox", "the red post box", "a red postbox", "the blue postbox", "the green bench")
    red, apart, any_, blue, bench = (embedding(text) for text in texts)
    assert red.shape == (EMBEDDING_SIZE,)
    np.testing.assert_array_equal(red, any_)
    assert np.linalg.norm(red) == pytest.approx(1.0)
    assert min(red @ apart, red @ blue) > red @ bench + 0.2
    beside = embedding("the red postbox next to the green bench")
    np.testing.assert_array_equal(beside[:OBJECT_SIZE], red[:OBJECT_SIZE])
    assert not np.array_equal(beside, embedding("the green bench next to the red postbox"))
    assert not np.any(red[OBJECT_SIZE:])
