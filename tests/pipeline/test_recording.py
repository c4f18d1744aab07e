"""`pipeline.record`: rows and images are those of driving the same episodes, and a second run gives the same files."""

import dataclasses
import errno
import json
import os
import pathlib
import types
from collections.abc import Mapping
from typing import Any

import cv2
import jax
import jax.numpy as jnp
import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.support.heard_progress import noted
from tests.support.recorded import write_dataset
from tests.support.unicycle import UnicycleEngine, unicycle_env
from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datatypes import SceneBank, SimState, ValidationError
from urbanverse_mjx.envs import NavEnv
from urbanverse_mjx.envs.navigation.draws import OFF
from urbanverse_mjx.evaluation import BASELINES, Rollout
from urbanverse_mjx.evaluation.rollouts import EpisodeSet
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.pipeline import machines
from urbanverse_mjx.pipeline.errors import naming, refusal
from urbanverse_mjx.pipeline.recording import cameras, driving, readings
from urbanverse_mjx.pipeline.recording.action_noise import ActionNoise
from urbanverse_mjx.pipeline.recording.cameras import FRONT, numbered
from urbanverse_mjx.pipeline.recording.driving import BatchDrive, Driven, drawn_episodes
from urbanverse_mjx.pipeline.recording.record import RecordOptions
from urbanverse_mjx.progress import Progress
from urbanverse_mjx.simulation.rendering.renderer import Renderer
from urbanverse_mjx.viewer.session import Machine, NamedPolicy

SIZE = (24, 32)
STEPS, BODIES = 12, 7
OPTIONS = RecordOptions(
    policy="random",
    num_episodes=5,
    num_envs=3,
    scenes="all",
    size=SIZE,
    sensors=("depth", "segmentation", "normal"),
    quiet=True,
)


class DrawnEngine(UnicycleEngine):
    """The kinematic engine with all bodies that the renderer draws, each in the pose of the robot."""

    def _state(self, *args: Any, **options: Any) -> SimState:
        state = super()._state(*args, **options)
        rows = np.minimum(np.arange(BODIES), 1)
        contacts = state.contacts._replace(foot_force=jnp.zeros(4))
        return state._replace(xpos=state.xpos[rows], xquat=state.xquat[rows], contacts=contacts)


def drawn_env(bank: SceneBank, overrides: dict[str, Any]) -> NavEnv:
    env = unicycle_env(bank, {"terminate_off_traversable": False, "randomization": OFF, **overrides})
    return NavEnv(env.config, bank, env.robot, DrawnEngine(env.robot, env.config.ctrl_dt), None)


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return drawn_env(small_bank, {"episode_length": STEPS})


@pytest.fixture(scope="module")
def notes() -> list[tuple[str, str | None]]:
    """What the recording says of its progress."""
    return []


@pytest.fixture(scope="module")
def recorded(
    env: NavEnv, tmp_path_factory: pytest.TempPathFactory, notes: list[tuple[str, str | None]]
) -> tuple[pathlib.Path, dict[str, Any]]:
    with pytest.MonkeyPatch.context() as patch:
        use(env, patch)
        patch.setattr(Progress, "task", noted(notes))
        folder = tmp_path_factory.mktemp("recorded") / "new"
        return folder, pipeline.record(folder, OPTIONS)


def use(env: NavEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets recordings drive in a kinematic environment."""

    def load(policy: str, *_: Any) -> Machine:
        return Machine(env, NamedPolicy(policy, BASELINES[policy]))

    monkeypatch.setattr(machines, "load_machine", load)
    monkeypatch.setattr("urbanverse_mjx.pipeline.training_run.bank_of", lambda *_: env.bank)


def table_of(folder: pathlib.Path) -> dict[str, list[Any]]:
    return pq.read_table(folder / "data/chunk-000/file-000.parquet").to_pydict()


@pytest.mark.extended
def test_it_is_sound_and_says_what_it_holds(recorded: tuple[pathlib.Path, dict[str, Any]], env: NavEnv) -> None:
    folder, said = recorded
    found = pipeline.check_dataset(folder)
    assert (found.problems, found.notes) == ((), ())
    assert (said["episodes"], said["frames"]) == (found.episodes, found.frames) == (5, 5 * STEPS)
    summary = pipeline.summarise_dataset(folder)
    assert said["results"] == summary.results == {"timeout": 5}
    assert sorted(summary.scenes.values()) == [1, 2, 2]
    assert summary.frames_per_second == 5
    origin = json.loads((folder / "meta/urbanverse.json").read_text())
    assert origin["policy"] == "random"
    assert origin["semantic"][:2] == ["sky", "robot"]
    assert set(origin["instance"]) == set(env.bank.scene_ids)


@pytest.mark.usefixtures("recorded")
def test_it_says_that_its_program_compiles_and_when_it_is_done(notes: list[tuple[str, str | None]]) -> None:
    assert notes[:2] == [("recording", "compiling"), ("recording", "")]
    assert ("recording", f"{5 * STEPS} frames") in notes


@pytest.mark.extended
def test_rows_are_those_of_a_rollout(recorded: tuple[pathlib.Path, dict[str, Any]], env: NavEnv) -> None:
    """The same random actions and poses as an evaluation's, and the rewards of stepping the environment."""
    rows, order = table_of(recorded[0]), drawn_episodes(env.bank, env.scenes, 5, 0)
    _, trajectory = Rollout(env).run({"random": BASELINES["random"]}, order)
    begin, observe, advance = (jax.jit(x) for x in (env.begin_at, env.observe, env.advance))
    for k in range(5):
        part = slice(k * STEPS, (k + 1) * STEPS)
        assert set(rows["scene_index"][part]) == {int(order.scenes[k])}
        assert set(rows["episode_row"][part]) == {int(order.episodes[k])}
        poses = np.array(rows["pose"][part])
        np.testing.assert_allclose(poses[:, :3], trajectory.xpos[:STEPS, k, 1], atol=1e-4)
        np.testing.assert_allclose(poses[:, 3:], trajectory.xquat[:STEPS, k, 1], atol=1e-5)
        nav = begin(order.keys()[k], jnp.int32(order.scenes[k]), jnp.int32(order.episodes[k]))
        for t in range(STEPS):
            np.testing.assert_allclose(rows["observation.environment_state"][part][t], observe(nav)["goal"], atol=1e-4)
            state = np.array(rows["observation.state"][part][t])
            np.testing.assert_allclose(state[3:], nav.last_action, atol=1e-6)
            nav, reward, done, _ = advance(nav, jnp.array(rows["action"][part][t]))
            assert rows["next.reward"][part][t] == pytest.approx(float(reward), rel=1e-4, abs=1e-4)
            assert rows["next.done"][part][t] == bool(done)
            # The speed of a step is that of the state after it.
            if t + 1 < STEPS:
                speed = np.array(rows["observation.state"][part][t + 1])[:3]
                np.testing.assert_allclose(speed[2], nav.sim.qvel[5], atol=1e-5)


@pytest.mark.extended
def test_images_are_those_of_the_rows_poses(recorded: tuple[pathlib.Path, dict[str, Any]], env: NavEnv) -> None:
    folder = recorded[0]
    rows, view = table_of(folder), env.config.vision_config
    outputs = ("rgb", "depth", "category", "object", "normal")
    looks = {name: view[name] for name in ("shadows", "sky", "shading", "light")}
    renderer = Renderer(env.bank, env.robot, *SIZE, outputs, **looks)
    capture, colours = cv2.VideoCapture(str(folder / f"videos/{FRONT}/chunk-000/file-000.mp4")), []
    while (frame := capture.read())[0]:
        colours.append(frame[1][..., ::-1])
    assert len(colours) == 5 * STEPS
    for k in (0, 17, 31, 59):
        pose = np.array(rows["pose"][k], np.float32)
        xpos, xquat = np.zeros((BODIES, 3), np.float32), np.tile(np.identity(4, dtype=np.float32)[0], (BODIES, 1))
        xpos[1:], xquat[1:] = pose[:3], pose[3:]
        drawn = {name: np.asarray(x) for name, x in renderer(rows["scene_index"][k], xpos, xquat).items()}
        for sensor in ("depth", "semantic", "instance"):
            name, output, offset = cameras.SENSORS[sensor]
            stored = cv2.imdecode(np.frombuffer(rows[name][k]["bytes"], np.uint8), cv2.IMREAD_UNCHANGED)
            assert stored is not None
            assert stored.dtype == np.uint16
            np.testing.assert_array_equal(stored, numbered(drawn[output], offset))
        assert np.abs(colours[k].astype(int) - drawn["rgb"]).mean() < 8
        check_normals(rows[cameras.SENSORS["normal"][0]][k]["bytes"], drawn, camera_turn(env, xpos, xquat))


def camera_turn(env: NavEnv, xpos: np.ndarray, xquat: np.ndarray) -> np.ndarray:
    """R_world_camera with the axes of computer vision."""
    turn = readings.camera_pose(env.mj_model, env.robot.camera, xpos[None], xquat[None])[1][0]
    return rotations.matrix_f64(turn) @ np.diag([1.0, -1.0, -1.0])


def check_normals(stored: bytes, drawn: dict[str, np.ndarray], turn: np.ndarray) -> None:
    """The stored colours are the world's normals turned into the camera's frame, and face the camera on the ground."""
    image = cv2.imdecode(np.frombuffer(stored, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    normals, surface = (image[..., ::-1].astype(float) - 128.0) / 127.0, drawn["object"] >= 0
    np.testing.assert_allclose(normals[surface], drawn["normal"][surface] @ turn, atol=0.5 / 127 + 1e-4)
    assert (normals[drawn["object"] == -1] == 0.0).all()
    ground = surface & (drawn["normal"][..., 2] > 0.999)
    assert ground.any()
    assert (normals[ground][:, 1] < -0.9).all()


def test_distances_are_millimetres_and_labels_begin_at_the_sky() -> None:
    assert numbered(np.array([[0.0, 1.2345, 70.0]], np.float32), 0).tolist() == [[0, 1234, 65535]]
    assert numbered(np.array([[-1, -2, 0, 7]]), cameras.SENSORS["semantic"][2]).tolist() == [[0, 1, 2, 9]]
    assert numbered(np.array([[-1, -2, -3, -4, 0]]), cameras.SENSORS["instance"][2]).tolist() == [[0, 1, 2, 2, 3]]


@pytest.mark.extended
def test_the_same_command_gives_the_same_bytes(
    recorded: tuple[pathlib.Path, dict[str, Any]], env: NavEnv, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use(env, monkeypatch)
    pipeline.record(tmp_path / "again", OPTIONS)
    names = sorted(p.relative_to(recorded[0]) for p in recorded[0].rglob("*") if p.is_file())
    assert len(names) == 7
    assert [n for n in names if (recorded[0] / n).read_bytes() != (tmp_path / "again" / n).read_bytes()] == []


@pytest.mark.extended
def test_a_continued_recording_is_that_of_one_command(
    recorded: tuple[pathlib.Path, dict[str, Any]], env: NavEnv, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use(env, monkeypatch)
    folder, more = tmp_path / "new", dataclasses.replace(OPTIONS, resume=True)
    pipeline.record(folder, dataclasses.replace(more, num_episodes=2))
    said = pipeline.record(folder, more)
    assert (said["resumed"], said["episodes"], said["frames"]) == (2, 5, 5 * STEPS)
    assert said["results"] == {"timeout": 3}
    names = sorted(p.relative_to(recorded[0]) for p in recorded[0].rglob("*") if p.is_file())
    assert sorted(p.relative_to(folder) for p in folder.rglob("*") if p.is_file()) == names
    assert [n for n in names if (recorded[0] / n).read_bytes() != (folder / n).read_bytes()] == []
    changes: list[tuple[dict[str, Any], str]] = [
        ({"num_episodes": 4}, "--resume: found 4 episodes without the recorded episode 4"),
        ({"seed": 1}, "--resume: found seed 1, needed 0 as in"),
        ({"size": (24, 40)}, "--resume: found another observation.images.depth, .*front"),
        ({"only_successes": True}, "--resume: found only_successes True, needed None"),
        ({"format": "kitti", "sensors": ()}, "found no file episodes.json, needed a recording of this --format"),
    ]
    for change, message in changes:
        with pytest.raises(ValidationError, match=message):
            pipeline.record(folder, dataclasses.replace(more, **change))
    assert [n for n in names if (recorded[0] / n).read_bytes() != (folder / n).read_bytes()] == []


@pytest.mark.extended
def test_another_policy_under_the_same_path_does_not_continue_it(
    env: NavEnv, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor the same one outside JAX in batches of another size."""
    use(env, monkeypatch)
    options = dataclasses.replace(OPTIONS, policy="p.onnx", num_episodes=2, num_envs=2, sensors=(), resume=True)

    def record(sha256: str, **changes: Any) -> dict[str, Any]:
        policy = NamedPolicy("p.onnx", Straight(), outside=True, loaded="p.onnx", sha256=sha256)
        monkeypatch.setattr(machines, "load_machine", lambda *_: Machine(env, policy))
        return pipeline.record(tmp_path / "new", dataclasses.replace(options, **changes))

    record("a" * 64)
    with pytest.raises(ValidationError, match=r"--resume: found --policy 'p.onnx' with the content of 'p.onnx' \(SHA"):
        record("b" * 64)
    for num_envs, num_episodes, found in ((1, 2, 1), (3, 3, 3)):
        with pytest.raises(ValidationError, match=f"--resume: found num_envs {found}, needed 2 as in"):
            record("a" * 64, num_envs=num_envs, num_episodes=num_episodes)
    assert record("a" * 64)["resumed"] == 2


@pytest.mark.extended
def test_only_successes_leaves_the_others_out(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Within the time that half of the episodes need at 2 m/s and 5 Hz."""
    drawn = drawn_episodes(small_bank, np.arange(3), 9, 0)
    offset = small_bank.episode_goal - small_bank.episode_start[..., :3]
    steps = int(np.median(np.linalg.norm(offset[drawn.scenes, drawn.episodes, :2], axis=-1)) / 0.4)
    use(drawn_env(small_bank, {"episode_length": steps}), monkeypatch)
    options = dataclasses.replace(OPTIONS, policy="go_to_goal", num_episodes=9, sensors=(), only_successes=True)
    said = pipeline.record(tmp_path / "new", options)
    assert 0 < said["episodes"] == said["results"]["goal"] < 9
    rows = table_of(tmp_path / "new")
    assert sum(rows["next.success"]) == sum(rows["next.done"]) == said["episodes"]
    assert pipeline.check_dataset(tmp_path / "new").problems == ()
    # Continued in the middle, after an episode that reached its goal; those that did not are driven again.
    for count in (5, 9):
        pipeline.record(tmp_path / "two", dataclasses.replace(options, num_episodes=count, resume=True))
    assert table_of(tmp_path / "two") == rows
    use(drawn_env(small_bank, {"episode_length": 2}), monkeypatch)
    with pytest.raises(ValidationError, match="--only-successes: found none among 9 episodes"):
        pipeline.record(tmp_path / "none", options)
    assert not (tmp_path / "none").exists()


def driven(
    env: NavEnv,
    policy: NamedPolicy,
    episodes: EpisodeSet,
    num_envs: int,
    first: int = 0,
    noise: ActionNoise | None = None,
) -> list[Driven]:
    drive = BatchDrive(Machine(env, policy), noise)
    return [e for part in drive.run(episodes, num_envs, first=first) for e in part]


class Counting:
    """A policy that remembers how often it was asked."""

    def first_memory(self) -> Any:
        return jnp.float32(0.0)

    def act(self, obs: Mapping[str, Any], memory: Any, key: Any) -> tuple[Any, Any]:
        del obs, key
        return jnp.stack([0.5 + 0.02 * memory, 0.3 * jnp.sin(memory)]), memory + 1.0


class Informed:
    """A policy that receives the episode it drives."""

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """As wide as its episodes need, like the planner's fields."""
        return np.pad(np.stack([scenes, rows % 10], axis=1) / 10.0, ((0, 0), (0, int(rows.max()) % 7)))

    def act(self, nav: Any, known: Any) -> Any:
        del nav
        return jnp.asarray([0.5, 0.0]) + known[:2] * jnp.asarray([0.1, 0.4])


@pytest.mark.extended
@pytest.mark.parametrize("agent", [Counting(), Informed()], ids=["counting", "informed"])
def test_an_env_that_begins_the_next_episode_drives_as_a_new_one(
    small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch, agent: Any
) -> None:
    """Episodes of different lengths, two at a time and each alone: the same steps, in the same order."""
    monkeypatch.setattr(driving, "_EPISODES_PER_BLOCK", 4)
    env = drawn_env(small_bank, {"episode_length": 45, "terminate_off_traversable": True})
    episodes, policy = drawn_episodes(small_bank, np.arange(3), 7, 2), NamedPolicy("own", agent)
    together, alone = driven(env, policy, episodes, 2), driven(env, policy, episodes, 1)
    assert [(e.scene, e.row) for e in together] == list(zip(episodes.scenes, episodes.episodes, strict=True))
    assert len({len(e.steps.running) for e in together}) > 2
    assert all(e.steps.running.all() for e in together)
    assert all((e.steps.result[:-1] == 0).all() and e.steps.result[-1] for e in together)
    for a, b in zip(together, alone, strict=True):
        assert (a.scene, a.row, a.seed, a.result) == (b.scene, b.row, b.seed, b.result)
        jax.tree.map(lambda x, y: np.testing.assert_allclose(x, y, atol=1e-4), a.steps, b.steps)
    # From the third on, and from the last, which the second block has with two others.
    for first in (2, 6):
        check_same(driven(env, policy, episodes, 2, first), together[first:])


def check_same(found: list[Driven], wanted: list[Driven]) -> None:
    """Bit by bit."""
    for a, b in zip(found, wanted, strict=True):
        assert (a.scene, a.row, a.seed, a.result) == (b.scene, b.row, b.seed, b.result)
        jax.tree.map(np.testing.assert_array_equal, a.steps, b.steps)


class Straight:
    """A policy outside JAX; counts the episodes that it is begun for."""

    begun = 0

    def begin(self, count: int) -> None:
        self.begun += count

    def __call__(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        goal = obs["goal"]
        return goal / np.maximum(np.linalg.norm(goal, axis=-1, keepdims=True), 1e-6)


@pytest.mark.extended
def test_a_policy_outside_jax_drives_as_one_inside(env: NavEnv) -> None:
    episodes, straight = drawn_episodes(env.bank, env.scenes, 3, 1), Straight()
    inside = driven(env, NamedPolicy("go_to_goal", BASELINES["go_to_goal"]), episodes, 2)
    outside = driven(env, NamedPolicy("own", straight, outside=True), episodes, 2)
    # Two together, then the third, in a batch of the same size.
    assert straight.begun == 4
    check_same(driven(env, NamedPolicy("own", Straight(), outside=True), episodes, 2, 1), outside[1:])
    for a, b in zip(inside, outside, strict=True):
        assert (a.scene, a.row, a.seed, a.result) == (b.scene, b.row, b.seed, b.result)
        jax.tree.map(lambda x, y: np.testing.assert_allclose(x, y, atol=1e-4), a.steps, b.steps)


@pytest.mark.parametrize("answer", [np.zeros((3, 1)), np.full((3, 2), np.nan)])
def test_wrong_actions_are_refused(env: NavEnv, answer: np.ndarray) -> None:
    policy, episodes = NamedPolicy("own", lambda obs: answer, outside=True), drawn_episodes(env.bank, env.scenes, 3, 0)
    with pytest.raises(ValidationError, match=r"policy 'own': found actions of shape .* needed finite ones of shape"):
        driven(env, policy, episodes, 3)


@pytest.mark.parametrize("batch", [5, 64])
def test_a_batch_of_the_camera_holds_frames_of_several_groups(batch: int) -> None:
    """Frames are drawn once each, in full batches but for the last one, and come back to their episodes."""
    sizes, drawn = [7, 1, 12, 4], []
    steps = [types.SimpleNamespace(running=np.ones(n, bool), appearance_seed=100 * k + np.arange(n), agents=None,
                                   bodies=(), xpos=np.zeros((n, 2, 3)), xquat=np.zeros((n, 2, 4)))
             for k, n in enumerate(sizes)]  # fmt: skip
    episodes: list[Any] = [types.SimpleNamespace(steps=x, scene=k) for k, x in enumerate(steps)]

    def draw(scene: Any, xpos: Any, xquat: Any, seed: Any, agents: Any, bodies: Any) -> dict[str, np.ndarray]:
        drawn.append(seed)
        return {"rgb": np.asarray(seed)}

    camera = object.__new__(cameras.Camera)
    camera.batch, camera._draw = batch, draw  # type: ignore[assignment]
    found = list(camera.draw([episodes[:2], [], episodes[2:3], episodes[3:]]))
    assert [episode.scene for episode, _ in found] == [0, 1, 2, 3]
    for (episode, images), wanted in zip(found, steps, strict=True):
        assert episode.steps is wanted
        np.testing.assert_array_equal(np.concatenate(images["rgb"]), wanted.appearance_seed)
    assert [len(x) for x in drawn] == [batch] * -(-sum(sizes) // batch)
    assert list(camera.draw([])) == list(camera.draw([[]])) == []


def test_calls_of_any_length_drive_the_same_episodes(env: NavEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    episodes, policy = drawn_episodes(env.bank, env.scenes, 3, 1), NamedPolicy("random", BASELINES["random"])
    found = driven(env, policy, episodes, 2)
    monkeypatch.setattr(driving, "_STEPS_PER_CALL", 7)
    check_same(driven(env, policy, episodes, 2), found)


NOISE = ActionNoise(deviation=0.3, seconds=0.5)


@pytest.mark.extended
@pytest.mark.parametrize("outside", [False, True])
def test_noise_drives_and_the_policys_answers_to_it_are_recorded(env: NavEnv, outside: bool) -> None:
    agent = Straight() if outside else BASELINES["go_to_goal"]
    policy, episodes = NamedPolicy("go_to_goal", agent, outside=outside), drawn_episodes(env.bank, env.scenes, 3, 1)
    noisy, plain = (driven(env, policy, episodes, 2, noise=noise) for noise in (NOISE, None))
    for episode, other in zip(noisy, plain, strict=True):
        steps = episode.steps
        goal = steps.goal / np.linalg.norm(steps.goal, axis=1, keepdims=True)
        np.testing.assert_allclose(steps.answer, goal, atol=1e-5, err_msg="in the state that the noise led to")
        assert np.abs(steps.action).max() <= 1.0
        free = (np.abs(steps.action) < 1.0).all(1)
        drawn = (steps.action - steps.answer)[free]
        assert 0.1 < drawn.std() < 0.6
        # The next observation has the action that drove.
        np.testing.assert_allclose(steps.proprio[1:, 3:], steps.action[:-1], atol=1e-6)
        assert np.abs(steps.xpos[-1, 1] - other.steps.xpos[-1, 1]).max() > 0.05
        np.testing.assert_array_equal(other.steps.answer, other.steps.action)
    assert not np.allclose(noisy[0].steps.action - noisy[0].steps.answer, noisy[1].steps.action - noisy[1].steps.answer)
    # Noise belongs to the episode, not to the env that drives it or to where a recording was cut.
    for a, b in zip(noisy, driven(env, policy, episodes, 1, noise=NOISE), strict=True):
        jax.tree.map(lambda x, y: np.testing.assert_allclose(x, y, atol=1e-4), a.steps, b.steps)
    check_same(driven(env, policy, episodes, 2, 1, NOISE), noisy[1:])


@pytest.mark.parametrize("seconds", [0.0, 0.5, 2.0])
def test_noise_has_the_same_deviation_at_all_times_and_loses_its_correlation(seconds: float) -> None:
    noise, count, dt = ActionNoise(0.4, seconds), 20_000, 0.2
    state = jax.vmap(lambda key: noise.begin(key, 2))(jax.random.split(jax.random.key(0), count))
    values = [state.value]
    for _ in range(5):
        state = jax.vmap(lambda s: noise.next(s, dt))(state)
        values.append(state.value)
    drawn = np.array(values)
    np.testing.assert_allclose(drawn.std((1, 2)), 0.4, rtol=0.02)
    for apart in (1, 3):
        found = (drawn[0] * drawn[apart]).mean() / 0.4**2
        assert found == pytest.approx(np.exp(-apart * dt / seconds) if seconds else 0.0, abs=0.03)
    assert abs((drawn[0, :, 0] * drawn[0, :, 1]).mean()) < 0.005, "components are independent"


@pytest.mark.extended
def test_a_recording_with_noise_has_both_actions(
    env: NavEnv, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use(env, monkeypatch)
    folder = tmp_path / "new"
    options = dataclasses.replace(OPTIONS, policy="go_to_goal", num_episodes=2, sensors=(), noise=NOISE)
    pipeline.record(folder, options)
    assert pipeline.check_dataset(folder).problems == ()
    rows = table_of(folder)
    goal = np.array(rows["observation.environment_state"])
    np.testing.assert_allclose(rows["action"], goal / np.linalg.norm(goal, axis=1, keepdims=True), atol=1e-5)
    applied = np.array(rows["applied_action"])
    assert np.abs(applied - rows["action"]).max() > 0.2
    np.testing.assert_allclose(np.array(rows["observation.state"])[1:STEPS, 3:], applied[: STEPS - 1], atol=1e-6)
    assert json.loads((folder / "meta/urbanverse.json").read_text())["noise"] == {"deviation": 0.3, "seconds": 0.5}
    other = dataclasses.replace(options, noise=ActionNoise(0.3, 1.0), num_episodes=3, resume=True)
    with pytest.raises(ValidationError, match=r"--resume: found noise.seconds 1.0, needed 0.5 as in"):
        pipeline.record(folder, other)


def test_episodes_differ_and_a_smaller_number_gives_the_first_ones(small_bank: SceneBank) -> None:
    scenes, most = np.arange(3), int(small_bank.num_episodes.min()) * 3

    def rows(episodes: EpisodeSet) -> list[tuple[int, int, int]]:
        assert episodes.seeds is not None
        return list(zip(*(x.tolist() for x in (episodes.scenes, episodes.episodes, episodes.seeds)), strict=True))

    few, many = rows(drawn_episodes(small_bank, scenes, 7, 3)), rows(drawn_episodes(small_bank, scenes, 12, 3))
    assert many[:7] == few
    assert len({row[:2] for row in rows(drawn_episodes(small_bank, scenes, most, 0))}) == most
    assert rows(drawn_episodes(small_bank, scenes, 7, 4)) != few
    with pytest.raises(ValidationError, match=f"--num-episodes: found {most + 1}, needed at most {most} in 3 scenes"):
        drawn_episodes(small_bank, scenes, most + 1, 0)


def test_an_error_of_the_disk_that_names_no_file_names_the_folder(tmp_path: pathlib.Path) -> None:
    """Arrow's do not; those that name a file keep it, and those that are not about a disk name none."""
    for code, name, named in (
        (errno.ENOSPC, None, str(tmp_path)),
        (errno.EIO, None, str(tmp_path)),
        (errno.ENOSPC, "a.mp4", "a.mp4"),
        (errno.EMFILE, None, None),
    ):
        with pytest.raises(OSError, match=os.strerror(code)) as caught, naming(tmp_path):
            raise OSError(code, os.strerror(code), name)
        assert caught.value.filename == named
        assert (refusal(caught.value) or "").startswith(f"{named}: found the error" if named else "found the error")


@pytest.mark.extended
def test_a_recording_on_a_full_disk_is_one_sentence_with_its_folder(
    capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    use(drawn_env(small_bank, {"episode_length": STEPS}), monkeypatch)
    monkeypatch.setattr("urbanverse_mjx.datasets.DatasetWriter.add", full)
    command = ["record", "--policy", "zero", "--out", str(tmp_path / "new"), "--num-episodes", "1", "--quiet"]
    assert cli.main(command) == 2
    said = capsys.readouterr()
    assert (said.out, said.err.count("\n")) == ("", 1)
    assert f"{tmp_path / 'new'}: found the error 'No space left on device'; free space on that disk." in said.err


def test_nothing_is_driven_where_the_folder_is_in_use(
    capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(machines, "load_machine", None)
    (tmp_path / "mine").write_text("mine")
    assert cli.main(["record", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert "found a folder that is not empty, needed a new or empty folder" in said.err
    assert [p.name for p in tmp_path.iterdir()] == ["mine"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--with", "depth,radar"],
            "--with: found 'radar', needed one of depth, semantic, instance, normal, lidar, imu",
        ),
        (["--num-episodes", "0"], "--num-episodes"),
        (["--num-envs", "0"], "--num-envs"),
        (["--size", "8x8"], "--size: found 8"),
        (["--policy", "planer"], "--policy: found 'planer'"),
        (["--scenes", "nowhere"], "found 'nowhere', which names no scene"),
        (["--env-name", "Go2Joystick", "--policy", "zero", "--preset", "fast"], "--env-name: found 'Go2Joystick'"),
        (["--seed", "-1"], "--seed"),
        (["--noise.deviation", "-0.1"], "--noise.deviation: found -0.1"),
        (["--noise.deviation", "0.1", "--teleop", "--port", "0"], "--noise.deviation: found it together with --teleop"),
    ],
)
def test_wrong_options_are_one_sentence_and_leave_no_folder(
    capsys: pytest.CaptureFixture[str],
    tmp_path: pathlib.Path,
    small_bank: SceneBank,
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    message: str,
) -> None:
    monkeypatch.setattr("urbanverse_mjx.pipeline.training_run.bank_of", lambda *_: small_bank)
    assert cli.main(["record", "--out", str(tmp_path / "new"), "--quiet", *options]) == 2
    said = capsys.readouterr()
    assert said.err.count("\n") == 1
    assert message in said.err
    assert not (tmp_path / "new").exists()


def test_the_commands_of_a_dataset(
    recorded: tuple[pathlib.Path, dict[str, Any]], capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path
) -> None:
    folder = str(recorded[0])
    assert cli.main(["dataset", "check", folder]) == 0
    assert json.loads(capsys.readouterr().out)["sound"]
    assert cli.main(["dataset", "stats", folder]) == 0
    said = capsys.readouterr().out
    assert "5 episodes, 60 frames at 5 Hz" in said
    assert "action waypoint_forward" in said
    assert cli.main(["dataset", "stats", folder, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["frames"] == 60
    assert cli.main(["dataset", "check", str(tmp_path)]) == 2
    assert "needed a LeRobotDataset v3 file" in capsys.readouterr().err


def test_an_unsound_dataset_is_exit_status_one(capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path) -> None:
    folder = write_dataset(tmp_path / "new")
    (folder / "meta/tasks.parquet").unlink()
    assert cli.main(["dataset", "check", str(folder)]) == 1
    said = capsys.readouterr()
    assert "meta/tasks.parquet" in said.err
    assert not json.loads(said.out)["sound"]
