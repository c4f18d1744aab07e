"""`metadata.json` of a compiled scene: its inputs, location and statistics."""

import dataclasses
import math
from typing import Any

import numpy as np

from .. import __version__, versions
from ..assets import AssetIndex
from ..datatypes import RobotSpec, SceneLayout, Source
from .exchange_routes import PlannedRoutes
from .geometry import SceneGeometry
from .planner import RobotSize
from .statistics import scene_statistics

SCHEMA = "urbanverse.compiled_scene/1"


def place_metadata(place: Source | None, routes: PlannedRoutes, geometry: SceneGeometry) -> dict[str, Any]:
    """Location and description of the scene."""
    return {
        "city": "none" if place is None else place.city,
        "country": "none" if place is None else place.country,
        "source": "" if place is None else place.video,
        "route_length_m": max((r.facts["length_m"] for r in routes.planned), default=0.0),
        "statistics": scene_statistics(geometry),
    }


def scene_metadata(
    layout: SceneLayout, index: AssetIndex, geometry: SceneGeometry, robot: RobotSpec, size: RobotSize
) -> dict[str, Any]:
    """Inputs and counts of the scene; `size`: size of the robot of its episodes."""
    table, m = geometry.episodes, geometry.map
    drawn = len(geometry.region_ids) - len(layout.ground)
    used = sorted({o.asset_uid for o in layout.objects})
    return {
        "schema": SCHEMA,
        "id": layout.id,
        "version": __version__,
        "code": versions.of("scenes"),
        "hashes": {"layout": layout.content_hash(), "graph": layout.graph_hash, **layout.hashes},
        "seed": layout.seed,
        "counts": {
            "objects": len(geometry.object_ids),
            "hulls": len(geometry.inst_hull),
            "prisms": len(geometry.prism_hull),
            "regions": len(layout.ground),
            **({"drawn": drawn} if drawn else {}),
            "episodes": len(table),
            "goals": len(np.unique(table.goal, axis=0)),
        },
        "map": {
            "x_min": float(m.origin[0]),
            "y_min": float(m.origin[1]),
            "y_max": float(m.origin[1] + m.kind.shape[1] * m.resolution),
            "res": m.resolution,
            "width": m.kind.shape[0],
            "height": m.kind.shape[1],
        },
        "episodes": {
            "line_free": float(table.line_free.mean()),
            "crosses_road": float(table.crosses_road.mean()),
            "mean_length_m": math.fsum(table.length) / len(table),
            "robot": robot.name,
            "robot_size": dataclasses.asdict(size),
        },
        "sky": layout.sky,
        "materials": sorted({g.material for g in layout.ground}),
        "assets": {uid: _credits(index, uid) for uid in used},
    }


def _credits(index: AssetIndex, uid: str) -> dict[str, str]:
    record = index.get(uid)
    return {"licence": record.licence, "provenance": record.provenance}
