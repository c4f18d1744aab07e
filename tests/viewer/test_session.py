"""A session's states are those of stepping the environment; actions of a person, and failures."""

import threading
import time
import types
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from urbanverse_mjx import table_arguments
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavState, default_config
from urbanverse_mjx.evaluation import Rollout
from urbanverse_mjx.evaluation.agents import BASELINES
from urbanverse_mjx.evaluation.planner import Planner, RouteField
from urbanverse_mjx.evaluation.rollouts import EpisodeSet
from urbanverse_mjx.viewer import layers
from urbanverse_mjx.viewer.drive_page import DrivePage
from urbanverse_mjx.viewer.session import Machine, NamedPolicy, Session


@pytest.fixture(scope="module")
def env(small_bank: SceneBank):
    config = default_config("cpu")
    config.unlock()
    config.vision = False
    config.episode_length = 60
    return unicycle_env(small_bank, config)


@pytest.fixture(scope="module")
def machine(env) -> Machine:
    return Machine(env, NamedPolicy("go_to_goal", BASELINES["go_to_goal"]))


@pytest.mark.extended
def test_states_are_those_of_the_environment(env, machine: Machine) -> None:
    session = Session(machine, 1, [3])
    nav = env.begin_at(jax.random.split(jax.random.key(0), 1)[0], jnp.int32(1), jnp.int32(3))
    for _ in range(8):
        frame = session.step()
        goal = env.observe(nav)["goal"]
        nav, *_ = env.advance(nav, goal / jnp.linalg.norm(goal))
        np.testing.assert_allclose(frame.nav.sim.qpos[0], nav.sim.qpos, atol=1e-5)
    assert len(session) == 9
    np.testing.assert_array_equal(session.path(8)[0], np.asarray(session.frames[0].nav.sim.xpos)[0, 1])


@pytest.mark.parametrize("name", ["random", "go_to_goal"])
def test_it_ends_as_an_evaluation_does(env, name: str) -> None:
    """Also for a random agent: the same keys, and an ended episode pauses while others continue."""
    rows = [0, 5, 9]
    session = Session(Machine(env, NamedPolicy(name, BASELINES[name])), 0, rows, seed=7)
    while not session.over:
        session.step()
    results, trajectory = Rollout(env).run(
        {name: BASELINES[name]}, EpisodeSet(np.zeros(3, np.int32), np.array(rows, np.int32), 7)
    )
    last = session.frames[-1].nav
    for robot, result in enumerate(results):
        assert session.outcome(len(session) - 1, robot) == result.result
        assert int(last.steps[robot]) == result.steps
        length = int(trajectory.running[:, robot].sum())
        poses = np.stack([np.asarray(f.nav.sim.xpos)[robot] for f in session.frames[:length]])
        np.testing.assert_allclose(poses, trajectory.xpos[:length, robot], atol=1e-4)


@pytest.mark.extended
def test_the_planner_is_compiled_once_for_all_scenes_and_episodes(env) -> None:
    """Its data have the window of the episode's route, so a shape of their own."""
    planner, traced = Planner(env), []

    class Traced(Planner):
        def act(self, nav: NavState, route: RouteField) -> Any:
            traced.append(route.cost.shape)
            return super().act(nav, route)

    machine = Machine(env, NamedPolicy("planner", Traced(env)))
    places = [(0, 0), (1, 3), (1, 7)]
    windows = {planner.prepare(np.array([scene]), np.array([row])).cost.shape for scene, row in places}
    assert len(windows) > 1
    for scene, row in places:
        Session(machine, scene, [row]).step()
    assert len(traced) == 1


@pytest.mark.extended
def test_the_fields_of_the_planner_are_arguments_of_its_program(env, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of a bank's streets are gigabytes, which a compiler copies and hashes if they are constants."""
    planner, tables = Planner(env), []
    make = table_arguments.Program.__init__

    def recorded(program: Any, *given: Any) -> None:
        make(program, *given)
        tables.extend(program.tables)

    monkeypatch.setattr(table_arguments.Program, "__init__", recorded)
    Session(Machine(env, NamedPolicy("planner", planner)), 0, [0]).step()
    for field in (planner._to_hull, planner._to_edge):
        assert field.values.nbytes > table_arguments.MIN_BYTES
        assert any(table.shape == field.values.shape and bool((table == field.values).all()) for table in tables)


def test_one_of_many_episodes_is_driven_again_by_its_key(env) -> None:
    machine = Machine(env, NamedPolicy("random", BASELINES["random"]))
    episodes = EpisodeSet(np.zeros(3, np.int32), np.array([2, 7, 4], np.int32), 1)
    together = Session(machine, 0, [2, 7, 4], keys=episodes.keys())
    alone = Session(machine, 0, [7], keys=episodes.keys()[1:2])
    for _ in range(5):
        together.step()
        alone.step()
    np.testing.assert_allclose(alone.path(5), together.path(5, 1), atol=1e-5)
    assert np.abs(alone.path(5) - together.path(5, 0)).max() > 0.1


class Counting:
    """Drives straight ahead; counts its calls and the robots in them."""

    observations = ("goal",)

    def __init__(self) -> None:
        self.asked, self.begun = 0, []

    def begin(self, count: int) -> None:
        self.begun.append(count)

    def __call__(self, obs) -> np.ndarray:
        self.asked += 1
        return np.tile([1.0, 0.0], (len(obs["goal"]), 1))


def test_a_person_takes_over_one_robot_and_gives_it_back(env) -> None:
    agent = Counting()
    session = Session(Machine(env, NamedPolicy("straight", agent, outside=True)), 0, [0, 1])
    session.step()
    frame = session.step({1: np.array([0.0, 1.0], np.float32)})
    np.testing.assert_array_equal(frame.action, [[1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_array_equal(frame.by_hand, [False, True])
    after = session.step()
    assert not after.by_hand.any()
    # It is called in every step, because an agent with memory needs all observations.
    assert (agent.asked, agent.begun) == (3, [2])
    turned = np.asarray(frame.nav.sim.qvel)[:, 5]
    assert abs(turned[0]) < 1e-6 < abs(turned[1])


@pytest.mark.parametrize("answer", [np.zeros((1, 3)), np.full((1, 2), np.nan), np.zeros(2)])
def test_wrong_actions_are_refused(env, answer: np.ndarray) -> None:
    session = Session(Machine(env, NamedPolicy("broken", lambda obs: answer, outside=True)), 0, [0])
    with pytest.raises(ValidationError, match="policy 'broken': found actions"):
        session.step()
    assert len(session) == 1


@pytest.mark.parametrize(("scene", "rows"), [(9, [0]), (-1, [0]), (0, []), (0, [10**6])])
def test_scenes_and_episodes_that_there_are_not(machine: Machine, scene: int, rows: list[int]) -> None:
    with pytest.raises(ValidationError, match="needed"):
        Session(machine, scene, rows)


def test_without_a_renderer_there_is_no_picture(machine: Machine) -> None:
    assert Session(machine, 0, [0]).camera_image(0) is None


def test_route_and_goal_lie_where_the_episode_has_them(machine: Machine, small_bank: SceneBank) -> None:
    frame = Session(machine, 2, [4, 1]).frames[0]
    route = layers.route_line(frame, 1)
    number = int(small_bank.episode_num_waypoints[2, 1])
    np.testing.assert_allclose(route[0, :2], small_bank.episode_start[2, 1, :2], atol=1e-6)
    np.testing.assert_allclose(route[1:, :2], small_bank.episode_waypoints[2, 1, :number, :2], atol=1e-6)
    ring = layers.goal_ring(frame, 0, 1.5)
    np.testing.assert_allclose(np.linalg.norm((ring - small_bank.episode_goal[2, 4])[..., :2], axis=-1), 1.5, atol=1e-5)


def test_hulls_in_reach_are_the_nearest_ones(machine: Machine, small_bank: SceneBank) -> None:
    """Against distances from the boxes of all hulls of the scene, without the grid."""
    find = layers.HullsInReach(machine)
    env = machine.env
    reach = env.robot.circumradius + env.robot.max_speed * env.dt
    seen = 0
    start = Session(machine, 0, [0]).frames[0]
    inside = np.flatnonzero(small_bank.inst_hull[0] >= 0)
    for beside in small_bank.inst_position[0, inside[::5]]:
        # Episodes begin away from hulls: the robot is put beside one.
        place = beside.astype(np.float64) + [0.4, 0.3, 0.2]
        sim = start.nav.sim
        frame = start._replace(nav=start.nav._replace(sim=sim._replace(xpos=sim.xpos.at[0, 1].set(jnp.array(place)))))
        near = []
        for i in np.flatnonzero(small_bank.inst_hull[0] >= 0):
            centre, half = small_bank.hull_box[small_bank.inst_hull[0, i]]
            local = (place - small_bank.inst_position[0, i]) @ small_bank.inst_rotation[0, i] - centre
            if np.linalg.norm(np.maximum(np.abs(local) - half, 0.0)) <= reach:
                near.append(i)
        wanted = [
            layers.hull_edges(small_bank, int(small_bank.inst_hull[0, i])) @ small_bank.inst_rotation[0, i].T
            + small_bank.inst_position[0, i]
            for i in near
        ]
        found = find(frame, 0)
        assert found.shape == (sum(map(len, wanted)), 2, 3)
        if near:
            flat = np.sort(np.concatenate(wanted).reshape(-1, 3), axis=0)
            np.testing.assert_allclose(np.sort(found.reshape(-1, 3), axis=0), flat, atol=1e-4)
        seen += len(near)
    assert seen > 5


def test_the_hulls_of_a_touched_object_lie_where_it_is(machine: Machine, small_bank: SceneBank) -> None:
    """Each corner of the object's hulls is the end of an edge, also where the object was pushed and turned."""
    frame = Session(machine, 0, [0, 1]).frames[0]
    slot = int(small_bank.inst_object[0, 0])
    corners = []
    for i in np.flatnonzero(small_bank.inst_object[0] == slot):
        hull = int(small_bank.inst_hull[0, i])
        own = small_bank.hull_vertices[hull, : small_bank.hull_num_vertices[hull]].astype(np.float64)
        corners.append(own @ small_bank.inst_rotation[0, i].T + small_bank.inst_position[0, i])
    home, centre = np.concatenate(corners), small_bank.slot_position[0, slot]

    def edges(hit: bool, touched: int, bodies: object = None) -> np.ndarray:
        contacts = frame.nav.sim.contacts._replace(hit=np.array([False, hit]), hit_object=np.array([-1, touched]))
        sim = frame.nav.sim._replace(contacts=contacts, bodies=bodies)
        found = frame._replace(nav=frame.nav._replace(sim=sim))
        assert layers.touched(small_bank, 0, found, 0).shape == (0, 2, 3)
        return layers.touched(small_bank, 0, found, 1)

    assert edges(False, slot).shape == edges(True, -1).shape == (0, 2, 3)
    assert small_bank.slot_quaternion[0, slot, 0] ** 2 + small_bank.slot_quaternion[0, slot, 3] ** 2 == pytest.approx(1)
    half = np.sqrt(0.5)
    upright = small_bank.slot_quaternion[0, slot]
    turned = half * np.array([upright[0] - upright[3], 0.0, 0.0, upright[0] + upright[3]])  # a quarter to the left
    bodies = types.SimpleNamespace(
        object_index=np.array([[-1, -1], [-1, slot]]),
        position=np.tile(centre + [0.0, 0.0, 1.0], (2, 2, 1)),
        quaternion=np.tile(turned, (2, 2, 1)),
    )
    away = home - centre
    quarter = np.stack([-away[:, 1], away[:, 0], away[:, 2] + 1.0], axis=1) + centre
    for wanted, found in ((home, edges(True, slot)), (quarter, edges(True, slot, bodies))):
        between = np.linalg.norm(wanted[:, None] - found.reshape(1, -1, 3), axis=-1)
        assert between.min(axis=1).max() < 1e-4
        assert between.min(axis=0).max() < 1e-4


def test_edges_of_a_box_are_twelve(small_bank: SceneBank) -> None:
    corners = small_bank.hull_num_vertices == 8
    faces = small_bank.hull_num_triangles == 12
    box = int(np.flatnonzero(corners & faces)[0])
    assert layers.hull_edges(small_bank, box).shape == (12, 2, 3)


def test_two_threads_compile_a_machines_step_one_after_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """The page's thread waits for the one that began as soon as the scene was open, and does not compile again."""
    within, most, calls = [0], [0], [0]

    def busy(*_: Any) -> None:
        calls[0] += 1
        within[0] += 1
        most[0] = max(most[0], within[0])
        time.sleep(0.05)
        within[0] -= 1

    machine = types.SimpleNamespace(
        compiling=threading.Lock(),
        advance=busy,
        act=busy,
        policy=types.SimpleNamespace(outside=False),
        env=types.SimpleNamespace(action_size=2),
    )
    session = Session.__new__(Session)
    session.machine, session.rows, session._compiled = machine, (0,), False  # type: ignore[assignment]
    session.frames = [types.SimpleNamespace(nav=None)]  # type: ignore[list-item]
    session._memory, session._known, session._key = (), (), None  # type: ignore[assignment]
    threads = [threading.Thread(target=session.compile) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(10.0)
    assert most == [1]
    assert calls == [2], "a step and an action, once"


def test_a_page_compiles_before_anyone_plays(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[str] = []
    done = threading.Event()

    def compile_step() -> None:
        compiled.append(threading.current_thread().name)
        done.set()

    page = DrivePage.__new__(DrivePage)
    page._stopped, page.playing = False, False
    page.session = types.SimpleNamespace(compile=compile_step)  # type: ignore[assignment]
    for name in ("_obey", "_notice_headset", "_command"):
        monkeypatch.setattr(page, name, lambda: None)
    end = time.monotonic() + 10.0
    page.run(lambda: done.is_set() or time.monotonic() > end)
    assert compiled == ["compile"], "once, in a thread of its own"
