"""Hypothesis strategies of valid graphs and layouts, written down from the documented ranges alone."""

import math

from hypothesis import strategies as st

from urbanverse_mjx.datatypes import (
    GROUND_KINDS,
    GraphObject,
    GroundRegion,
    PlacedGround,
    PlacedObject,
    SceneGraph,
    SceneLayout,
    Source,
)
from urbanverse_mjx.datatypes.scene_layout import HULL_KINDS

words = st.text(
    st.characters(min_codepoint=32, max_codepoint=0x2FFF, exclude_categories=("Cs",)), min_size=1, max_size=20
)
names = st.text("abcdefghijklmnopqrstuvwxyzABCXYZ0123456789_-", min_size=1, max_size=20)
coordinates = st.floats(-1e5, 1e5, allow_nan=False)
points = st.tuples(coordinates, coordinates, coordinates)
sides = st.floats(1e-3, 1e4)
yaws = st.floats(-100.0, 100.0)
descriptors = st.none() | st.lists(st.integers(0, 255), min_size=1, max_size=64).map(tuple)
planes = st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-1e5, 1e5))


@st.composite
def rings(draw: st.DrawFn) -> tuple[tuple[float, float], ...]:
    """Corners on a circle in angular order: simple by construction; either sense of rotation."""
    n = draw(st.integers(3, 9))
    steps = draw(st.lists(st.floats(0.5, 1.0), min_size=n, max_size=n))
    radius = draw(st.floats(0.5, 50.0))
    x, y = draw(st.floats(-100, 100)), draw(st.floats(-100, 100))
    total, angle, ring = sum(steps), 0.0, []
    for step in steps:
        angle += math.tau * step / total
        ring.append((x + radius * math.cos(angle), y + radius * math.sin(angle)))
    return tuple(ring if draw(st.booleans()) else reversed(ring))


graph_objects = st.builds(
    GraphObject, id=words, label=words, center=points, size=st.tuples(sides, sides, sides), yaw=yaws,
    score=st.floats(0.0, 1.0), descriptor=descriptors,
)  # fmt: skip
regions = st.builds(
    GroundRegion,
    id=words,
    kind=st.sampled_from(GROUND_KINDS[1:]),
    polygon=rings(),
    plane=planes,
    descriptor=descriptors,
)
graphs = st.builds(
    SceneGraph,
    id=names,
    source=st.builds(Source, words, words, words, words),
    objects=st.lists(graph_objects, max_size=4, unique_by=lambda o: o.id).map(tuple),
    ground=st.lists(regions, min_size=1, max_size=3, unique_by=lambda r: r.id).map(tuple),
    sky_descriptor=descriptors,
    camera_path=st.lists(st.tuples(coordinates, coordinates, coordinates, yaws), max_size=3).map(tuple),
)

placed_objects = st.builds(
    PlacedObject, id=words, label=words, category=words, asset_uid=words, position=points, yaw=yaws,
    scale=st.tuples(*[st.floats(0.01, 100.0)] * 3), mass=st.floats(1e-3, 1e9), friction=st.floats(0.0, 5.0),
    movable=st.booleans(),
)  # fmt: skip
placed_ground = st.builds(
    PlacedGround, id=words, kind=st.sampled_from(GROUND_KINDS[1:]), polygon=rings(), plane=planes, material=words
)
layouts = st.builds(
    SceneLayout,
    id=names,
    graph_id=names,
    graph_hash=words,
    seed=st.integers(0, 2**63),
    cousin=st.integers(0, 1000),
    objects=st.lists(placed_objects, max_size=4, unique_by=lambda o: o.id).map(tuple),
    ground=st.lists(placed_ground, min_size=1, max_size=3, unique_by=lambda r: r.id).map(tuple),
    sky=words,
    sky_yaw=yaws,
    hashes=st.dictionaries(words, words, max_size=3),
    place=st.none() | st.tuples(words, words),
    hulls=st.sampled_from(HULL_KINDS),
)
