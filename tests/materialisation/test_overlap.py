"""No two objects in one place, and the moves that see to it."""

import dataclasses
import math

import pytest
import shapely
from shapely import affinity

from urbanverse_mjx.datatypes import GroundRegion, PlacedObject
from urbanverse_mjx.materialisation import overlap

from .fake_index import box_hulls, fake_index

PAVEMENT = GroundRegion("pavement", "sidewalk", ((-30, 0), (30, 0), (30, 8), (-30, 8)), (0.0, 0.0, 0.15))
ROAD = GroundRegion("road", "road", ((-30, -8), (30, -8), (30, 0), (-30, 0)), (0.0, 0.0, 0.0))


@dataclasses.dataclass(frozen=True)
class Resolved:
    """Moved objects and distances (id, m), and the pairs of ids that still overlap."""

    moved: tuple[tuple[str, float], ...]
    unresolved: tuple[tuple[str, str], ...]


def at(name: str, label: str, x: float, y: float, yaw: float = 0.0, foot: float = 0.15) -> PlacedObject:
    """The first asset of a leaf, at its own size."""
    asset = fake_index().by_leaf(label)[0]
    return PlacedObject(
        name, label, label, asset.uid, (x, y, foot), yaw, (1.0, 1.0, 1.0), asset.mass, 0.6, asset.movable
    )  # fmt: skip


def run(*objects: PlacedObject) -> tuple[Resolved, dict[str, PlacedObject]]:
    """Ends penetrations; returns the changes and the final positions."""
    records = [fake_index().get(placed.asset_uid) for placed in objects]
    bodies = [
        overlap.Body(placed, record, overlap.prisms_of(placed, box_hulls(record)))
        for placed, record in zip(objects, records, strict=True)
    ]
    support = overlap.Support([(shapely.Polygon(r.polygon), r.kind, r.plane) for r in (PAVEMENT, ROAD)])
    pairs = overlap.resolve(bodies, support)
    done = Resolved(
        tuple((b.placed.id, b.distance) for b in bodies if b.distance),
        tuple((bodies[i].placed.id, bodies[j].placed.id) for i, j in pairs),
    )
    return done, {b.placed.id: overlap.moved(b) for b in bodies}


def rectangle(placed) -> tuple[shapely.Polygon, float, float]:
    """Footprint and heights of a placed box, computed without the code under test."""
    x, y, z = (e * s for e, s in zip(fake_index().get(placed.asset_uid).extent_xyz, placed.scale, strict=True))
    flat = affinity.rotate(shapely.box(-x / 2, -y / 2, x / 2, y / 2), placed.yaw, origin=(0, 0), use_radians=True)
    px, py, pz = placed.position
    return affinity.translate(flat, px, py), pz, pz + z


def shared_area(a, b) -> float:
    (pa, la, ha), (pb, lb, hb) = rectangle(a), rectangle(b)
    return pa.intersection(pb).area if min(ha, hb) - max(la, lb) > 0.011 else 0.0


def test_the_light_movable_object_gives_way_and_the_house_never():
    done, placed = run(
        at("house", "bakery", 0, 5.0, math.pi / 2),
        at("cone", "traffic cone", 3.9, 4.0),
    )
    assert placed["house"].position[:2] == (0.0, 5.0)
    assert [name for name, _ in done.moved] == ["cone"]
    assert not done.unresolved
    assert shared_area(placed["house"], placed["cone"]) < 0.01 * 0.36 + 1e-9
    assert math.dist(placed["cone"].position[:2], (3.9, 4.0)) <= 0.5 + 1e-6


def test_the_least_move_that_is_free_is_taken():
    done, _ = run(at("bin", "trash bin", 0, 4), at("bag", "garbage bag", 0.47, 4))
    # 11.5 cm deep, of which 1 cm may stay: three steps of 5 cm straight away from the bin
    assert done.moved == (("bag", 0.15),)


def test_what_half_a_metre_cannot_part_is_reported_and_left():
    done, placed = run(
        at("one", "bakery", 0, 5.0, math.pi / 2),
        at("two", "bank", 2.0, 5.0, math.pi / 2),
    )
    assert done.unresolved == (("one", "two"),)
    assert not done.moved
    assert placed["two"].position[:2] == (2.0, 5.0)


def test_objects_at_different_heights_may_share_a_plan():
    done, _ = run(
        at("car", "sedan", 0, -3, foot=0.0),
        at("sign", "directional sign", 0, -3, foot=2.0),
    )
    assert not done.moved
    assert not done.unresolved


def test_no_move_takes_an_object_over_the_kerb():
    done, placed = run(at("booth", "telephone booth", 0.0, 1.0), at("bag", "garbage bag", 0.0, 0.42))
    assert placed["bag"].position[1] > 0.0
    assert not done.unresolved
    assert placed["bag"].position[2] == pytest.approx(0.15)


def test_a_crowd_is_sorted_out_without_a_new_penetration():
    """Twenty boxes thrown onto three metres: an independent count finds no pair that the report does not name."""
    crowd = [at(f"box_{i:02d}", "storage box", 0.31 * (i % 10), 3.0 + 0.45 * (i // 10), 0.4 * i) for i in range(20)]
    done, placed = run(*crowd)
    assert len(done.moved) >= 5
    assert done.unresolved
    ids = sorted(placed)
    found = {
        (a, b)
        for i, a in enumerate(ids)
        for b in ids[i + 1 :]
        if not rectangle(placed[a])[0]
        .intersection(rectangle(placed[b])[0])
        .buffer(-overlap.PENETRATION_TOLERANCE / 2)
        .is_empty
    }
    assert found == {tuple(sorted(pair)) for pair in done.unresolved}
    assert all(0.0 < metres <= 0.5 + 1e-3 for _, metres in done.moved)
