"""Fusing a detector's boxes with the perception model's objects: classes, riders, masks, depth, and order."""

import dataclasses
import pathlib

import numpy as np
import pytest

from benchmarks import photographs, second_opinion
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation.perception.foundation.boxes import Boxes
from urbanverse_mjx.distillation.perception.published import fusion, groups, opinion
from urbanverse_mjx.distillation.perception.published.fusion import FusionOptions, fuse
from urbanverse_mjx.distillation.perception_model import classes
from urbanverse_mjx.distillation.perception_model.decode import Decoded, FoundObject
from urbanverse_mjx.pipeline.generation.predictors import make_predictor
from urbanverse_mjx.pipeline.generation.video_options import VideoOptions

H, W = 36, 64
SIZE = 360, 640  # of the image, ten pixels for one of the outputs
#: The probability is the detector's score.
PLAIN = FusionOptions(trust=(0.0, 1.0, 0.0, 0.0, 0.0, 0.0))
PERSON, BICYCLE, CAR, MOTORCYCLE, BUS, LIGHT = 0, 1, 2, 3, 5, 9


def number(name: str) -> int:
    return classes.names().index(name)


def scene(*objects: tuple[str, float, tuple[int, int, int, int]]) -> Decoded:
    """Sky above row 12, house fronts to row 20 and road below, 20 m far and nearer by the row; objects are
    rectangles (left, top, right, bottom)."""
    kinds = np.full((H, W), classes.SKY_CLASS, np.int32)
    kinds[12:20], kinds[20:] = classes.HOUSE, number("road")
    depth = np.full((H, W), 20.0, np.float32)
    depth[20:] = 400.0 / np.arange(20, H)[:, None]
    masks = np.full((H, W), -1, np.int32)
    found = []
    for name, score, (left, top, right, bottom) in objects:
        kinds[top:bottom, left:right] = number(name)
        masks[top:bottom, left:right] = len(found)
        leaf = int(np.flatnonzero(classes.leaf_classes() == number(name))[-1])
        found.append(FoundObject(number(name), score, leaf, (), 0.9))
    return Decoded(kinds, masks, tuple(found), depth)


def boxes(*rows: tuple[str, float, tuple[float, float, float, float]]) -> Boxes:
    """In pixels of the outputs."""
    return Boxes(
        np.array([r[2] for r in rows], float).reshape(-1, 4) * 10,
        np.array([number(r[0]) for r in rows], int),
        np.array([r[1] for r in rows], float),
    )


def names(seen: Decoded) -> list[str]:
    return [classes.names()[o.kind] for o in seen.objects]


def test_a_box_confirms_an_object_and_raises_its_probability() -> None:
    seen = scene(("van", 0.6, (10, 18, 20, 26)), ("car", 0.7, (40, 20, 50, 26)))
    fused = fuse(seen, boxes(("car", 0.9, (10, 18, 20, 27)), ("car", 0.3, (40, 20, 50, 26))), SIZE, PLAIN)
    # COCO's car includes vans, so the finer class stays; a doubtful box takes nothing away.
    assert names(fused) == ["van", "car"]
    assert [round(o.score, 3) for o in fused.objects] == [0.9, 0.7]
    assert [o.certainty for o in fused.objects] == [0.9, 0.9]
    np.testing.assert_array_equal(fused.masks, seen.masks)
    np.testing.assert_array_equal(fused.depth, seen.depth)


def test_the_options_say_how_much_an_object_and_its_box_overlap() -> None:
    """They overlap by 0.6."""
    seen, found = scene(("car", 0.6, (10, 20, 20, 26))), boxes(("bus", 0.9, (10, 20, 20, 30)))
    assert names(fuse(seen, found, SIZE, PLAIN)) == ["bus"]
    (one,) = fusion.candidates(seen, found, SIZE, dataclasses.replace(PLAIN, same=0.7))
    assert one.partner == -1


@pytest.mark.parametrize(("score", "name"), [(0.8, "bus"), (0.5, "car")])
def test_the_surer_of_two_classes_counts(score: float, name: str) -> None:
    fused = fuse(scene(("car", 0.6, (10, 12, 24, 26))), boxes(("bus", score, (10, 12, 24, 26))), SIZE, PLAIN)
    assert names(fused) == [name]
    assert fused.objects[0].score == pytest.approx(max(score, 0.6))
    assert (fused.kinds[fused.masks == 0] == number(name)).all()
    if name == "bus":  # nothing is known of its leaf
        assert fused.objects[0].certainty == 0.0
        assert classes.leaf_classes()[fused.objects[0].leaf] == number("bus")


def test_a_missed_object_is_an_ellipse_at_the_depth_of_the_ground_below_it() -> None:
    seen = scene()
    fused = fuse(seen, boxes(("pedestrian adult", 0.8, (30, 16, 34, 26))), SIZE, PLAIN)
    assert names(fused) == ["pedestrian adult"]
    rows, columns = np.nonzero(fused.masks == 0)
    assert (rows.min(), rows.max() + 1, columns.min(), columns.max() + 1) == (16, 26, 30, 34)
    assert 0.7 < len(rows) / 40 < 0.95
    assert fused.masks[16, 30] == -1  # a corner
    assert (fused.kinds[rows, columns] == number("pedestrian adult")).all()
    np.testing.assert_allclose(fused.depth[rows, columns], np.median(400.0 / np.arange(26, 29)), rtol=1e-6)
    outside = fused.masks < 0
    np.testing.assert_array_equal(fused.depth[outside], seen.depth[outside])
    np.testing.assert_array_equal(fused.kinds[outside], seen.kinds[outside])


def test_a_bus_fills_its_box_and_a_car_does_not() -> None:
    shares = [
        (fuse(scene(), boxes((name, 0.8, (10, 14, 40, 30))), SIZE, PLAIN).masks == 0).sum() / 480
        for name in ("bus", "car")
    ]
    assert shares[0] > 0.93
    assert 0.7 < shares[1] < 0.82


def test_what_hangs_has_the_models_own_depth() -> None:
    fused = fuse(scene(), boxes(("traffic light", 0.8, (30, 13, 33, 19))), SIZE, PLAIN)
    np.testing.assert_allclose(fused.depth[fused.masks == 0], 20.0)


def test_pixels_of_related_classes_are_the_mask_where_they_fill_the_box() -> None:
    """The model saw the pixels of two parked cars as one object without a probability worth reporting."""
    seen = scene(("truck", 0.1, (10, 20, 30, 26)))
    fused = fuse(seen, boxes(("car", 0.8, (9, 19, 20, 27)), ("car", 0.7, (20, 19, 31, 27))), SIZE, PLAIN)
    assert names(fused) == ["car", "car"]  # of the truck's pixels nothing is left
    for k, columns in ((0, slice(10, 20)), (1, slice(20, 30))):
        mask = np.zeros((H, W), bool)
        mask[20:26, columns] = True
        np.testing.assert_array_equal(fused.masks == k, mask)
        np.testing.assert_array_equal(fused.depth[mask], seen.depth[mask])


def test_a_nearer_object_keeps_its_pixels_and_a_house_does_not() -> None:
    seen = scene(("house", 0.9, (0, 4, 64, 36)), ("pedestrian adult", 0.9, (28, 14, 32, 30)))
    fused = fuse(seen, boxes(("car", 0.8, (20, 18, 40, 26))), SIZE, PLAIN)
    assert names(fused) == ["house", "pedestrian adult", "car"]
    np.testing.assert_array_equal(fused.masks == 1, seen.masks == 1)
    assert (fused.masks == 2).sum() > 80


def test_one_object_is_not_reported_twice() -> None:
    seen = scene(("car", 0.9, (10, 18, 22, 26)))
    half = boxes(("car", 0.8, (10, 18, 16, 26)), ("truck", 0.7, (9, 18, 16, 26)))
    assert names(fuse(seen, half, SIZE, PLAIN)) == ["car"]
    nothing = scene()
    assert names(fuse(nothing, half, SIZE, PLAIN)) == ["car"]
    far = boxes(("car", 0.8, (10, 18, 16, 26)), ("car", 0.7, (40, 18, 46, 26)), ("car", 0.4, (50, 20, 58, 26)))
    assert names(fuse(nothing, far, SIZE, PLAIN)) == ["car", "car"]  # the third is too doubtful


def test_a_box_of_no_pixels_is_left_out() -> None:
    assert fuse(scene(), boxes(("car", 0.9, (10.1, 20.1, 12.0, 22.0))), SIZE, PLAIN).objects == ()
    seen = scene(("car", 0.9, (10, 18, 22, 26)))
    same = fuse(seen, boxes(), SIZE, PLAIN)
    assert same.objects == seen.objects
    np.testing.assert_array_equal(same.masks, seen.masks)


def test_the_order_of_boxes_does_not_matter() -> None:
    rng = np.random.default_rng(0)
    kinds = ("car", "truck", "pedestrian adult", "bicycle", "traffic light", "cyclist")
    seen = scene(
        ("car", 0.6, (8, 18, 20, 27)), ("bus", 0.4, (20, 10, 36, 26)), ("pedestrian adult", 0.2, (40, 16, 44, 28))
    )
    rows = []
    for _ in range(40):
        left, top = rng.uniform(0, 50), rng.uniform(8, 26)
        box = (left, top, left + rng.uniform(3, 14), top + rng.uniform(4, 10))
        # Equal scores and equal boxes too.
        rows.append((kinds[rng.integers(6)], float(rng.choice([0.5, 0.7, 0.9])), box))
    rows += [("car", 0.9, rows[0][2]), ("truck", 0.9, rows[0][2])]
    fused = fuse(seen, boxes(*rows), SIZE, PLAIN)
    assert len(fused.objects) > 8
    for _ in range(10):
        other = fuse(seen, boxes(*(rows[k] for k in rng.permutation(len(rows)))), SIZE, PLAIN)
        assert other.objects == fused.objects
        for name in ("kinds", "masks", "depth"):
            np.testing.assert_array_equal(getattr(other, name), getattr(fused, name))


def test_the_evidence_is_what_the_model_says_inside_the_box() -> None:
    seen = scene(("van", 0.6, (10, 20, 20, 26)))
    (one,) = fusion.candidates(seen, boxes(("car", 0.8, (10, 20, 20, 29))), SIZE)
    assert one.partner == 0
    constant, odds, share, prior, side, sign = one.evidence
    assert (constant, prior, sign) == (1.0, 0.6, 0.0)
    assert odds == pytest.approx(np.log(4.0))
    assert share == pytest.approx(6 / 9)
    assert np.exp(2 * side) == pytest.approx(90 / (H * W))
    (alone,) = fusion.candidates(seen, boxes(("bus", 0.8, (10, 20, 20, 29))), SIZE)
    assert alone.evidence[2:4] == (0.0, 0.0)


def coco(*rows: tuple[int, float, tuple[float, float, float, float]]) -> Boxes:
    return Boxes(np.array([r[2] for r in rows], float), np.array([r[0] for r in rows]), np.array([r[1] for r in rows]))


def test_classes_of_coco_become_groups_and_others_go() -> None:
    found = groups.to_groups(coco((CAR, 0.5, (0, 0, 9, 9)), (15, 0.9, (0, 0, 9, 9)), (LIGHT, 0.4, (20, 0, 25, 9))))
    assert [classes.names()[k] for k in found.label] == ["car", "traffic light"]
    assert found.score.tolist() == [0.5, 0.4]
    members = set(groups.COCO.values())
    assert members <= {g for known in photographs.GROUPS.values() for g in known}  # what is not measured is not used


def test_a_rider_and_a_bicycle_are_a_cyclist() -> None:
    """Positions as in a photograph of a street: the feet are above the ground on which the wheels stand."""
    rider, bicycle = (680.0, 383.0, 868.0, 747.0), (588.0, 545.0, 938.0, 783.0)
    walker, passer = (700.0, 400.0, 800.0, 790.0), (100.0, 383.0, 288.0, 747.0)
    cyclist = (588.0, 383.0, 938.0, 783.0)
    for wheels in (BICYCLE, MOTORCYCLE):
        found = groups.to_groups(coco((PERSON, 0.9, rider), (wheels, 0.6, bicycle), (PERSON, 0.8, passer)))
        assert sorted(classes.names()[k] for k in found.label) == ["cyclist", "pedestrian adult"]
        k = found.label.tolist().index(number("cyclist"))
        assert tuple(found.box[k]) == cyclist
        assert found.score[k] == 0.6
    # Whoever stands in front of a bicycle has the feet below its wheels.
    apart = groups.to_groups(coco((PERSON, 0.9, walker), (BICYCLE, 0.6, bicycle)))
    assert sorted(classes.names()[k] for k in apart.label) == ["bicycle", "pedestrian adult"]
    # One bicycle has one rider.
    second = (685.0, 388.0, 873.0, 752.0)
    two = groups.to_groups(coco((PERSON, 0.9, rider), (PERSON, 0.8, second), (BICYCLE, 0.6, bicycle)))
    assert sorted(classes.names()[k] for k in two.label) == ["cyclist", "pedestrian adult"]


class Model:
    """A perception model that sees the scene with a doubtful car."""

    def decoded(self, rgb: np.ndarray, focal: float) -> Decoded:
        assert rgb.shape == (*SIZE, 3)
        assert focal == 500.0
        return scene(("car", 0.3, (10, 18, 20, 26)))


def test_the_predictor_reports_what_both_see() -> None:
    car, person = (CAR, 0.9, (100, 180, 200, 260)), (PERSON, 0.8, (300, 160, 340, 260))
    found = coco(car, person, (CAR, 0.2, (500, 200, 560, 260)))
    both = opinion.SecondOpinion(Model(), lambda rgb: found, PLAIN)  # pyright: ignore[reportArgumentType]
    rgb = np.zeros((*SIZE, 3), np.uint8)
    seen = both(rgb, 500.0)
    leaf = classes.leaves()[Model().decoded(rgb, 500.0).objects[0].leaf]
    assert [d.label for d in seen.detections] == [leaf, "pedestrian adult"]
    assert seen.masks.shape == SIZE
    assert seen.masks[200, 150] == 0
    assert seen.masks[210, 320] == 1
    assert seen.masks[230, 530] == -1
    assert seen.surfaces[210, 320] == 0  # an object is no ground
    assert seen.depth is not None
    assert seen.depth[210, 320] == pytest.approx(np.median(400.0 / np.arange(26, 29)))


def test_without_weights_nothing_is_written(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "frames").mkdir()
    words = ["gen", str(tmp_path / "frames"), "--out", str(tmp_path / "run"), "--second-opinion", "nanodet"]
    assert main(words) == 2
    assert "urbanverse gen weights nanodet" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_a_second_opinion_belongs_to_the_built_in_network() -> None:
    with pytest.raises(ValidationError, match="--second-opinion"):
        make_predictor(VideoOptions(perception="foundation", second_opinion="nanodet"))
    with pytest.raises(ValidationError, match="nanodet"):
        make_predictor(VideoOptions(second_opinion="yolo"))


# Calibration ---------------------------------------------------------------------------------------------------------


def test_calibration_and_report_share_no_photograph() -> None:
    entries = [{"repository": f"a/{k % 7}", "path": f"{k}.jpg"} for k in range(107)]
    calibration, report = (photographs.part_of(entries, p) for p in ("calibration", "report"))
    assert (len(calibration), len(report)) == (35, 72)
    names = [{(e["repository"], e["path"]) for e in part} for part in (calibration, report)]
    assert not names[0] & names[1]
    assert photographs.part_of(entries, "all") == entries
    backwards = photographs.part_of(entries[::-1], "calibration")
    assert {(e["repository"], e["path"]) for e in backwards} == names[0]


def test_boxes_are_judged_as_the_benchmark_counts_them() -> None:
    def candidate(name: str, mark: float) -> fusion.Candidate:
        return fusion.Candidate(number(name), np.zeros(4), (mark,), -1)

    labelled = [("car", np.array([0, 0, 100, 100.0])), ("person", np.array([200, 0, 230, 90.0]))]
    found = [candidate("car", 1), candidate("car", 2), candidate("pedestrian adult", 3), candidate("car", 4)]
    box = np.array([[0, 0, 100, 90], [5, 0, 100, 100], [300, 0, 330, 90], [0, 0, 30, photographs.MIN_HEIGHT - 1.0]])
    # The second repeats the first, the third is beside the person, the fourth is too small to be judged.
    assert second_opinion.judged(found, box, labelled) == [((1,), True), ((2,), False), ((3,), False)]


def test_reliability_compares_probabilities_with_shares() -> None:
    rows = second_opinion.reliability(np.array([0.1, 0.15, 0.9, 1.0]), np.array([False, True, True, True]))
    assert rows == [
        {"boxes": 2, "probability": 0.12, "right": 0.5},
        {"boxes": 2, "probability": 0.95, "right": 1.0},
    ]


def test_shipped_options_have_a_coefficient_for_each_feature() -> None:
    (one,) = fusion.candidates(scene(), boxes(("car", 0.8, (10, 20, 20, 26))), SIZE)
    assert len(fusion.OPTIONS.trust) == len(one.evidence)
    assert dataclasses.asdict(fusion.OPTIONS)["least"] == 0.5
