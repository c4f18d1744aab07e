"""StreetQA's facts: cameras, visible objects, colours, free ground, and words, against cases made by hand."""

import dataclasses
import math
import pathlib
import types
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.lib.streetqa import checking, colours, signs, templates, views, walkable
from benchmarks.lib.streetqa.blind import Blind
from benchmarks.lib.streetqa.facts import Facts
from benchmarks.lib.streetqa.perceiving import Perceiving
from benchmarks.lib.streetqa.views import FOVY, HEIGHT, PITCH, WIDTH, View
from benchmarks.lib.streetqa.words import words
from tests.support.box_bank import KERB, box_bank
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.meshes import paint
from urbanverse_mjx.assets.meshes.recipe import get_recipe
from urbanverse_mjx.capture.street import street_grid
from urbanverse_mjx.datatypes import KIND_INDEX, Detection, SceneBank
from urbanverse_mjx.distillation.perception.observation import FrameObservation
from urbanverse_mjx.envs.navigation.tasks.colours import EXAMPLES
from urbanverse_mjx.simulation.rendering.cameras import look_at

#: Templates whose answers follow from images alone.
CHECKED = ("exists", "count", "side", "nearer", "distance")


def view_at(x: float, y: float, yaw: float, slots: np.ndarray | None = None, depth: Any = None, size: int = 64) -> View:
    slots = np.full((HEIGHT, WIDTH), -1, np.int16) if slots is None else slots
    depth = np.zeros(slots.shape, np.float32) if depth is None else depth
    place = np.array([x, y, KERB + views.CAMERA_HEIGHT])
    return View("v", "box_0_0", "test", place, KERB, yaw, PITCH, slots, depth, np.zeros(size, np.int32))


def test_words_name_leaves_of_the_ontology_and_none_is_both_meant_and_doubtful() -> None:
    known = set(ontology.categories())
    for word in words().values():
        assert word.leaves <= known, (word.name, word.leaves - known)
        assert not word.leaves & word.doubtful


def test_the_camera_is_that_of_the_renderer_and_pixels_return_to_their_points() -> None:
    depth = np.full((HEIGHT, WIDTH), 7.0, np.float32)
    view = view_at(3.0, -2.0, 0.8, depth=depth)
    ahead = np.array([math.cos(0.8) * math.cos(PITCH), math.sin(0.8) * math.cos(PITCH), math.sin(PITCH)])
    camera = Rotation.from_quat(look_at(view.position, view.position + ahead), scalar_first=True).as_matrix()
    # The renderer's camera looks along -z with +y up; rows of `axes` are right, down and forward.
    np.testing.assert_allclose(view.axes, np.stack([camera[:, 0], -camera[:, 1], -camera[:, 2]]), atol=1e-12)
    pixels, away = view.project(view.points()[::40, ::60].reshape(-1, 3))
    rows, columns = np.meshgrid(np.arange(0, HEIGHT, 40) + 0.5, np.arange(0, WIDTH, 60) + 0.5, indexing="ij")
    np.testing.assert_allclose(pixels, np.stack([rows.ravel(), columns.ravel()], -1), atol=1e-6)
    np.testing.assert_allclose(away, 7.0, atol=1e-6)


def test_candidate_cameras_depend_on_the_scene_and_stand_apart() -> None:
    bank = box_bank(2, num_objects=6)
    first = views.candidate_cameras(bank, 0, 8, 1)
    again = views.candidate_cameras(bank, 0, 8, 1)
    assert [x[2] for x in first] == [x[2] for x in again]
    assert [x[2] for x in first] != [x[2] for x in views.candidate_cameras(bank, 0, 8, 2)]
    # More cameras continue the fewer ones.
    assert [x[2] for x in views.candidate_cameras(bank, 0, 4, 1)] == [x[2] for x in first[:4]]
    places = np.array([x[0][:2] for x in first])
    away = np.linalg.norm(places[:, None] - places[None], axis=-1) + 10 * np.eye(len(places))
    assert len(first) >= 4
    assert away.min() >= views.APART


def test_views_are_read_again_only_where_their_labels_mean_the_same(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another bank of the same scene may number its objects otherwise: its labels are not those of the files."""
    drawn: list[str] = []

    def worthy(bank: SceneBank, scene: int, split: str, cameras: Any, number: int, _: Any) -> list[View]:
        flat = np.zeros((HEIGHT, WIDTH))
        names = [views.view_name(bank.scene_ids[scene], number + k) for k in range(len(cameras))]
        return [
            View(n, bank.scene_ids[scene], split, at, h, yaw, PITCH, flat.astype(np.int16), flat, np.zeros(9, np.int32))
            for n, (at, h, yaw) in zip(names, cameras, strict=True)
        ]

    monkeypatch.setattr(views, "_worthy", worthy)
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    monkeypatch.setattr(views, "_drawer", lambda *_: lambda scene, places: {"rgb": image[None].repeat(len(places), 0)})

    def made(bank: SceneBank, seed: int = 1) -> int:
        drawn.clear()
        assert len(list(views.make_views(bank, [0], "test", 2, seed, tmp_path, drawn.append))) == 2
        return len(drawn)

    bank = box_bank(1, num_objects=6)
    assert [made(bank), made(bank)] == [2, 0]
    assert [made(bank, 2), made(bank, 1)] == [2, 2]
    a, b = np.flatnonzero((bank.slot_mesh[0] >= 0) & ~views.is_ground(bank, 0))[:2]
    order = np.arange(bank.slot_mesh.shape[1])
    order[[a, b]] = b, a
    rows = {name: getattr(bank, name)[:, order] for name in ("slot_mesh", "slot_position", "slot_quaternion")}
    other = dataclasses.replace(bank, **rows, slot_category=bank.slot_category[:, order])
    assert [made(other), made(other), made(bank)] == [2, 0, 2]


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(1, num_objects=1)


def street_facts(bank: SceneBank, view: View, leaves: dict[int, str] | None = None, rgb: Any = None) -> Facts:
    """Facts of a view in which slots have other categories: number of a slot -> leaf."""
    facts = Facts(view, bank, np.zeros((*view.slots.shape, 3), np.uint8) if rgb is None else rgb, street_grid(bank, 0))
    if leaves:
        original = facts.leaf
        facts.leaf = lambda slot: leaves.get(slot, original(slot))  # type: ignore[method-assign]
        facts.seen = tuple(facts._objects())
    return facts


def ground_slot(bank: SceneBank) -> int:
    return int(np.flatnonzero(views.is_ground(bank, 0))[0])


@pytest.mark.parametrize(
    ("x", "yaw", "answer"),
    [
        (15.0, -math.pi / 2, True),  # from the pavement straight over the road
        (30.0, -math.pi / 2, False),  # over the crosswalk
        (28.2, -math.pi / 2, None),  # along the crosswalk's edge
        (15.0, 0.0, False),  # along the pavement
    ],
)
def test_who_yields_to_vehicles_follows_from_the_ground_ahead(
    bank: SceneBank, x: float, yaw: float, answer: Any
) -> None:
    slots = np.full((HEIGHT, WIDTH), ground_slot(bank), np.int16)
    assert walkable.yields_to_vehicles(street_facts(bank, view_at(x, 6.0, yaw, slots)), 0.0) is answer
    # Where the ground is hidden, nothing is asked.
    assert walkable.yields_to_vehicles(street_facts(bank, view_at(x, 6.0, yaw)), 0.0) is None


def test_the_free_direction_is_the_one_that_stays_on_the_pavement() -> None:
    """At the pavement's outer border the way along it is free if neither side is; an object closes it."""
    bank = box_bank(1, num_objects=1)
    # The pavement lies between y = 4 and y = 8. From y = 6, 25 degrees to either side leave it after 4.7 m.
    facts = street_facts(bank, view_at(40.0, 6.0, 0.0))
    assert walkable.free_direction(facts, 25, 7) == "straight ahead"
    turned = street_facts(bank, view_at(40.0, 6.0, math.radians(25)))
    assert walkable.free_direction(turned, 25, 7) == "right"
    clearance = facts.street.clearance.copy()
    i, j = facts.street.cell(np.array([44.0, 6.0]))
    clearance[i - 3 : i + 3, j - 3 : j + 3] = 0.0
    facts.street = dataclasses.replace(facts.street, clearance=clearance)
    assert walkable.free_direction(facts, 25, 7) is None


def test_an_object_across_the_road_is_out_of_reach(bank: SceneBank) -> None:
    slot = int(np.flatnonzero((bank.slot_mesh[0] >= 0) & ~views.is_ground(bank, 0))[0])
    place = bank.slot_position[0, slot, :2].astype(float)
    seen = types.SimpleNamespace(slot=slot)
    side = math.copysign(1.0, place[1])
    # Towards the object from 6 m away on its own pavement, and from the other one, away from the crosswalk.
    along = 1.0 if place[0] > 30.0 else -1.0
    start = place[0] - 6.0 * along
    near = street_facts(bank, view_at(start, 6.0 * side, 0.0 if along > 0 else math.pi))
    assert walkable.reachable(near, seen) is True  # type: ignore[arg-type]
    kinds = near.street.kind.copy()
    kinds[kinds == KIND_INDEX["crosswalk"]] = KIND_INDEX["road"]
    far = street_facts(bank, view_at(start, -6.0 * side, 0.0 if along > 0 else math.pi))
    # With the crosswalk it can be reached outside of the view, so that nothing is asked; without it, not at all.
    assert walkable.reachable(far, seen) is None  # type: ignore[arg-type]
    clearance = np.where(np.isin(far.street.kind, [KIND_INDEX["crosswalk"]]), 0.0, far.street.clearance)
    far.street = dataclasses.replace(far.street, clearance=clearance)
    assert walkable.reachable(far, seen) is False  # type: ignore[arg-type]


def scene_of_two(bank: SceneBank, hidden: bool = False) -> tuple[View, dict[int, str]]:
    """A bench on the left at 4 m and a dog on the right at 9 m, the dog perhaps cut to a doubtful sliver."""
    slots, depth = np.full((HEIGHT, WIDTH), -1, np.int16), np.zeros((HEIGHT, WIDTH), np.float32)
    objects = np.flatnonzero((bank.slot_mesh[0] >= 0) & ~views.is_ground(bank, 0))[:2]
    a, b = (int(x) for x in objects)
    slots[150:200, 60:160], depth[150:200, 60:160] = a, 4.0
    slots[150:180, 300 : 302 if hidden else 340], depth[150:180, 300:340] = b, 9.0
    return view_at(40.0, 6.0, 0.0, slots, depth), {a: "bench", b: "dog"}


def questions(facts: Facts) -> dict[tuple[str, str], templates.Candidate]:
    nothing = types.SimpleNamespace(in_view=lambda _: [])
    return {(c.template, c.subject): c for c in templates.candidates(facts, nothing)}  # type: ignore[arg-type]


def test_questions_on_two_objects_have_the_answers_of_a_ruler() -> None:
    bank = box_bank(1, num_objects=3)
    found = questions(street_facts(bank, *scene_of_two(bank)))
    assert found["exists", "bench"].answer == "yes"
    assert found["exists", "traffic cone"].answer == "no"
    assert found["count", "dog"].answer == "1"
    side = next(c for (template, _), c in found.items() if template == "side")
    assert side.answer == ("left" if side.question.startswith("Is the bench") else "right")
    assert found["nearer", "the bench/the dog"].answer == "the bench"
    # Nearest point of a plane 4 m ahead: its pixel nearest to the axis, here the lower right corner of 100 x 50.
    focal = HEIGHT / 2 / math.tan(FOVY / 2)
    nearest = 4.0 * math.hypot(1.0, (WIDTH / 2 - 159.5) / focal)
    assert found["distance", "the bench"].number == pytest.approx(nearest, rel=0.01)


def test_a_doubtful_object_silences_every_question_on_it() -> None:
    bank = box_bank(1, num_objects=3)
    found = questions(street_facts(bank, *scene_of_two(bank, hidden=True)))
    assert [key for key, c in found.items() if "dog" in c.question] == []
    view, leaves = scene_of_two(bank)
    other: dict[int, str] = dict(zip(leaves, ("bench", "picnic table"), strict=True))
    found = questions(street_facts(bank, view, other))
    # A picnic table could be called a bench: it may be said that there is one, but not how many.
    assert ("count", "bench") not in found
    assert found["exists", "bench"].answer == "yes"


def test_perception_that_sees_the_ground_truth_answers_right() -> None:
    """The same questions, answered by a model whose masks and depth are those that made them."""
    bank = box_bank(1, num_objects=3)
    view, leaves = scene_of_two(bank)
    masks = np.full(view.slots.shape, -1, np.int32)
    for row, slot in enumerate(leaves):
        masks[view.slots == slot] = row
    seen = tuple(Detection(leaf, 0.9) for leaf in leaves.values())
    surfaces = np.full(view.slots.shape, KIND_INDEX["sidewalk"], np.uint8)
    model = Perceiving(lambda rgb, focal: FrameObservation(surfaces, masks, seen, view.depth), Blind([]))
    model._image, model._rgb = "x", np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    model._found = model._model(model._rgb, 1.0)
    found = questions(street_facts(bank, view, leaves))
    asked = 0
    for candidate in found.values():
        if candidate.template not in ("exists", "count", "side", "nearer", "distance"):
            continue
        options = list(candidate.pool)
        doc = {**dataclasses.asdict(candidate), "options": options}
        assert model.answer(doc, "x", "mc") == "ABCDEF"[options.index(candidate.answer)], candidate
        asked += 1
    assert asked > 10


@pytest.mark.parametrize("name", colours.NAMES)
def test_examples_have_their_own_name_and_mixtures_none(name: str) -> None:
    examples = np.array(EXAMPLES[name], float)
    assert [colours.NAMES[k] for k in colours.name_rows(examples)] == [name] * len(examples)
    other = np.array(EXAMPLES["blue" if name != "blue" else "red"], float)[:1]
    half = np.concatenate([examples[:1], other])
    assert colours.main_colour(half, np.array([1.0, 1.0])) is None
    assert colours.main_colour(half, np.array([8.0, 1.0])) == name


def test_the_lit_image_must_agree_with_the_paint() -> None:
    red = np.tile([200.0, 40.0, 40.0], (50, 1))
    assert colours.shown_as(red * 0.5, "red")
    assert not colours.shown_as(red, "blue")
    assert not colours.shown_as(red, "grey")
    assert colours.shown_as(np.tile([90.0, 92.0, 95.0], (50, 1)), "grey")
    assert not colours.shown_as(np.tile([90.0, 92.0, 95.0], (50, 1)), "white")


def test_words_are_found_on_the_texels_where_they_stand() -> None:
    recipe = next(r for r in _recipes("stop sign"))
    build = lambda: recipe.build(0).mesh  # noqa: E731
    original = paint.text
    found = signs.texts_of(build)
    assert paint.text is original
    assert "STOP" in found
    texels = found["STOP"]
    assert 0.01 < texels.mean() < 0.6
    # STOP is white on red, so that its texels are lighter than the plate's.
    texture = build().texture
    assert texture[texels].mean() > texture[~texels].mean() + 40
    plain = next(r for r in _recipes("bollard"))
    assert signs.texts_of(lambda: plain.build(0).mesh) == {}


def test_words_come_from_the_cache_the_second_time(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    recipes = [_recipes("stop sign")[0], _recipes("bollard")[0]]
    first = [signs._cached_texts(r.name, r.leaf, 0) for r in recipes]
    monkeypatch.setattr(signs, "texts_of", None)
    again = [signs._cached_texts(r.name, r.leaf, 0) for r in recipes]
    assert [list(found) for found in again] == [list(found) for found in first]
    assert "STOP" in again[0]
    assert again[1] == {}
    np.testing.assert_array_equal(again[0]["STOP"], first[0]["STOP"])


def stock_images(view: View, leaves: dict[int, str]) -> tuple[Any, tuple[np.ndarray, np.ndarray]]:
    """What stock MuJoCo would draw of a view."""
    owners = np.full(view.slots.shape, "", dtype="<U8")
    for slot in leaves:
        owners[view.slots == slot] = f"object_{slot}"
    category = {f"object_{slot}": leaf for slot, leaf in leaves.items()}
    return types.SimpleNamespace(category=category), (owners, view.depth)


def test_the_check_agrees_with_right_answers_and_finds_wrong_ones() -> None:
    bank = box_bank(1, num_objects=3)
    view, leaves = scene_of_two(bank)
    stock, images = stock_images(view, leaves)
    swapped = {
        "yes": "no",
        "no": "yes",
        "left": "right",
        "right": "left",
        "the bench": "the dog",
        "the dog": "the bench",
    }
    checked = 0
    for candidate in questions(street_facts(bank, view, leaves)).values():
        doc = dataclasses.asdict(candidate)
        agrees = checking.check(doc, view, stock, images) if doc["template"] in CHECKED else None
        if agrees is None:
            continue
        checked += 1
        assert agrees, doc
        wrong = {**doc, "answer": swapped.get(doc["answer"], "5"), "number": (doc["number"] or 0.0) * 1.2}
        assert not checking.check(wrong, view, stock, images), wrong
    assert checked > 10


def _recipes(leaf: str) -> list[Any]:
    from urbanverse_mjx.assets.meshes.recipe import all_recipes

    found = [r for r in all_recipes() if r.leaf == leaf]
    assert all(get_recipe(r.name, r.leaf) is r for r in found)
    return found
