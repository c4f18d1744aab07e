"""Façades of a region on a cousin: the same street, other houses."""

import dataclasses
import math

import numpy as np
import pytest

from urbanverse_mjx import materialisation
from urbanverse_mjx.assets import load_hulls, load_index
from urbanverse_mjx.assets.records import regional
from urbanverse_mjx.datatypes import (
    GraphObject,
    GroundRegion,
    PlacedGround,
    PlacedObject,
    SceneGraph,
    SceneLayout,
    Source,
    ValidationError,
)
from urbanverse_mjx.materialisation import Cousin, check_city, facades, localise, overlap, paints
from urbanverse_mjx.materialisation import regional as looks
from urbanverse_mjx.materialisation.facades import Block, block_of, dress
from urbanverse_mjx.pipeline.library import building
from urbanverse_mjx.scene import library

INDEX = load_index()
#: Variants of the recipe of trees.
LIME, POPLAR, PALM = 0, 2, 7


def graph(city: str, country: str) -> SceneGraph:
    square = ((0.0, -5.0), (60.0, -5.0), (60.0, 5.0), (0.0, 5.0))
    ground = GroundRegion(id="walk", kind="sidewalk", polygon=square, plane=(0.0, 0.0, 0.1))
    return SceneGraph(id="street", source=Source("hand", "CC0-1.0", city, country), objects=(), ground=(ground,))


def placed(name: str, leaf: str, at: tuple[float, float, float], yaw: float, number: int = 0) -> PlacedObject:
    record = INDEX.by_leaf(leaf)[number]
    return PlacedObject(
        id=name,
        label=leaf,
        category=leaf,
        asset_uid=record.uid,
        position=at,
        yaw=yaw,
        scale=(1.0, 1.0, 1.0),
        mass=record.mass,
        friction=record.friction_coefficient,
        movable=record.movable,
    )


OBJECTS = (
    placed("bakery_0", "bakery", (8.0, 8.5, 0.1), -math.pi / 2),
    placed("bench_0", "bench", (8.0, 3.0, 0.1), -math.pi / 2),
    placed("block_0", "apartment building", (22.0, 9.0, 0.1), -math.pi / 2, 1),
    placed("board_0", "banner", (8.0, 4.4, 4.0), 0.0),
    placed("church_0", "church", (45.0, 20.0, 0.1), -math.pi / 2),
    placed("flag_0", "banner", (40.0, -4.0, 4.0), 0.0),
    placed("house_0", "house", (34.0, 8.7, 0.1), -math.pi / 2),
)


def cousin(number: int = 0, objects: tuple[PlacedObject, ...] = OBJECTS) -> Cousin:
    layout = SceneLayout(
        id="street",
        graph_id="street",
        graph_hash="0",
        seed=0,
        cousin=number,
        objects=objects,
        ground=(PlacedGround(id="walk", kind="sidewalk", polygon=graph("x", "y").ground[0].polygon,
                             plane=(0.0, 0.0, 0.1), material="concrete"),),
        sky="clear",
        sky_yaw=0.0,
        hashes={"assets": "a"},
    )  # fmt: skip
    return Cousin(layout, (), (), (("bakery_0", "bench_0"),), {}, (), (), None)  # type: ignore[arg-type]


def dressed(city: str, country: str, number: int = 0) -> Cousin:
    return dress(cousin(number), graph(city, country), INDEX)


def by_id(made: Cousin) -> dict[str, PlacedObject]:
    return {p.id: p for p in made.layout.objects}


def world_front(p: PlacedObject, block: Block) -> tuple[np.ndarray, float]:
    """Middle of the foot of a house's front in the scene, and the front's width."""
    own = block.scaled(p.scale)
    turn = np.array([[math.cos(p.yaw), -math.sin(p.yaw)], [math.sin(p.yaw), math.cos(p.yaw)]])
    return np.array(p.position[:2]) + turn @ [own.front, own.middle], own.width


def test_the_new_front_stands_in_the_plane_of_the_old_one_and_is_as_wide() -> None:
    old, new = by_id(cousin()), by_id(dressed("Tokyo", "Japan"))
    for name in ("bakery_0", "block_0", "house_0"):
        before = world_front(old[name], block_of(load_hulls(INDEX.get(old[name].asset_uid))))
        record = regional.load_regional().get(new[name].asset_uid)
        after = world_front(new[name], Block(*record.params["block"]))
        assert after[0] == pytest.approx(before[0], abs=2e-3), name
        assert after[1] == pytest.approx(before[1], rel=1e-3), name
        # The walls, not what the record says of them: the largest hull in reach has its front there.
        block = block_of(load_hulls(record))
        assert world_front(new[name], block)[0] == pytest.approx(before[0], abs=0.06), name


def test_all_else_stays() -> None:
    made = dressed("Tokyo", "Japan")
    old, new = by_id(cousin()), by_id(made)
    assert new["bench_0"] == old["bench_0"]
    assert new["church_0"] == old["church_0"], "a leaf that no tradition replaces"
    assert new["flag_0"] == old["flag_0"], "it hangs on no house"
    for name in ("bakery_0", "block_0", "house_0"):
        a, b = old[name], new[name]
        assert (a.label, a.category, a.yaw, a.position[2]) == (b.label, b.category, b.yaw, b.position[2])
        assert not b.movable
    assert [(g.id, g.reason) for g in made.left_out] == [("board_0", facades.WITH_FACADE)]
    assert list(new) == sorted(new)
    assert made.layout.hashes == {"assets": "a", "facades": regional.regional_hash()}


def test_houses_are_of_the_citys_tradition_and_cousins_differ() -> None:
    for city, country, name in (
        ("Tokyo", "Japan", "tokyo"),
        ("Lagos", "Nigeria", "lagos"),
        ("Nice", "France", "paris"),
    ):
        made = by_id(dressed(city, country))
        houses = [made[key].asset_uid for key in ("bakery_0", "block_0", "house_0")]
        assert all(f"/regional-{name}/" in uid for uid in houses)
        assert len(set(houses)) == 3
    looks = {tuple(p.asset_uid for p in dressed("Tokyo", "Japan", k).layout.objects) for k in range(4)}
    assert len(looks) >= 3
    assert dressed("Tokyo", "Japan") == dressed("Tokyo", "Japan")


def test_a_row_of_homes_stays_one_where_labels_are_exact() -> None:
    """Labels of a distilled graph may be wrong, so there a shop may stand for a house that was used often."""
    homes = tuple(placed(f"house_{k:02d}", "house", (10.0 * k, 8.7, 0.1), -math.pi / 2) for k in range(14))
    by_hand = graph("Toronto", "Canada")
    distilled = dataclasses.replace(by_hand, source=dataclasses.replace(by_hand.source, video="synthetic film"))
    trades = [
        [regional.load_regional().get(p.asset_uid).params["trade"] for p in made.layout.objects]
        for made in (dress(cousin(objects=homes), g, INDEX) for g in (by_hand, distilled))
    ]
    assert set(trades[0]) == {""}
    assert "" in trades[1]
    assert set(trades[1]) != {""}


def test_a_street_of_no_known_city_is_not_touched() -> None:
    plain = cousin()
    assert dress(plain, graph("Testville", "nowhere"), INDEX) is plain
    with pytest.raises(ValidationError, match=r"found 'Testville' in 'nowhere', needed one of Algeria, Almaty"):
        check_city(graph("Testville", "nowhere"))
    check_city(graph("Osaka", "Japan"))


def test_where_the_catalogues_houses_are_at_home_they_stay_and_all_else_is_of_the_place() -> None:
    there = graph("London", "United Kingdom")
    check_city(there)
    car = placed("car_0", "sedan", (30.0, -4.0, 0.1), 0.0)
    plain = cousin(objects=tuple(sorted((*OBJECTS, car), key=lambda p: p.id)))
    made = localise(plain, there, INDEX)
    assert made.layout.place == ("London", "United Kingdom")
    assert [p.asset_uid for p in made.layout.objects] == [p.asset_uid for p in plain.layout.objects]
    assert by_id(made)["car_0"].paint
    assert made.left_out == ()


def test_a_set_with_the_regional_look_has_a_city_that_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without this check such a scene silently keeps the catalogue's look."""
    monkeypatch.setattr(building, "_makers", lambda scenes: {"street": lambda: graph("Testville", "nowhere")})
    plain = library.scene_set("autobench")
    assert building.graph_of(plain, "street").source.city == "Testville"
    with pytest.raises(ValidationError, match="found 'Testville' in 'nowhere'"):
        building.graph_of(dataclasses.replace(plain, regional=True), "street")


def test_closer_hulls_of_a_recessed_front_do_not_move_the_new_house() -> None:
    """The largest of the closer hulls of this shop is 1.1 m deeper than the largest of the first."""
    shop = next(r for r in INDEX.by_leaf("dry cleaning") if r.params["variant"] == 1)
    close, first = (block_of(load_hulls(shop, kind)) for kind in ("close", ""))
    assert close.depth > first.depth + 0.5
    old = dataclasses.replace(placed("shop_0", "dry cleaning", (20.0, 9.0, 0.1), -math.pi / 2), asset_uid=shop.uid)
    plain = cousin(objects=(old,))
    wanted = dataclasses.replace(plain, layout=dataclasses.replace(plain.layout, hulls="close"))
    made = [localise(c, graph("Tokyo", "Japan"), INDEX).layout.objects for c in (plain, wanted)]
    assert made[0][0].asset_uid != shop.uid
    assert made[0] == made[1]


def test_a_chair_that_a_new_house_penetrates_is_left_out_and_listed() -> None:
    inside = dataclasses.replace(placed("chair_0", "chair", (8.0, 8.0, 0.1), 0.0), movable=True)
    objects = tuple(sorted((*OBJECTS, inside), key=lambda p: p.id))
    made = dress(cousin(objects=objects), graph("Tokyo", "Japan"), INDEX)
    assert "chair_0" not in by_id(made)
    assert any(g.id == "chair_0" and "bakery_0" in g.reason for g in made.left_out)


def test_with_standing_what_a_new_house_penetrates_is_moved_to_the_nearest_free_place() -> None:
    """A vending machine on the step of a shop goes in front of it; one deep inside is left out, though not movable."""
    machine = placed("machine_0", "vending machine", (8.0, 3.0, 0.1), -math.pi / 2)
    front = by_id(dressed("Tokyo", "Japan"))["bakery_0"]
    record = regional.load_regional().get(front.asset_uid)
    house = overlap.Body(front, record, overlap.prisms_of(front, load_hulls(record)))
    step = min(y for y in np.arange(3.0, 9.0, 0.05) if overlap.penetration(house, body(_at(machine, y))) > 0.0)
    for y, stays in ((step + 0.1, True), (step + 1.5, False)):
        objects = tuple(sorted((*OBJECTS, _at(machine, y)), key=lambda p: p.id))
        inside = dress(cousin(objects=objects), graph("Tokyo", "Japan"), INDEX)
        made = dress(cousin(objects=objects), graph("Tokyo", "Japan"), INDEX, standing=True)
        assert ("machine_0", "bakery_0") in inside.unresolved
        assert not [pair for pair in made.unresolved if "machine_0" in pair]
        assert ("machine_0" in by_id(made)) is stays
        assert ("machine_0" in {g.id for g in made.left_out}) is not stays
        if stays:
            moved = by_id(made)["machine_0"]
            assert overlap.penetration(house, body(moved)) == 0.0
            assert 0.05 < y - moved.position[1] < 0.3


def test_with_standing_a_board_on_the_former_front_is_not_moved_into_the_air() -> None:
    """It hangs in the new house, and is left out as it is without."""
    board = dataclasses.replace(placed("board_1", "advertising board", (8.0, 5.0, 2.0), 0.0), movable=True)
    inside = next(
        _at(board, y)
        for y in np.arange(4.0, 8.0, 0.1)
        if "board_1" not in by_id(dress(cousin(objects=(*OBJECTS, _at(board, y))), graph("Tokyo", "Japan"), INDEX))
    )
    made = dress(cousin(objects=(*OBJECTS, inside)), graph("Tokyo", "Japan"), INDEX, standing=True)
    assert "board_1" not in by_id(made)


def test_with_standing_one_of_two_cars_in_one_place_is_left_out_and_a_tree_never() -> None:
    cars = tuple(dataclasses.replace(placed(f"car_{k}", "sedan", (12.0 + k, 0.0, 0.1), 0.0)) for k in range(2))
    tree_0, tree_1 = (placed(f"tree_{k}", "tree", (30.0 + k, 0.0, 0.1), 0.0) for k in range(2))
    street = graph("Tokyo", "Japan")
    nodes = tuple(
        GraphObject(c.id, c.label, c.position, (4.6, 1.8, 1.5), 0.0, score=0.9 - 0.1 * k) for k, c in enumerate(cars)
    )
    street = dataclasses.replace(street, objects=nodes)
    before = cousin(objects=(*OBJECTS, *cars, tree_0, tree_1))
    before = dataclasses.replace(before, unresolved=(("car_0", "car_1"), ("tree_0", "tree_1")))
    plain, parted = (localise(before, street, INDEX, standing=on) for on in (False, True))
    assert {"car_0", "car_1"} <= by_id(plain).keys()
    assert ("car_0", "car_1") in plain.unresolved
    assert by_id(plain).keys() - by_id(parted).keys() == {"car_1"}, "the less certain of the two"
    assert [g.id for g in parted.left_out if g.id.startswith("car")] == ["car_1"]
    assert not [pair for pair in parted.unresolved if "car_1" in pair]


def _at(placed: PlacedObject, y: float) -> PlacedObject:
    return dataclasses.replace(placed, position=(placed.position[0], round(float(y), 3), placed.position[2]))


def test_a_set_of_the_library_asks_for_the_regional_look_by_a_field(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(building, "graph_of", lambda scenes, layout: graph("Tokyo", "Japan"))
    monkeypatch.setattr(materialisation, "materialise_cousins", lambda *_, **__: [cousin()])
    monkeypatch.setattr(looks, "index_of", lambda layout: INDEX)
    plain = library.scene_set("autobench")
    made = [next(building.cousins_of(dataclasses.replace(plain, regional=on), "street")) for on in (False, True)]
    assert made[0].layout.objects == cousin().layout.objects
    assert made[0].layout.place is None
    assert [p.asset_uid for p in made[1].layout.objects] == [
        p.asset_uid for p in dressed("Tokyo", "Japan").layout.objects
    ]
    assert made[1].layout.place == ("Tokyo", "Japan")
    frozen = ("autobench", "craftbench", "validation", "procedural")
    assert not any(library.scene_set(name).regional for name in frozen)


def test_cars_have_the_published_shares_of_colours_and_no_others() -> None:
    """Axalta 2021 for Europe: grey 27, white 23, black 22, blue 11 %."""
    shades = paints.colours()
    car = dataclasses.replace(placed("car", "sedan", (0.0, 0.0, 0.0), 0.0))
    drawn = [
        paints.paint_of(dataclasses.replace(car, id=f"car_{k}"), "sedan", ("Paris", "France"), 0) for k in range(3000)
    ]
    assert all(len(paint) == 1 for paint in drawn)
    for name, share in (("grey", 0.27), ("white", 0.23), ("black", 0.22), ("blue", 0.11)):
        found = sum(paint[0] in shades[name] for paint in drawn) / len(drawn)
        assert found == pytest.approx(share, abs=0.03), name
    known = {shade for name in shades for shade in shades[name]}
    assert {paint[0] for paint in drawn} <= known


def test_vehicles_clothes_and_furniture_are_painted_and_matter_is_not() -> None:
    car = placed("car", "sedan", (0.0, 0.0, 0.0), 0.0)
    delhi = ("New Delhi", "India")
    assert paints.paint_of(car, "rickshaw", delhi) == ("#2e7d47", "#dcae1f")
    assert paints.paint_of(car, "taxi", ("Kyoto", "Japan")) == paints.paint_of(car, "taxi", ("Tokyo", "Japan"))
    assert len(paints.paint_of(car, "pedestrian adult", delhi)) == 2
    assert paints.paint_of(car, "chair", delhi) == ("own",)
    assert paints.paint_of(car, "fire hydrant", delhi) == ()
    assert paints.paint_of(car, "police officer", delhi) == ()


def test_trees_are_of_the_climate_and_the_season() -> None:
    palm = next(r for r in INDEX.by_leaf("tree") if r.params["variant"] == 7)
    lime = next(r for r in INDEX.by_leaf("tree") if r.params["variant"] == 0)
    stockholm, singapore = ("Stockholm", "Sweden"), ("Singapore", "Singapore")
    assert 7 not in paints.species(stockholm, "autumn_noon")
    assert {4, 6}.isdisjoint(paints.species(singapore, "summer_noon"))
    for season, variant in (("spring", 3), ("autumn", 5)):
        seasons = [
            s
            for s in ("winter", "spring", "summer", "autumn")
            if variant in paints.species(("Paris", "France"), f"{s}_noon")
        ]
        assert seasons == [season]
    tree = dataclasses.replace(placed("tree", "tree", (3.0, -2.0, 0.1), 0.0), asset_uid=palm.uid, scale=(1.1, 1.1, 1.1))
    allowed = paints.species(stockholm, "summer_noon")
    found = list(paints.replanted(tree, palm, allowed, lambda: INDEX.by_leaf("tree"), 0))
    assert {r.params["variant"] for _, r in found} <= allowed
    new, record = found[0]
    assert record.params["variant"] in allowed
    assert record.uid == new.asset_uid
    assert (new.position, new.yaw, new.category) == (tree.position, tree.yaw, tree.category)
    assert record.height * new.scale[2] == pytest.approx(palm.height * 1.1, rel=0.25)
    assert not list(paints.replanted(tree, lime, allowed, tuple, 0))


def test_a_kind_of_paint_that_the_code_does_not_know_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paints, "_KIND_OF", {"sedan": "boats"})
    with pytest.raises(ValidationError, match=r"leaf 'sedan': found 'boats', needed cars, vans"):
        paints.paint_of(placed("car", "sedan", (0.0, 0.0, 0.0), 0.0), "sedan", ("Paris", "France"))


def tree(name: str, variant: int, at: tuple[float, float, float]) -> PlacedObject:
    record = next(r for r in INDEX.by_leaf("tree") if r.params["variant"] == variant)
    return dataclasses.replace(placed(name, "tree", at, 0.3), asset_uid=record.uid)


def together(*more: PlacedObject) -> Cousin:
    objects = tuple(sorted((*OBJECTS, *more), key=lambda p: p.id))
    return dataclasses.replace(cousin(objects=objects), chosen=dict.fromkeys([p.id for p in objects]))


@pytest.fixture
def few_trees(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(looks, "trees_of", lambda: INDEX.by_leaf("tree"))


@pytest.mark.usefixtures("few_trees")
def test_the_look_of_a_city_changes_no_place_and_only_trees_and_houses() -> None:
    plain = together(
        tree("palm_0", PALM, (20.0, -14.0, 0.1)),
        tree("lime_0", LIME, (40.0, -14.0, 0.1)),
        placed("car_0", "sedan", (30.0, -4.0, 0.1), 0.0),
        placed("person_0", "pedestrian adult", (33.0, 2.0, 0.1), 0.0),
    )
    made = localise(plain, graph("Stockholm", "Sweden"), INDEX)
    before, after = by_id(dress(plain, graph("Stockholm", "Sweden"), INDEX)), by_id(made)
    assert after.keys() == before.keys()
    for name, there in after.items():
        if name != "palm_0":
            assert dataclasses.replace(there, paint=()) == before[name]
    old, new = before["palm_0"], after["palm_0"]
    assert INDEX.get(new.asset_uid).params["variant"] in paints.species(("Stockholm", "Sweden"), "clear")
    assert (new.position, new.yaw, new.label, new.category) == (old.position, old.yaw, old.label, old.category)
    assert made.chosen.keys() == plain.chosen.keys() - {"bakery_0", "block_0", "house_0", "palm_0"}
    shades = paints.colours()
    known = {shade for name in shades for shade in shades[name]}
    for name, number in (("car_0", 1), ("person_0", 2)):
        assert len(after[name].paint) == number
        assert known.issuperset(after[name].paint)
    assert after["lime_0"].paint == after["bakery_0"].paint == ()
    assert SceneLayout.from_json(made.layout.to_json()) == made.layout
    assert localise(cousin(), graph("Testville", "nowhere"), INDEX).layout == cousin().layout


@pytest.mark.usefixtures("few_trees")
@pytest.mark.parametrize(("gap", "variant"), [(4.0, LIME), (1.1, POPLAR), (0.8, PALM), (0.1, PALM)])
def test_a_new_tree_enters_nothing_that_the_one_before_did_not(gap: float, variant: int) -> None:
    """Nearest in height is the lime, with a crown of 3 m from 2 m up; the poplar's is half as wide, the palm's higher
    than the bus."""
    bus, palm = placed("bus_0", "bus", (20.0, 0.0, 0.1), 0.0), tree("palm_0", PALM, (20.0, -14.0, 0.1))
    aside = INDEX.get(bus.asset_uid).extent_xyz[1] / 2 + gap
    bus = dataclasses.replace(bus, position=(20.0, -14.0 - aside, 0.1))
    pair = ("bus_0", "palm_0")
    plain = dataclasses.replace(together(bus, palm), unresolved=(pair,))
    made = localise(plain, graph("Stockholm", "Sweden"), INDEX)
    new = by_id(made)["palm_0"]
    assert INDEX.get(new.asset_uid).params["variant"] == variant
    before, after, by_lime = (
        overlap.penetration(body(bus), body(p)) for p in (palm, new, tree("lime", LIME, palm.position))
    )
    assert after <= before
    assert (by_lime > 0.0) == (variant != LIME), "otherwise nothing is in its way"
    assert (before > 0.0) == (gap < 0.15)
    assert (pair in made.unresolved) == (variant == PALM), "the pair of a tree that is gone is not kept"
    assert ("palm_0" in made.chosen) == (variant == PALM)


def body(p: PlacedObject) -> overlap.Body:
    record = INDEX.get(p.asset_uid)
    return overlap.Body(p, record, overlap.prisms_of(p, load_hulls(record)))
