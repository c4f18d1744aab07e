"""Where the scripted people of an encounter begin, relative to the route."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from urbanverse_mjx.crowds import behaviours
from urbanverse_mjx.crowds.behaviours import GO, ROAM, STAY
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs.navigation import encounters


@pytest.mark.parametrize("heading", [0.0, 1.1, -2.5])
def test_a_place_beside_the_route_is_in_its_frame(heading: float) -> None:
    pose = jnp.float32(3.0), jnp.float32(-1.0), jnp.float32(heading)
    x, y, turned = encounters._beside(pose, jnp.float32(0.7), 2.0)
    cos, sin = np.cos(heading), np.sin(heading)
    np.testing.assert_allclose([x, y, turned], [3 + 2 * cos - 0.7 * sin, -1 + 2 * sin + 0.7 * cos, heading], atol=1e-5)


def test_who_comes_head_on_meets_the_robot_at_the_drawn_place() -> None:
    """Six metres before it, walking back along the route."""
    pose = jnp.float32(3.0), jnp.float32(-1.0), jnp.float32(1.1)
    found = encounters.ENCOUNTERS["head_on"][2](pose, jnp.float32(1.0))
    by_hand = behaviours.head_on(*encounters._beside(pose, jnp.float32(0.3), -6.0), distance=6.0)
    for a, b in zip(found, by_hand, strict=True):
        np.testing.assert_array_equal(a, b)
    assert np.hypot(found.x - 3.0, found.y + 1.0) == pytest.approx(0.3, abs=1e-4)


#: Encounter -> whether its people walk, their speed (m/s; 0 is their own), and for a lateral offset of +1 and of -1 m
#: their places, what they walk to or keep, as (ahead, left) m, and their heading from that of the route, rad.
PEOPLE = {
    "head_on": (GO, 1.34, [((0, 0.3), (-12, 0.3), np.pi)], [((0, -0.3), (-12, -0.3), np.pi)]),
    "cross": (GO, 1.34, [((0, 2.5), (0, -2.5), -np.pi / 2)], [((0, -2.5), (0, 2.5), np.pi / 2)]),
    "obstruct": (STAY, 0.0, [((0, 0.2), (0, 0.2), np.pi)], [((0, -0.2), (0, -0.2), np.pi)]),
    "overtaken": (GO, 0.6, [((0, 0.3), (30, 0.3), 0.0)], [((0, -0.3), (30, -0.3), 0.0)]),
    "talk": (
        *(STAY, 0.0),
        *([((a, x), (a, x), np.pi if a > 0 else 0.0) for a in (0.425, -0.425)] for x in (1, -1)),
    ),
    "queue": (STAY, 0.0, *([((a, x), (a, x), np.pi) for a in (0.0, 0.75, 1.5)] for x in (1, -1))),
}


@pytest.mark.parametrize("name", PEOPLE)
def test_people_of_an_encounter_by_hand(name: str) -> None:
    heading = 1.1
    pose = jnp.float32(3.0), jnp.float32(-1.0), jnp.float32(heading)
    cos, sin = np.cos(heading), np.sin(heading)
    mode, speed, *sides = PEOPLE[name]
    number, _, make = encounters.ENCOUNTERS[name]
    for left, people in zip((1.0, -1.0), sides, strict=True):
        script = make(pose, jnp.float32(left))
        assert len(people) == number == len(script.x)
        assert script.mode.tolist() == [mode] * number
        np.testing.assert_allclose(script.speed, speed, atol=1e-6)
        for columns, at in (((script.x, script.y), 0), ((script.anchor_x, script.anchor_y), 1)):
            ahead, aside = np.array([row[at] for row in people], float).T
            expected = 3.0 + ahead * cos - aside * sin, -1.0 + ahead * sin + aside * cos
            np.testing.assert_allclose(columns, expected, atol=1e-4)
        turn = np.asarray(script.heading) - heading - [row[2] for row in people]
        np.testing.assert_allclose(np.angle(np.exp(1j * turn)), 0.0, atol=1e-3)


#: m, where a route starts.
START = (3.0, -2.0)


class Drawn:
    """1500 draws of encounters with these chances, compiled once."""

    def __init__(self, chances: dict[str, float], walkers: int = 9) -> None:
        every = encounters.Encounters(ConfigDict(chances), walkers)
        keys = jax.random.split(jax.random.key(0), 1500)

        def draw(route: jax.Array, free: jax.Array) -> Any:
            return jax.vmap(
                lambda key: every.draw(
                    key,
                    jnp.array([*START, 0.0, 0.0]),
                    route + jnp.array([*START, 0.0]),
                    lambda p: jnp.full(p.shape, free),
                )
            )(keys)

        self._draw = jax.jit(draw)

    def __call__(self, *waypoints: tuple[float, float], free: float = 2.0) -> behaviours.Script:
        """Places from the start, on a route through these points (m from it), which repeats its end up to four."""
        rows = [*waypoints, *[waypoints[-1]] * (4 - len(waypoints))]
        script = jax.tree.map(np.asarray, self._draw(jnp.array([[*row, 0.0] for row in rows]), jnp.float32(free)))
        return script._replace(x=script.x - START[0], y=script.y - START[1])


@pytest.mark.extended
def test_places_and_chances_of_encounters() -> None:
    """On 30 m along x. Those who cross need 2.5 m at 1.34 m/s, in which a robot covers 2.2 m; 1 to 3 m before it."""
    drawn = Drawn(dict.fromkeys(encounters.ENCOUNTERS, 0.3))
    script = drawn((30.0, 0.0))
    meet = 2.5 * 1.2 / 1.34
    rows = {"head_on": 0, "cross": 1, "obstruct": 2, "overtaken": 3, "talk": slice(4, 6), "queue": 6}
    ranges = {"head_on": (8, 16), "cross": (meet + 1, meet + 3), "obstruct": (4, 14), "overtaken": (3, 6)}
    ranges |= {"talk": (4, 20), "queue": (5, 20)}
    offsets = {"head_on": 0.36, "cross": 2.5, "obstruct": 0.24, "overtaken": 0.36, "talk": 1.2, "queue": 1.2}
    for name, row in rows.items():
        x, y = (a[:, row] if isinstance(row, int) else a[:, row].mean(1) for a in (script.x, script.y))
        low, high = ranges[name]
        near = 0.01 * (high - low)
        assert low - 1e-3 < x.min() < low + near
        assert high - near < x.max() < high + 1e-3
        for side in (y, -y):
            assert 0.98 * offsets[name] < side.max() < offsets[name] + 1e-4
    taken = script.mode != ROAM
    assert taken[:, 0].mean() == pytest.approx(0.3, abs=0.04), "nobody is in the way of the first"
    first = script.y[taken[:, 0], 0], script.x[taken[:, 0], 0]
    assert np.abs(np.mean(first[0])) < 0.04, "whether it takes place says nothing about where"
    assert np.mean(first[1]) == pytest.approx(12.0, abs=0.5)
    assert (taken[:, 1:].mean(0) > 0.2).all()
    assert (taken[:, 1:].mean(0) < 0.34).all()
    # 27 cm of a body and 10 cm more.
    assert not (drawn((30.0, 0.0), free=0.365).mode != ROAM).any()
    assert (drawn((30.0, 0.0), free=0.375).mode != ROAM).any()


@pytest.mark.extended
def test_encounters_keep_apart_from_the_robot_and_each_other() -> None:
    """On a route that comes back to its start after 9 m."""
    script = Drawn(dict.fromkeys(encounters.ENCOUNTERS, 1.0))((4.0, 0.0), (4.0, 1.0), (-5.0, 1.0))
    taken, away = script.mode != ROAM, np.hypot(script.x, script.y)
    assert 2.2 < away[taken].min() < 2.3
    assert away.min() < 1.5
    group = np.array([0, 1, 2, 3, 4, 4, 5, 5, 5])
    apart = np.hypot(script.x[:, :, None] - script.x[:, None], script.y[:, :, None] - script.y[:, None])
    others = taken[:, :, None] & taken[:, None] & (group[:, None] != group)
    assert 0.75 < apart[others].min() < 0.8
    # A route that is shorter than where they begin has them at the least distance.
    alone = Drawn({"head_on": 1.0}, walkers=1)
    short, middle = alone((5.0, 0.0)), alone((12.0, 0.0))
    np.testing.assert_allclose(short.x, 5.0, atol=1e-4)
    assert 8.0 <= middle.x.min() < 8.1
    assert 10.9 < middle.x.max() <= 11.0


@pytest.mark.parametrize(("name", "chance"), [("dance", 0.5), ("talk", 1.1), ("talk", -0.1)])
def test_what_is_no_chance_of_an_encounter_is_refused(name: str, chance: float) -> None:
    with pytest.raises(ValidationError, match=rf"found '{name}': {chance}, needed shares in \[0, 1\]"):
        encounters.Encounters(ConfigDict({name: chance}), 9)
