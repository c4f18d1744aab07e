"""The perception model: its targets, decoding to objects, its weights' file, and its score."""

import dataclasses
import pathlib

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from benchmarks import perception_streets
from urbanverse_mjx.assets import load_index
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.ground import GROUND_KINDS
from urbanverse_mjx.datatypes.recording import SKY
from urbanverse_mjx.distillation.perception_model import classes, inference, scales, score, weights
from urbanverse_mjx.distillation.perception_model.augment import augment, jpeg, recolour
from urbanverse_mjx.distillation.perception_model.decode import Decoded, FoundObject, decode
from urbanverse_mjx.distillation.perception_model.network import BLOCKS, LEAF_STRIDE, Seen, blocks_of
from urbanverse_mjx.distillation.perception_model.targets import GroundTruth, ground_truth, loss
from urbanverse_mjx.distillation.perception_model.views import _OPTIONS, _aimed, _balance, _stands, _with_mixed_ground

NAMES = classes.names()
CAR, HOUSE, PERSON = (NAMES.index(n) for n in ("car", "house", "pedestrian adult"))
ROAD = GROUND_KINDS.index("road")


def _street() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(128, 192) category (an index into `_CATEGORIES`), slot, depth: two cars side by side before a house."""
    category = np.full((128, 192), -1, np.int32)
    slot = np.full(category.shape, -1, np.int32)
    depth = np.full(category.shape, 50.0, np.float32)
    for rows, columns, kind, number, far in (
        (np.s_[80:], np.s_[:], 0, 0, 5.0),
        (np.s_[20:80], np.s_[10:180], 1, 1, 20.0),
        (np.s_[60:90], np.s_[30:70], 2, 2, 8.0),
        (np.s_[60:90], np.s_[70:110], 2, 3, 8.0),
        (np.s_[50:100], np.s_[140:150], 3, 4, 6.0),
    ):
        category[rows, columns], slot[rows, columns], depth[rows, columns] = kind, number, far
    return category, slot, depth


_CATEGORIES = ["ground:road", "bakery", "taxi", "jogger"]


@pytest.fixture(scope="module")
def wanted() -> GroundTruth:
    category, slot, depth = (jnp.asarray(x) for x in _street())
    table = jnp.asarray(classes.class_table(_CATEGORIES))
    found = jax.jit(lambda c, s, d: ground_truth(c, s, d, jnp.asarray(200.0), table, 5))(category, slot, depth)
    return jax.tree.map(np.asarray, found)


def _answer(wanted: GroundTruth) -> Decoded:
    return decode(_right(wanted), 200.0)


def _right(wanted: GroundTruth) -> Seen:
    """Output of a perfect network."""
    logits = 8.0 * np.eye(len(NAMES), dtype=np.float32)[wanted.classes]
    coarse = np.asarray(wanted.leaf)[::LEAF_STRIDE, ::LEAF_STRIDE, None]
    # Other classes' leaves are loud: they must not be listened to.
    loud = np.arange(len(classes.leaves())) == classes.leaves().index("bus")
    leaves = 8.0 * (np.arange(len(classes.leaves())) == coarse) + 100.0 * loud
    return Seen(logits, wanted.centre, wanted.offset, wanted.log_depth, leaves)


def test_every_group_is_called_by_a_leaf_and_holds_leaves_of_the_ontology():
    leaves = set(load_index().leaves)
    for name, group in classes.groups().items():
        assert name in leaves
        assert set(group) <= leaves
    every = [leaf for group in classes.groups().values() for leaf in group]
    assert len(every) == len(set(every))


def test_what_is_told_apart_is_what_the_streets_show_and_every_group_has_some():
    shown = {leaf for leaf in perception_streets.shown_leaves() if classes.class_of_leaf(leaf) != classes.FIRST_OBJECT}
    assert set(classes.leaves()) == shown
    assert set(classes.leaf_classes()) == set(range(classes.FIRST_OBJECT + 1, len(NAMES)))
    assert (np.diff(classes.leaf_classes()) >= 0).all()


def test_surfaces_keep_their_codes():
    codes = classes.surface_codes()
    assert codes[0] == SKY
    assert [GROUND_KINDS[codes[k]] for k in range(1, classes.FIRST_OBJECT)] == list(NAMES[1 : classes.FIRST_OBJECT])
    with pytest.raises(ValidationError, match="ground:lava"):
        classes.class_table(["ground:lava"])


def test_a_right_answer_is_decoded_to_the_objects_that_are_there(wanted: GroundTruth):
    seen = _answer(wanted)
    assert sorted(t.kind for t in seen.objects) == sorted([CAR, CAR, HOUSE, PERSON])
    names = sorted(classes.leaves()[t.leaf] for t in seen.objects)
    assert names == ["bakery", "jogger", "taxi", "taxi"]
    for number in (1, 2, 3, 4):
        there = wanted.owner == number
        found = np.unique(seen.masks[there])
        assert len(found) == 1
        assert found[0] >= 0
        assert (seen.masks == found[0]).sum() == there.sum()
    assert seen.depth[40, 17] == pytest.approx(8.0, rel=1e-3)
    assert (seen.kinds[50] == ROAD).sum() == 96


def test_what_is_too_unsure_leaves_its_pixels_to_nobody(wanted: GroundTruth):
    seen = _answer(wanted)
    doubtful = next(k for k, obj in enumerate(seen.objects) if obj.kind == HOUSE)
    objects = tuple(dataclasses.replace(t, score=0.3 if k == doubtful else 0.7) for k, t in enumerate(seen.objects))
    kept = dataclasses.replace(seen, objects=objects).surer(0.5)
    left = [k for k in range(len(objects)) if k != doubtful]
    assert kept.objects == tuple(objects[k] for k in left)
    assert (kept.masks[seen.masks == doubtful] == -1).all()
    for number, k in enumerate(left):
        np.testing.assert_array_equal(kept.masks == number, seen.masks == k)
    np.testing.assert_array_equal(kept.kinds, seen.kinds)


def test_the_score_counts_found_missed_and_invented_objects(wanted: GroundTruth):
    seen = _answer(wanted)
    perfect, wrong = score.Score(), score.Score()
    depth = np.where(wanted.has_depth, 8.0, 0.0)
    kinds, owner, leaves = (np.asarray(part) for part in (wanted.classes, wanted.owner, wanted.leaf))
    perfect.add(seen, kinds, owner, depth, leaves)
    assert perfect.table()["all"] == {"there": 4, "recall": 1.0, "precision": 1.0}
    assert perfect.table()["surface_iou"]["road"] == 1.0
    assert perfect.table()["leaf"] == 1.0
    # One car is called a person, the other is lost.
    cars = [k for k, t in enumerate(seen.objects) if t.kind == CAR]
    other = classes.leaves().index("bar")
    objects = tuple(
        FoundObject(PERSON, 1.0, t.leaf)
        if k == cars[0]
        else dataclasses.replace(t, leaf=other if t.kind == HOUSE else t.leaf)
        for k, t in enumerate(seen.objects)
    )
    masks = np.where(seen.masks == cars[1], -1, seen.masks)
    wrong.add(Decoded(seen.kinds, masks, objects, seen.depth), kinds, owner, depth, leaves)
    rows = wrong.table()["objects"]
    assert wrong.table()["leaf"] == 0.5
    assert rows["car"] == {"there": 2, "recall": 0.0, "precision": None}
    assert rows["pedestrian adult"] == {"there": 1, "recall": 1.0, "precision": 0.5}
    assert "| car | 2 | 0.00 | - |" in score.as_markdown(wrong.table())


def test_a_right_answer_costs_less_than_any_other_and_small_objects_count_more(wanted: GroundTruth):
    right, ground_truths = (jax.tree.map(lambda x: jnp.asarray(x)[None], x) for x in (_right(wanted), wanted))
    cost = jax.jit(lambda s: loss(s, ground_truths, jnp.ones(1))[1])

    def without(number: int) -> dict[str, float]:
        """Parts of the loss where one object is taken for sky and for another leaf."""
        there = jnp.asarray(wanted.owner == number)[None]
        sky = 8.0 * (jnp.arange(len(NAMES)) == classes.SKY_CLASS)
        flat = right.leaves * ~there[:, ::LEAF_STRIDE, ::LEAF_STRIDE, None]
        seen = right._replace(classes=jnp.where(there[..., None], sky, right.classes), leaves=flat)
        return {name: float(x) for name, x in cost(seen).items()}

    base = {name: float(x) for name, x in cost(right).items()}
    assert base["centre"] == base["offset"] == base["depth"] == 0.0
    assert base["classes"] < 0.1
    person, house = without(4), without(1)
    assert min(person["classes"], house["classes"]) > 2 * base["classes"]
    assert person["leaves"] > base["leaves"]
    areas = [(wanted.owner == k).sum() for k in (4, 1)]
    assert (person["classes"] - base["classes"]) / areas[0] > 2 * (house["classes"] - base["classes"]) / areas[1]


def test_an_object_of_a_heavier_class_costs_more(wanted: GroundTruth):
    right, ground_truths = (jax.tree.map(lambda x: jnp.asarray(x)[None], x) for x in (_right(wanted), wanted))
    missed = jnp.asarray(wanted.owner == 4)[None, ..., None]  # the person
    seen = right._replace(classes=jnp.where(missed, jnp.zeros(len(NAMES)), right.classes))

    def cost(of_person: float) -> float:
        balance = jnp.ones(len(NAMES)).at[PERSON].set(of_person)
        return float(loss(seen, ground_truths, jnp.ones(1), balance)[1]["objects"])

    plain = float(loss(seen, ground_truths, jnp.ones(1))[1]["objects"])
    assert cost(1.0) == pytest.approx(plain, rel=1e-6)
    # A weighted mean over the person and the three others, which cost next to nothing.
    assert cost(3.0) == pytest.approx(plain * 3.0 * 4.0 / 6.0, rel=0.05)


def test_a_object_is_less_likely_right_with_a_low_peak_and_a_miss_and_in_pieces(wanted: GroundTruth):
    right = _right(wanted)
    striped = right.classes.copy()
    striped[(wanted.owner == 4) & (np.arange(len(striped)) % 4 < 2)[:, None]] = 8.0 * np.eye(len(NAMES))[ROAD]

    def wrong(seen: Seen) -> float:
        (score,) = (t.score for t in decode(seen, 200.0).objects if t.kind == PERSON)
        return 1.0 - score

    sure = wrong(right)
    assert sure < 0.1
    assert wrong(right._replace(centre=0.3 * right.centre)) > 2.0 * sure
    assert wrong(right._replace(offset=right.offset + 0.2)) > 2.0 * sure
    assert wrong(right._replace(classes=striped)) > 3.0 * sure


def test_small_objects_side_by_side_keep_their_own_peaks():
    category = np.full((64, 128), -1, np.int32)
    slot = category.copy()
    for number, column in enumerate((20, 32)):
        category[20:52, column : column + 10], slot[20:52, column : column + 10] = 3, number
    table = jnp.asarray(classes.class_table(_CATEGORIES))
    depth = jnp.full(slot.shape, 8.0)
    made = ground_truth(jnp.asarray(category), jnp.asarray(slot), depth, jnp.asarray(200.0), table, 2)
    middle = np.asarray(made.centre)[17]
    assert (np.diff(np.sign(np.diff(middle))) < 0).sum() == 2
    seen = _answer(jax.tree.map(np.asarray, made))
    assert len(seen.objects) == 2


def test_recolouring_gives_every_region_one_other_colour():
    image = jnp.asarray(np.tile(np.array([200, 60, 40], np.uint8), (8, 12, 1)))
    region = jnp.asarray(np.repeat(np.arange(4), 3)[None] * np.ones((8, 1), int))
    dyed = np.asarray(jax.jit(recolour, static_argnums=3)(jax.random.key(3), image, region, 4))
    colours = {tuple(c) for c in dyed.reshape(-1, 3).tolist()}
    assert len(colours) == 4
    assert all(len(np.unique(dyed[:, 3 * k : 3 * k + 3].reshape(-1, 3), axis=0)) == 1 for k in range(4))


def test_camera_faults_keep_the_picture_and_differ():
    rng = np.random.default_rng(0)
    smooth = np.asarray(jax.image.resize(rng.random((4, 6, 3)).astype(np.float32), (64, 96, 3), "cubic")).clip(0, 1)
    fine, coarse = (np.asarray(jpeg(jnp.asarray(smooth), jnp.asarray(q))) for q in (95.0, 8.0))
    assert np.abs(fine - smooth).mean() < 0.01 < np.abs(coarse - smooth).mean()
    faulty = jax.jit(jax.vmap(augment))(jax.random.split(jax.random.key(0), 2), jnp.asarray([smooth * 255] * 2))
    a, b = np.asarray(faulty)
    assert np.abs(a - b).mean() > 0.005
    assert min(np.corrcoef(x.ravel(), smooth.ravel())[0, 1] for x in (a, b)) > 0.6


def test_mixed_paving_changes_grounds_alone(small_bank: SceneBank):
    mixed = _with_mixed_ground(small_bank, 1.0, np.random.default_rng(0))
    grounds = [k for k, name in enumerate(small_bank.meta["categories"]) if name.startswith("ground:")]
    of_ground = np.unique(small_bank.slot_mesh[np.isin(small_bank.slot_category, grounds)])
    changed = np.flatnonzero(mixed.mesh_material != small_bank.mesh_material)
    assert set(changed) <= set(of_ground)
    assert set(mixed.mesh_material[changed]) <= set(small_bank.mesh_material[of_ground])
    same = _with_mixed_ground(small_bank, 0.0, np.random.default_rng(0))
    assert (same.mesh_material == small_bank.mesh_material).all()


def test_aimed_cameras_look_at_objects_and_rare_classes_weigh_more(small_bank: SceneBank):
    table = classes.class_table(small_bank.meta["categories"])
    other = np.flatnonzero(table[:, 0] == classes.FIRST_OBJECT)
    table[other, 0] = np.where(np.arange(len(other)) % 2, CAR, PERSON)
    places, weights_of_ground = _stands(small_bank, np.random.default_rng(0))
    aimed = _aimed(small_bank, table, places, weights_of_ground, np.random.default_rng(0))
    kinds = np.where(small_bank.slot_mesh >= 0, table[small_bank.slot_category, 0], -1)
    with_objects = np.flatnonzero((kinds > classes.FIRST_OBJECT).any(1))
    assert len(with_objects)
    for z in with_objects:
        objects = small_bank.slot_position[z, kinds[z] > classes.FIRST_OBJECT, :2]
        offset = objects - aimed[z, :, None, :2]
        away = np.arctan2(offset[..., 1], offset[..., 0]) - aimed[z, :, None, 3]
        distance = np.hypot(*np.moveaxis(offset, -1, 0))
        low, high = _OPTIONS.target_distance
        meets = (np.abs(np.sin(away / 2)) < 1e-3) & (distance > low) & (distance < high)
        assert meets.any(1).mean() > 0.9
    balance = _balance(small_bank, table)
    counts = np.bincount(kinds[kinds > classes.FIRST_OBJECT], minlength=len(NAMES))
    there = np.flatnonzero(counts)
    order = there[np.argsort(counts[there])]
    assert (np.diff(balance[order]) <= 1e-6).all()
    assert balance.min() >= 1 / 3 - 1e-6
    assert balance.max() <= 3.0 + 1e-6


@pytest.fixture(scope="module")
def variables():
    """Small random numbers in the network's shapes: compiling its own initialisation takes a minute."""
    shapes = jax.eval_shape(weights.network().init, jax.random.key(0), jnp.zeros((1, 32, 32, 3)))
    rng = np.random.default_rng(0)
    return jax.tree.map(lambda x: (0.1 * rng.random(x.shape)).astype(np.float32), shapes)


def test_weights_are_read_as_they_were_written(tmp_path: pathlib.Path, variables):
    path = weights.save(tmp_path / "w.npz", variables, {"steps": 3})
    read, record = weights.load(path)
    assert record == {"steps": 3}
    assert jax.tree.structure(read) == jax.tree.structure(variables)
    off = jax.tree.map(lambda a, b: float(np.abs(a - b).max()), read, variables)
    # Half a step of 127 to the largest, which is below 0.1.
    assert max(jax.tree.leaves(off)) < 0.1 / 127 / 2 + 1e-4


def test_a_channel_of_small_numbers_keeps_its_digits(tmp_path: pathlib.Path):
    kernel = np.random.default_rng(0).normal(size=(3, 3, 8, 4)).astype(np.float32) * [1e-4, 1.0, 100.0, 0.0]
    path = weights.save(tmp_path / "w.npz", {"a": {"kernel": kernel, "bias": np.array([1e-3, 2.0])}}, {})
    read, _ = weights.load(path)
    largest = np.abs(kernel).max((0, 1, 2))
    assert (np.abs(read["a"]["kernel"] - kernel).max((0, 1, 2)) <= 0.51 * largest / 127 + 1e-3 * largest + 1e-7).all()
    assert not read["a"]["kernel"][..., 3].any()
    np.testing.assert_allclose(read["a"]["bias"], [1e-3, 2.0], rtol=1e-3)
    with np.load(path) as file:
        assert file["a/kernel"].dtype == np.int8
        assert file["a/bias"].dtype == np.float16


def test_the_shipped_weights_are_small_and_belong_to_this_network():
    """They may have fewer residual blocks than a network that is trained today."""
    read, record = weights.load()
    blocks = blocks_of(read)
    assert all(a <= b for a, b in zip(blocks, BLOCKS, strict=True))
    shapes = jax.eval_shape(weights.network(blocks=blocks).init, jax.random.key(0), jnp.zeros((1, 32, 32, 3)))
    assert jax.tree.map(np.shape, read) == jax.tree.map(np.shape, dict(shapes))
    assert record["steps"] > 0
    assert weights.shipped().stat().st_size < 3.6e6


def test_missing_and_foreign_weights_are_named(tmp_path: pathlib.Path, variables, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(ValidationError, match="found no weights of the perception model"):
        weights.load(tmp_path / "none.npz")
    body = bytearray(weights.shipped().read_bytes())
    body[len(body) // 2] ^= 8
    for bad in (b"no weights", body[:-100], body):
        (tmp_path / "bad.npz").write_bytes(bad)
        with pytest.raises(ValidationError, match=r"bad\.npz: found an unreadable or damaged file"):
            weights.load(tmp_path / "bad.npz")
    path = weights.save(tmp_path / "w.npz", variables, {})
    monkeypatch.setattr(classes, "names", lambda: NAMES[:-1])
    with pytest.raises(ValidationError, match="other classes"):
        weights.load(path)


@pytest.mark.parametrize("size", [(45, 80), (80, 45), (33, 31)])
def test_the_model_takes_images_of_any_size(variables, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]):
    monkeypatch.setattr(inference, "SIZE", (64, 128))
    image = np.random.default_rng(0).integers(0, 255, (*size, 3), dtype=np.uint8)
    observation = inference.PerceptionModel(variables, {})(image, 60.0)
    assert observation.surfaces.shape == observation.masks.shape == size
    assert observation.depth is not None
    assert observation.depth.shape == size
    assert set(np.unique(observation.surfaces)) <= {0, *range(1, len(GROUND_KINDS)), SKY}
    assert observation.masks.max() == len(observation.detections) - 1 or not observation.detections


def test_the_model_sees_an_image_at_the_size_of_training_and_at_half_of_it(variables, monkeypatch: pytest.MonkeyPatch):
    seen: list[tuple[tuple[int, ...], tuple[int, ...], float]] = []
    real = scales.decoded

    def decoded(fine: Seen, coarse: Seen, focal: float) -> Decoded:
        seen.append((np.shape(fine.centre), np.shape(coarse.centre), focal))
        return real(fine, coarse, focal)

    monkeypatch.setattr(scales, "decoded", decoded)
    monkeypatch.setattr(inference, "SIZE", (64, 128))
    inference.PerceptionModel(variables, {}).decoded(np.zeros((30, 40, 3), np.uint8), 50.0)
    assert seen == [((48, 64), (24, 32), 160.0)]


@pytest.mark.parametrize(("kind", "threshold"), [(HOUSE, 0.7), (CAR, 0.4), (PERSON, 0.4)])
def test_an_unsure_leaf_becomes_the_plain_one_of_its_group(kind: int, threshold: float) -> None:
    special = {HOUSE: "pharmacy", CAR: "police car", PERSON: "firefighter"}[kind]
    leaf = classes.leaves().index(special)
    for certainty, label in ((threshold + 0.01, special), (threshold - 0.01, NAMES[kind])):
        assert inference.label_of(FoundObject(kind, 0.9, leaf, (), certainty)) == label
    assert load_index().by_leaf(NAMES[kind]), "the plain leaf has assets of its own"


def test_certainty_is_the_leaf_s_share_within_its_group(wanted: GroundTruth) -> None:
    """Leaves of other groups do not count: the taxi's log odds are ln 6 above those of the ten other cars."""
    right = _right(wanted)
    leaves = np.where(classes.leaf_classes() == CAR, 0.0, 20.0) + np.zeros_like(np.asarray(right.leaves))
    leaves[..., classes.leaves().index("taxi")] = np.log(6.0)
    cars = [obj for obj in decode(right._replace(leaves=leaves), 200.0).objects if obj.kind == CAR]
    assert len(cars) == 2
    count = int((classes.leaf_classes() == CAR).sum())
    for car in cars:
        assert classes.leaves()[car.leaf] == "taxi"
        assert car.certainty == pytest.approx(6.0 / (5.0 + count), rel=1e-4)


def test_beliefs_are_the_class_s_probability_times_the_leaf_s_share(wanted: GroundTruth) -> None:
    """A third of the belief in the class goes to vans; within both classes all leaves but one are equally likely."""
    right = _right(wanted)
    logits = np.asarray(right.classes).copy()
    van = NAMES.index("van")
    logits[..., van] = np.where(np.asarray(wanted.classes) == CAR, logits[..., CAR] - np.log(2.0), logits[..., van])
    leaves = np.zeros_like(np.asarray(right.leaves))
    leaves[..., classes.leaves().index("taxi")] = np.log(6.0)
    seen = decode(right._replace(classes=logits, leaves=leaves), 200.0)
    cars = [obj for obj in seen.objects if obj.kind == CAR]
    assert len(cars) == 2
    count = {kind: int((classes.leaf_classes() == kind).sum()) for kind in (CAR, van)}
    for car in cars:
        beliefs = {classes.leaves()[leaf]: p for leaf, p in car.beliefs}
        assert next(iter(beliefs)) == "taxi"
        assert beliefs["taxi"] == pytest.approx(2 / 3 * 6.0 / (5.0 + count[CAR]), rel=0.02)
        assert beliefs["minivan"] == pytest.approx(1 / 3 / count[van], rel=0.02)
        assert len(beliefs) <= 12
        assert sum(beliefs.values()) <= 1.0
        assert list(beliefs.values()) == sorted(beliefs.values(), reverse=True)
    (detection, *_) = [d for d in inference.full_size(seen, 96, 160).detections if dict(d.beliefs).get("minivan")]
    assert dict(detection.beliefs)["taxi"] == round(next(iter(cars)).beliefs[0][1], 3)
