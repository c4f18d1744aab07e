"""`DropOff`: where its boxes stand, when the hand opens, how episodes end, what is observed, and refused
configurations."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import first_states, one
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, registry
from urbanverse_mjx.envs.navigation.clearance_maps import build_clearance_maps
from urbanverse_mjx.envs.navigation.tasks.boxes import FOOT, HALF_SIDE, INNER
from urbanverse_mjx.envs.navigation.tasks.doorbells import APPROACH, POST_SPACING, STANDOFF
from urbanverse_mjx.envs.navigation.tasks.drop_off import CLEARANCE, DropOff
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.evaluation.doorbell_agent import ParcelDropper
from urbanverse_mjx.evaluation.task_agents import baseline_of, planner_of

OPTIONS: dict[str, Any] = {"vision": False, "scenes": "all", "impl": "warp-fused", "task.posts": 3}
#: m: half a side of the parcel, and from the rim to the floor.
HALF, DEEP = 0.06, 0.25


def made(bank: SceneBank, **overrides: Any) -> NavEnv:
    config = registry.get_default_config("CocoDropOff", "cpu")
    return registry.load_nav_env("CocoDropOff", registry.with_overrides(config, OPTIONS | overrides), bank)


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return made(small_bank)


@pytest.fixture(scope="module")
def task(env: NavEnv) -> DropOff:
    assert isinstance(env.task, DropOff)
    return env.task


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    return first_states(env)


def at(env: NavEnv, nav: Any, place: Any, force: float = 0.0, touch: float = 0.0, opens: bool = False) -> Any:
    """The state after a step that ends with the parcel at `place`: m towards the robot and to the left as seen from the
    box, and above the rim. Its spheres felt `force` N in all and the fingertip `touch` N; `opens` is the action."""
    task: Any = env.task
    middle, facing = (np.asarray(x) for x in task.box(nav))
    aside = np.array([-facing[1], facing[0], 0.0])
    there = middle + place[0] * facing + place[1] * aside + [0.0, 0.0, place[2]]
    felt = np.zeros(len(env.robot.foot_geoms), np.float32)
    felt[task._spheres[:2]], felt[task._finger] = force / 2, touch
    contacts = nav.sim.contacts._replace(foot_force=jnp.asarray(felt), hit=jnp.bool_(False))
    sim = nav.sim._replace(xpos=nav.sim.xpos.at[task.body].set(jnp.asarray(there, jnp.float32)), contacts=contacts)
    after = nav._replace(sim=sim, **task.advance(nav, sim, None))
    return after._replace(last_action=nav.last_action.at[-1].set(1.0 if opens else -1.0))


def let_go(env: NavEnv, nav: Any, place: Any) -> Any:
    """The state in which the hand has just opened at a place."""
    for _ in range(5):
        nav = at(env, nav, place, opens=True)
    assert bool(nav.task.released)
    return nav


def ends(env: NavEnv, nav: Any, before: Result = Result.RUNNING) -> Result:
    return Result(int(env.task.result(nav, jnp.int32(before))))


ABOVE = (0.0, 0.0, CLEARANCE + HALF)
LYING = (0.05, -0.05, HALF - DEEP)


# Boxes and episodes.


def test_boxes_stand_where_the_arm_can_reach_over_them(env: NavEnv, small_bank: SceneBank) -> None:
    """Spacing, heights of rims, free ground on the last line and around the box by the maps of the street without."""
    maps = build_clearance_maps(small_bank, [0, 1, 2], env.robot.planner_height)
    for scene in range(3):
        boxes = np.array(env.bank.meta["boxes"][scene])
        assert 1 <= len(boxes) <= 3
        apart = np.linalg.norm(boxes[:, None, :2] - boxes[None, :, :2], axis=-1) + 1e9 * np.identity(len(boxes))
        assert apart.min() >= POST_SPACING
        clear = np.minimum(maps.to_hull[scene], maps.to_edge[scene]).astype(float)
        for x, y, z, yaw in boxes:
            for out in (0.0, *(HALF_SIDE + np.linspace(STANDOFF, APPROACH, 5))):
                away = np.array([x, y]) + out * np.array([np.cos(yaw), np.sin(yaw)]) - maps.origin[scene]
                i, j = np.floor(away / 0.05).astype(int)
                assert clear[i, j] > (env.robot.planner_radius if out > 0 else 0.4)
                assert 0.5 - 0.05 <= z - maps.ground[scene, i, j] <= 0.85 + 0.05


def test_an_episode_leads_to_the_standoff_with_a_parcel_at_the_hand(env: NavEnv, task: DropOff, begun: Any) -> None:
    low, high = env.config.task.distance
    for scene in range(3):
        for row in range(int(env.bank.num_episodes[scene])):
            x, y, _, yaw = np.asarray(task.boxes.places[scene, task.boxes.nearest[scene, row]])
            facing = np.array([np.cos(yaw), np.sin(yaw)])
            np.testing.assert_allclose(
                env.bank.episode_goal[scene, row, :2], [x, y] + (HALF_SIDE + STANDOFF) * facing, atol=1e-4
            )
            start = env.bank.episode_start[scene, row]
            assert low - 0.1 <= np.linalg.norm(start[:2] - [x, y]) <= high + 0.1
    nav = one(begun)
    tip = nav.sim.xpos[task.reach.hand]
    assert float(jnp.linalg.norm(nav.task.parcel - tip)) < 0.2
    assert not bool(nav.task.released)
    assert float(task.holds(nav)) == 1.0


def test_the_engine_has_five_surfaces_and_a_foot_of_each_box_within_reach(env: NavEnv) -> None:
    """At each standoff they are listed in the cell of the robot: the floor and four walls around the middle."""
    bank = env.bank
    for scene in range(3):
        for number, (x, y, z, yaw) in enumerate(bank.meta["boxes"][scene]):
            facing = np.array([np.cos(yaw), np.sin(yaw)])
            place = np.array([x, y]) + (HALF_SIDE + STANDOFF) * facing
            i, j = np.floor((place - bank.grid_origin[scene]) / float(bank.grid_cell)).astype(int)
            owners = bank.inst_object[scene, bank.hull_grid[scene, i, j][bank.hull_grid[scene, i, j] >= 0]]
            assert f"parcel_box_{number}" in {bank.meta["object_ids"][scene][o] for o in owners}
            rows = bank.prism_grid[scene, i, j][bank.prism_grid[scene, i, j] >= 0]
            rows = rows[np.linalg.norm(bank.prism_position[scene, rows] - [x, y, z], axis=1) < 0.3]
            assert len(rows) == 5
            hulls = bank.prism_hull[scene, rows]
            corners = [
                bank.hull_vertices[h, : bank.hull_num_vertices[h]] + p
                for h, p in zip(hulls, bank.prism_position[scene, rows], strict=True)
            ]
            points = np.concatenate(corners) - [x, y, z]
            aside = np.array([-facing[1], facing[0]])
            for along in (facing, aside):
                reach = points[:, :2] @ along
                np.testing.assert_allclose([reach.min(), reach.max()], [-HALF_SIDE, HALF_SIDE], atol=1e-4)
            np.testing.assert_allclose([points[:, 2].min(), points[:, 2].max()], [-DEEP - 0.06, 0.0], atol=1e-4)
            # No wall begins within the opening.
            walls = np.concatenate([c for c in corners if np.ptp(c[:, 2]) > 0.2]) - [x, y, z]
            assert np.maximum(np.abs(walls[:, :2] @ facing), np.abs(walls[:, :2] @ aside)).min() > INNER - 1e-4
    assert FOOT < HALF_SIDE


def test_the_same_bank_gives_the_same_boxes_and_other_heights_others(env: NavEnv, small_bank: SceneBank) -> None:
    assert made(small_bank).bank.meta["boxes"] == env.bank.meta["boxes"]
    low = made(small_bank, **{"task.height": (0.4, 0.45)})
    for scene in range(3):
        mine, other = (np.array(e.bank.meta["boxes"][scene]) for e in (env, low))
        np.testing.assert_array_equal(mine[:, :2], other[:, :2])
        assert (mine[:, 2] - other[:, 2]).min() > 0.0


# The hand and ends.


def test_the_hand_opens_when_told_for_long_enough_and_never_closes(env: NavEnv, task: DropOff, begun: Any) -> None:
    """Four steps of 0.1 s without a pause; a pause begins anew. The command holds until then."""
    arm = env.robot.arm
    assert arm is not None
    assert env.robot.parcel is not None
    held = list(env.robot.parcel.actuators)
    nav = one(begun)
    for told in (True, True, True, False, True, True, True, True):
        nav = at(env, nav, ABOVE, opens=told)
        assert not bool(nav.task.released)
        np.testing.assert_array_equal(np.asarray(env._control(nav, nav.last_action))[held], 1.0)
    nav = at(env, nav, ABOVE)
    assert bool(nav.task.released)
    assert float(nav.task.height) == pytest.approx(DEEP + CLEARANCE, abs=1e-4)
    for _ in range(3):
        nav = at(env, nav, ABOVE)
        assert float(task.holds(nav)) == 0.0
        np.testing.assert_array_equal(np.asarray(env._control(nav, nav.last_action))[held], 0.0)
    assert env.action_size == 8
    assert float(one(begun).last_action[-1]) == -1.0


def test_latency_neither_holds_nor_drops_by_halves(small_bank: SceneBank) -> None:
    late = made(small_bank, **{"randomization.latency": (0.05, 0.05)})
    nav = one(first_states(late))
    held = list(late.robot.parcel.actuators) if late.robot.parcel else []
    for state, value in ((nav, 1.0), (let_go(late, nav, ABOVE), 0.0)):
        command = np.asarray(late._obeyed(state, jnp.zeros(8)))
        np.testing.assert_array_equal(command[held], value)


def test_a_parcel_that_lies_in_the_box_is_delivered(env: NavEnv, begun: Any) -> None:
    """For half a second, below the rim, and not held; what is too high or outside begins anew."""
    nav = let_go(env, one(begun), ABOVE)
    for _ in range(4):
        nav = at(env, nav, LYING, force=4.9)
        assert ends(env, nav) == Result.RUNNING
    out = at(env, nav, (0.05, 0.0, -0.05), force=4.9)
    assert float(out.task.lain) == 0.0
    nav = at(env, nav, LYING, force=4.9)
    assert ends(env, nav) == Result.GOAL
    assert ends(env, nav, Result.HIT) == Result.HIT
    assert ends(env, nav, Result.TIMEOUT) == Result.GOAL
    held = one(begun)
    for _ in range(7):
        held = at(env, held, LYING)
    assert ends(env, held) == Result.RUNNING, "at the hand, however deep in the box"


@pytest.mark.parametrize(
    ("place", "force", "end"),
    [
        ((HALF_SIDE + 0.01, 0.0, -0.5), 3.0, Result.DROPPED),
        ((0.0, -HALF_SIDE - 0.01, -0.5), 3.0, Result.DROPPED),
        ((0.0, 0.0, -DEEP - 0.1), 3.0, Result.DROPPED),
        ((0.5, 0.0, -0.4), 0.0, Result.RUNNING),
        ((0.5, 0.0, -1.6), 0.0, Result.DROPPED),
        ((INNER, 0.0, 0.05), 3.0, Result.RUNNING),
    ],
)
def test_a_parcel_that_comes_down_elsewhere_is_dropped(
    env: NavEnv, begun: Any, place: Any, force: float, end: Result
) -> None:
    """Beside the box or under it; not in the air, nor on the rim."""
    nav = at(env, let_go(env, one(begun), ABOVE), place, force=force)
    assert ends(env, nav) == end
    held = at(env, one(begun), place, force=force)
    assert ends(env, held) in (Result.RUNNING, Result.HIT)


def test_hand_and_held_parcel_may_touch_nothing_but_the_box(env: NavEnv, begun: Any) -> None:
    nav = one(begun)
    assert ends(env, at(env, nav, (0.3, 0.0, 0.0), force=3.0)) == Result.RUNNING
    assert ends(env, at(env, nav, (0.6, 0.0, 0.0), force=3.0)) == Result.HIT
    assert ends(env, at(env, nav, (0.3, 0.0, 0.0), touch=3.0)) == Result.HIT
    assert ends(env, at(env, nav, (0.3, 0.0, 0.0), touch=0.1)) == Result.RUNNING
    assert ends(env, at(env, nav, (0.3, 0.0, 0.0), touch=3.0), Result.FALL) == Result.FALL


def test_scores_and_rewards(env: NavEnv, task: DropOff, begun: Any) -> None:
    nav = one(begun)
    far, near = at(env, nav, (0.3, 0.4, CLEARANCE + HALF)), at(env, nav, ABOVE, opens=True)
    rewards = {name: float(x) for name, x in task.rewards(far, near).items()}
    assert rewards == {"carry": pytest.approx(0.5, abs=1e-4), "open": 0.0, "spilt": 0.0, "dropped": 0.0}
    # A quarter of the time above the box; the same again is worth nothing.
    told = at(env, near, ABOVE)
    assert float(task.rewards(near, told)["open"]) == pytest.approx(0.25)
    again = at(env, at(env, told, ABOVE, opens=True), ABOVE)
    assert float(task.rewards(told, again)["open"]) == 0.0
    spilt = at(env, at(env, nav, (0.3, 0.0, 0.2), opens=True), (0.3, 0.0, 0.2))
    assert float(task.rewards(nav, spilt)["spilt"]) == 1.0
    assert float(task.rewards(nav, spilt)["open"]) == 0.0
    lying = at(env, let_go(env, nav, ABOVE), LYING)
    assert float(task.rewards(nav, lying)["open"]) == pytest.approx(1.0)
    assert float(task.rewards(let_go(env, nav, ABOVE), lying)["carry"]) == 0.0
    done = lying._replace(result=jnp.int32(Result.GOAL), driven=2.0 * nav.route_length)
    scores = {name: float(x) for name, x in task.scores(done).items()}
    assert scores["score"] == pytest.approx(0.5)
    assert scores["parcel_distance"] == pytest.approx(np.hypot(0.05, 0.05), abs=1e-4)
    assert scores["release_height"] == pytest.approx(DEEP + CLEARANCE, abs=1e-4)
    lost = lying._replace(result=jnp.int32(Result.DROPPED))
    assert float(task.scores(lost)["score"]) == 0.0
    assert float(task.rewards(lying, lost)["dropped"]) == 1.0


def test_captions_say_where_the_parcel_is(env: NavEnv, task: DropOff, begun: Any) -> None:
    nav = one(begun)
    free = let_go(env, nav, ABOVE)
    states = {"holds the parcel": nav, "let go of the parcel": free, "the parcel is in the box": at(env, free, LYING)}
    for words, state in states.items():
        assert task.note({name: float(x) for name, x in task.shown(state).items()}) == words


def test_a_policy_feels_its_hand_and_a_teacher_knows_the_box(env: NavEnv, task: DropOff, begun: Any) -> None:
    nav = at(env, at(env, one(begun), (0.2, 0.0, 0.1), opens=True), (0.2, 0.0, 0.1))
    arm = env.robot.arm
    assert arm is not None
    own = np.concatenate([np.ravel(x) for x in task.proprio(nav)])
    np.testing.assert_allclose(own[:5], np.array(arm.folded) / np.pi, atol=1e-6)
    np.testing.assert_allclose(own[-2:], [1.0, 0.25])
    told = np.asarray(env.observe(nav)["privileged"])[-9:]
    middle, facing = (np.asarray(x) for x in task.box(nav))
    yaw = float(env.bank.episode_start[0, 0, 3])
    into = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    away = into @ (middle[:2] - np.asarray(nav.start[:2]))
    np.testing.assert_allclose(told[:2], np.clip(away / 5.0, -2, 2), atol=1e-3)
    np.testing.assert_allclose(told[2], (middle[2] - float(nav.sim.xpos[1, 2])) / 5.0, atol=1e-4)
    left = np.append(into @ (-0.2 * facing[:2]), CLEARANCE + HALF - 0.1)
    np.testing.assert_allclose(told[3:6] * 0.5, left, atol=1e-3)
    np.testing.assert_allclose(told[6:8], into @ facing[:2], atol=1e-3)
    assert told[8] == 0.0
    free = at(env, let_go(env, one(begun), ABOVE), LYING)
    assert np.asarray(env.observe(free)["privileged"])[-1] == pytest.approx(0.2)


# Whole episodes.


@pytest.mark.extended
def test_the_scripted_expert_delivers_and_one_that_knows_only_the_goal_mostly_drops(env: NavEnv) -> None:
    agents = {"dropper": planner_of(env), baseline_of(env)[0]: baseline_of(env)[1]}
    assert all(isinstance(agent, ParcelDropper) for agent in agents.values())
    results, _ = Rollout(env, chunk=12).run(agents, fixed_episodes(env, 6))
    ended = {name: [r.result for r in results if r.agent == name] for name in agents}
    assert np.mean([end == "goal" for end in ended["dropper"]]) >= 0.8
    assert np.mean([end == "goal" for end in ended["straight_ahead"]]) <= 0.5
    assert "dropped" in ended["straight_ahead"]


@pytest.mark.extended
def test_a_hand_that_opens_at_the_start_drops_the_parcel(env: NavEnv) -> None:
    """Through the engine: it falls beside the robot, and the episode ends by it and not by a hit of the robot."""
    action = jnp.append(one(first_states(env)).last_action[:-1], 1.0)
    step = jax.jit(lambda nav: env.advance(nav, action)[0])
    nav = one(first_states(env))
    for _ in range(15):
        nav = step(nav)
        if int(nav.result):
            break
    assert int(nav.result) == Result.DROPPED
    assert 6 <= int(nav.steps) <= 12
    assert not bool(nav.sim.contacts.hit)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.posts": 0}, "config.task.posts: found 0, needed 1 to 32 in a scene"),
        ({"task.height": (0.5, 1.0)}, "config.task.height: found 0.5 to 1 m"),
        ({"task.distance": (0.5, 3.0)}, "config.task.distance: found 0.5 to 3 m, needed 1.1 <= least < greatest"),
        ({"task.distance": (58.0, 59.0)}, "config.scenes: found no space for a parcel box in 3 scenes"),
        ({"task.release_time": 0.0}, "config.task.release_time: found 0 s"),
        ({"task.lie_time": -1.0}, "config.task.lie_time: found -1 s"),
        ({"action_mode": "joint"}, "config.action_mode: found 'joint' for a robot with a parcel"),
        ({"robot": "coco_arm"}, "robot 'coco_arm': found no parcel, needed an arm that holds one"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        made(small_bank, **overrides)
