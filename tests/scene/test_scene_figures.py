"""Figures of whole drawn streets, of terrain and of compiled geometry: see `tests.support.figures`.

Meshes are compared by their area and its first moments, which do not depend on how polygons are cut into triangles.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pytest

from tests.scene.test_backdrop import row
from tests.support import figures
from tests.support.box_bank import box_skies, street_regions
from tests.support.toy_assets import TOY_SOURCE, few_episodes, toy_index, toy_layout
from urbanverse_mjx.assets.recipes.building.regional.styles import traditions
from urbanverse_mjx.citygen.section import StreetSection, ground_regions
from urbanverse_mjx.datatypes import GraphObject, PlacedGround, SceneBank, SceneGraph, Source
from urbanverse_mjx.scene import statistics, terrain
from urbanverse_mjx.scene.backdrop import openings, surround
from urbanverse_mjx.scene.bank import ground_category
from urbanverse_mjx.scene.compiler import scene_geometry
from urbanverse_mjx.scene.drive import Drive
from urbanverse_mjx.scene.episodes import EpisodeRules, build_episodes
from urbanverse_mjx.scene.geometry import SHOWN_KINDS
from urbanverse_mjx.scene.halves import half_layouts
from urbanverse_mjx.scene.mjcf import scene_mjcf
from urbanverse_mjx.scene.planner import GoalField, RobotSize, free_space, path_length
from urbanverse_mjx.scene.roads import Drawn, Parked, crosswalk_materials, draw_roads, images, rules_of
from urbanverse_mjx.scene.routes import RoutePlanner

PLACES = [("Tokyo", "Japan"), ("London", "United Kingdom"), ("Melbourne", "Australia"), ("Bangkok", "Thailand")]


def ground(section: StreetSection, turn: float, material: str = "asphalt_old") -> list[PlacedGround]:
    """A street turned about the origin and moved, so that no axis is special."""
    names = {"road": material, "crosswalk": "zebra_new"}
    found = []
    c, s = math.cos(turn), math.sin(turn)
    for r in ground_regions(section):
        polygon = tuple((c * x - s * y + 3.0, s * x + c * y - 2.0) for x, y in r.polygon)
        a, b, z = r.plane
        slope = (c * a - s * b, s * a + c * b)
        plane = (*slope, z - 3.0 * slope[0] + 2.0 * slope[1])
        found.append(PlacedGround(r.id, r.kind, polygon, plane, names.get(r.kind, "slabs_grey")))
    return found


def moments(drawn: Iterable[Drawn]) -> dict[str, Any]:
    """Of each group of meshes: how many, m² of their triangles, and means over that area of places, of squares of
    places, of texture coordinates, and the textures."""
    groups: dict[str, list[Drawn]] = {}
    for piece in drawn:
        name = "/".join(word for word in piece.id.split("/") if not word.startswith("("))
        groups.setdefault(f"{piece.kind} {name}", []).append(piece)
    found = {}
    for name, pieces in sorted(groups.items()):
        corners = np.concatenate([(p.mesh.vertices + p.position)[p.mesh.faces] for p in pieces]).astype(np.float64)
        uv = np.concatenate([p.mesh.uv[p.mesh.faces] for p in pieces]).astype(np.float64)
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        share = (area / max(area.sum(), 1e-12))[:, None]
        middle, within = corners.mean(1), uv.mean(1)
        # The integral of the square over a triangle is that of the middles of its edges.
        halves = (corners + np.roll(corners, 1, 1)) / 2
        pixels = np.concatenate([p.mesh.texture[::4, ::4].reshape(-1, 3) for p in pieces[:2]])
        found[name] = {
            "pieces": len(pieces), "area": area.sum(), "place": (share * middle).sum(0),
            "square": (share[:, None] * halves**2).sum(0).mean(0), "uv": (share * within).sum(0),
            "look": [pieces[0].mesh.roughness, pixels.mean(), pixels.std(), *pixels[len(pixels) // 3]],
        }  # fmt: skip
    return found


@pytest.mark.parametrize("number", range(len(PLACES)))
def test_figures_of_streets_of_places(number: int) -> None:
    """Roads with a crosswalk, parked vehicles and corners; the rows and the fronts around them."""
    city, country = PLACES[number]
    width = (7.0, 9.5, 14.0, 6.0)[number]
    section = StreetSection(
        64.0, width, 3.0, 2.5, (27.0,), start="junction", end=("junction", "court")[number % 2], yards=number == 3
    )
    turn = (0.0, 0.4, 1.2, 2.0)[number]
    regions = ground(section, turn)
    c, s = math.cos(turn), math.sin(turn)
    parked = []
    for x, side in ((8.0, 1), (14.0, 1), (40.0, -1), (46.5, -1)):
        y = side * (width / 2 - 1.1)
        parked.append(Parked((c * x - s * y + 3.0, s * x + c * y - 2.0), turn + (0.0 if side < 0 else np.pi), 4.4))
    drawn = draw_roads(regions, crosswalk_materials(regions), parked, rules_of(city, country), f"street {number}")
    found = {"roads": moments(drawn)}
    if number in (1, 2):
        forms = [form for name in sorted(traditions())[number::3] for form in traditions()[name].forms]
        houses = [h for k, x in enumerate((10.0, 18.0, 29.0, 40.0)) for h in row([x], forms[k])]
        plain = ground(section, 0.0)
        found["ends"] = moments(openings(houses, "a"))
        found["around"] = moments(surround(plain, houses, (city, country), "a"))
    figures.check(f"scene/street_{number}", found)


def test_figures_of_images_on_roads() -> None:
    found = {name: images.paint_image(name) for name in images.LENGTHS}
    figures.check("scene/images", found)


def test_figures_of_terrain() -> None:
    levels = {kind: [terrain.terrain_regions(kind, level, 3) for level in (0, 4, 9)] for kind in terrain.KINDS}
    found: dict[str, Any] = {}
    for kind, several in levels.items():
        found[kind] = {
            "corners": [np.array(r.polygon) for regions in several for r in regions],
            "planes": [np.array(r.plane) for regions in several for r in regions],
        }
    scene = terrain.region_scene("kerbs", levels["kerbs"][1])
    figures.check("scene/terrain", found | {"scene": scene})


def toy_street() -> SceneGraph:
    rng, objects = np.random.default_rng(4), []
    for k in range(30):
        size = rng.uniform([0.2, 0.2, 0.4], [0.9, 0.7, 1.8])
        x, y = rng.uniform(1, 59), rng.choice([-1, 1]) * rng.uniform(3.2, 7.6)
        if abs(x - 30) > 3:
            z = (0.15 if abs(y) > 4.0 else 0.0) + size[2] / 2
            objects.append(GraphObject(f"o{k}", "bollard", (x, y, z), tuple(size), rng.uniform(-3, 3)))
    source = Source("hand", "Apache-2.0", "none", "none")
    return SceneGraph("toy_street", source, tuple(objects), tuple(street_regions()))


def test_figures_of_a_compiled_street() -> None:
    """Geometry, maps, its file for MuJoCo, statistics, free space, paths, routes and episodes over it, its halves."""
    layout = toy_layout(toy_street(), 3)
    geometry = scene_geometry(layout, toy_index(), TOY_SOURCE)
    size = RobotSize()
    space = free_space(geometry.map, size)
    field = GoalField(space, space.coarse_cell(np.array([50.0, 6.0])))
    starts = space.coarse_cell(np.array([[2.0, 6.5], [20.0, -6.5], [55.0, 6.0]]))
    paths = field.paths(starts[np.isfinite(field.cost[tuple(starts.T)])])
    planner = RoutePlanner(geometry.map)
    wanted = planner.choose(layout.seed)

    def driven(starts: np.ndarray, paths: Sequence[np.ndarray]) -> list[Drive]:
        """As if all paths but those of one direction could be driven at 1 m/s."""
        away = [path_length(path) for path in paths]
        return [Drive(s, "") if start[3] < 2.0 else Drive(-1.0, "stuck") for start, s in zip(starts, away, strict=True)]

    with few_episodes():
        table = build_episodes(space, size, 5, driven, EpisodeRules(rows=24, goals=6))
    text, files = scene_mjcf(geometry, box_skies()["clear"], free=True, comment="toy")
    figures.check(
        "scene/compiled",
        {
            "geometry": geometry, "space": space, "wanted": wanted, "field": field.cost, "paths": paths,
            "routes": planner.plan(wanted[::3]), "statistics": statistics.scene_statistics(geometry),
            "text": text, "files": sorted(files),
            "halves": half_layouts(layout),
            "episodes": table,
        },
    )  # fmt: skip


def test_figures_of_a_bank(small_bank: SceneBank) -> None:
    shown = [ground_category(kind) for kind in range(len(SHOWN_KINDS))]
    figures.check("scene/bank", {"bank": small_bank, "shown": shown})
