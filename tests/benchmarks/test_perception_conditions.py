"""Hard conditions of rendered test streets: the streets, what counts as found, and the rows of the table."""

import csv
import pathlib

import numpy as np
import pytest

from benchmarks import perception_conditions, perception_streets
from benchmarks.lib import hard_streets
from benchmarks.lib.resampling import share_interval, with_interval
from benchmarks.perception_conditions import JudgedObject, judged, rows_of
from urbanverse_mjx.assets import load_index
from urbanverse_mjx.datatypes import SceneLayout
from urbanverse_mjx.distillation.perception_model import classes
from urbanverse_mjx.distillation.perception_model.decode import Decoded, FoundObject

ROWS = pathlib.Path(__file__).parents[2] / "benchmarks" / "scores" / "perception_conditions.csv"
NAMES = classes.names()
ROAD, CAR, TREE = (NAMES.index(n) for n in ("road", "car", "tree"))


@pytest.fixture(scope="module")
def street() -> SceneLayout:
    return perception_conditions.layouts(1)[0]


@pytest.fixture(scope="module")
def half() -> float:
    return perception_streets.make_ground("test", 0).section.half


def _area(polygon: tuple[tuple[float, float], ...]) -> float:
    x, y = np.array(polygon).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


def test_a_sloping_street_keeps_its_plan_and_its_left_pavement_climbs_in_steps(street: SceneLayout, half: float):
    steep = hard_streets.steep(street, half, load_index())
    for kind in ("road", "sidewalk", "ground"):
        before, after = (sum(_area(r.polygon) for r in s.ground if r.kind == kind) for s in (street, steep))
        assert after == pytest.approx(before, abs=0.05)
    treads = [r for r in steep.ground if "_tread_" in r.id and r.id.startswith("left_pavement")]
    assert len(treads) > 40
    for tread in treads:
        x = [p[0] for p in tread.polygon]
        assert tread.plane[0] == 0.0
        assert max(x) - min(x) <= hard_streets.TREAD + 1e-6
    # A piece lies at a whole number of steps; between two pieces of a name there can be a dropped kerb.
    steps = np.array(sorted({r.plane[2] for r in treads})) / (hard_streets.GRADE * hard_streets.TREAD)
    np.testing.assert_allclose(steps - steps[0], np.round(steps - steps[0]), atol=1e-5)
    assert np.median(np.diff(steps)) == pytest.approx(1.0, abs=1e-5)
    road = next(r for r in steep.ground if r.kind == "road")
    assert road.plane[0] == pytest.approx(hard_streets.GRADE)


def test_objects_stand_on_the_slope_and_houses_are_set_into_it(street: SceneLayout, half: float):
    index = load_index()
    steep = hard_streets.steep(street, half, index)
    for flat, placed in zip(street.objects, steep.objects, strict=True):
        assert placed.position[:2] == flat.position[:2]
        x, y, _ = placed.position
        lift = placed.position[2] - flat.position[2]
        if classes.class_of_leaf(placed.category) == classes.HOUSE:
            assert lift < hard_streets.rise(x, y, half) + 0.06
        else:
            assert lift == pytest.approx(hard_streets.rise(x, y, half), abs=1e-5)


def test_low_light_changes_the_sky_alone(street: SceneLayout):
    for condition, skies in hard_streets.SKIES.items():
        dark = [hard_streets.under_sky(street, condition, k) for k in range(3)]
        assert tuple(s.sky for s in dark) == skies
        assert all(s.objects == street.objects and s.ground == street.ground for s in dark)


def test_true_and_false_objects_have_a_distance():
    """A found car, a tree taken for a car, and a car seen where nothing is; what is too small is not asked for."""
    kinds, owner, masks = np.full((40, 60), ROAD), np.full((40, 60), -1), np.full((40, 60), -1)
    distance = np.tile(np.linspace(1.0, 60.0, 60), (40, 1))
    for number, (at, kind) in enumerate(
        ((np.s_[5:20, 0:10], CAR), (np.s_[5:20, 40:50], TREE), (np.s_[30:39, 20:30], CAR))
    ):
        kinds[at], owner[at] = kind, number
    masks[5:20, 0:10], masks[5:20, 40:50], masks[20:35, 52:60] = 0, 1, 2
    seen = Decoded(kinds, masks, tuple(FoundObject(CAR, 0.9, 0) for _ in range(3)), distance)
    out = judged(seen, kinds, owner, distance, (3, 7))
    assert [(x.kind, x.true, x.found) for x in out] == [
        (CAR, True, True),
        (TREE, True, False),
        (CAR, False, False),
        (CAR, False, False),
    ]
    assert [round(x.distance) for x in out] == [6, 46, 46, 56]
    assert {(x.street, x.frame, x.around) for x in out} == {(3, 7, 2)}


def test_rows_part_objects_by_distance_and_frames_by_clutter():
    near = [JudgedObject(s, s, 5.0, CAR, True, s > 0, 2) for s in range(4)]
    far = [JudgedObject(s, 9 + s, 50.0, CAR, True, False, 30) for s in range(4)]
    false = [JudgedObject(0, 0, 50.0, CAR, False, False, 2)]
    rows = {
        r["condition"]: r
        for r in rows_of(dict.fromkeys(("plain", "dusk", "night", "steep"), (near + far + false, 8)), 4)
    }
    assert rows["all frames, by day, flat"]["recall"] == pytest.approx(3 / 8)
    assert rows["all frames, by day, flat"]["precision"] == pytest.approx(3 / 4)
    assert rows["objects up to 30 m"]["recall"] == 0.75
    assert rows["objects up to 30 m"]["precision"] == 1.0
    assert rows["distant objects: above 30 m"]["recall"] == 0.0
    assert rows["distant objects: above 30 m"]["precision"] == 0.0
    assert rows["clutter: frames of 15 objects or more"]["frames"] == 4
    assert rows["frames of fewer than 15 objects"]["objects"] == 4


def test_intervals_are_over_units_and_hold_the_share():
    rng = np.random.default_rng(0)
    under = rng.integers(0, 20, 50)
    top = rng.binomial(under, 0.3)
    low, high = share_interval(top, under) or (1.0, 0.0)
    assert low < top.sum() / under.sum() < high
    assert 0.05 < high - low < 0.3
    assert with_interval(np.array([0, 1]), np.array([0, 4])) == [0.25]
    assert with_interval(np.zeros(3, int), np.zeros(3, int)) is None
    # Ten units of one object each are less certain than ten objects of each of a hundred units.
    few = share_interval(np.array([0, 1] * 5), np.ones(10, int)) or (0.0, 0.0)
    many = share_interval(np.array([0, 10] * 50), np.full(100, 10)) or (0.0, 0.0)
    assert few[1] - few[0] > 2.0 * (many[1] - many[0])


def test_the_kept_rows_have_each_condition():
    with ROWS.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(perception_conditions.COLUMNS)
    names = " ".join(r["condition"] for r in rows)
    assert all(word in names for word in ("low light", "distant objects", "clutter", "complex terrain"))
    for r in rows:
        assert float(r["recall_low"]) <= float(r["recall"]) <= float(r["recall_high"])
        assert int(r["objects"]) > 0
