"""Compiles a `SceneLayout` to a `CompiledScene`: a folder that stock MuJoCo loads, with maps, routes and episodes."""

import dataclasses
import os
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..assets import AssetIndex, build_mesh, hull_loader, load_hulls
from ..assets.appearances.ground_friction import ground_friction
from ..assets.appearances.ground_materials import build_material
from ..assets.appearances.skies import build_sky
from ..assets.meshes import crowns, repaint, sheets
from ..assets.recipes.building.regional import boards
from ..datatypes import AssetMesh, AssetRecord, HullSet, PlacedGround, PlacedObject, SceneLayout, Source
from ..datatypes import validation as v
from ..geometry import rotations
from ..work_folder import MADE, recover, replacing_folder
from . import backdrop, ground, maps, roads
from .drive import Controller, drive_all, ground_model
from .episodes import EpisodeRules, build_episodes
from .exchange import exchange_map, save_map
from .exchange_routes import plan_all, save_annotations, save_planned
from .geometry import SHOWN_KINDS, EpisodeTable, SceneGeometry
from .metadata import SCHEMA, place_metadata, scene_metadata
from .mjcf import scene_mjcf
from .planner import RobotSize, free_space
from .resting import RestingScene, resting
from .routes import RoutePlanner
from .stability import displacements

#: Sliding friction of every ground (URBAN-SIM's ground: 1.0 static and dynamic, docs/sources/reference_systems.md b.5).
GROUND_FRICTION = 1.0


@dataclasses.dataclass(frozen=True)
class CompiledScene:
    """A scene folder and its contents.

    Attributes:
      folder: `scene.xml`, `meshes/`, `textures/`, `episodes.npz`, `layout.json`, `metadata.json`, `geometry.npz`, and
        in the files of CraftBench-Nav `map.json`, `layers.npz`, `annotations.json`, `routes.json`, `routes.txt` and
        the waypoints `<route>.npy` of its delivery robot.
      layout, geometry: the inputs of the compilation.
      metadata: the content of `metadata.json`.
    """

    folder: pathlib.Path
    layout: SceneLayout
    geometry: SceneGeometry
    metadata: dict[str, Any]

    @staticmethod
    def load(folder: str | os.PathLike[str]) -> "CompiledScene":
        """Reads a folder that `compile_scene` wrote, or had moved aside when it was killed.

        Raises:
          ValidationError: the folder is not a compiled scene.
        """
        folder = pathlib.Path(folder)
        recover(folder)
        metadata = v.read_json(folder / "metadata.json", "compiled scene's metadata")
        v.choice(metadata.get("schema") if isinstance(metadata, dict) else None, f"{folder}: schema", (SCHEMA,))
        layout = SceneLayout.load(folder / "layout.json")
        geometry = SceneGeometry.load(folder / "geometry.npz")
        material = {region.id: region.material for region in layout.ground}
        carrying = [ground_friction(material[geometry.region_ids[region]]) for region in geometry.prism_region]
        geometry = dataclasses.replace(geometry, prism_material_friction=np.array(carrying))
        return CompiledScene(folder, layout, geometry, metadata)


@dataclasses.dataclass(frozen=True)
class AssetSource:
    """Builds a record's visual mesh and collision hulls, both in the asset frame at scale 1."""

    mesh: Callable[[AssetRecord], AssetMesh] = build_mesh
    hulls: Callable[[AssetRecord], HullSet] = load_hulls


def compile_scene(
    layout: SceneLayout,
    index: AssetIndex,
    out_dir: str | os.PathLike[str],
    controller: Controller,
    size: RobotSize | None = None,
    rules: EpisodeRules | None = None,
    source: AssetSource | None = None,
    freeze_unstable: bool = False,
    place: Source | None = None,
    movable: bool = False,
) -> CompiledScene:
    """Compiles a layout and writes its folder atomically.

    Args:
      controller: robot and controller that drive every episode once over the ground.
      size: size of the robot for route planning.
      rules: rules of the episode table.
      source: source of the meshes and hulls of records; default: the packaged recipes, and the hulls that the layout
        asks for.
      freeze_unstable: whether objects that do not keep their place for two seconds at rest (`stability.displacements`:
        a bicycle without its stand) become fixed in the compiled scene and in the folder's `layout.json`.
      place: city and country for `metadata.json`, the `source` of the layout's graph.
      movable: whether movable objects are free bodies in `scene.xml` (see `resting.resting`); otherwise all objects are
        fixed. The other files do not depend on it.

    Raises:
      ValidationError: ground overlaps, there is no room for episodes, an asset is unknown, or the output folder holds
        other files.
    """
    out_dir = pathlib.Path(out_dir)
    check_out_dir(out_dir)
    robot = controller.robot
    size = size or RobotSize(height=robot.planner_height)
    geometry = scene_geometry(layout, index, source)
    before = int(geometry.object_movable.sum())
    if freeze_unstable:
        geometry, layout = _with_unstable_frozen(geometry, layout)
    unstable = before - int(geometry.object_movable.sum())
    space = free_space(geometry.map, size)
    model = ground_model(geometry, robot)

    def drive(starts: np.ndarray, paths: Sequence[np.ndarray]) -> Any:
        return drive_all(model, controller, space, starts, paths)

    geometry = dataclasses.replace(geometry, episodes=build_episodes(space, size, layout.seed, drive, rules))
    exchanged = exchange_map(geometry)
    planner = RoutePlanner(geometry.map)
    wanted = planner.choose(layout.seed)
    routes = plan_all(planner, layout.id, exchanged.grid, wanted)
    metadata = scene_metadata(layout, index, geometry, robot, size) | place_metadata(place, routes, geometry)
    bodies = resting(geometry) if movable else None
    metadata["bodies"] = _body_counts(geometry, unstable, bodies)
    with replacing_folder(out_dir) as folder:
        _write(folder, layout, geometry, metadata, bodies)
        save_map(folder, exchanged)
        save_annotations(folder / "annotations.json", layout.id, wanted)
        save_planned(folder, routes)
    return CompiledScene(out_dir, layout, geometry, metadata)


def check_out_dir(out_dir: pathlib.Path) -> None:
    """Raises an error if the output folder holds files but no compiled scene; those beside a scene's are kept.

    Raises:
      ValidationError: the folder has other contents, which the message names.
    """
    compiled = (out_dir / "metadata.json").is_file() and (out_dir / "geometry.npz").is_file()
    if out_dir.is_dir() and not (compiled or (out_dir / MADE).is_file()):
        if any(out_dir.iterdir()):
            raise v.fail(str(out_dir), "a folder with other files", "a new name or a compiled scene", "choose another")
    elif out_dir.exists() and not out_dir.is_dir():
        raise v.fail(str(out_dir), "a file", "the name of a folder", "choose another")


def scene_geometry(layout: SceneLayout, index: AssetIndex, source: AssetSource | None = None) -> SceneGeometry:
    """Converts the contents of the layout to arrays; the episode table is empty.

    Raises:
      ValidationError: ground regions overlap, or an asset, material or sky is unknown.
    """
    ground.check_regions(layout.ground)
    objects = sorted(layout.objects, key=lambda o: (o.position[0], o.position[1], o.id))
    regions = sorted(layout.ground, key=lambda r: (min(p[0] for p in r.polygon), r.id))
    library = _Assets(index, source or AssetSource(hulls=hull_loader(layout.hulls)), layout.place)
    kinds = [library.add(o) for o in objects]
    prisms = ground.ground_prisms(regions)
    crossings = {} if layout.place is None else roads.crosswalk_materials(regions)
    position = np.array([o.position for o in objects], np.float64).reshape(-1, 3)
    quaternion = rotations.from_yaw(np.array([o.yaw for o in objects], np.float64))
    counts = [len(library.hull_rows[k]) for k in kinds]
    inst_object = np.repeat(np.arange(len(objects)), counts).astype(np.int32)
    inst_hull = np.array([h for k in kinds for h in library.hull_rows[k]], np.int32)
    hulls = (*library.hulls, *(p.corners for p in prisms))
    drawn = _drawn_roads(layout, regions, crossings, index)
    if layout.place is not None and drawn is not None:
        houses = [h for o, k in zip(objects, kinds, strict=True) if (h := library.house(o, k)) is not None]
        drawn += backdrop.openings(houses, layout.id) + backdrop.surround(regions, houses, layout.place, layout.id)
    scene_map = maps.with_clearance(
        maps.ground_map(regions),
        [hulls[h] for h in inst_hull],
        rotations.matrix(quaternion)[inst_object],
        position[inst_object],
    )
    return SceneGeometry(
        scene_id=layout.id,
        object_ids=tuple(o.id for o in objects),
        object_categories=tuple(o.category for o in objects),
        object_position=position,
        object_quaternion=quaternion,
        object_mesh=np.array(kinds, np.int32),
        object_mass=np.array([o.mass for o in objects]),
        object_friction=np.array([o.friction for o in objects]),
        object_movable=np.array([o.movable for o in objects], bool),
        hulls=hulls,
        inst_hull=inst_hull,
        inst_object=inst_object,
        prism_hull=len(library.hulls) + np.arange(len(prisms), dtype=np.int32),
        prism_position=np.stack([p.position for p in prisms]),
        prism_kind=np.array([ground.kind_index(regions[p.region]) for p in prisms], np.int32),
        prism_friction=np.full(len(prisms), GROUND_FRICTION),
        prism_region=np.array([p.region for p in prisms], np.int32),
        prism_material_friction=np.array([ground_friction(regions[p.region].material) for p in prisms]),
        **_region_fields(regions, crossings, library.meshes, drawn),
        sky=layout.sky,
        sky_yaw=layout.sky_yaw,
        map=scene_map,
        episodes=_no_episodes(),
    )


def _with_unstable_frozen(geometry: SceneGeometry, layout: SceneLayout) -> tuple[SceneGeometry, SceneLayout]:
    """Fixes unstable movable objects, and repeats this until all others stay at rest, because fixing one object may
    remove the support of another."""
    while moves := displacements(geometry):
        names = {m.id for m in moves}
        falls = np.array([name in names for name in geometry.object_ids])
        geometry = dataclasses.replace(geometry, object_movable=geometry.object_movable & ~falls)
        objects = tuple(dataclasses.replace(o, movable=False) if o.id in names else o for o in layout.objects)
        layout = dataclasses.replace(layout, objects=objects)
    return geometry, layout


def _drawn_roads(
    layout: SceneLayout, regions: Sequence[PlacedGround], crossings: Mapping[str, str], index: AssetIndex
) -> list[roads.Drawn] | None:
    """What lies on the roads of the layout's place; None without a place."""
    if layout.place is None:
        return None
    parked = []
    for placed in layout.objects:
        record = index.get(placed.asset_uid)
        if record.category[0] == "vehicle":
            parked.append(roads.Parked(placed.position[:2], placed.yaw, record.extent_xyz[0] * placed.scale[0]))
    return roads.draw_roads(regions, crossings, parked, roads.rules_of(*layout.place), layout.id)


def _region_fields(
    regions: Sequence[PlacedGround],
    crossings: Mapping[str, str],
    meshes: list[AssetMesh],
    drawn: list[roads.Drawn] | None,
) -> dict[str, Any]:
    """The fields of the ground regions, followed by what is drawn on them, which has no prism."""
    visuals = []
    for region in regions:
        # Bars of a crosswalk are drawn on the road; the region's own material has them painted into its texture.
        plain = crossings.get(region.id)
        material = build_material(plain or region.material)
        turn = 0.0 if plain else ground.traffic_turn(region, regions)
        rough = material.roughness if drawn is None else max(material.roughness, roads.LEAST_ROUGHNESS)
        visuals.append(ground.region_mesh(region, material.texture, material.tile_size_m, rough, turn=turn))
    visuals += [(d.position, d.mesh) for d in drawn or ()]
    shown = [*regions, *(drawn or ())]
    return {
        "region_ids": tuple(r.id for r in shown),
        "region_kind": np.array([SHOWN_KINDS.index(r.kind) for r in shown], np.int32),
        "region_mesh": len(meshes) + np.arange(len(shown), dtype=np.int32),
        "region_position": np.stack([p for p, _ in visuals]),
        "meshes": (*meshes, *(m for _, m in visuals)),
    }


class _Assets:
    """Meshes and hulls of the distinct (asset, scale, paint) triples of a layout.

    Those of a place have the look of their region, and their boards its language.
    """

    def __init__(self, index: AssetIndex, source: AssetSource, place: tuple[str, str] | None) -> None:
        self._index, self._source, self._regional = index, source, place is not None
        self._language = "" if place is None else boards.language_of(place)
        self._rows: dict[tuple[Any, ...], int] = {}
        self.meshes: list[AssetMesh] = []
        self.hulls: list[np.ndarray] = []
        self.hull_rows: list[range] = []

    def add(self, placed: PlacedObject) -> int:
        """Adds a triple and returns the number of its mesh, which is also the row of `hull_rows`."""
        key = (placed.asset_uid, *placed.scale, placed.paint)
        if key not in self._rows:
            record = self._index.get(placed.asset_uid)
            scale = np.array(placed.scale, np.float32)
            with boards.in_language(self._language):
                mesh = self._source.mesh(repaint.untinted(record) if placed.paint else record)
            mesh = repaint.repainted(mesh, [color for color in placed.paint if color != repaint.OWN])
            if self._regional and record.category[:2] == ("nature", "vegetation"):
                mesh = crowns.with_sprays(mesh, record.uid)
            if self._regional and record.leaf in sheets.LETTERED:
                mesh = sheets.with_sides_apart(mesh)
            hulls = [h * scale for h in self._source.hulls(record).hulls]
            self._rows[key] = len(self.meshes)
            self.hull_rows.append(range(len(self.hulls), len(self.hulls) + len(hulls)))
            self.hulls += hulls
            self.meshes.append(dataclasses.replace(mesh, vertices=mesh.vertices * scale))
        return self._rows[key]

    def house(self, placed: PlacedObject, row: int) -> backdrop.House | None:
        """What an added object is for the background if it is a house, otherwise None."""
        record = self._index.get(placed.asset_uid)
        if record.category[0] != "building" or record.extent_xyz[1] * placed.scale[1] < backdrop.LEAST_WIDTH:
            return None
        corners = np.concatenate([self.hulls[k] for k in self.hull_rows[row]]).astype(np.float64)
        flat = corners[:, :2] @ rotations.about_z(placed.yaw)[:2, :2].T + np.array(placed.position[:2])
        return backdrop.house(placed, record, self.meshes[row], flat)


def _no_episodes() -> EpisodeTable:
    no = np.zeros(0)
    return EpisodeTable(np.zeros((0, 4)), np.zeros((0, 3)), np.zeros((0, 1, 3)), no, no, no, no, no)


def _body_counts(geometry: SceneGeometry, unstable: int, bodies: RestingScene | None) -> dict[str, int]:
    """Free and fixed movable objects of `scene.xml`; `unstable`: objects that were frozen before."""
    movable, more = int(geometry.object_movable.sum()), 0 if bodies is None else len(bodies.unstable)
    free = 0 if bodies is None else movable - more
    laid = 0 if bodies is None else len(bodies.laid)
    return {
        "free": free,
        "laid": laid,
        "movable_fixed": movable - more - free,
        "unstable_fixed": unstable + more,
    }


def _comment(counts: dict[str, int], objects: int) -> str:
    """Text for the file's comment about its bodies."""
    left = f"{counts['unstable_fixed']} do not stay in place by themselves and are fixed"
    if counts["free"]:
        laid = f"{counts['laid']} of them laid where they come to rest"
        return f"{counts['free']} of {objects} objects are free bodies ({laid}); {left}, as the others are."
    return (
        f"All {objects} objects are fixed, {counts['movable_fixed']} of them movable; {left}. "
        "The option 'movable' of 'urbanverse scene compile' makes movable objects free bodies."
    )


def _write(
    folder: pathlib.Path,
    layout: SceneLayout,
    geometry: SceneGeometry,
    metadata: dict[str, Any],
    bodies: RestingScene | None,
) -> None:
    drawn = geometry if bodies is None else bodies.geometry
    comment = _comment(metadata["bodies"], len(geometry.object_ids))
    text, files = scene_mjcf(drawn, build_sky(layout.sky), free=bodies is not None, comment=comment)
    for path, body in {"scene.xml": text.encode("utf-8"), **files}.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(body)
    table = geometry.episodes
    np.savez_compressed(folder / "episodes.npz", allow_pickle=False, **vars(table))
    geometry.save(folder / "geometry.npz")
    layout.save(folder / "layout.json")
    v.write_json(folder / "metadata.json", metadata)
