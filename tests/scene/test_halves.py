"""Half-length scenes: no object is lost or duplicated, and the ground has no gaps."""

import numpy as np
import pytest
import shapely

from tests.support.box_bank import street_regions
from tests.support.toy_assets import toy_layout
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, SceneLayout, Source
from urbanverse_mjx.scene.ground import check_regions
from urbanverse_mjx.scene.halves import half_layouts


def _layout(turn: float = 0.0) -> SceneLayout:
    """The toy street of 60 m by 16 m with a post every 2 m, turned about the origin."""
    c, s = np.cos(turn), np.sin(turn)

    def turned(x: float, y: float) -> tuple[float, float]:
        return float(c * x - s * y), float(s * x + c * y)

    regions = [type(r)(r.id, r.kind, tuple(turned(*p) for p in r.polygon), (0.0, 0.0, 0.1)) for r in street_regions()]
    posts = tuple(
        GraphObject(f"o{k}", "bollard", (*turned(2.0 * k + 1.0, 6.0), 0.5), (0.2, 0.2, 1.0), 0.0) for k in range(30)
    )
    return toy_layout(SceneGraph("toy", Source("hand", "x", "none", "none"), posts, tuple(regions)))


@pytest.mark.parametrize("turn", [0.0, 0.4, np.pi / 2])
def test_two_halves_make_the_whole(turn: float) -> None:
    layout = _layout(turn)
    halves = half_layouts(layout)
    assert [h.id for h in halves] == [f"{layout.id}_Half_01", f"{layout.id}_Half_02"]
    assert sorted(o.id for h in halves for o in h.objects) == sorted(o.id for o in layout.objects)
    assert [len(h.objects) for h in halves] == [15, 15]
    whole = shapely.union_all([shapely.Polygon(g.polygon) for g in layout.ground])
    parts = [shapely.union_all([shapely.Polygon(g.polygon) for g in h.ground]) for h in halves]
    assert parts[0].intersection(parts[1]).area < 0.1
    assert sum(p.area for p in parts) == pytest.approx(whole.area, rel=1e-3)
    for half, part in zip(halves, parts, strict=True):
        check_regions(half.ground)
        assert part.area == pytest.approx(whole.area / 2, rel=0.08)
        box = shapely.get_coordinates(shapely.minimum_rotated_rectangle(part))
        sides = np.linalg.norm(np.diff(box, axis=0), axis=1)[:2]
        assert sorted(sides) == pytest.approx([16.0, 30.0], abs=2.5)
        # A connected area stays connected: no gap where neighbours were cut.
        assert len(shapely.get_parts(part.buffer(0.003).buffer(-0.003))) == 1
        assert half.hashes["half_of"] == layout.content_hash()
