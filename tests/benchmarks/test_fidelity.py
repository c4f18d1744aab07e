"""The fidelity scores against numbers worked out by hand."""

import dataclasses
import pathlib

import numpy as np
import pytest

from benchmarks.lib import fidelity_scores as scores
from benchmarks.lib import fidelity_store
from benchmarks.lib.injection import Errors, drifted
from urbanverse_mjx.datatypes import GraphObject


def obj(name: str, label: str, x: float, y: float, size: tuple[float, float, float], yaw: float = 0.0) -> GraphObject:
    return GraphObject(name, label, (x, y, size[2] / 2), size, yaw)


def test_scores_of_a_small_street() -> None:
    ground_truth = [
        obj("a", "car", 0, 0, (4, 2, 1.5)),
        obj("b", "bench", 10, 0, (0.5, 2, 1), np.pi / 2),
        obj("c", "house", 20, 0, (8, 8, 8)),
        obj("d", "bin", 40, 0, (0.5, 0.5, 1)),
    ]
    found = [
        obj("x", "car", 0.3, 0.4, (4, 2, 1.5), np.pi + 0.1),
        obj("y", "bin", 10, 0, (0.5, 2, 1), np.pi / 2),
        obj("z", "house", 20, 3, (8, 8, 8)),
        obj("w", "bin", 60, 0, (0.5, 0.5, 1)),
        obj("v", "lamp", 80, 0, (0.2, 0.2, 5)),
    ]
    turnable = {"a": True, "b": True, "c": False, "d": False}
    row = scores.table_row([scores.score(found, ground_truth, [obj("u", "lamp", 80, 0, (0.2, 0.2, 5))], turnable)])
    assert row["cat_percent"] == pytest.approx(66.7)
    assert row["dist_m"] == pytest.approx((0.5 + 0 + 3) / 3, abs=1e-3)
    assert row["ori_deg"] == pytest.approx(np.degrees(0.1) / 2, abs=0.01)
    assert row["front_percent"] == 50.0
    assert row["scale_m3"] == 0.0
    assert row["recall_percent"] == 75.0
    # The lamp was hardly seen: finding it counts neither way.
    assert (row["objects"], row["found"]) == (4, 4)
    assert row["precision_percent"] == 75.0
    # Of car, bench and bin (the house is large) the car alone is found.
    assert row["map25"] == pytest.approx(100 / 3, abs=0.1)


def test_scores_come_back_from_their_file(tmp_path: pathlib.Path) -> None:
    ground_truth = [obj("a", "car", 0, 0, (4, 2, 1.5)), obj("b", "bench", 10, 0, (0.5, 2, 1))]
    found = [obj("x", "car", 0.3, 0.4, (4, 2, 1.5), 0.1), obj("y", "bin", 11, 0, (0.5, 2, 1))]
    scored = scores.score(found, ground_truth, [], {"a": True, "b": True})
    path = tmp_path / "new" / "street.json"
    assert fidelity_store.load(path) == {}
    fidelity_store.save(path, {"a row": (scored, {"registered": 1.0})})
    back, figures = fidelity_store.load(path)["a row"]
    assert figures == {"registered": 1.0}
    assert back.pairs == scored.pairs
    assert scores.table_row([back, back]) == scores.table_row([scored, scored])


def test_iou_of_boxes() -> None:
    a = obj("a", "x", 0, 0, (2, 2, 2))
    assert scores.iou(a, a) == pytest.approx(1.0)
    assert scores.iou(a, obj("b", "x", 1, 0, (2, 2, 2))) == pytest.approx(1 / 3)
    # A square turned by 45° inside and out: an octagon of area 8 (sqrt 2 - 1).
    octagon = 8 * (np.sqrt(2) - 1)
    assert scores.iou(a, obj("b", "x", 0, 0, (2, 2, 2), np.pi / 4)) == pytest.approx(octagon / (8 - octagon))
    assert scores.iou(a, obj("b", "x", 3, 0, (2, 2, 2))) == 0.0


def test_average_precision_by_hand() -> None:
    rows = np.array([[0.9, 1], [0.8, 0], [0.7, 1]], float)
    assert scores.average_precision(rows, 2) == pytest.approx(0.5 * 1.0 + 0.5 * 2 / 3)
    assert scores.average_precision(np.zeros((0, 2)), 3) == 0.0


def test_alignment_takes_a_rigid_motion_out_and_no_scale() -> None:
    poses = np.tile(np.eye(4), (10, 1, 1))
    poses[:, 0, 3] = np.arange(10)  # straight: centres alone would leave the turn about the path open
    T = np.eye(4)
    T[:3, :3] = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    T[:3, 3] = 4, 5, 6
    np.testing.assert_allclose(scores.alignment(poses, T @ poses), T, atol=1e-9)
    longer = poses.copy()
    longer[:, 0, 3] *= 2
    found = scores.alignment(longer, poses)
    assert np.linalg.det(found[:3, :3]) == pytest.approx(1.0)
    (moved,) = scores.moved([obj("a", "x", 1, 0, (1, 1, 1))], T)
    np.testing.assert_allclose(moved.center, (4, 6, 6.5))
    assert moved.yaw == pytest.approx(np.pi / 2)


def test_drift_has_the_size_that_the_protocol_says() -> None:
    poses = np.tile(np.eye(4), (101, 1, 1))
    poses[:, 0, 3] = np.arange(101)
    straight = drifted(poses, dataclasses.replace(Errors(), turn=0.0), 1.0)
    assert straight[-1, 0, 3] == pytest.approx(101.0)
    turned = drifted(poses, dataclasses.replace(Errors(), drift=0.0), 1.0)
    assert np.degrees(np.arctan2(turned[-1, 1, 0], turned[-1, 0, 0])) == pytest.approx(3.0)


def test_round_and_square_objects_have_no_heading() -> None:
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], -1)
    assert not scores.is_turnable(circle)
    square = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    assert not scores.is_turnable(square)
    assert scores.is_turnable(square * [1.5, 1.0])
