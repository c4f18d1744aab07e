"""The front of a vehicle is found by the side of its road and by red lamps."""

import dataclasses
import pathlib

import numpy as np
import pytest
import shapely
from PIL import Image

from tests.support import drawn_street as street
from urbanverse_mjx.datatypes import GraphObject, LabelPrior, Recording
from urbanverse_mjx.distillation import distil, fronts

ROAD = shapely.box(-50, -4, 50, 4)


@pytest.mark.parametrize(
    ("y", "yaw", "left", "sign"),
    [
        (-3.0, 0.0, False, 1),
        (3.0, 0.0, False, -1),
        (3.0, np.pi, False, 1),
        (-3.0, 0.0, True, -1),
        (3.0, 0.0, True, 1),
        (0.3, 0.0, False, 0),  # in the middle
        (-5.5, 0.1, False, 1),  # parked on the pavement
        (-9.0, 0.0, False, 0),  # in a yard
        (-3.0, np.pi / 2, False, 0),  # across: the road is 100 m wide
    ],
)
def test_traffic_keeps_to_its_side(y: float, yaw: float, left: bool, sign: int) -> None:
    odds = fronts.side_of_road(np.array([0.0, y]), yaw, ROAD, left)
    assert np.sign(odds) == sign
    assert abs(odds) <= 1.8
    assert fronts.side_of_road(np.array([0.0, y]), yaw + np.pi, ROAD, left) == pytest.approx(-odds)


def test_a_lane_and_no_road_say_nothing() -> None:
    assert fronts.side_of_road(np.array([0.0, -1.0]), 0.0, shapely.box(-50, -2, 50, 2), False) == 0.0
    assert fronts.side_of_road(np.zeros(2), 0.0, shapely.Polygon(), False) == 0.0


def test_ground_that_vehicles_hide_does_not_part_a_road() -> None:
    hidden = shapely.box(-5, -2, 5, 0.2)
    assert fronts.side_of_road(np.array([0.0, -3.0]), 0.0, ROAD - hidden, False) == pytest.approx(1.8)
    assert fronts.side_of_road(np.array([0.0, -1.5]), 0.0, ROAD - hidden, False) > 0
    wide_verge = shapely.union_all([ROAD, shapely.box(-50, 8, 50, 15)])
    assert fronts.side_of_road(np.array([0.0, -3.0]), 0.0, wide_verge, False) == pytest.approx(1.8)


def paint(share: float, body: tuple[int, int, int]) -> np.ndarray:
    """(1000, 3) u8 pixels, a share of them lamps."""
    pixels = np.tile(np.array(body, np.uint8), (1000, 1))
    pixels[: round(1000 * share)] = (170, 20, 25)
    return pixels


def test_red_lamps_are_a_tail_and_a_red_body_says_nothing() -> None:
    for body in ((200, 200, 205), (30, 32, 30), (40, 70, 160)):
        assert fronts.tail_log_odds(paint(0.02, body)) == 3.0
        assert fronts.tail_log_odds(paint(0.0, body)) == -0.8
    assert fronts.tail_log_odds(paint(0.02, (160, 30, 30))) == 0.0
    assert fronts.tail_log_odds(paint(0.002, (90, 90, 90))) == 0.0


def with_lamps(recording: Recording, cars: list[GraphObject], grey: bool = False) -> Recording:
    """Paints bodies, white headlights at +x of each car and red lamps at -x into the frames of a drawn recording."""
    objects = [*street.street_objects()[2:], *cars]
    for number, frame in enumerate(recording.frames):
        pose = np.array(frame.T_world_camera)
        depth, which, _ = street.draw(objects, pose)
        rgb = recording.rgb(number).copy()
        points = pose[:3, 3] + depth[..., None] * (street.CAMERA.rays() @ pose[:3, :3].T)
        for k, car in enumerate(cars):
            mine = which == len(objects) - len(cars) + k
            c, s = np.cos(car.yaw), np.sin(car.yaw)
            local = (points - car.center) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            lamp = mine & (np.abs(local[..., 1]) > 0.55) & (np.abs(local[..., 2]) < 0.2)
            rgb[mine] = (70, 90, 120)
            rgb[lamp & (local[..., 0] < -car.size[0] / 2 + 0.05)] = (180, 15, 20)
            rgb[lamp & (local[..., 0] > car.size[0] / 2 - 0.05)] = (250, 250, 240)
        if grey:
            rgb = np.repeat(rgb.mean(-1, keepdims=True).astype(np.uint8), 3, 2)
        Image.fromarray(rgb).save(recording.folder / frame.rgb)
    return recording


def prior_of(label: str) -> LabelPrior:
    sizes = [obj.size for obj in street.street_objects() if obj.label == label]
    return LabelPrior(np.array(sizes), stands_on=("road", "crosswalk") if label == "sedan" else ())


@pytest.mark.extended
@pytest.mark.parametrize(
    ("turned", "country", "grey", "right", "cues"),
    [
        (False, "none", False, 2, 2),
        (True, "none", False, 2, 2),  # lamps alone
        (False, "Germany", True, 2, 2),  # the road alone
        (True, "Japan", True, 2, 2),
        (
            True,
            "Germany",
            False,
            1,
            2,
        ),  # against the traffic: a tail outweighs the side, a front without lamps does not
        (True, "none", True, 1, 0),  # nothing: both face the camera
    ],
)
def test_fronts_of_a_recording(
    tmp_path: pathlib.Path, turned: bool, country: str, grey: bool, right: int, cues: int
) -> None:
    """Two cars, one seen from either end; front and tail are exchanged with `turned`."""
    cars = [
        street.box("car_0", "sedan", 14.0, 3.0, (4.4, 1.8, 1.5), 0.0 if turned else np.pi),
        street.box("car_1", "sedan", 30.0, -3.0, (4.4, 1.8, 1.5), np.pi if turned else 0.0),
    ]
    objects = [*street.street_objects()[2:], *cars]
    drawn = street.record(tmp_path, objects, street.walk(18, x0=2.0, y=5.9))
    source = dataclasses.replace(drawn.source, country=country)
    made = distil(dataclasses.replace(with_lamps(drawn, cars, grey), source=source), prior_of)
    correct = []
    for car in cars:
        found = min(made.graph.objects, key=lambda obj: np.linalg.norm(np.subtract(obj.center, car.center)))
        assert found.label == "sedan"
        correct.append(bool(np.cos(found.yaw - car.yaw) > 0.9))
    assert sum(correct) == right
    fronts_of = {entry.id: entry.front for entry in made.evidence if entry.front}
    assert len(fronts_of) == cues
    assert set(fronts_of) <= {obj.id for obj in made.graph.objects if obj.label == "sedan"}
