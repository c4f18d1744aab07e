"""`materialisation.json`: for every node the chosen asset and its fit, and the nodes left out with the reason."""

import dataclasses
from collections.abc import Sequence
from typing import Any

from ...datatypes import SceneGraph
from ...materialisation import Cousin


def record_of(graph: SceneGraph, cousins: Sequence[Cousin]) -> dict[str, Any]:
    """The record of one graph's cousins, as JSON."""
    first = cousins[0]
    return {
        "graph": {"id": graph.id, "objects": len(graph.objects), "regions": len(graph.ground)},
        "raised": list(first.raised),
        "ground": [dataclasses.asdict(piece) for piece in first.materials],
        "skies": [dataclasses.asdict(c.sky) for c in cousins],
        "matches": {obj.id: [_match(c, obj.id) for c in cousins] for obj in graph.objects},
        "cousins": [
            {
                "id": c.layout.id,
                "placed": len(c.layout.objects),
                "left_out": [dataclasses.asdict(gone) for gone in c.left_out],
                "moved": [list(m) for m in c.moved],
                "unresolved": [list(p) for p in c.unresolved],
            }
            for c in cousins
        ],
    }


def _match(cousin: Cousin, name: str) -> dict[str, Any] | None:
    candidate = cousin.chosen.get(name)
    if candidate is None:
        return None
    match = candidate.match
    appearance = None if match.appearance_distance is None else round(match.appearance_distance, 4)
    return {"uid": match.uid, "leaf": match.leaf, "distortion": round(match.distortion, 4), "look": appearance}
