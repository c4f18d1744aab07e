"""Streets: free space, flats, routes, crossings, places to appear, behaviours, and a crowd that lives in one."""

import dataclasses
import itertools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.crowds.test_resolve_collisions import distances
from tests.support import figures
from tests.support.box_bank import HALF_WIDTH, KERB_Y
from tests.support.compiling import optimized
from urbanverse_mjx.crowds import (
    KINDS,
    Bodies,
    PreferredVelocity,
    behaviours,
    crossings,
    flats,
    free_space,
    goal_fields,
    lanes,
    spawning,
    traits_of,
)
from urbanverse_mjx.crowds import crowd as crowd_module
from urbanverse_mjx.crowds.crowd import Crowd, CrowdModel, CrowdTables, make_tables
from urbanverse_mjx.crowds.free_space import CELL, FreeSpace
from urbanverse_mjx.datatypes import GROUND_KINDS, SceneBank, ValidationError

NOBODY = spawning.Observer(jnp.float32(0), jnp.float32(0), jnp.float32(0), jnp.array(False))


@pytest.fixture(scope="module")
def spaces(small_bank: SceneBank) -> dict[str, FreeSpace]:
    return free_space.free_spaces(small_bank, 0)


@pytest.fixture(scope="module")
def tables(small_bank: SceneBank) -> CrowdTables:
    with optimized():  # flats take seconds
        return make_tables(small_bank, [0, 1])


def test_figures_of_a_crowds_tables(spaces: dict[str, FreeSpace], tables: CrowdTables) -> None:
    figures.check("crowds/tables", {"spaces": spaces, "tables": tables})


@pytest.mark.extended
def test_figures_of_a_crowds_first_steps(tables: CrowdTables) -> None:
    """Agents of every kind in two streets, some of them in each other's way, with a robot among them."""
    kinds = ("pedestrian",) * 5 + ("wheelchair", "scooter", "cyclist", "car", "car")
    model, scene = CrowdModel(tables, kinds, num_neighbours=6, reach=25.0), jnp.array([0, 1])
    robot = spawning.Observer(jnp.float32(24.0), jnp.float32(5.5), jnp.float32(0.3), jnp.array(True))
    script = behaviours.talk(jnp.float32(15.0), jnp.float32(5.9), 2)

    def few(key: jax.Array, z: jax.Array) -> tuple[Crowd, Crowd]:
        first = model.init(key, z, robot, script=script)
        close = first.bodies._replace(
            x=first.bodies.x.at[2:5].set(jnp.array([22.0, 23.0, 23.2])), y=first.bodies.y.at[2:5].set(5.6)
        )
        begun = first._replace(bodies=close, blocked=first.blocked.at[3].set(2.0))

        def body(crowd: Crowd, key: jax.Array) -> tuple[Crowd, None]:
            return model.step(crowd, z, robot, (jnp.float32(0.8), jnp.float32(-0.1)), key), None

        last, _ = jax.lax.scan(body, begun, jax.random.split(key, 5))
        return first, last

    first, last = jax.jit(jax.vmap(few))(jax.random.split(jax.random.key(3), 2), scene)
    figures.check("crowds/first", first, tolerance=1e-3)
    figures.check("crowds/steps", last, tolerance=5e-3)


def cell_of(space: FreeSpace, x: float, y: float) -> tuple[int, int]:
    i, j = np.floor((np.array([x, y]) - space.origin) / CELL).astype(int)
    return int(i), int(j)


def test_free_space_is_the_surface_without_what_stands_on_it(
    small_bank: SceneBank, spaces: dict[str, FreeSpace]
) -> None:
    standing = 0
    for hull, position in zip(small_bank.inst_hull[0], small_bank.inst_position[0], strict=True):
        if hull >= 0:
            cell = cell_of(spaces["foot"], position[0], position[1])
            assert not spaces["foot"].free[cell]
            assert not spaces["road"].free[cell]
            standing += 1
    assert standing > 20
    half_road = spaces["road"].free[:, cell_of(spaces["road"], 0, -KERB_Y + 0.1)[1]]
    assert half_road.mean() > 0.7
    foot = spaces["foot"]
    lane = cell_of(foot, 10.0, 0.0)[1]
    crossing = slice(cell_of(foot, 28.2, 0)[0], cell_of(foot, 31.8, 0)[0])
    assert not foot.free[: crossing.start - 5, lane].any()
    assert foot.free[crossing, lane].mean() > 0.5
    edge = cell_of(foot, 0.0, HALF_WIDTH + 0.2)[1]
    assert not foot.free[:, edge:].any()


def test_the_ground_has_the_height_of_its_regions(small_bank: SceneBank, spaces: dict[str, FreeSpace]) -> None:
    """Road, ramp and pavement at the crossing; a ramp ten times as steep as theirs; the nearest ground's beside it."""
    height = free_space.ground_height(small_bank, 0)
    space = spaces["foot"]
    assert height.shape == space.free.shape
    for y in (2.0, KERB_Y + 0.35, KERB_Y + 0.75, KERB_Y + 1.15, 7.0, HALF_WIDTH + 0.2):
        cell = cell_of(space, 30.0, y)
        centre = (cell[1] + 0.5) * CELL + space.origin[1]
        assert height[cell] == pytest.approx(float(np.clip(0.1 * (centre - KERB_Y), 0.0, 0.15)), abs=2e-4), y
    steep = np.array([(x, y, x - 2.0 if z else -3.0) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (0, 1)])
    up = np.array([-1.0, 0.0, 1.0]) / np.sqrt(2.0)
    planes = np.array(small_bank.hull_planes)
    vertices, count = np.array(small_bank.hull_vertices), np.array(small_bank.hull_num_vertices)
    vertices[0, :8], count[0], planes[0] = steep, 8, np.array([0.0, 0.0, -1.0, 3.0])
    planes[0, 3] = [*up, up @ [0.0, 0.0, -2.0]]
    prisms, places = np.full_like(small_bank.prism_hull, -1), np.array(small_bank.prism_position)
    prisms[0, 2], places[0, 2] = 0, (10.0, 3.0, 5.0)
    alone = dataclasses.replace(
        small_bank, hull_planes=planes, hull_vertices=vertices, hull_num_vertices=count, prism_hull=prisms,
        prism_position=places,
    )  # fmt: skip
    height = free_space.ground_height(alone, 0)
    for x in (9.25, 10.05, 10.75):
        cell = cell_of(space, x, 3.0)
        centre = (cell[0] + 0.5) * CELL + space.origin[0]
        assert height[cell] == pytest.approx(5.0 + (centre - 10.0) - 2.0, abs=1e-5)
    assert height[cell_of(space, 20.0, 3.0)] == pytest.approx(4.0, abs=CELL)


def test_free_space_refuses_a_scene_that_is_not_there(small_bank: SceneBank) -> None:
    with pytest.raises(ValidationError, match="found scene 7, needed one of 0 to 2"):
        free_space.free_spaces(small_bank, 7)


def test_the_walls_of_a_place_are_those_of_its_cell() -> None:
    """Also at the edges of the map; outside it there are none."""
    rng = np.random.default_rng(0)
    side, half, origin = flats.POOL * CELL, flats.NUM_FLATS, np.array([4.0, -2.0])
    table = rng.integers(8, 255, (1, 3, 2, 2 * half)).astype(np.uint8)
    tables = flats.Flats(jnp.asarray(table), jnp.asarray(origin[None], jnp.float32))
    for i, j in itertools.product(range(3), range(2)):
        x, y = origin + (np.array([i, j]) + 0.5) * side + [0.03, -0.02]
        walls = flats.walls_at(tables, jnp.int32(0), *(jnp.float32([v]) for v in (x, y, 0.1, 1.0)))
        angle = 2 * np.pi * table[0, i, j, :half] / 256
        normal = np.stack([np.cos(angle), np.sin(angle)], -1)
        np.testing.assert_allclose(np.stack([walls.x, walls.y], -1)[:, 0], -normal, atol=1e-5)
        free = table[0, i, j, half:] * flats.UNIT - normal @ [0.03, -0.02] - 0.1
        np.testing.assert_allclose(walls.offset[:, 0], -free, atol=1e-4)
    for x, y in ((-0.01, 0.1), (3 * side + 0.01, 0.1), (0.1, -0.01), (0.1, 2 * side + 0.01)):
        at = (jnp.float32([v]) for v in (origin[0] + x, origin[1] + y, 0.1, 1.0))
        assert (np.asarray(flats.walls_at(tables, jnp.int32(0), *at).offset) < -1e5).all()


def test_flats_leave_nothing_blocked_in_front_of_them(spaces: dict[str, FreeSpace]) -> None:
    space, reach = spaces["foot"], 2.0
    with optimized():
        table = flats.flats_of(space, reach)
    rng = np.random.default_rng(0)
    cells = np.argwhere((table[..., flats.NUM_FLATS :] < 255).any(-1))
    blocked = np.argwhere(~space.free)
    centres = space.centres(blocked)
    angles = 2 * np.pi * np.arange(256) / 256
    full = 0
    for cell in cells[rng.choice(len(cells), 200, replace=False)]:
        centre = space.origin + (cell + 0.5) * flats.POOL * CELL
        row = table[tuple(cell)]
        used = row[flats.NUM_FLATS :] < 255
        normal = np.stack([np.cos(angles), np.sin(angles)], -1)[row[: flats.NUM_FLATS][used]]
        offset = row[flats.NUM_FLATS :][used] * flats.UNIT
        away = centres - centre
        near = np.linalg.norm(away, axis=1) < reach
        beyond = (away[near] @ normal.T - offset).max(1)
        # Behind a flat, but for the roughness that slanted walls have; unless there were more than fit.
        full += used.all()
        if not used.all():
            assert beyond.min() > -0.051
        nearest = np.linalg.norm(np.maximum(np.abs(away[near]) - CELL / 2, 0), axis=1).min()
        assert offset[0] == pytest.approx(nearest, abs=0.05)
    assert full < 40


def peeled(space: FreeSpace, cell: np.ndarray, reach: float) -> list[tuple[int, float]]:
    """(direction, distance in m) of the flats around the centre of a coarse cell, one blocked cell after the other."""
    corner = (cell * flats.POOL + flats.POOL // 2).astype(int)
    half = int(np.ceil(reach / CELL))
    around = [np.array([i, j]) for i in range(-half, half) for j in range(-half, half)]
    around = sorted((a for a in around if np.hypot(*(a + 0.5)) * CELL <= reach), key=lambda a: np.hypot(*(a + 0.5)))
    found: list[tuple[int, np.ndarray, float]] = []
    for offset in around:
        i, j = corner + offset
        inside = 0 <= i < space.free.shape[0] and 0 <= j < space.free.shape[1]
        if (inside and space.free[i, j]) or len(found) == flats.NUM_FLATS:
            continue
        place = (offset + 0.5) * CELL
        if any(normal @ place >= behind - flats._MAX_PROTRUSION for _, normal, behind in found):
            continue
        code = round(float(np.arctan2(place[1], place[0])) * 256 / (2 * np.pi)) % 256
        normal = np.array([np.cos(2 * np.pi * code / 256), np.sin(2 * np.pi * code / 256)])
        found.append((code, normal, float(normal @ place)))
    return [(code, behind - CELL / 2 * float(np.abs(normal).sum())) for code, normal, behind in found]


def test_flats_are_peeled_off_one_after_the_other() -> None:
    """Against the same in Python, where no two blocked cells are equally near."""
    free = np.random.default_rng(2).random((24, 30)) < 0.93
    space = FreeSpace(np.zeros(2), free, np.zeros(free.shape, np.uint8))
    table, alike, seen = flats.flats_of(space, 0.8), 0, 0
    for cell in np.ndindex(*table.shape[:2]):
        row = table[cell]
        distances = row[flats.NUM_FLATS :]
        used = distances < 255
        block = space.free[tuple(slice(c * flats.POOL, (c + 1) * flats.POOL) for c in cell)]
        if not block.all():
            assert not used.any()
            continue
        expected = peeled(space, np.array(cell), 0.8)
        first = expected[0]
        assert distances[0] * flats.UNIT == pytest.approx(first[1], abs=flats.UNIT)
        same = {int(x) for x in row[: flats.NUM_FLATS][used]} == {code for code, _ in expected}
        alike, seen = alike + same, seen + 1
    assert seen > 10
    assert alike > 0.6 * seen


def test_flats_are_made_on_the_cpu_where_jax_may_use_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """With `JAX_PLATFORMS=cuda` JAX has no CPU: the default device makes the same table."""
    free = np.random.default_rng(0).random((12, 14)) < 0.9
    space = FreeSpace(np.zeros(2), free, np.zeros(free.shape, np.uint8))
    table = flats.flats_of(space, 0.5)
    assert ((table[..., flats.NUM_FLATS :] < 255).any(-1)).sum() > 10
    asked = []

    def local_devices(backend: str | None = None) -> list[Any]:
        asked.append(backend)
        raise RuntimeError(f"Unknown backend {backend}. Available backends are ['cuda']")

    monkeypatch.setattr(jax, "local_devices", local_devices)
    np.testing.assert_array_equal(flats.flats_of(space, 0.5), table)
    assert asked == ["cpu"]


def test_the_tables_of_scenes_keep_their_order() -> None:
    """Scenes of different sizes, which threads finish in any order."""
    rng = np.random.default_rng(1)
    spaces = []
    for number, shape in enumerate(((24, 20), (8, 10), (16, 6))):
        free = rng.random(shape) < 0.9
        spaces.append(FreeSpace(np.full(2, float(number)), free, np.zeros(shape, np.uint8)))
    joined = flats.make_flats(spaces, 0.5)
    assert joined.table.shape == (3, 12, 10, 2 * flats.NUM_FLATS)
    np.testing.assert_array_equal(joined.origin[:, 0], [0.0, 1.0, 2.0])
    for table, space in zip(np.asarray(joined.table), spaces, strict=True):
        single = flats.flats_of(space, 0.5)
        columns, rows = single.shape[:2]
        np.testing.assert_array_equal(table[:columns, :rows], single)
        assert (table[columns:] == 255).all()
        assert (table[:, rows:] == 255).all()


def test_walls_stop_a_walker_at_the_body(spaces: dict[str, FreeSpace]) -> None:
    with optimized():
        table = flats.make_flats([spaces["foot"]], 3.0)
    rng = np.random.default_rng(1)
    distance = spaces["foot"].distance()
    cells = np.argwhere((distance > 0.35) & (distance < 0.8))
    cells = cells[rng.choice(len(cells), 500, replace=False)]
    x, y = spaces["foot"].centres(cells).T.astype(np.float32)
    radius, horizon = 0.27, 0.8
    walls = flats.walls_at(table, jnp.int32(0), x, y, np.float32(radius), np.float32(horizon))
    nearest = -np.asarray(walls.offset).max(0) * horizon + radius
    # The nearest flat has the map's distance, up to the size of its coarse cell.
    np.testing.assert_allclose(nearest, distance[tuple(cells.T)], atol=0.13)


@pytest.mark.parametrize("group", ["foot", "drive"])
def test_ways_lead_to_their_goals(spaces: dict[str, FreeSpace], group: str) -> None:
    rules = goal_fields.RULES[group]
    space = spaces[rules.surface]
    fields, goals, places, place_goal = goal_fields.fields_of(space, rules)
    assert len(goals) >= 2
    apart = np.linalg.norm(goals[:, None] - goals[None], axis=-1)
    assert apart[np.triu_indices(len(goals), 1)].min() > 3.0
    distance, on_right = space.distance(), []
    for start, goal in list(zip(places, place_goal, strict=True))[:40]:
        at, goal = start.copy(), max(int(goal), 0)
        for _ in range(1500):
            if np.linalg.norm(at - goals[goal]) < 2 * rules.node:
                break
            node = tuple(np.floor((at - space.origin) / rules.node).astype(int))
            angle = fields[goal][node] * (2 * np.pi / 256)
            step = 0.1 * np.array([np.cos(angle), np.sin(angle)])
            at = at + step
            assert distance[tuple(np.floor((at - space.origin) / CELL).astype(int))] > 0.5 * rules.clearance
            if group == "drive" and abs(step[0]) > 0.09:
                on_right.append(-np.sign(step[0]) * at[1] > 0)  # the street runs along x, its middle is y = 0
        else:
            raise AssertionError(f"{start} does not lead to {goals[goal]}")
    if group == "drive":
        assert np.mean(on_right) > 0.75


@pytest.mark.parametrize(("side", "goes"), [(4.5, False), (5.9, True)])
def test_a_yard_of_less_than_25_square_metres_has_no_walkers(side: float, goes: bool) -> None:
    """Nodes half a clearance of 0.35 m inside its walls count: 3.8² m² of the small one, 5.2² of the other."""
    cells = round(8.0 / CELL)
    kind = np.zeros((cells, cells), np.int8)
    inner = slice(round(1.0 / CELL), round((1.0 + side) / CELL))
    kind[inner, inner] = GROUND_KINDS.index("sidewalk")
    space = FreeSpace(np.zeros(2), kind > 0, kind)
    fields, goals, places, place_goal = goal_fields.fields_of(space, goal_fields.RULES["foot"])
    assert (len(goals) >= 2) == (len(places) > 0) == goes
    assert (len(fields), len(place_goal)) == (len(goals), len(places))


@pytest.mark.parametrize("degrees", [0.0, 90.0, 30.0, 45.0, 160.0])
def test_distances_to_the_middle_of_a_road_are_those_of_a_strip(degrees: float) -> None:
    """A straight road of 8 m in any direction: unit vectors across it, and half its width less the distance to the
    edge, to about a node. In the outermost node, where no vehicle fits, a slanted edge is a stair."""
    node, size, width = 0.4, 80, 8.0
    along = np.radians(degrees)
    x, y = ((np.indices((size, size)) - size / 2 + 0.5) * node).reshape(2, -1)
    across = (np.cos(along) * y - np.sin(along) * x).reshape(size, size)
    to_edge, from_middle = goal_fields._sides(np.abs(across) < width / 2, node)
    # Whole cross-sections inside the grid, and no points whose two edges are equally near.
    inner = np.hypot(x, y).reshape(size, size) < size * node / 2 - width
    nodes = inner & (np.abs(across) < width / 2 - node) & (np.abs(across) > node)
    assert nodes.sum() > 400
    np.testing.assert_allclose(from_middle[nodes], np.abs(across)[nodes], atol=1.3 * node)
    normal = np.sign(across)[..., None] * np.array([-np.sin(along), np.cos(along)])
    assert ((to_edge * normal).sum(-1)[nodes] > 0.7).all()


@pytest.mark.parametrize("quarter", range(4))
def test_a_vehicle_fits_where_both_of_its_ends_are_on_its_nodes(quarter: int) -> None:
    """A passage of one node: a vehicle fits along it, not across it, and not where an end is beyond its own end."""
    nodes = np.zeros((21, 21), bool)
    nodes[10] = True
    if quarter % 2 == 0:
        nodes = nodes.T  # along x
    along = quarter * goal_fields._OPTIONS.directions // 4
    across = (along + goal_fields._OPTIONS.directions // 4) % goal_fields._OPTIONS.directions
    middle, ends = np.array([10, 10]), [np.array([10, 10]) for _ in range(2)]
    ends[0][quarter % 2], ends[1][quarter % 2] = 0, 20
    assert goal_fields._roomy(nodes, middle, np.full(nodes.shape, along))
    assert not goal_fields._roomy(nodes, middle, np.full(nodes.shape, across))
    assert not any(goal_fields._roomy(nodes, end, np.full(nodes.shape, along)) for end in ends)


def crowd_at(x: list[float], y: list[float], vx: float = 0.0) -> Crowd:
    """Agents at these places, m, that follow their routes along x to goal 0."""
    zero, number = jnp.zeros(len(x)), len(x)
    bodies = Bodies(zero + jnp.array(x, jnp.float32), zero + jnp.array(y, jnp.float32), zero + vx, zero, zero)
    none = jnp.zeros(number, jnp.int32)
    return Crowd(
        bodies, jnp.ones(number, bool), zero + 1.0, none, none + behaviours.ROAM, zero, zero, zero, zero, zero, zero,
        zero, none,
    )  # fmt: skip


@pytest.mark.extended
def test_who_is_left_far_behind_appears_again_near_the_robot(tables: CrowdTables) -> None:
    """One of those farther away than 1.5 times the reach and out of sight is placed elsewhere in a step."""
    observer = spawning.Observer(jnp.float32(45.0), jnp.float32(6.0), jnp.float32(0.0), jnp.array(True))
    before_x, before_y = [20.0, 38.0, 20.0, 20.0], [6.0, 6.0, -6.0, 5.0]
    for reach, moved in ((12.0, [True, False, False, False]), (20.0, [False] * 4)):
        model = CrowdModel(tables, ("pedestrian",) * 4, reach=reach)
        crowd = crowd_at(before_x, before_y)
        new = jax.jit(model._next_errands)(crowd, jnp.int32(0), observer, jax.random.key(0))
        x, y = np.asarray(new.bodies.x), np.asarray(new.bodies.y)
        gone = np.hypot(x - before_x, y - before_y) > 1e-3
        np.testing.assert_array_equal(gone, moved, err_msg=f"reach {reach} m")
        if any(moved):
            assert 4.0 < np.hypot(x[0] - 45.0, y[0] - 6.0) < 12.5, "out of sight, and within reach"


def test_vehicles_look_up_their_route_ahead_and_walkers_where_they_stand(tables: CrowdTables) -> None:
    """A route that turns left at x = 10: a car's course turns when its front, 0.4 s on, is there."""
    routes = {}
    for group, rules in goal_fields.RULES.items():
        turn = np.zeros((1, 1, 400, 400), np.uint8)
        turn[:, :, round(10.0 / rules.node) :] = 64
        zero = jnp.zeros((1, 2))
        routes[group] = tables.routes[group]._replace(
            direction=jnp.asarray(turn), origin=zero, goal=jnp.full((1, 1, 2), 1e3)
        )
    model = CrowdModel(tables._replace(routes=routes), ("pedestrian", "wheelchair", "cyclist", "car"))
    front = np.array([0.0, 0.0, KINDS["cyclist"].half_length, KINDS["car"].half_length]) + [0.0, 0.0, 2.0, 2.0]
    for shift, turned in ((-0.5, 0.0), (0.5, np.pi / 2)):
        crowd = crowd_at(list(10.0 - front + shift), [10.0] * 4, vx=5.0)
        np.testing.assert_allclose(model._courses(crowd, jnp.int32(0)), turned, atol=1e-3, err_msg=str(shift))


def walkers_and_cars(
    cars: list[tuple[float, float]],
    walker: tuple[float, float],
    phase: int | None = None,
    robot: tuple[float, float, bool] = (0.0, -7.0, False),
) -> crossings.Order:
    """A crossing at x 28 to 32 of a road along x; one walker heading north, cars (x, speed) coming from the west.

    Args:
      phase: of its signal; None for no signals and no robot.
      robot: x, y of a robot heading north, and whether drivers give way to it.
    """
    kind = np.zeros((600, 160), np.uint8)
    kind[280:320, 40:120] = 3
    space = FreeSpace(np.array([0.0, -8.0]), np.ones(kind.shape, bool), kind)
    table = crossings.make_crossings([space])
    f = lambda *v: jnp.array(v, jnp.float32)  # noqa: E731
    bodies = Bodies(
        f(walker[0], *(x for x, _ in cars)),
        f(walker[1], *(-2.0 for _ in cars)),
        f(0.0, *(v for _, v in cars)),
        f(*([0.0] * (len(cars) + 1))),
        f(np.pi / 2, *(0.0 for _ in cars)),
    )
    walks = jnp.arange(len(cars) + 1) == 0
    speed = f(1.34, *(8.0 for _ in cars))
    front = f(0.27, *(2.37 for _ in cars))
    rights = None
    if phase is not None:
        x, y, yields = robot
        phases = jnp.zeros(256, jnp.int32).at[1].set(phase)
        rights = crossings.Precedence(phases, f(x)[0], f(y)[0], f(np.pi / 2)[0], jnp.bool_(yields))
    return crossings.give_way(table, jnp.int32(0), bodies, bodies.heading, speed, walks, front, walks | True, rights)


def test_crossing_waits_for_what_comes_and_not_for_what_does_not() -> None:
    kerb = (30.0, -4.4)
    assert not walkers_and_cars([(0.0, 0.0)], kerb).wait[0]
    # 14 m in 1.8 s, while crossing 8 m takes 6 s and 3 s more.
    coming = walkers_and_cars([(10.5, 8.0)], kerb)
    assert bool(coming.wait[0])
    # A slow car takes 12 s, and at twice its speed less than the 9 s.
    assert not walkers_and_cars([(10.5, 1.2)], kerb).wait[0]
    assert bool(walkers_and_cars([(10.5, 2.4)], kerb).wait[0])
    # A car that has stopped lets one go, and one past the crossing does not count.
    assert not walkers_and_cars([(24.0, 0.0)], kerb).wait[0]
    assert not walkers_and_cars([(36.0, 8.0)], kerb).wait[0]
    # Away from the kerb no agent waits.
    assert not walkers_and_cars([(10.5, 8.0)], (30.0, -6.0)).wait[0]


def test_vehicles_stop_for_walkers_if_they_can() -> None:
    for walker, stops in (((30.0, -4.4), True), ((30.0, 0.0), True), ((30.0, -7.0), False)):
        limit = float(walkers_and_cars([(10.5, 6.0)], walker).limit[1])
        assert np.isfinite(limit) == stops
        if stops:
            # v² = 2 b d, with 1.7 m/s² and the distance from the front (12.87 m) to a metre before the crossing (27.x
            # m).
            assert 6.0 < limit < np.sqrt(2 * 1.7 * 15.2)
    # 8 m/s five metres before it: too late to stop gently.
    assert not np.isfinite(float(walkers_and_cars([(21.0, 8.0)], (30.0, 0.0)).limit[1]))


def test_people_and_vehicles_obey_signals() -> None:
    kerb, on_it, away = (30.0, -4.4), (30.0, 0.0), (30.0, -7.0)
    far = [(10.5, 6.0)]
    # Nobody comes, yet only in the phase of walking people begin; on the crosswalk they go on.
    for phase, waits in (
        (crossings.UNSIGNALLED, False),
        (crossings.WALK, False),
        (crossings.CLEAR, True),
        (crossings.STOP, True),
    ):
        assert bool(walkers_and_cars([(0.0, 0.0)], kerb, phase).wait[0]) == waits
        assert not walkers_and_cars([(0.0, 0.0)], on_it, phase).wait[0]
    # A car stops although nobody is near, until its own phase, in which it stops for people on the crosswalk alone.
    for phase, walker, stops in (
        (crossings.UNSIGNALLED, away, False),
        (crossings.UNSIGNALLED, kerb, True),
        (crossings.WALK, away, True),
        (crossings.CLEAR, away, True),
        (crossings.STOP, away, False),
        (crossings.STOP, kerb, False),
        (crossings.STOP, on_it, True),
    ):
        assert np.isfinite(float(walkers_and_cars(far, walker, phase).limit[1])) == stops, (phase, walker)


def test_drivers_give_way_to_a_robot_where_they_have_to() -> None:
    away = (10.0, -7.0)
    for place, yields, phase, stops in (
        ((30.0, -4.9), True, crossings.UNSIGNALLED, True),  # at the kerb, heading to the crosswalk
        ((30.0, -4.9), False, crossings.UNSIGNALLED, False),
        ((30.0, -4.9), True, crossings.STOP, False),
        ((30.0, 0.0), True, crossings.STOP, True),  # on it
        ((30.0, 0.0), False, crossings.UNSIGNALLED, False),
        ((30.0, -6.0), True, crossings.UNSIGNALLED, False),  # too far away to be about to cross
        ((30.0, 4.9), True, crossings.UNSIGNALLED, False),  # behind it, heading on
    ):
        limit = walkers_and_cars([(10.5, 6.0)], away, phase, (*place, yields)).limit[1]
        assert np.isfinite(float(limit)) == stops, (place, yields, phase)


def test_nobody_appears_in_sight_or_upon_another() -> None:
    rng = np.random.default_rng(0)
    place = jnp.asarray(rng.uniform(-40, 40, (256, 2)), jnp.float32)
    x, y = (jnp.asarray(rng.uniform(-40, 40, 30), jnp.float32) for _ in range(2))
    present = jnp.arange(30) < 20
    observer = spawning.Observer(jnp.float32(0), jnp.float32(0), jnp.float32(0.5), jnp.array(True))
    chosen = set()
    for seed in range(30):
        row, found = spawning.choose(
            jax.random.key(seed), place, jnp.float32(0.3), x, y, jnp.full(30, 0.3), present, observer, True
        )
        assert bool(found)
        chosen.add(int(row))
        px, py = (float(v) for v in place[row])
        gap = np.hypot(px - np.asarray(x), py - np.asarray(y))[:20].min()
        assert gap > 0.3 + 0.3 + 0.5
        off = abs((np.arctan2(py, px) - 0.5 + np.pi) % (2 * np.pi) - np.pi)
        assert np.hypot(px, py) > 4.0
        assert np.hypot(px, py) > 30.0 or off > 1.0
    assert len(chosen) > 15
    none = spawning.choose(
        jax.random.key(0), place[:1], jnp.float32(0.3), place[:1, 0], place[:1, 1], jnp.full(1, 0.3), jnp.ones(1, bool),
        observer, True,
    )  # fmt: skip
    assert not bool(none[1])


def test_places_within_reach_come_first_and_others_when_there_are_none() -> None:
    place = jnp.stack([jnp.arange(40.0), jnp.zeros(40)], -1)
    observer = NOBODY._replace(present=jnp.array(True))
    nobody = (jnp.zeros(1), jnp.zeros(1), jnp.zeros(1), jnp.zeros(1, bool))

    def chosen(places: jax.Array, hidden: bool, reach: float) -> set[float]:
        keys = jax.random.split(jax.random.key(0), 20)
        call = jax.jit(jax.vmap(lambda k: spawning.choose(k, places, 0.3, *nobody, observer, hidden, reach)))
        rows, found = call(keys)
        return set(np.asarray(places[rows, 0])[np.asarray(found)].tolist())

    near = chosen(place, False, 12.0)
    assert len(near) > 3
    assert min(near) > 1.5
    assert max(near) < 12.5
    assert min(chosen(place, True, 12.0)) >= 30.0, "in sight within reach: what is out of sight will do"
    assert max(chosen(place[20:], False, 12.0)) > 20.0


def test_scripts_put_people_where_they_say() -> None:
    ring = behaviours.talk(jnp.float32(3.0), jnp.float32(1.0), 4)
    side = np.hypot(np.diff(ring.x), np.diff(ring.y))
    np.testing.assert_allclose(side, behaviours.TALK_DISTANCE, atol=1e-5)
    ahead = np.stack([ring.x + np.cos(ring.face), ring.y + np.sin(ring.face)])
    centre = np.array([[3.0], [1.0]])
    before = np.linalg.norm(np.stack([ring.x, ring.y]) - centre, axis=0)
    assert np.all(np.linalg.norm(ahead - centre, axis=0) < before)
    line = behaviours.queue(jnp.float32(0.0), jnp.float32(0.0), jnp.float32(np.pi / 2), 3)
    np.testing.assert_allclose(line.y, [0.0, 0.75, 1.5], atol=1e-6)
    np.testing.assert_allclose(np.abs(line.face), np.pi / 2, atol=1e-6)
    meets = behaviours.head_on(jnp.float32(1.0), jnp.float32(2.0), jnp.float32(0.0), 8.0)
    assert (float(meets.x[0]), float(meets.y[0]), float(meets.anchor_x[0])) == (9.0, 2.0, -7.0)
    cuts = behaviours.cross(jnp.float32(0.0), jnp.float32(0.0), jnp.float32(np.pi / 2), 5.0)
    np.testing.assert_allclose([cuts.x[0], cuts.y[0], cuts.anchor_x[0]], [-4.0, 5.0, 4.0], atol=1e-5)
    both = behaviours.together(ring, line)
    assert both.mode.shape == (7,)


def test_people_of_a_script_walk_to_their_place_or_keep_it() -> None:
    """Far and near ones who go, slower within half a second of their place; who stays returns at up to 0.6 m/s."""
    f = lambda *v: jnp.array(v, jnp.float32)  # noqa: E731
    bodies = Bodies(f(0, 0, 0, 0), f(0, 0, 0, 0), f(0, 0, 0, 0), f(0, 0, 0, 0), f(0, 0, 0, 0))
    mode = jnp.array([behaviours.GO, behaviours.GO, behaviours.STAY, behaviours.STAY])
    anchor = f(3.0, 0.2, 0.5, 0.0), f(4.0, 0.0, 0.0, 3.0)
    found = behaviours.scripted_velocity(mode, anchor, f(0.7, 0.7, 0.7, 0.7), f(1.3, 1.3, 1.3, 1.3), bodies)
    expected = [[0.78, 0.4, 0.5, 0.0], [1.04, 0.0, 0.0, 0.6], [np.arctan2(4.0, 3.0), 0.7, 0.7, 0.7]]
    np.testing.assert_allclose(np.stack(found), expected, atol=1e-5)


@pytest.mark.parametrize(
    ("gap", "there", "hidden", "away", "free"),
    [
        (0.52, True, False, 9.0, True),
        (0.48, True, False, 9.0, False),
        (0.48, False, False, 9.0, True),
        (2.0, True, False, 1.52, True),
        (2.0, True, False, 1.48, False),
        (2.0, True, True, 9.0, False),  # in sight
    ],
)
def test_who_appears_has_half_a_metre_around_it(gap: float, there: bool, hidden: bool, away: float, free: bool) -> None:
    """A body of 0.27 m beside one of 0.4 m, and a robot that looks at it."""
    place = jnp.array([[10.0, 5.0]])
    observer = spawning.Observer(
        jnp.float32(10.0), jnp.float32(5.0 - 0.27 - away), jnp.float32(np.pi / 2), jnp.array(True)
    )
    other = jnp.array([10.0 + 0.27 + 0.4 + gap]), jnp.array([5.0]), jnp.array([0.4]), jnp.array([there])
    _, found = spawning.choose(jax.random.key(0), place, jnp.float32(0.27), *other, observer, hidden)
    assert bool(found) == free


def test_a_script_takes_the_first_slots_that_act() -> None:
    """The second row does not; the third keeps its own speed."""
    crowd = crowd_at([1.0, 2.0, 3.0, 4.0], [5.0] * 4, vx=0.7)._replace(present=jnp.zeros(4, bool))
    f = lambda *v: jnp.array(v, jnp.float32)  # noqa: E731
    script = behaviours.Script(
        jnp.array([behaviours.GO, behaviours.ROAM, behaviours.STAY]),
        *(f(11, 12, 13), f(21, 22, 23), f(0.1, 0.2, 0.3), f(1.5, 1.6, 0.0), f(31, 32, 33), f(41, 42, 43)),
        f(0.4, 0.5, 0.6),
    )
    after = crowd_module._follow(crowd, script)
    assert after.mode.tolist() == [behaviours.GO, behaviours.ROAM, behaviours.STAY, behaviours.ROAM]
    assert after.present.tolist() == [True, False, True, False]
    expected = {
        "x": [11, 2, 13, 4], "y": [21, 5, 23, 5], "vx": [0, 0.7, 0, 0.7], "vy": [0] * 4, "heading": [0.1, 0, 0.3, 0],
    }  # fmt: skip
    for name, values in expected.items():
        np.testing.assert_allclose(getattr(after.bodies, name), values, atol=1e-6, err_msg=name)
    for name, values in {"speed": [1.5, 1, 1, 1], "anchor_x": [31, 0, 33, 0], "anchor_y": [41, 0, 43, 0]}.items():
        np.testing.assert_allclose(getattr(after, name), values, atol=1e-6, err_msg=name)
    np.testing.assert_allclose(after.face, [0.4, 0, 0.6, 0], atol=1e-6)


@pytest.mark.slow
def test_a_crowd_lives_in_streets_it_does_not_leave(small_bank: SceneBank, tables: CrowdTables) -> None:
    kinds = ("pedestrian",) * 8 + ("wheelchair", "car")
    model = CrowdModel(tables, kinds, num_neighbours=6)
    scene = jnp.array([0, 1])
    script = behaviours.talk(jnp.float32(15.0), jnp.float32(5.9), 2)
    keys = jax.random.split(jax.random.key(0), 2)
    crowd = jax.jit(jax.vmap(lambda k, z: model.init(k, z, NOBODY, script=script)))(keys, scene)
    assert np.asarray(crowd.present)[:, :9].all()
    still = jnp.zeros(())

    def body(crowd: object, key: jax.Array) -> tuple[object, tuple[Bodies, jax.Array]]:
        new = jax.vmap(lambda c, z, k: model.step(c, z, NOBODY, (still, still), k))(
            crowd, scene, jax.random.split(key, 2)
        )
        return new, (new.bodies, new.arrived)

    run = jax.jit(lambda c: jax.lax.scan(body, c, jax.random.split(jax.random.key(1), 300)))
    last, (path, _) = run(crowd)
    again, _ = run(crowd)
    np.testing.assert_array_equal(last.bodies.x, again.bodies.x)
    x, y = np.asarray(path.x), np.asarray(path.y)
    radius = np.array([k.radius for k in model.kinds])
    walkers = slice(0, 9)
    apart = np.hypot(x[..., walkers, None] - x[..., None, walkers], y[..., walkers, None] - y[..., None, walkers])
    overlap = radius[walkers, None] + radius[None, walkers] - apart
    overlap[..., np.arange(9), np.arange(9)] = -1
    assert overlap.max() <= 0.02
    for e in range(2):
        space = free_space.free_spaces(small_bank, e)
        for i, kind in enumerate(model.kinds):
            cells = np.floor((np.stack([x[:, e, i], y[:, e, i]], -1) - space["foot"].origin) / CELL).astype(int)
            assert space[kind.surface].free[tuple(cells.T)].all(), kind.name
    # Talking agents stay; most others make progress.
    moved = np.hypot(x[-1] - x[0], y[-1] - y[0])
    assert moved[:, :2].max() < 0.7
    assert np.median(moved[:, 2:8]) > 5.0


@pytest.mark.extended
def test_who_looks_at_nothing_still_runs_into_nobody(small_bank: SceneBank, tables: CrowdTables) -> None:
    """Agents that move in circles of 7.5 m without avoidance: each is stopped before contact."""
    kinds = ("pedestrian",) * 9 + ("wheelchair", "scooter", "cyclist", "car", "car")
    model = CrowdModel(tables, kinds)

    def reckless(bodies: Bodies, *_: object) -> tuple[Bodies, None]:
        x, y, vector = (a[: len(kinds)] for a in (bodies.x, bodies.y, bodies.heading + 0.02))
        vx, vy = 1.5 * jnp.cos(vector), 1.5 * jnp.sin(vector)
        return Bodies(x + vx * model.dt, y + vy * model.dt, vx, vy, vector), None

    model._step = reckless  # type: ignore[assignment]
    scene, still = jnp.array([0, 1]), jnp.zeros(())
    crowd = jax.jit(jax.vmap(lambda k, z: model.init(k, z, NOBODY)))(jax.random.split(jax.random.key(0), 2), scene)

    def body(crowd: Crowd, key: jax.Array) -> tuple[Crowd, tuple[Bodies, jax.Array]]:
        step = jax.vmap(lambda c, z, k: model.step(c, z, NOBODY, (still, still), k))
        new = step(crowd, scene, jax.random.split(key, 2))
        return new, (new.bodies, new.present)

    _, (path, present) = jax.jit(lambda c: jax.lax.scan(body, c, jax.random.split(jax.random.key(1), 200)))(crowd)
    path, present = jax.device_get((path, present))
    radius, half = (np.array([getattr(k, name) for k in model.kinds]) for name in ("radius", "half_length"))
    need, nearest = radius + radius[:, None], np.inf
    for e in range(2):
        for t in range(200):
            now, there = Bodies(*(a[t, e] for a in path)), present[t, e]
            pairs = there & there[:, None] & ~np.eye(len(kinds), dtype=bool)
            nearest = min(nearest, (distances(now, half, crossed=True) - need)[pairs].min())
        free = free_space.free_spaces(small_bank, int(scene[e]))
        for end, (i, kind) in itertools.product((-1.0, 1.0), enumerate(model.kinds)):
            x, y, heading = (a[:, e, i] for a in (path.x, path.y, path.heading))
            at = np.stack([x + end * half[i] * np.cos(heading), y + end * half[i] * np.sin(heading)], -1)
            space = free[kind.surface]
            cells = np.floor((at - space.origin) / CELL).astype(int)[present[:, e, i]]
            assert space.free[tuple(cells.T)].all(), (e, kind.name)
    assert -0.001 < nearest < 0.01, "some came to the touch"


def test_vehicles_drive_no_faster_than_they_can_stop() -> None:
    """A car that prefers 8 m/s, with another across its lane, beside it, driving away, and behind it."""
    kinds = [KINDS["pedestrian"], KINDS["car"], KINDS["car"]]
    traits = jax.tree.map(lambda a: a[:, 0], traits_of(kinds))
    car = KINDS["car"]
    preferred_velocity = PreferredVelocity(jnp.array([1.0, 8.0, 0.0]), jnp.zeros(3), jnp.zeros(3))

    def speed(x: float, y: float, vx: float, heading: float) -> float:
        zero = jnp.zeros(3)
        bodies = Bodies(
            jnp.array([0.0, 0.0, x]), jnp.array([50.0, 0.0, y]), zero.at[2].set(vx), zero, zero.at[2].set(heading)
        )
        new = lanes.stop_in_time(preferred_velocity, bodies, traits, 1)
        assert float(new.x[0]) == 1.0
        return float(new.x[1])

    across = speed(10.0, 0.5, 0.0, np.pi / 2)
    gap = 10.0 - car.half_length - 2 * car.radius - lanes.BUMPER_DISTANCE
    np.testing.assert_allclose(across, np.sqrt(2 * car.braking * gap), rtol=1e-5)
    assert speed(4.0, 0.0, 0.0, np.pi / 2) < 2.5
    assert speed(3.0, 0.0, 0.0, np.pi / 2) == 0.0
    assert speed(10.0, 2.0, 0.0, 0.0) == 8.0
    assert speed(-6.0, 0.0, 0.0, 0.0) == 8.0
    assert speed(8.0, 0.0, 6.0, 0.0) == 8.0
