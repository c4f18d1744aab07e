"""What a country does not have is exchanged, and no house hangs in the air."""

import dataclasses
import math

import pytest

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.selection.search import library as objects
from urbanverse_mjx.datatypes import GroundRegion, PlacedGround, PlacedObject, SceneGraph, SceneLayout, Source
from urbanverse_mjx.datatypes.toml_table import table
from urbanverse_mjx.materialisation import Cousin, exchange, localise
from urbanverse_mjx.materialisation.cousins import index_of
from urbanverse_mjx.scene import library

INDEX = load_index()
SQUARE = ((0.0, -5.0), (60.0, -5.0), (60.0, 5.0), (0.0, 5.0))


def placed(name: str, leaf: str, variant: int, at: tuple[float, float, float]) -> PlacedObject:
    record = next(r for r in INDEX.by_leaf(leaf) if r.params["variant"] == variant)
    mass, rough, movable = record.mass, record.friction_coefficient, record.movable
    return PlacedObject(name, leaf, leaf, record.uid, at, -math.pi / 2, (1.0, 1.0, 1.0), mass, rough, movable)


def cousin(*found: PlacedObject) -> Cousin:
    ground = PlacedGround("walk", "sidewalk", SQUARE, (0.0, 0.0, 0.1), "slabs_grey")
    layout = SceneLayout("street", "street", "0" * 64, 0, 0, found, (ground,), "day_noon_clear_summer", 0.0, {})
    return Cousin(layout, (), (), (), {}, (), (), None)  # type: ignore[arg-type]


def in_city(city: str, country: str, *found: PlacedObject, exchanging: bool = True) -> Cousin:
    region = GroundRegion(id="walk", kind="sidewalk", polygon=SQUARE, plane=(0.0, 0.0, 0.1))
    graph = SceneGraph(id="street", source=Source("hand", "CC0-1.0", city, country), objects=(), ground=(region,))
    return localise(cousin(*found), graph, exchange=exchanging)


def variant_of(made: Cousin, name: str) -> int:
    (uid,) = [p.asset_uid for p in made.layout.objects if p.id == name]
    return objects().record(uid).params["variant"]


RICKSHAW = placed("rickshaw_0", "rickshaw", 0, (20.0, 0.0, 0.1))
POSTBOX = placed("postbox_0", "postbox", 0, (30.0, 0.0, 0.1))


@pytest.mark.parametrize(
    ("city", "country", "auto", "red"),
    [
        ("Kyoto", "Japan", False, True), ("New Delhi", "India", True, True), ("Paris", "France", False, False),
        ("Bangkok", "Thailand", True, False), ("London", "United Kingdom", False, True),
    ],
)  # fmt: skip
def test_streets_have_the_rickshaws_and_postboxes_of_their_country(
    city: str, country: str, auto: bool, red: bool
) -> None:
    made = in_city(city, country, RICKSHAW, POSTBOX)
    assert (variant_of(made, "rickshaw_0") in (0, 1)) == auto
    assert (variant_of(made, "postbox_0") == 0) == red
    before = {p.id: p for p in cousin(RICKSHAW, POSTBOX).layout.objects}
    assert all(p.position == before[p.id].position and p.yaw == before[p.id].yaw for p in made.layout.objects)


def test_without_the_option_they_stay() -> None:
    made = in_city("Kyoto", "Japan", RICKSHAW, POSTBOX, exchanging=False)
    assert {p.asset_uid for p in made.layout.objects} == {RICKSHAW.asset_uid, POSTBOX.asset_uid}


def test_what_would_enter_another_object_deeper_stays() -> None:
    bollards = [
        placed(f"b_{k}", "bollard", 0, (20.0 + x, y, 0.1)) for k, (x, y) in enumerate([(0.8, 0.0), (-0.8, 0.0)])
    ]
    layout = cousin(POSTBOX, RICKSHAW, *bollards).layout
    index = index_of(layout)
    (box,) = [p for p in layout.objects if p.id == "postbox_0"]
    tight = dataclasses.replace(box, scale=(0.2, 0.2, 0.2), position=(20.0, 0.0, 0.1))
    layout = dataclasses.replace(layout, objects=(tight, *bollards))
    from urbanverse_mjx.assets import load_hulls

    assert exchange.exchanged(layout, "France", index, load_hulls).objects[1:] == tuple(bollards)


def test_a_house_in_the_air_is_left_out_and_named() -> None:
    low = placed("cafe_0", "cafe", 0, (10.0, 9.0, 0.1))
    high = dataclasses.replace(placed("cafe_1", "cafe", 0, (40.0, 9.0, 0.1)), position=(40.0, 9.0, 9.0))
    made = in_city("Havana", "Cuba", low, high)
    assert [p.id for p in made.layout.objects] == ["cafe_0"]
    assert [(x.id, x.reason) for x in made.left_out] == [("cafe_1", exchange.IN_THE_AIR)]
    assert len(in_city("Havana", "Cuba", low, high, exchanging=False).layout.objects) == 2


def test_rows_name_variants_that_exist() -> None:
    known = {(r.recipe, r.params["variant"]) for r in INDEX.records}
    for row in table(exchange.__file__)["rows"]:
        assert {(row["recipe"], k) for k in (*row["variants"], row["instead"])} <= known
        assert ("native" in row) != ("foreign" in row)


def test_only_sets_with_a_version_of_their_own_ask_for_it() -> None:
    """Scenes of UrbanVerse-160 keep their hashes."""
    assert {name for name, s in library.sets().items() if s.exchange} == {
        "autobench_v2",
        "craftbench_v2",
        "validation_v2",
    }
