"""Blocks after cities: the table of profiles, the ground, what stays free, and the committed graphs of their
captures."""

import dataclasses
import itertools
import pathlib
import random
import re

import numpy as np
import pytest
import shapely

from urbanverse_mjx import settings
from urbanverse_mjx.citygen import city_blocks, clearance
from urbanverse_mjx.citygen.city_blocks import tables
from urbanverse_mjx.citygen.city_blocks.block import plan_of
from urbanverse_mjx.citygen.city_blocks.filling import Filler
from urbanverse_mjx.citygen.city_blocks.ground import ground
from urbanverse_mjx.citygen.city_blocks.line import StreetLine
from urbanverse_mjx.citygen.city_blocks.profile import CityProfile, mix
from urbanverse_mjx.datatypes import SceneGraph, ValidationError
from urbanverse_mjx.scene.ground import check_regions

#: The paper's appendix on the scene library.
PAPER = (
    "Cairo, Nairobi, Tangier, Rabat, Lagos, Cape Town, Beijing, Shijiazhuang, New Delhi, Tokyo, Kyoto, Almaty, "
    "Singapore, Seoul, Ho Chi Minh City, Paris, Reykjavik, Naples, Amsterdam, Barcelona, Stockholm, Riyadh, Dubai, "
    "Toronto, Puerto Vallarta, Los Angeles, Sydney, Auckland, Buenos Aires, São Paulo, Rio de Janeiro, Bogotá"
).split(", ")
ALL = [p for profiles in city_blocks.PROFILES.values() for p in profiles]


def city(name: str) -> CityProfile:
    return next(p for p in ALL if p.city == name)


def test_the_library_holds_the_papers_cities_and_autobench_others() -> None:
    library, other = ([p.city for p in city_blocks.PROFILES[name]] for name in ("urbanverse160", "autobench"))
    assert sorted(library) == sorted(PAPER)
    assert len(other) == len(set(other)) == 10
    assert not set(other) & set(library)
    for name in city_blocks.PROFILES:
        for layout in city_blocks.layouts(name):
            assert re.fullmatch(r"[A-Za-z]+_[A-Za-z]+_[A-Za-z]+_(walk|drive)_01", layout)


def test_left_hand_traffic_is_where_it_is() -> None:
    left = {p.city for p in ALL if p.drives == "left"}
    assert left == {
        *("Nairobi", "Cape Town", "New Delhi", "Tokyo", "Kyoto", "Singapore", "Sydney", "Auckland"),
        *("Bangkok", "London", "Melbourne"),
    }


def test_mixes_are_read() -> None:
    assert mix("cafe#1 3, bus stop, bar 0.5") == (("cafe#1", 3.0), ("bus stop", 1.0), ("bar", 0.5))
    with pytest.raises(ValidationError, match="empty entry"):
        mix("bar 1,, cafe 2")
    with pytest.raises(ValidationError, match="bends"):
        dataclasses.replace(city("Paris"), bends=(30.0,))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("road =", "raod =", r"my\.toml: Dubai: field: found \['raod'\]"),
        ('asphalt = "', 'asphalt = "@', r"my\.toml: Dubai: asphalt: found 'asphalt_.*, needed one of walkers"),
        ('"Dubai"', '"Doha"', None),
    ],
)
def test_a_table_of_cities_says_what_it_cannot_read(
    old: str, new: str, words: str | None, tmp_path: pathlib.Path
) -> None:
    text = (tables.FOLDER / "middle_east.toml").read_text(encoding="utf-8")
    row = next(r for r in text.split("[[profiles]]") if '"Dubai"' in r)
    assert old in row
    (tmp_path / "my.toml").write_text("[[profiles]]" + row.replace(old, new), encoding="utf-8")
    if words is None:
        (profile,) = tables.read_profiles(tmp_path / "my.toml")
        assert profile == dataclasses.replace(city("Dubai"), city="Doha")
    else:
        with pytest.raises(ValidationError, match=words):
            tables.read_profiles(tmp_path / "my.toml")


@pytest.mark.parametrize("profile", ALL, ids=lambda p: p.city)
def test_ground_is_whole(profile: CityProfile) -> None:
    """Regions do not overlap, and no gap lies between them along the street."""
    plan = plan_of(profile, random.Random(1), 200.0)
    regions = ground(plan)
    check_regions(regions)
    whole = shapely.union_all([shapely.Polygon(r.polygon).buffer(1e-6) for r in regions])
    assert isinstance(whole, shapely.Polygon)
    assert not whole.interiors
    assert len(plan.crosswalks) >= 2


def test_a_bend_keeps_widths_and_shares_corners() -> None:
    line = StreetLine(100.0, (12.0,))
    first, second = line.pieces
    for t in (-5.0, 0.0, 5.0):
        np.testing.assert_allclose(line.corner(first, 50.0, t), line.corner(second, 50.0, t), atol=1e-9)
    a, b = (np.array(line.corner(first, 50.0, t)) for t in (0.0, 5.0))
    assert float(np.dot(b - a, first.across)) == pytest.approx(5.0)


@pytest.fixture(scope="module")
def tokyo() -> SceneGraph:
    return city_blocks.block(city("Tokyo"), 3, "tokyo", length=70.0)


@pytest.mark.extended
def test_the_same_seed_gives_the_same_block_and_another_does_not(tokyo: SceneGraph) -> None:
    again, other = (city_blocks.block(city("Tokyo"), seed, "tokyo", length=70.0) for seed in (3, 4))
    assert again.content_hash() == tokyo.content_hash() != other.content_hash()


def test_nothing_stands_in_something_else(tokyo: SceneGraph) -> None:
    """Except for houses and hanging objects, footprints do not overlap."""
    standing = [
        clearance.footprint(o)
        for o in tokyo.objects
        if o.center[2] - o.size[2] / 2 < 0.3 and clearance.is_obstacle(o) and min(o.size[:2]) < 3.0
    ]
    tree = shapely.STRtree(standing)
    pairs = [(i, j) for i, j in tree.query(standing, "intersects").T if i < j]
    assert all(standing[i].intersection(standing[j]).area < 0.02 for i, j in pairs)


def test_cars_keep_to_their_side() -> None:
    for name, sign in (("London", 1.0), ("Paris", -1.0)):
        graph = city_blocks.block(city(name), 1, "x", length=80.0)
        cars = [o for o in graph.objects if o.label in ("hatchback car", "sedan", "suv") and abs(np.sin(o.yaw)) < 0.5]
        agree = [np.sign(o.center[1] * np.cos(o.yaw)) == sign for o in cars]
        assert len(cars) >= 4
        assert np.mean(agree) > 0.7  # some stand the wrong way round


@pytest.mark.extended
def test_the_lane_stays_free() -> None:
    plan = plan_of(city("Naples"), random.Random(5), 80.0)
    filler = Filler(plan, random.Random(5))
    filler.close_zones()
    for _ in range(300):
        filler.somewhere((("trash bin", 1.0), ("chair", 1.0)), 1, "any")
    taken = shapely.union_all(filler._shapes)
    for side, lane in filler.lanes.items():
        for (s0, v0), (s1, v1) in itertools.pairwise(lane):
            route = shapely.LineString([filler.at(s0, side, v0), filler.at(s1, side, v1)])
            assert route.buffer(0.45).intersection(taken).area < 0.02
    assert len(filler.objects) > 15


@pytest.mark.extended
@pytest.mark.parametrize("name", sorted(city_blocks.PROFILES))
def test_committed_graphs_are_the_layouts(name: str) -> None:
    folder = settings.scene_root() / name
    found = {p.parent.name: p for p in folder.glob("*/graph.json.gz")}
    wanted = city_blocks.layouts(name)
    assert set(found) == set(wanted)
    total = 0
    for layout, path in found.items():
        total += path.stat().st_size
        assert path.stat().st_size <= 100_000
        graph = SceneGraph.load(path)
        assert graph.id == layout
        assert graph.source.city == wanted[layout].city
        assert graph.source.video.startswith("synthetic tour of a block that follows the statistics of ")
        assert 120 <= len(graph.objects) <= 460
        assert sum(o.descriptor is not None for o in graph.objects) > 0.95 * len(graph.objects)
        assert graph.sky_descriptor is not None
        assert {"road", "sidewalk", "crosswalk"} <= {r.kind for r in graph.ground}
        span = np.ptp(np.array([p for r in graph.ground for p in r.polygon]), axis=0)
        assert span.max() > 180.0
    assert total <= 1_800_000
