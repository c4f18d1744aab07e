"""Terrain to walk on: heights as promised, none kept for the test, the same ground in the bank and in C MuJoCo."""

import itertools

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.heights import UNIT, build_heights
from urbanverse_mjx.scene import terrain
from urbanverse_mjx.scene.mjcf import scene_spec


def _height(plane: tuple[float, ...], x: float) -> float:
    return plane[0] * x + plane[2]


def _edges(kind: str, level: int, seed: int = 0) -> np.ndarray:
    """(n,) m, steps between neighbouring strips."""
    regions = terrain.terrain_regions(kind, level, seed)
    ends = [max(p[0] for p in r.polygon) for r in regions]
    return np.array(
        [
            _height(b.plane, x) - _height(a.plane, x)
            for (a, b), x in zip(itertools.pairwise(regions), ends, strict=False)
        ]
    )


@pytest.mark.parametrize("kind", terrain.KINDS)
@pytest.mark.parametrize("level", [0, terrain.LEVELS - 1])
def test_scenes_are_full_squares(kind: str, level: int) -> None:
    area = sum(np.prod(np.ptp(np.array(r.polygon), axis=0)) for r in terrain.terrain_regions(kind, level))
    assert area == pytest.approx(terrain.SCENE_SIDE**2)


def test_the_only_path_leads_a_metre_ahead_on_the_ground() -> None:
    scene = terrain.region_scene("kerbs-3", terrain.terrain_regions("kerbs", 3))
    start = scene.episodes.start
    assert start.shape == (1, 4)
    np.testing.assert_allclose(scene.episodes.goal - start[:, :3], [[1.0, 0.0, 0.0]])
    i, j = scene.map.grid.cell(start[0, :2])
    assert start[0, 2] == scene.map.height[i, j]


def test_kerbs_grow_with_the_level_and_leave_the_tests_heights_out() -> None:
    steps = {level: np.abs(np.concatenate([_edges("kerbs", level, seed) for seed in range(6)])) for level in range(10)}
    for level, found in steps.items():
        high = 0.03 + (0.22 - 0.03) * level / 9
        assert len(found) > 40
        assert 0.7 * high - 1e-9 <= found.min() <= found.max() <= high + 1e-9
        assert np.abs(found[:, None] - np.array([0.05, 0.08, 0.10, 0.12, 0.15, 0.18, 0.20])).min() > 0.0029


def test_kerbs_lead_up_from_the_street_by_one_or_two_and_down_again() -> None:
    """Three of ten first kerbs are followed by a second one; nothing is lower than the street."""
    second = first = 0
    for seed in range(20):
        heights = [r.plane[2] for r in terrain.terrain_regions("kerbs", 7, seed)]
        assert heights[0] == 0.0
        up = [0]
        for a, b in itertools.pairwise(heights):
            up.append(up[-1] + (1 if b > a else -1))
            first += up[-2] == 0
            second += up[-2] == 1 and up[-1] == 2
            assert (up[-1] == 0) == (abs(b) < 1e-9)
        assert set(up) <= {0, 1, 2}
    assert first > 40
    assert second / first == pytest.approx(0.3, abs=0.15)


def test_stairs_rise_and_fall_by_one_height() -> None:
    steps = np.abs(_edges("stairs", 9))
    np.testing.assert_allclose(steps, 0.17, atol=1e-6)


def test_slopes_have_no_edge_and_the_slope_of_their_level() -> None:
    np.testing.assert_allclose(_edges("slopes", 9)[:-1], 0.0, atol=1e-9)
    slopes = {round(abs(r.plane[0]), 6) for r in terrain.terrain_regions("slopes", 9)}
    assert slopes == {0.0, 0.45}


def lengths(kind: str, level: int) -> tuple[np.ndarray, np.ndarray]:
    """m, along x, of the level strips of some terrains and of the inclined ones, the last of each left out."""
    level_ones, inclined = [], []
    for seed in range(12):
        for region in terrain.terrain_regions(kind, level, seed)[:-1]:
            (inclined if region.plane[0] else level_ones).append(np.ptp([p[0] for p in region.polygon]))
    return np.array(level_ones), np.array(inclined)


@pytest.mark.parametrize(("kind", "low", "high"), [("kerbs", 1.0, 2.5), ("stairs", 0.3, 1.6), ("slopes", 1.0, 1.6)])
def test_strips_are_as_long_as_the_kind_says(kind: str, low: float, high: float) -> None:
    """m; docs/decisions/go2.md has the distance of kerbs, steps out of doors have treads of 0.30 to 0.38 m."""
    found, inclined = lengths(kind, 5)
    for ends, part in [((low, high), found), ((1.5, 3.0), inclined)]:
        if len(part):
            assert ends[0] - 1e-6 <= part.min() < ends[0] + 0.1
            assert ends[1] - 0.1 < part.max() <= ends[1] + 1e-6
    if kind == "stairs":
        treads = found[found < 0.9]
        assert treads.max() <= 0.38 + 1e-6
        assert treads.max() > 0.37
        # Three treads of a flight of four steps, then a landing.
        assert (found > 0.9).sum() == pytest.approx(len(treads) / 3, rel=0.1)
    assert (len(inclined) > 0) == (kind == "slopes")


def test_unknown_kinds_and_levels_are_refused() -> None:
    with pytest.raises(ValidationError, match="terrain kind"):
        terrain.terrain_regions("moon", 0)
    with pytest.raises(ValidationError, match="terrain level"):
        terrain.terrain_regions("flat", terrain.LEVELS)


@pytest.fixture(scope="module")
def kerbs() -> tuple[terrain.SceneGeometry, SceneBank]:
    scene = terrain.region_scene("kerbs-5", terrain.terrain_regions("kerbs", 5))
    return scene, terrain.pack_regions([scene])


@pytest.mark.parametrize("cell", [0.05, 0.2])
def test_heights_of_the_bank_are_those_of_c_mujoco(kerbs: tuple[terrain.SceneGeometry, SceneBank], cell: float) -> None:
    """Rays from above, at the centres of random cells."""
    scene, bank = kerbs
    stored, lowest, origin = build_heights(bank, cell)
    heights = lowest[:, None, None] + UNIT * stored
    assert np.ptp(stored) > 50, "kerbs"
    model = scene_spec(scene).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rng, geom = np.random.default_rng(0), np.zeros(1, np.int32)
    for i, j in rng.integers(2, np.array(heights.shape[1:]) - 2, (200, 2)):
        point = np.array([*(origin[0] + (np.array([i, j]) + 0.5) * cell), 5.0])
        down = mujoco.mj_ray(model, data, point, np.array([0.0, 0.0, -1.0]), None, 1, -1, geom)
        assert heights[0, i, j] == pytest.approx(5.0 - down, abs=0.51 * UNIT)


def test_every_place_finds_its_ground_among_the_nearest_prisms(
    kerbs: tuple[terrain.SceneGeometry, SceneBank],
) -> None:
    """Eight slots hold all prisms within reach of a Go2 (0.72 m), on the roughest ground, too."""
    rough = terrain.pack_regions([terrain.region_scene("rough-0", terrain.terrain_regions("rough", 0))])
    rng = np.random.default_rng(0)
    for bank, limit in ((kerbs[1], 8), (rough, 9)):
        box = bank.hull_box[bank.prism_hull[0]]
        centre, half = box[:, 0] + bank.prism_position[0], box[:, 1]
        for place in rng.uniform(-8.0, 8.0, (200, 2)):
            apart = np.linalg.norm(np.maximum(np.abs(place - centre[:, :2]) - half[:, :2], 0.0), axis=1)
            assert (apart < 0.72).sum() <= limit


@pytest.mark.parametrize("level", [0, 3, terrain.LEVELS - 1])
def test_rough_pieces_are_tilted_about_their_middles(level: int) -> None:
    """There the ground is as uneven as the level says, however much a piece is tilted."""
    share = level / (terrain.LEVELS - 1)
    unevenness = terrain.ROUGH_HEIGHT[0] + (terrain.ROUGH_HEIGHT[1] - terrain.ROUGH_HEIGHT[0]) * share
    regions = terrain.terrain_regions("rough", level, 2)
    middles = np.array([np.mean(r.polygon, axis=0) for r in regions])
    slope, height = np.array([r.plane[:2] for r in regions]), np.array([r.plane[2] for r in regions])
    at_middle = (slope * middles).sum(1) + height
    assert at_middle.min() > -1e-3
    assert at_middle.max() < unevenness + 1e-3
    assert at_middle.max() > 0.9 * unevenness
    assert np.ptp(at_middle) > 0.8 * unevenness
    assert (np.linalg.norm(slope, axis=1) > 0.0).mean() > 0.9
