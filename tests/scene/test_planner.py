import numpy as np
import pytest

from urbanverse_mjx.datatypes import GroundRegion
from urbanverse_mjx.scene import episodes, maps
from urbanverse_mjx.scene.geometry import SceneMap
from urbanverse_mjx.scene.planner import GoalField, RobotSize, free_space, path_length, resample

BOX = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])
IDENTITY = np.eye(3)


def _region(name: str, kind: str, x0: float, y0: float, x1: float, y1: float, z: float = 0.0) -> GroundRegion:
    return GroundRegion(name, kind, ((x0, y0), (x1, y0), (x1, y1), (x0, y1)), (0.0, 0.0, z))


def _yard() -> SceneMap:
    return maps.ground_map([_region("yard", "sidewalk", 0, 0, 12, 6)])


def _blocked(scene_map: SceneMap, centre: tuple[float, float, float], size: tuple[float, float, float]) -> SceneMap:
    return maps.with_clearance(scene_map, [BOX * size], IDENTITY[None], np.array([centre]))


def _cell(space, x: float, y: float) -> np.ndarray:
    return np.floor((np.array([x, y]) - space.map.origin) / 0.2).astype(int)


def test_map_of_two_levels_and_paint() -> None:
    regions = [
        _region("walk", "sidewalk", 0, 0, 4, 2, 0.15),
        _region("road", "road", 0, 2, 4, 6),
        _region("line", "road_marking", 1, 3.9, 3, 4.1, 0.0),
    ]
    m = maps.ground_map(regions)

    def at(x: float, y: float) -> tuple[float, int]:
        i, j = np.floor((np.array([x, y]) - m.origin) / m.resolution).astype(int)
        return float(m.height[i, j]), int(m.kind[i, j])

    assert at(2.01, 1.01) == (pytest.approx(0.15), 4)
    assert at(2.01, 3.01) == (0.0, 1)
    assert at(2.01, 4.01) == (0.0, 2)
    assert np.isnan(at(-0.3, 1.01)[0])
    assert at(-0.3, 1.01)[1] == 0
    assert (m.kind == 4).sum() * 0.05**2 == pytest.approx(8.0, rel=1e-3)


@pytest.mark.parametrize(
    ("z", "height", "expected"), [(0.0, 1.0, 0.0), (2.2, 1.0, 2.2), (-0.3, 0.5, 0.0), (6.5, 1.0, 9.99)]
)
def test_clearance_is_the_height_of_the_lower_side(z: float, height: float, expected: float) -> None:
    m = _blocked(_yard(), (6.0, 3.0, z), (1.0, 1.0, height))
    i, j = np.floor((np.array([6.01, 3.01]) - m.origin) / m.resolution).astype(int)
    assert m.clearance[i, j] == pytest.approx(expected, abs=1e-6)
    assert m.clearance[i + 30, j] == pytest.approx(9.99)
    touched = (m.clearance < 9.0).sum() * 0.05**2
    assert touched == 0 if expected > 9 else 1.0 <= touched <= 1.2**2


def test_buried_objects_do_not_block() -> None:
    assert (_blocked(_yard(), (6.0, 3.0, -2.0), (1.0, 1.0, 1.9)).clearance == np.float32(9.99)).all()


def test_nothing_is_nearer_than_the_radius_on_a_free_cell() -> None:
    size = RobotSize()
    m = _blocked(_yard(), (6.0, 3.0, 0.0), (0.5, 0.5, 1.0))
    space = free_space(m, size)
    i, j = np.nonzero(space.free)
    centres = m.origin + (np.stack([i, j], -1) + 0.5) * m.resolution
    to_box = np.linalg.norm(np.maximum(np.abs(centres - [6.0, 3.0]) - 0.25, 0), axis=1)
    to_rim = np.min([centres[:, 0], 12 - centres[:, 0], centres[:, 1], 6 - centres[:, 1]], 0)
    assert to_box.min() >= size.radius + size.margin - 0.02
    assert to_rim.min() >= size.radius + size.margin - 0.02
    assert space.free[tuple(np.floor((np.array([6.0, 4.0]) - m.origin) / 0.05).astype(int))]
    coarse = np.argwhere(space.cost > 0)
    for a, b in coarse:
        assert space.free[a * 4 : a * 4 + 4, b * 4 : b * 4 + 4].all()


def test_a_kerb_is_no_way_but_a_low_step_is() -> None:
    for step, passable in ((0.15, False), (0.02, True)):
        m = maps.ground_map([_region("a", "sidewalk", 0, 0, 4, 6), _region("b", "sidewalk", 4, 0, 8, 6, step)])
        space = free_space(m, RobotSize())
        assert space.lines_free(np.array([[1.0, 3.0]]), np.array([[7.0, 3.0]])).tolist() == [passable]
        field = GoalField(space, _cell(space, 7, 3))
        assert np.isfinite(field.cost[tuple(_cell(space, 1, 3))]) == passable


def test_way_around_a_wall_is_the_shortest() -> None:
    """A wall from y = 0 to 4 leaves a gap at the top: the taut path touches its inflated end."""
    m = _blocked(_yard(), (6.0, 2.0, 0.0), (0.2, 4.0, 2.0))
    space = free_space(m, RobotSize())
    start, goal = np.array([4.0, 1.0]), np.array([8.0, 1.0])
    assert not space.lines_free(start[None], goal[None])[0]
    field = GoalField(space, _cell(space, *goal))
    path, straight = field.paths(np.array([_cell(space, *start), _cell(space, 8.0, 5.0)]))
    least = 2 * np.hypot(2.0 - 0.1, 3.0 + 0.4)
    assert least < path_length(path) < 1.16 * least
    assert space.lines_free(path[:-1], path[1:]).all()
    assert len(straight) == 2


def test_resample_keeps_distance_and_ends_at_the_goal() -> None:
    path = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 9.0]])
    np.testing.assert_allclose(resample(path, 5.0), [[3, 2], [3, 7], [3, 9]])
    np.testing.assert_allclose(resample(path, 6.0), [[3, 3], [3, 9]])
    np.testing.assert_allclose(resample(path, 50.0), [[3, 9]])


def test_lines_asked_together_are_answered_as_one_by_one() -> None:
    space = free_space(_blocked(_yard(), (6.0, 2.0, 0.0), (0.2, 4.0, 2.0)), RobotSize())
    low, high = space.map.origin, space.map.origin + np.array(space.free.shape) * space.map.resolution
    a, b = np.random.default_rng(0).uniform(low + 0.1, high - 0.1, (2, 200, 2))
    together = space.lines_free(a, b)
    assert 0.05 < together.mean() < 0.95
    for line, (start, end) in zip(together, zip(a, b, strict=True), strict=True):
        points = start + np.linspace(0.0, 1.0, 2000)[:, None] * (end - start)
        inside = space.free[space.cell(points)]
        # Finer points than the question's own may graze a corner that it steps over.
        assert line == inside.all() or (line and (~inside).sum() * np.linalg.norm(end - start) / 2000 < 0.08)


def test_goals_are_two_metres_apart_as_long_as_there_is_room_then_two_planning_cells() -> None:
    """A pavement of 14 m: goals are possible in its outer 4 m only, 10 m away from starts."""
    space = free_space(maps.ground_map([_region("walk", "sidewalk", 0, 0, 14, 1.4)]), RobotSize())
    cells = episodes._end_cells(space, RobotSize())
    rules = episodes.EpisodeRules(goals=200)
    pool = episodes._candidate_pool(space, cells, rules, np.random.default_rng(0))
    ends = {row.goal: row.path[-1] for row in pool}
    goals = np.array([ends[k] for k in range(len(ends))])
    apart = np.linalg.norm(goals[:, None] - goals, axis=-1) + 99.0 * np.eye(len(goals))
    nearest = np.array([apart[k, :k].min(initial=99.0) for k in range(len(goals))])
    roomy = int((nearest >= 2.0).sum())
    assert (nearest[:roomy] >= 2.0).all(), "first those with space around them"
    assert 2 <= roomy < len(goals)
    assert apart.min() == pytest.approx(0.4), "two planning cells of 0.2 m"
    assert (np.abs(goals[:, 0] - 7.0) > 3.0 - 0.1).all()
