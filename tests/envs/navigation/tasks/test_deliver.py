"""`Deliver`: where its posts stand, how a press is counted, how episodes end, what is observed, and refused
configurations."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.task_figures import check_task
from tests.support.unicycle import first_states, one
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.ground import GROUND_KINDS
from urbanverse_mjx.envs import NavEnv, Result, registry
from urbanverse_mjx.envs.navigation.clearance_maps import build_clearance_maps
from urbanverse_mjx.envs.navigation.tasks.deliver import NEAR, Deliver
from urbanverse_mjx.envs.navigation.tasks.doorbells import APPROACH, POST_SPACING, STANDOFF, START_ANGLE
from urbanverse_mjx.envs.navigation.tasks.posts import CAP_RADIUS, DEPTH, HALF_SIDE
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.evaluation.agents import zero
from urbanverse_mjx.evaluation.doorbell_agent import DoorbellPresser
from urbanverse_mjx.evaluation.planner import waypoint_of
from urbanverse_mjx.evaluation.task_agents import baseline_of, planner_of
from urbanverse_mjx.robots import make_coco_arm

#: m, from the rear axle, which turns on the spot, to the robot's origin.
PIVOT = 0.235
OPTIONS: dict[str, Any] = {"vision": False, "scenes": "all", "impl": "warp-fused", "task.posts": 3}


def made(bank: SceneBank, **overrides: Any) -> NavEnv:
    config = registry.get_default_config("CocoDeliver", "cpu")
    return registry.load_nav_env("CocoDeliver", registry.with_overrides(config, OPTIONS | overrides), bank)


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return made(small_bank)


@pytest.fixture(scope="module")
def task(env: NavEnv) -> Deliver:
    assert isinstance(env.task, Deliver)
    return env.task


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    return first_states(env)


def test_figures_of_the_task(env: NavEnv, begun: Any) -> None:
    check_task(env, begun)


def touching(env: NavEnv, nav: Any, away: float, force: float, hit: bool = False) -> Any:
    """The state after a step that ends with the fingertip `away` m before the button, which felt `force` N."""
    task: Any = env.task
    middle, facing = task.button(nav)
    hand, turn = task.reach.hand, nav.sim.xquat[task.reach.hand]
    place = middle + (task.radius + away) * facing - jnp.array(_turned(np.asarray(turn), np.asarray(task.reach.tip)))
    felt = nav.sim.contacts.foot_force.at[-1].set(force)
    contacts = nav.sim.contacts._replace(foot_force=felt, hit=jnp.bool_(hit))
    sim = nav.sim._replace(xpos=nav.sim.xpos.at[hand].set(place), contacts=contacts)
    return nav._replace(sim=sim, **task.advance(nav, sim, None))


def _turned(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    w, axis = quaternion[0], quaternion[1:]
    return vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)


def ends(env: NavEnv, nav: Any, before: Result = Result.RUNNING) -> Result:
    return Result(int(env.task.result(nav, jnp.int32(before))))


# Posts and episodes.


def test_posts_stand_where_the_robot_can_reach_their_buttons(env: NavEnv, small_bank: SceneBank) -> None:
    """Spacing, heights, free ground on the last line by the maps of the street without posts, and level ground."""
    maps = build_clearance_maps(small_bank, [0, 1, 2], env.robot.planner_height)
    for scene in range(3):
        buttons = np.array(env.bank.meta["buttons"][scene])
        assert 1 <= len(buttons) <= 3
        feet = buttons[:, :2] - (HALF_SIDE + DEPTH) * np.stack([np.cos(buttons[:, 3]), np.sin(buttons[:, 3])], -1)
        apart = np.linalg.norm(feet[:, None] - feet[None], axis=-1) + 1e9 * np.identity(len(feet))
        assert apart.min() >= POST_SPACING
        clear = np.minimum(maps.to_hull[scene], maps.to_edge[scene]).astype(float)
        side = float(small_bank.map_resolution)
        for x, y, z, yaw in buttons:
            for out in (-HALF_SIDE - DEPTH, *np.linspace(STANDOFF, APPROACH, 5)):
                away = np.array([x, y]) + out * np.array([np.cos(yaw), np.sin(yaw)]) - maps.origin[scene]
                i, j = np.floor(away / 0.05).astype(int)
                assert clear[i, j] > (env.robot.planner_radius if out > 0 else 0.25)
                kind = GROUND_KINDS[small_bank.map_kind[scene][tuple(np.floor(away / side).astype(int))]]
                assert kind == "sidewalk", "and on no crosswalk"
            assert 0.9 - 0.05 <= z - maps.ground[scene, i, j] <= 1.2 + 0.05


def test_an_episode_leads_from_a_start_within_the_distances_to_the_standoff(env: NavEnv, task: Deliver) -> None:
    low, high = env.config.task.distance
    for scene in range(3):
        for row in range(int(env.bank.num_episodes[scene])):
            x, y, _, yaw = np.asarray(task.buttons.places[scene, task.buttons.nearest[scene, row]])
            facing = np.array([np.cos(yaw), np.sin(yaw)])
            start, goal = env.bank.episode_start[scene, row], env.bank.episode_goal[scene, row, :2]
            np.testing.assert_allclose(goal, [x, y] + STANDOFF * facing, atol=1e-4)
            first = env.bank.episode_waypoints[scene, row, 0, :2]
            np.testing.assert_allclose(first, [x, y] + APPROACH * facing, atol=1e-4)
            assert low - 0.1 <= np.linalg.norm(start[:2] - [x, y]) <= high + 0.1
            offset = first - start[:2]
            angle = np.arctan2(offset[1], offset[0]) - start[3]
            assert abs(np.arctan2(np.sin(angle), np.cos(angle))) <= START_ANGLE + 1e-4


def test_the_same_bank_gives_the_same_posts_and_other_heights_others(env: NavEnv, small_bank: SceneBank) -> None:
    again = made(small_bank)
    assert again.bank.meta["buttons"] == env.bank.meta["buttons"]
    low = made(small_bank, **{"task.height": (0.4, 0.5)})
    for scene in range(3):
        mine, other = (np.array(e.bank.meta["buttons"][scene]) for e in (env, low))
        np.testing.assert_array_equal(mine[:, :2], other[:, :2])
        assert (mine[:, 2] - other[:, 2]).min() > 0.3


def test_the_engine_finds_every_post_within_reach(env: NavEnv, task: Deliver) -> None:
    """At each standoff the post and its cap are listed in the cell of the robot."""
    bank = env.bank
    for scene in range(3):
        for number, (x, y, _, yaw) in enumerate(bank.meta["buttons"][scene]):
            place = np.array([x, y]) + STANDOFF * np.array([np.cos(yaw), np.sin(yaw)])
            i, j = np.floor((place - bank.grid_origin[scene]) / float(bank.grid_cell)).astype(int)
            owners = bank.inst_object[scene, bank.hull_grid[scene, i, j][bank.hull_grid[scene, i, j] >= 0]]
            names = {bank.meta["object_ids"][scene][o] for o in owners}
            assert f"doorbell_{number}" in names
            caps = bank.prism_position[scene, bank.prism_grid[scene, i, j][bank.prism_grid[scene, i, j] >= 0]]
            front = np.array([x, y]) - DEPTH * np.array([np.cos(yaw), np.sin(yaw)])
            assert np.linalg.norm(caps[:, :2] - front, axis=1).min() < 1e-4


# Presses and ends.


def test_a_press_of_the_time_rings(env: NavEnv, task: Deliver, begun: Any) -> None:
    """Two control steps of 0.1 s with 5 N; a weaker step in between begins anew."""
    nav = one(begun)
    first = touching(env, nav, 0.0, 5.1)
    assert ends(env, first) == Result.RUNNING
    assert ends(env, touching(env, first, 0.0, 5.1)) == Result.GOAL
    weak = touching(env, first, 0.0, 4.9)
    assert float(weak.task.held) == 0.0
    assert ends(env, touching(env, weak, 0.0, 9.0)) == Result.RUNNING
    assert float(touching(env, weak, 0.0, 1.0).task.greatest) == pytest.approx(5.1)


def test_what_else_is_hit_meanwhile_spoils_the_press(env: NavEnv, begun: Any) -> None:
    nav = touching(env, one(begun), 0.0, 8.0, hit=True)
    assert float(nav.task.force) == float(nav.task.held) == 0.0
    twice = touching(env, touching(env, one(begun), 0.0, 8.0), 0.0, 8.0)
    assert ends(env, twice, Result.HIT) == Result.HIT
    assert ends(env, twice, Result.TIMEOUT) == Result.GOAL


def test_a_fingertip_that_touches_elsewhere_ends_the_episode(env: NavEnv, begun: Any) -> None:
    """The ground or another button; without contacts that end episodes it goes on."""
    nav = touching(env, one(begun), NEAR + 0.05, 3.0)
    assert float(nav.task.force) == 0.0
    assert ends(env, nav) == Result.HIT
    assert ends(env, touching(env, one(begun), NEAR + 0.05, 0.1)) == Result.RUNNING


def test_scores_and_rewards(env: NavEnv, task: Deliver, begun: Any) -> None:
    nav = one(begun)
    far, near = touching(env, nav, 0.3, 0.0), touching(env, nav, 0.1, 2.5)
    rewards = {name: float(x) for name, x in task.rewards(far, near).items()}
    assert rewards == {"reach": pytest.approx(0.2, abs=1e-4), "press": pytest.approx(0.5)}
    rang = near._replace(result=jnp.int32(Result.GOAL), driven=2.0 * nav.route_length)
    scores = {name: float(x) for name, x in task.scores(rang).items()}
    assert scores["score"] == pytest.approx(0.5)
    assert scores["press_force"] == pytest.approx(2.5)
    assert scores["tip_distance"] == pytest.approx(0.1, abs=1e-4)
    assert float(task.scores(near._replace(result=jnp.int32(Result.TIMEOUT)))["score"]) == 0.0


def test_a_policy_feels_its_arm_and_a_teacher_knows_the_button(env: NavEnv, task: Deliver, begun: Any) -> None:
    nav = touching(env, one(begun), 0.2, 2.5)
    obs = env.observe(nav)
    arm = env.robot.arm
    assert arm is not None
    (own,) = [np.concatenate([np.ravel(x) for x in task.proprio(nav)])]
    np.testing.assert_allclose(own[:5], np.array(arm.folded) / np.pi, atol=1e-6)
    assert own[-1] == pytest.approx(0.5)
    told = np.asarray(obs["privileged"])[-9:]
    middle, facing = (np.asarray(x) for x in task.button(nav))
    yaw = float(nav.start[2] * 0) + float(env.bank.episode_start[0, 0, 3])
    into = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    away = into @ (middle[:2] - np.asarray(nav.start[:2]))
    np.testing.assert_allclose(told[:2], np.clip(away / 5.0, -2, 2), atol=1e-3)
    np.testing.assert_allclose(told[2], (middle[2] - float(nav.sim.xpos[1, 2])) / 5.0, atol=1e-4)
    np.testing.assert_allclose(told[3:6] * 0.5, np.append(into @ (-0.2 * facing[:2]), 0.0), atol=1e-3)
    np.testing.assert_allclose(told[6:8], into @ facing[:2], atol=1e-3)
    assert env.observation_size["goal"] == (2,)


# Actions.


def test_an_arms_targets_are_limited_by_its_speed_and_the_ends_of_its_joints(
    env: NavEnv, task: Deliver, begun: Any
) -> None:
    nav, arm = one(begun), env.robot.arm
    assert arm is not None
    assert env.action_size == 7
    low, high, now = (np.asarray(x) for x in (task.reach.low, task.reach.high, nav.sim.qpos[task.reach.addresses]))
    for sign in (-1.0, 1.0):
        command = np.asarray(env._control(nav, jnp.array([0.0, 0.0, *[sign] * 5])))[list(arm.actuators)]
        end = low if sign < 0 else high
        step = np.minimum(np.abs(end - now), arm.speed * env.dt)
        np.testing.assert_allclose(command, now + sign * step, atol=1e-5)
    still = np.asarray(env._control(nav, nav.last_action))
    np.testing.assert_allclose(still[list(arm.actuators)], arm.folded, atol=1e-5)


def test_an_agent_for_a_base_alone_is_refused_in_a_sentence(env: NavEnv, begun: Any) -> None:
    with pytest.raises(ValidationError, match="action: found 2 numbers, needed 7 for the robot 'coco_arm'"):
        env.advance(one(begun), zero({}, jax.random.key(0)))


# Whole episodes.


@pytest.mark.extended
def test_the_scripted_expert_rings_and_one_that_does_not_know_the_height_mostly_does_not(env: NavEnv) -> None:
    agents = {"presser": planner_of(env), baseline_of(env)[0]: baseline_of(env)[1]}
    assert all(isinstance(agent, DoorbellPresser) for agent in agents.values())
    results, _ = Rollout(env, chunk=12).run(agents, fixed_episodes(env, 6))
    rang = {name: [r.result == "goal" for r in results if r.agent == name] for name in agents}
    assert np.mean(rang["presser"]) >= 0.8
    assert np.mean(rang["fixed_height"]) <= 0.5
    assert CAP_RADIUS < 0.5 * (1.2 - 0.9), "or a fixed height would ring everywhere"


def base_by_hand(before: float, beside: float, turn: float, max_speed: float, max_turn: float) -> tuple[float, float]:
    """Speed and yaw rate of the expert with a folded arm whose axle is so many metres before its place and beside the
    last line (left as seen from the button), and that has to turn so many radians to face the button."""
    if before < 0.04 and abs(turn) < 0.1:
        return 0.0, 0.0
    line = APPROACH - STANDOFF - PIVOT  # of the axle's place, from where the last line begins
    if abs(beside) < 0.15 and before < line + 0.15:
        error = turn + (float(np.clip(1.5 * beside, -0.3, 0.3)) if before > 0.04 else 0.0)
        speed = float(np.clip(before, 0.0, 0.4)) if before >= 0.02 else 0.0
    else:
        # As seen by who faces the button: left of it is what was right.
        ahead, left = before - line, beside
        error = float(np.angle(np.exp(1j * (np.arctan2(left, ahead) + turn))))
        speed = float(np.hypot(ahead, left)) + 0.1
    speed = 0.0 if abs(error) > 0.35 else speed * np.cos(error)
    return min(speed, max_speed), float(np.clip(1.2 * error, -1.0, 1.0)) * max_turn


def test_the_expert_drives_to_the_line_and_along_it(env: NavEnv, task: Deliver, begun: Any) -> None:
    """Its base from places all around the button, against the same rules in the button's frame."""
    agent, nav = DoorbellPresser(env), one(begun)
    (x, y, _), facing = (np.asarray(v) for v in task.button(nav))
    heading = np.arctan2(facing[1], facing[0])
    robot, root = env.robot, agent._root
    rows = [
        (b, s, t)
        for b in (-0.1, 0.01, 0.1, 0.3, 0.7, 2.0)
        for s in (-0.6, -0.1, 0.0, 0.05, 0.4)
        for t in (-1.0, -0.22, 0.05, 0.3, 2.5)
    ]

    def action(row: Any) -> Any:
        before, beside, turn = row
        yaw = heading + np.pi - turn
        axle_out = STANDOFF + PIVOT + before  # from the button's surface
        axle = jnp.array([x + axle_out * facing[0] - beside * facing[1], y + axle_out * facing[1] + beside * facing[0]])
        place = axle + PIVOT * jnp.stack([jnp.cos(yaw), jnp.sin(yaw)])
        sim = nav.sim._replace(
            xpos=nav.sim.xpos.at[root, :2].set(place),
            xquat=nav.sim.xquat.at[root].set(jnp.stack([jnp.cos(yaw / 2), 0.0 * yaw, 0.0 * yaw, jnp.sin(yaw / 2)])),
            qpos=nav.sim.qpos.at[agent._reach.addresses].set(agent._folded),
            qvel=jnp.zeros_like(nav.sim.qvel),
        )
        return agent.act(nav._replace(sim=sim))

    found = np.asarray(jax.jit(jax.vmap(action))(jnp.array(rows)))
    for row, one_action in zip(rows, found, strict=True):
        v, omega = base_by_hand(*row, robot.max_speed, robot.max_yaw_rate)
        expected = np.clip(waypoint_of(v, omega, robot.max_speed, env.dt), -1.0, 1.0)
        np.testing.assert_allclose(one_action[:2], expected, atol=2e-4, err_msg=str(row))


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.posts": 0}, "config.task.posts: found 0, needed 1 to 32 in a scene"),
        ({"task.height": (1.0, 1.5)}, "config.task.height: found 1 to 1.5 m"),
        ({"task.distance": (0.5, 3.0)}, "config.task.distance: found 0.5 to 3 m, needed 1.1 <= least < greatest"),
        ({"task.distance": (58.0, 59.0)}, "config.scenes: found no space for a doorbell in 3 scenes"),
        ({"task.force": 0.0}, "config.task.force: found 0 N"),
        ({"task.hold_time": 0.0}, "config.task.hold_time: found 0 s"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        made(small_bank, **overrides)


def test_a_robot_without_an_arm_is_refused(small_bank: SceneBank) -> None:
    with pytest.raises(ValidationError, match="robot 'wheelchair': found no arm"):
        made(small_bank, robot="wheelchair")


def test_the_robot_keeps_its_arm_folded_for_other_tasks() -> None:
    robot = make_coco_arm()
    command = np.asarray(robot.command(np.array([0.5, 0.2])))
    assert robot.arm is not None
    np.testing.assert_allclose(command[list(robot.arm.actuators)], robot.arm.folded, atol=1e-6)
    assert robot.foot_geoms[-1] == robot.arm.tip
