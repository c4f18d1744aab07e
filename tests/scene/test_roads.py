"""What is drawn on roads: on the right side, along the kerbs, flat on the ground, and seen but never touched."""

import dataclasses

import numpy as np
import pytest
import shapely

from urbanverse_mjx import settings
from urbanverse_mjx.assets import AssetIndex, load_index
from urbanverse_mjx.citygen.section import StreetSection, ground_regions
from urbanverse_mjx.datatypes import PlacedGround, PlacedObject, SceneGraph, SceneLayout
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.compiler import scene_geometry
from urbanverse_mjx.scene.geometry import EpisodeTable
from urbanverse_mjx.scene.ground import plane_height
from urbanverse_mjx.scene.metadata import scene_metadata
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.planner import RobotSize
from urbanverse_mjx.scene.roads import Drawn, Parked, RoadRules, crosswalk_materials, draw_roads, rules_of
from urbanverse_mjx.scene.roads.axis import Axis, axes
from urbanverse_mjx.scene.roads.markings import EDGE, GUTTER, Mark, find_roads, marks

WIDTH, LENGTH, CROSSWALK = 7.0, 100.0, 50.0
SECTION = StreetSection(LENGTH, WIDTH, 3.0, 3.0, (CROSSWALK,), start="junction", end="junction")


def ground(section: StreetSection = SECTION) -> list[PlacedGround]:
    material = {"road": "asphalt_old", "crosswalk": "zebra_new"}
    return [
        PlacedGround(r.id, r.kind, r.polygon, r.plane, material.get(r.kind, "slabs_grey"))
        for r in ground_regions(section)
    ]


def found(rules: RoadRules, parked: tuple[Parked, ...] = (), section: StreetSection = SECTION) -> list[Mark]:
    return marks(find_roads(ground(section)), rules, parked, np.random.default_rng(0))


def draw(regions: list[PlacedGround], place: tuple[str, str], seed: str = "a") -> list[Drawn]:
    return draw_roads(regions, crosswalk_materials(regions), (), rules_of(*place), seed)


def bounds(found: list[Mark], paint: str, kind: str) -> np.ndarray:
    """(n, 4) lowest x and y and highest x and y of the pieces of a paint."""
    pieces = [p for m in found if (m.paint, m.kind) == (paint, kind) for p in shapely.get_parts(m.shape)]
    return np.array([p.bounds for p in pieces if p.area > 1e-6])


def test_the_middle_of_a_straight_road_and_its_width() -> None:
    (axis,) = find_roads(ground()).axes
    assert axis.length == pytest.approx(LENGTH, abs=6.0)
    assert np.abs(axis.middle[:, 1]).max() < 0.02
    assert np.abs(axis.half - WIDTH / 2).max() < 0.05
    np.testing.assert_allclose(axis.project(np.array([[20.0, 1.5]]))[0, 1], 1.5, atol=0.02)


def test_the_middle_of_a_bend_follows_the_circle() -> None:
    turn, radius = np.radians(np.arange(0, 71)), 60.0
    circle = np.stack([np.sin(turn), -np.cos(turn)], -1)
    bend = shapely.Polygon(np.concatenate([circle * (radius - 4), circle[::-1] * (radius + 4)]))
    (axis,) = axes(bend)
    assert axis.length > 60.0
    assert np.abs(np.linalg.norm(axis.middle, axis=1) - radius).max() < 0.2
    strip = axis.strip(10.0, 40.0, 0.9, 1.1)  # the left is inside
    assert np.abs(np.linalg.norm(shapely.get_coordinates(strip), axis=1) - (radius - 1)).max() < 0.2


@pytest.mark.parametrize("step", [0.93, 1.0, 1.08])
def test_places_along_a_bend_are_found_again(step: float) -> None:
    """Stations that are not exactly 1 m apart, as after smoothing; to the error of a chord."""
    angle = np.arange(0.0, 1.4, step / 40.0)
    out = np.stack([np.cos(angle), np.sin(angle)], -1)
    flat = np.zeros(len(angle), bool)
    axis = Axis(40.0 * out, -out, np.full(len(angle), 4.0), flat, flat)
    rng = np.random.default_rng(0)
    s, d = rng.uniform(1.0, axis.length - 1.0, 50), rng.uniform(-4.0, 4.0, 50)
    found = axis.project(axis.points(s, d))
    np.testing.assert_allclose(found, np.stack([s, d], -1), atol=0.06)
    # By the circle itself: d is what lies nearer to its middle, s the share of the arc.
    place = np.stack([np.cos(0.7), np.sin(0.7)]) * 38.5
    np.testing.assert_allclose(axis.project(place[None])[0], [0.7 * 40.0 / step, 1.5], atol=0.03)


@pytest.mark.parametrize(("traffic", "side"), [("right", -1), ("left", 1)])
def test_stop_lines_lie_on_the_side_of_the_traffic(traffic: str, side: int) -> None:
    lines = bounds(found(RoadRules(traffic=traffic, stop=0.4)), "white", "road_marking")
    long = lines[(lines[:, 2] - lines[:, 0] < 0.5) & (lines[:, 3] - lines[:, 1] > 2.0)]
    eastward = long[(long[:, 2] < CROSSWALK - 2.0) & (long[:, 0] > CROSSWALK - 4.0)]
    westward = long[(long[:, 0] > CROSSWALK + 2.0) & (long[:, 2] < CROSSWALK + 4.0)]
    assert len(eastward) == len(westward) == 1
    # Whoever drives to the east and keeps to the right has the line at y < 0.
    assert np.sign(eastward[0, [1, 3]].mean()) == side
    assert np.sign(westward[0, [1, 3]].mean()) == -side


@pytest.mark.parametrize(("traffic", "side"), [("right", -1), ("left", 1)])
def test_teeth_fill_the_lane_before_a_crosswalk_and_point_at_who_comes(traffic: str, side: int) -> None:
    """Triangles of 0.5 m by 0.6 m every 0.75 m from the gutter to the middle of the road, 0.1 m away from each."""
    made = found(RoadRules(traffic=traffic, approach="teeth"))
    pieces = [p for m in made if m.kind == "road_marking" for p in shapely.get_parts(m.shape)]
    pieces = [p for p in pieces if abs(p.bounds[2] - p.bounds[0] - 0.6) < 1e-6]
    for sense in (1, -1):
        teeth = [p for p in pieces if (CROSSWALK - p.centroid.x) * sense > 0.0]
        rows = np.array(sorted((p.bounds for p in teeth), key=lambda row: row[1]))
        assert len(rows) == 4
        np.testing.assert_allclose(rows[:, 3] - rows[:, 1], 0.5, atol=1e-6)
        np.testing.assert_allclose(np.diff(rows[:, 1]), 0.75, atol=1e-6)
        low, high = (0.0, WIDTH / 2 - GUTTER) if side * sense > 0 else (-WIDTH / 2 + GUTTER, 0.0)
        assert low + 0.05 < rows[0, 1] < low + 0.25
        assert high - 0.4 < rows[-1, 3] < high - 0.1
        for tooth in teeth:
            corners = shapely.get_coordinates(tooth)
            tip = corners[(corners[:, 0] * sense).argmin()]
            assert tip[1] == pytest.approx(tooth.centroid.y, abs=1e-6), "its tip is away from the crosswalk"


def test_the_centre_line_is_broken_in_the_middle_of_the_road_and_ends_before_the_crosswalk() -> None:
    lines = bounds(found(RoadRules(centre="yellow", dash=2.0, gap=3.0)), "yellow", "road_marking")
    assert np.abs(lines[:, [1, 3]].mean(1)).max() < 0.03
    np.testing.assert_allclose(lines[:, 3] - lines[:, 1], 0.12, atol=0.01)
    assert not ((lines[:, 0] < CROSSWALK + 2.3) & (lines[:, 2] > CROSSWALK - 2.3)).any()
    lines = lines[np.argsort(lines[:, 0])]
    dashes = lines[(lines[:, 2] - lines[:, 0]) < 2.1]
    assert len(dashes) >= 2
    gaps = lines[1:, 0] - lines[:-1, 2]
    assert (gaps > 2.9).all()


@pytest.mark.parametrize("narrows", [False, True])
def test_edge_lines_keep_their_distance_from_the_kerbs_of_a_road_that_changes_its_width(narrows: bool) -> None:
    near, far = (4.5, 3.0) if narrows else (3.0, 4.5)
    corners = ((0.0, -near), (LENGTH, -far), (LENGTH, far), (0.0, near))
    roads = find_roads([PlacedGround("road", "road", corners, (0.0, 0.0, 0.0), "asphalt_old")])
    made = marks(roads, RoadRules(edge="white", centre="yellow", bay="none"), (), np.random.default_rng(0))
    lines = [m.shape for m in made if m.paint == "white" and m.shape.length > LENGTH]
    assert len(lines) == 2
    for line in lines:
        x, y = shapely.get_coordinates(shapely.segmentize(line, 1.0)).T
        assert np.ptp(x) > LENGTH - 12.0
        away = near + (far - near) * x / LENGTH - np.abs(y)
        assert np.abs(away - (GUTTER + 0.2)).max() < EDGE / 2 + 0.04


def test_bars_of_a_crosswalk_have_their_width_and_stay_inside() -> None:
    rules = rules_of("Tokyo", "Japan")
    made = found(rules)
    bars = bounds(made, "white", "crosswalk")
    np.testing.assert_allclose(bars[:, 3] - bars[:, 1], 0.45, atol=1e-6)
    np.testing.assert_allclose(np.diff(np.sort(bars[:, 1])), 0.9, atol=1e-6)
    assert len(bars) == 7
    assert bars[:, 0].min() > CROSSWALK - 2.0
    assert bars[:, 2].max() < CROSSWALK + 2.0
    assert {m.paint for m in found(rules_of("Almaty", "Kazakhstan")) if m.kind == "crosswalk"} == {"white", "yellow"}
    assert {m.paint for m in found(rules_of("Mexico City", "Mexico")) if m.kind == "crosswalk"} == {"yellow"}


def test_bays_hold_the_parked_vehicles() -> None:
    parked = tuple(Parked((x, 2.5), 0.0, 4.4) for x in (10.0, 16.0, 75.0))
    made = found(RoadRules(bay="box", bay_colour="blue"), parked)
    lines = bounds(made, "blue", "road_marking")
    assert lines[:, 1].min() > 1.2, "on their side alone"
    assert lines[:, 3].max() < WIDTH / 2
    across = np.sort(lines[lines[:, 2] - lines[:, 0] < 0.2][:, [0, 2]].mean(1))
    for vehicle in parked:
        x = vehicle.place[0]
        assert ((across > x - 3.2) & (across < x - 2.2)).any()
        assert ((across > x + 2.2) & (across < x + 3.2)).any()
        assert not ((across > x - 2.15) & (across < x + 2.15)).any(), "no line under a vehicle"


def test_nothing_lies_beside_the_road_and_rails_keep_their_gauge() -> None:
    for city, country in (("Toronto", "Canada"), ("Seoul", "South Korea"), ("Lagos", "Nigeria")):
        roads = find_roads(ground())
        near = roads.carriageway.buffer(0.01)
        for mark in found(rules_of(city, country)):
            assert mark.shape.difference(near).area < 0.02 * mark.shape.area, (city, mark.paint, mark.kind)
    rails = bounds(found(rules_of("Toronto", "Canada")), "steel", "road")
    middles = np.sort(rails[:, [1, 3]].mean(1))
    np.testing.assert_allclose(middles[1::2] - middles[::2], 1.435, atol=0.01)
    (axis,) = find_roads(ground()).axes
    np.testing.assert_allclose(rails[:, 2] - rails[:, 0], axis.length, atol=0.02, err_msg="from end to end")


@pytest.mark.extended
def test_what_is_drawn_lies_millimetres_above_the_ground() -> None:
    regions = ground()
    for drawn in draw(regions, ("Tokyo", "Japan")):
        world = drawn.mesh.vertices + drawn.position
        triangles = world[drawn.mesh.faces]
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        flat = np.abs(normal[:, 2]) > 0.9 * np.linalg.norm(normal, axis=1)
        for triangle in triangles[flat]:
            x, y, z = triangle.mean(0)
            under = [r for r in regions if shapely.Polygon(r.polygon).buffer(1e-3).contains(shapely.Point(x, y))]
            assert any(0.0005 < z - plane_height(r.plane, np.array([x, y])) < 0.008 for r in under), drawn.id
    assert {d.kind for d in draw(regions, ("Tokyo", "Japan"))} >= {"road_marking", "crosswalk"}


def layout(place: tuple[str, str] | None) -> tuple[SceneLayout, AssetIndex]:
    record = load_index().by_leaf("sedan")[0]
    car = PlacedObject("car", "sedan", "sedan", record.uid, (12.0, 2.5, 0.0), 0.0, (1.0, 1.0, 1.0), 900.0, 0.8, False)
    made = SceneLayout("street", "street", "0", 0, 0, (car,), tuple(ground()), "clear_noon", 0.0, {}, place)
    return made, AssetIndex([record])


def test_roads_are_seen_and_never_touched() -> None:
    plain, marked = (scene_geometry(*layout(place)) for place in (None, ("Osaka", "Japan")))
    for field in dataclasses.fields(plain):
        a, b = getattr(plain, field.name), getattr(marked, field.name)
        if field.name.startswith(("prism_", "inst_", "object_")) and isinstance(a, np.ndarray):
            np.testing.assert_array_equal(a, b)
    assert all((a == b).all() for a, b in zip(plain.hulls, marked.hulls, strict=True))
    for name in ("height", "kind", "clearance"):
        np.testing.assert_array_equal(getattr(plain.map, name), getattr(marked.map, name))
    extra = len(marked.region_ids) - len(plain.region_ids)
    assert 20 <= extra <= 150
    assert marked.region_ids[: len(plain.region_ids)] == plain.region_ids
    triangles = [sum(len(s.meshes[m].faces) for m in s.region_mesh) for s in (plain, marked)]
    assert triangles[1] - triangles[0] < 3_000
    models = [scene_spec(scene, visuals=True).compile() for scene in (plain, marked)]
    touched = [int(((m.geom_contype > 0) | (m.geom_conaffinity > 0)).sum()) for m in models]
    assert touched[0] == touched[1]
    assert models[1].ngeom - models[0].ngeom == extra
    for scene, place, drawn in ((plain, None, {}), (marked, ("Osaka", "Japan"), {"drawn": extra})):
        made, index = layout(place)
        one = dataclasses.replace(scene, episodes=three_episodes())
        counts = scene_metadata(made, index, one, make_coco(), RobotSize())["counts"]
        assert counts["regions"] == len(made.ground)
        assert {k: n for k, n in counts.items() if k == "drawn"} == drawn
        assert (counts["episodes"], counts["goals"], counts["objects"]) == (3, 2, 1)
        assert (counts["hulls"], counts["prisms"]) == (len(scene.inst_hull), len(scene.prism_hull))


def test_bays_are_drawn_around_the_parked_cars_of_a_layout() -> None:
    """Across the road half the length of a car and at most a metre before and behind it."""
    made, index = layout(("Rome", "Italy"))
    (car,) = made.objects
    cars = (
        dataclasses.replace(car, position=(20.0, 2.5, 0.0)),
        dataclasses.replace(car, id="longer", position=(34.0, 2.5, 0.0), yaw=np.pi, scale=(1.3, 1.0, 1.0)),
    )
    scene = scene_geometry(dataclasses.replace(made, objects=cars), index)
    rows = [i for i, name in enumerate(scene.region_ids) if name.startswith("drawn/blue/road_marking")]
    meshes = [scene.meshes[scene.region_mesh[i]] for i in rows]
    places = [scene.region_position[i] for i in rows]
    corners = np.concatenate([(m.vertices + p)[m.faces] for m, p in zip(meshes, places, strict=True)])
    across = corners[np.ptp(corners[..., 0], axis=1) < 0.2][..., 0].ravel()
    for placed in cars:
        half = index.get(placed.asset_uid).extent_xyz[0] * placed.scale[0] / 2
        for side in (-1, 1):
            line = across[(across - placed.position[0]) * side > 0]
            assert half < np.abs(line - placed.position[0]).min() < half + 1.0


def three_episodes() -> EpisodeTable:
    """Of which two have the same goal."""
    no, one = np.zeros(3, bool), np.ones(3)
    goal = np.array([[5.0, 2.0, 0.0], [5.0, 4.0, 0.0], [5.0, 2.0, 0.0]])
    return EpisodeTable(np.zeros((3, 4)), goal, np.zeros((3, 1, 3)), np.ones(3, np.int32), one, no, no, one)


def test_a_layout_without_a_place_has_the_json_and_the_image_of_before() -> None:
    made, index = layout(None)
    assert "place" not in made.to_json()
    assert SceneLayout.from_json(made.to_json()) == made
    there, _ = layout(("Osaka", "Japan"))
    assert SceneLayout.from_json(there.to_json()) == there
    assert there.content_hash() != made.content_hash()
    assert not any(name.startswith("drawn/") for name in scene_geometry(made, index).region_ids)


@pytest.mark.parametrize(
    "layout",
    [
        "Africa_SouthAfrica_CapeTown_walk_01",
        "Asia_Kazakhstan_Almaty_walk_01",
        "MiddleEast_UnitedArabEmirates_Dubai_drive_01",
        "Europe_France_Paris_walk_01",
    ],
)
def test_distilled_streets_have_one_road_from_end_to_end(layout: str) -> None:
    """Distilled ground has side streets, junctions at its ends and borders that are not quite straight."""
    graph = SceneGraph.load(settings.scene_root() / "urbanverse160" / layout / "graph.json.gz")
    regions = [PlacedGround(r.id, r.kind, r.polygon, r.plane, "asphalt_old") for r in graph.ground]
    (axis,) = find_roads(regions).axes
    assert axis.length > 190.0
    along = np.diff(axis.middle, axis=0)
    heading = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
    assert np.abs(heading[8:] - heading[:-8]).max() < 0.35, "no turn into the road at an end"
    drawn = draw(regions, (graph.source.city, graph.source.country), graph.id)
    assert sum(len(d.mesh.faces) for d in drawn) < 2_500


def test_a_street_without_a_road_has_nothing_to_draw() -> None:
    walk = [r for r in ground() if r.kind == "sidewalk"]
    assert draw(walk, ("Venice", "Italy")) == []
    assert rules_of("Atlantis", "nowhere") == RoadRules()
    # The side is that of the country, whether or not the table has a row for it.
    sides = {country: rules_of("", country).traffic for country in ("Japan", "Cyprus", "Malaysia", "France", "unknown")}
    assert sides == {"Japan": "left", "Cyprus": "left", "Malaysia": "left", "France": "right", "unknown": "right"}
