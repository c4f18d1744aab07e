"""An index of one record, a unit box, and layouts that put one scaled box where a graph has an object; streets
compiled with few episodes."""

import contextlib
import functools
from collections.abc import Iterator
from unittest import mock

import numpy as np

from urbanverse_mjx.assets import AssetIndex
from urbanverse_mjx.assets.appearances.ground_materials import material_ids
from urbanverse_mjx.assets.appearances.skies import sky_ids
from urbanverse_mjx.datatypes import (
    AssetMesh,
    AssetRecord,
    HullSet,
    PlacedGround,
    PlacedObject,
    SceneGraph,
    SceneLayout,
)
from urbanverse_mjx.scene import EpisodeRules, episodes
from urbanverse_mjx.scene.compiler import AssetSource
from urbanverse_mjx.scene.hulls import convex_part

UNIT_BOX = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)], np.float32)
RECORD = AssetRecord(
    uid="toy/box",
    category=("barrier", "bollard", "bollard"),
    description="a box",
    recipe="toy",
    params={},
    extent_xyz=(1.0, 1.0, 1.0),
    length=1.0,
    width=1.0,
    height=1.0,
    volume=1.0,
    mass=50.0,
    materials=("wood",),
    friction_coefficient=0.7,
    movable=True,
    required_force=100.0,
    licence="Apache-2.0",
    provenance="tests",
)


def toy_index() -> AssetIndex:
    return AssetIndex([RECORD])


def _mesh(record: AssetRecord) -> AssetMesh:
    part = convex_part(UNIT_BOX)
    vertices = part.corners[part.triangles].reshape(-1, 3)
    texture = np.full((4, 4, 3), (200, 120, 60), np.uint8)
    return AssetMesh(vertices, np.arange(len(vertices)).reshape(-1, 3), vertices[:, :2] + 0.5, texture)


TOY_SOURCE = AssetSource(mesh=_mesh, hulls=lambda record: HullSet((UNIT_BOX,)))


def toy_layout(graph: SceneGraph, seed: int = 0) -> SceneLayout:
    """A box of the right size for every object, the first material of every kind, the first sky."""
    objects = tuple(
        PlacedObject(
            id=o.id,
            label=o.label,
            category="bollard",
            asset_uid=RECORD.uid,
            position=(o.center[0], o.center[1], o.center[2] - o.size[2] / 2),
            yaw=o.yaw,
            scale=o.size,
            mass=50.0,
            friction=0.7,
            movable=True,
        )
        for o in graph.objects
    )
    ground = tuple(PlacedGround(g.id, g.kind, g.polygon, g.plane, material_ids(g.kind)[0]) for g in graph.ground)
    return SceneLayout(graph.id, graph.id, graph.content_hash(), seed, 0, objects, ground, sky_ids()[0], 0.3, {})


#: Episodes of a street whose episodes do not matter; its own 256 are tried and driven for seconds.
FEW = 24


@contextlib.contextmanager
def few_episodes() -> Iterator[None]:
    """Within, a street that is compiled without rules of its own gets `FEW` episodes towards six goals."""
    rules = functools.partial(EpisodeRules, rows=FEW, goals=6)
    with mock.patch.object(episodes, "MIN_ROWS", FEW), mock.patch.object(episodes, "EpisodeRules", rules):
        yield
