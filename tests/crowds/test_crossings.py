"""Right of way at crosswalks in random traffic, against the same rules for one agent after another."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.crowds import Bodies, crossings
from urbanverse_mjx.crowds.crossings import CLEAR, STOP, UNSIGNALLED, WALK
from urbanverse_mjx.crowds.free_space import CELL, FreeSpace
from urbanverse_mjx.datatypes import KIND_INDEX

#: Of each scene: where its map begins, m, and its crosswalks (x0, x1, y0, y1), m, by their numbers from 1 on.
SCENES = (
    ((0.0, -8.0), ((9.6, 12.8, -4.0, 4.0), (28.0, 32.0, -4.0, 4.0), (44.8, 55.6, -4.0, 4.0))),
    ((-4.0, -8.0), ((18.0, 21.2, -4.8, 4.0),)),
)
AGENTS, CASES = 24, 150


def table() -> crossings.Crossings:
    spaces = []
    for origin, rows in SCENES:
        kind = np.zeros((round(64.0 / CELL), round(16.0 / CELL)), np.uint8)
        for x0, x1, y0, y1 in rows:
            i, j = ([round((v - o) / CELL) for v in ends] for ends, o in zip(((x0, x1), (y0, y1)), origin, strict=True))
            kind[i[0] : i[1], j[0] : j[1]] = KIND_INDEX["crosswalk"]
        spaces.append(FreeSpace(np.array(origin), np.ones(kind.shape, bool), kind))
    return crossings.make_crossings(spaces)


@dataclasses.dataclass(frozen=True)
class Traffic:
    """Agents (AGENTS,) of one case, its signals and its robot."""

    scene: int
    x: np.ndarray
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    heading: np.ndarray
    course: np.ndarray
    speed: np.ndarray
    walks: np.ndarray
    front: np.ndarray
    present: np.ndarray
    phase: np.ndarray
    robot: np.ndarray
    robot_walks: bool

    @staticmethod
    def drawn(rng: np.random.Generator, scene: int) -> "Traffic":
        """Walkers near the kerbs and on crosswalks, vehicles in both directions along x."""
        walks = rng.random(AGENTS) < 0.4
        rows = np.array(SCENES[scene][1])[rng.integers(len(SCENES[scene][1]), size=AGENTS)]
        beside = rng.uniform(rows[:, 0] - 1.0, rows[:, 1] + 1.0)
        side = rng.choice([-1, 1], AGENTS)
        aside = side * np.where(rng.random(AGENTS) < 0.7, rng.uniform(3.9, 5.0, AGENTS), rng.uniform(2.0, 6.0, AGENTS))
        x = np.where(walks, beside, rng.uniform(-2.0, 58.0, AGENTS))
        y = np.where(walks, aside, rng.choice([-2.0, 2.0], AGENTS))
        heading = np.where(
            walks, np.where(rng.random(AGENTS) < 0.8, -side, side) * np.pi / 2, rng.choice([0.0, np.pi], AGENTS)
        )
        heading = heading + rng.uniform(-0.1, 0.1, AGENTS)
        going = np.where(walks, 1.3, rng.choice([0.0, 0.5, 1.0, 4.0, 9.0], AGENTS) + rng.uniform(0.0, 0.3, AGENTS))
        speed = np.where(walks, rng.choice([0.05, 0.8, 1.6], AGENTS), 8.0)
        front = np.where(walks, 0.27, rng.choice([0.9, 2.4], AGENTS))
        robot = np.array(
            [*(rng.uniform((rows[0, 0] - 1, -6.5), (rows[0, 1] + 1, 6.5))), rng.choice([-1, 1]) * np.pi / 2]
        )
        phase = np.zeros(256, np.int32)
        phase[1:4] = rng.integers(4, size=3)
        return Traffic(
            scene, x, y, going * np.cos(heading), going * np.sin(heading), heading,
            heading + rng.uniform(-0.2, 0.2, AGENTS), speed, walks, front, rng.random(AGENTS) < 0.5, phase, robot,
            bool(rng.random() < 0.7),
        )  # fmt: skip


def number_at(scene: int, x: float, y: float) -> int:
    found = [n for n, (x0, x1, y0, y1) in enumerate(SCENES[scene][1], 1) if x0 <= x < x1 and y0 <= y < y1]
    return found[0] if found else 0


class ByHand:
    """The rules, one agent after another."""

    def __init__(self, traffic: Traffic, signals: bool) -> None:
        t, self.signals = traffic, signals
        agents = range(AGENTS)
        self.t = t
        self.here = [number_at(t.scene, t.x[a], t.y[a]) for a in agents]
        self.ahead = [
            number_at(t.scene, t.x[a] + 0.8 * np.cos(t.course[a]), t.y[a] + 0.8 * np.sin(t.course[a])) for a in agents
        ]
        self.walkers = [a for a in agents if t.present[a] and t.walks[a]]
        self.drivers = [a for a in agents if t.present[a] and not t.walks[a]]
        self.going = np.hypot(t.vx, t.vy)
        #: Of each driver that comes to a crosswalk: its number, and m from the front to it.
        self.coming: dict[int, tuple[int, float]] = {}
        for a in self.drivers:
            for metres in range(1, 25) if not self.here[a] else ():
                number = number_at(
                    t.scene, t.x[a] + metres * np.cos(t.heading[a]), t.y[a] + metres * np.sin(t.heading[a])
                )
                if number:
                    self.coming[a] = number, metres - 1.0 - t.front[a]
                    break

    def waits(self, a: int) -> bool:
        number = self.ahead[a]
        if a not in self.walkers or self.here[a] or not number:
            return False
        if self.signals and self.t.phase[number] in (CLEAR, STOP):
            return True
        x0, x1, y0, y1 = SCENES[self.t.scene][1][number - 1]
        needs = max(x1 - x0, y1 - y0) / max(self.t.speed[a], 0.1) + 3.0
        for b in self.drivers:
            if self.here[b] == number:
                return True
            if self.coming.get(b, (0, 0.0))[0] == number and self.going[b] > 0.8:
                if max(self.coming[b][1], 0.0) / max(self.going[b], 0.1) < needs:
                    return True
        return False

    def stops(self, number: int) -> bool:
        """Whether vehicles have to stop before a crosswalk."""
        t = self.t
        on_it = any(self.here[a] == number for a in self.walkers)
        at_it = any(not self.here[a] and self.ahead[a] == number for a in self.walkers)
        if not self.signals:
            return on_it or at_it
        x, y, heading = t.robot
        on_it_robot = number_at(t.scene, x, y)
        robot_ahead = number_at(t.scene, x + 1.3 * np.cos(heading), y + 1.3 * np.sin(heading))
        robot = on_it_robot == number or (not on_it_robot and robot_ahead == number and t.phase[number] != STOP)
        if robot and t.robot_walks:
            return True
        return on_it if t.phase[number] == STOP else on_it or at_it or t.phase[number] != UNSIGNALLED

    def limit(self, a: int) -> float:
        if a not in self.coming:
            return np.inf
        number, gap = self.coming[a]
        if not self.stops(number) or self.going[a] ** 2 >= 2.0 * 2.0 * 1.7 * max(gap, 0.0):
            return np.inf
        return float(np.sqrt(2.0 * 1.7 * max(gap - 1.0, 0.0)))


@pytest.mark.parametrize("signals", [False, True])
def test_everybody_waits_and_stops_by_the_rules(signals: bool) -> None:
    rng = np.random.default_rng(3)
    cases = [Traffic.drawn(rng, k % 2) for k in range(CASES)]
    rows = {f.name: jnp.asarray(np.array([getattr(c, f.name) for c in cases])) for f in dataclasses.fields(Traffic)}
    made = table()
    np.testing.assert_allclose(made.width[:, :4], [[0, 8.0, 8.0, 10.8], [0, 8.8, 0, 0]], atol=1e-5)

    def one(r: dict[str, jax.Array]) -> crossings.Order:
        f = {k: v.astype(jnp.float32) for k, v in r.items()}
        bodies = Bodies(f["x"], f["y"], f["vx"], f["vy"], f["heading"])
        x, y, heading = (f["robot"][k] for k in range(3))
        rights = crossings.Precedence(r["phase"], x, y, heading, r["robot_walks"]) if signals else None
        return crossings.give_way(
            made, r["scene"], bodies, f["course"], f["speed"], r["walks"], f["front"], r["present"], rights
        )

    wait, limit = (np.asarray(x) for x in jax.jit(jax.vmap(one))(rows))
    by_hand = [ByHand(case, signals) for case in cases]
    expected = np.array([[rules.waits(a) for a in range(AGENTS)] for rules in by_hand])
    limits = np.array([[rules.limit(a) for a in range(AGENTS)] for rules in by_hand])
    assert min(expected.sum(), np.isfinite(limits).sum()) > 60
    np.testing.assert_array_equal(wait, expected)
    np.testing.assert_allclose(limit, limits, rtol=1e-4, atol=1e-3)
    assert set(np.unique(rows["phase"])) == {UNSIGNALLED, WALK, CLEAR, STOP}
