"""Objects are named by all that their views believe, and by their height."""

import dataclasses
import pathlib

import numpy as np
import pytest

from tests.support import drawn_street as street
from urbanverse_mjx.assets.records.index import load_index
from urbanverse_mjx.datatypes import Detection, GraphObject, LabelPrior, Recording, ValidationError
from urbanverse_mjx.distillation import distil, fusion
from urbanverse_mjx.distillation.distil import word_similarity
from urbanverse_mjx.distillation.lifting import NUM_POINTS, Views
from urbanverse_mjx.distillation.perception_model import classes, naming

LEAVES = classes.leaves()


def belief_of(**shares: float) -> np.ndarray:
    out = np.zeros(len(LEAVES))
    for name, share in shares.items():
        out[LEAVES.index(name.replace("_", " "))] = share
    return out


def plain(**heights: tuple[float, float]) -> naming.Naming:
    """A regression that knows only that some leaves prefer a height (m): log odds -strength (log h - log best)^2."""
    weights = np.zeros(naming.used().shape)
    for name, (best, strength) in heights.items():
        log = np.log(best)
        weights[-3:, LEAVES.index(name.replace("_", " "))] = -strength * np.array([log**2, -2.0 * log, 1.0])
    return naming.Naming(1.0, weights)


def test_without_weights_the_beliefs_stand() -> None:
    belief = belief_of(sedan=0.6, van=0.3)
    p = plain().probabilities(belief[None], np.array([1.5]))[0]
    floor = 0.001
    total = 0.9 + floor * len(LEAVES)
    assert p[LEAVES.index("sedan")] == pytest.approx((0.6 + floor) / total)
    assert p[LEAVES.index("bench")] == pytest.approx(floor / total)


def test_height_decides_between_equal_beliefs() -> None:
    belief = belief_of(hatchback_car=0.5, minivan=0.5)
    known = plain(hatchback_car=(1.4, 50.0), minivan=(1.9, 50.0))
    for height, name in ((1.45, "hatchback car"), (1.85, "minivan")):
        assert LEAVES[known.leaf(belief, height)] == name


def test_what_is_improbable_has_the_name_of_its_group() -> None:
    few = belief_of(bakery=0.4, pharmacy=0.35, cafe=0.25)
    many = belief_of(**dict.fromkeys(("bakery", "pharmacy", "cafe", "bar", "bank", "bistro", "hotel", "school"), 0.125))
    assert LEAVES[plain().leaf(few, 8.0)] == "bakery"
    assert LEAVES[plain().leaf(many, 8.0)] == "house"


def test_a_leaf_depends_on_its_siblings_on_groups_and_on_height_alone() -> None:
    used = naming.used()
    kinds = classes.leaf_classes()
    sedan = LEAVES.index("sedan")
    np.testing.assert_array_equal(np.flatnonzero(used[: len(LEAVES), sedan]), np.flatnonzero(kinds == kinds[sedan]))
    assert used[len(LEAVES) :].all()
    assert not naming.shipped().weights[~used].any()


def test_the_shipped_regression_keeps_what_all_views_are_certain_of() -> None:
    index = load_index()
    wrong = []
    for number, leaf in enumerate(LEAVES):
        height = float(np.median([record.extent_xyz[2] for record in index.by_leaf(leaf)]))
        if naming.shipped().leaf(np.eye(len(LEAVES))[number], height) != number:
            wrong.append(leaf)
    assert not wrong


def test_a_file_holds_the_weights_to_a_127th_of_the_largest(tmp_path: pathlib.Path) -> None:
    weights = np.where(naming.used(), np.random.default_rng(0).normal(size=naming.used().shape), 0.0)
    naming.save(naming.Naming(0.7, weights), tmp_path / "naming.npz")
    back = naming.load(tmp_path / "naming.npz")
    assert back.sharpness == pytest.approx(0.7)
    assert (np.abs(back.weights - weights) <= np.abs(weights).max(0) / 254.0 + 1e-6).all()
    naming.save(naming.Naming(0.7, weights[:-1]), tmp_path / "other.npz")
    with pytest.raises(ValidationError, match=r"found weights \(184, 136\), needed \(185, 136\)"):
        naming.load(tmp_path / "other.npz")


def views_of(*beliefs: dict[str, float]) -> Views:
    n, labels = len(beliefs), tuple(dict.fromkeys(label for b in beliefs for label in b))
    belief = np.array([[b.get(label, 0.0) for label in labels] for b in beliefs], np.float32)
    whole, three = np.zeros(n, np.int32), np.zeros((n, NUM_POINTS, 3), np.float32)
    return Views(
        labels, whole, belief.argmax(1).astype(np.int32), np.ones(n, np.float32), whole - 1, three, whole,
        np.zeros((n, 4), bool), np.zeros((n, 2), np.int32), belief,
    )  # fmt: skip


def test_torn_views_of_one_object_are_alike() -> None:
    """By the likeliest label alone, the first two are as different as a house and a bus shelter."""
    torn = {"bakery": 0.35, "pharmacy": 0.33, "cafe": 0.32}
    other = {"bakery": 0.32, "pharmacy": 0.35, "cafe": 0.33}
    views = views_of(torn, other, {"bus shelter": 1.0}, {"cafe": 1.0})
    alike = np.array([[word_similarity(a, b) for b in views.labels] for a in views.labels])
    likeness = (votes := fusion.directions(views, alike)) @ alike @ votes.T
    np.testing.assert_allclose(np.diag(likeness), 1.0, rtol=1e-5)
    assert likeness[0, 1] > 0.9
    assert likeness[0, 2] < 0.7
    assert likeness[2, 3] == pytest.approx(word_similarity("bus shelter", "cafe"))


CAR = GraphObject("car_0", "car", (20.0, -2.6, 0.72), (4.4, 1.8, 1.44), 0.0)


def prior_of(label: str) -> LabelPrior:
    return LabelPrior(np.array([[4.4, 1.8, 1.44]]) if "car" in label else np.zeros((0, 3)))


def recorded(folder: pathlib.Path, beliefs: list[dict[str, float]]) -> Recording:
    """A drawn car of which each view has another belief, in turn."""
    drawn = street.record(folder, [CAR], street.walk(16))
    frames = []
    for number, frame in enumerate(drawn.frames):
        given = tuple(beliefs[number % len(beliefs)].items())
        label = max(given, key=lambda pair: pair[1])[0]
        found = tuple(Detection(label, d.score, None, given if len(given) > 1 else ()) for d in frame.detections)
        frames.append(dataclasses.replace(frame, detections=found))
    return dataclasses.replace(drawn, frames=tuple(frames))


def test_second_choices_of_all_views_name_an_object(tmp_path: pathlib.Path) -> None:
    """No view believes most that it is a police car, all together do."""
    shares = [
        {"bench": 0.55, "police car": 0.45},
        {"kiosk": 0.55, "police car": 0.45},
        {"table": 0.55, "police car": 0.45},
    ]
    soft = distil(recorded(tmp_path / "soft", shares), prior_of)
    assert [o.label for o in soft.graph.objects] == ["police car"]
    hard = distil(recorded(tmp_path / "hard", [{max(s, key=s.__getitem__): 1.0} for s in shares]), prior_of)
    assert "police car" not in {o.label for o in hard.graph.objects}


def test_labels_of_other_detectors_are_not_renamed(tmp_path: pathlib.Path) -> None:
    """The regression knows only the leaves of the perception model; beliefs in other labels are added up."""
    given = [{"a car of some kind": 0.6, "hovercraft": 0.4}, {"hovercraft": 0.6, "motor car": 0.4}]
    made = distil(recorded(tmp_path, given), prior_of)
    assert {o.label for o in made.graph.objects} == {"hovercraft"}
