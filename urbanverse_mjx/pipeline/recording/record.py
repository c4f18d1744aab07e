"""`record`: a policy drives episodes, and what its robot senses and does is written as a dataset."""

import collections
import dataclasses
import os
import pathlib
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from ...datatypes import RESULTS, SceneBank
from ...datatypes import validation as v
from ..errors import naming
from ..viewing import PageOptions
from .action_noise import ActionNoise
from .formats import Format, check_folder, frame_episode, image_type, open_writer, stored
from .lidar import LidarOptions

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from ...datasets import Episode, Feature
    from ...envs import NavEnv
    from ...evaluation.rollouts import EpisodeSet
    from ...viewer.session import Machine
    from .cameras import Camera
    from .driving import Driven
    from .encoding import Encoding, EpisodeWriting, Filmed
    from .readings import Readings

#: Batches of the camera that are waited for before they are drawn.
_BATCHES = 8
#: Calls of the driving program whose episodes may wait for them.
_CALLS_AHEAD = 8
TASK = "drive to the goal over the pavement without touching anything"


@dataclasses.dataclass(frozen=True)
class RecordOptions(PageOptions):
    """Who drives, where, and what is recorded; the page's address is for --teleop."""

    policy: str | None = None
    """zero, random, go_to_goal, planner, a policy or run folder, or an ONNX file; default: planner, by teleop zero."""
    teleop: bool = False
    """Drive by hand in a web page, at --host and --port, one episode after another; else the policy drives."""
    num_episodes: int = 20
    """Episodes that are driven, all different."""
    format: Format = "lerobot"
    """lerobot: LeRobotDataset v3; coco: images with instances and captions; kitti: images with LiDAR scans and boxes in
    space; mcap: a log an episode for Foxglove and rerun."""
    env_name: str | None = None
    """Whose robot is driven, e.g. Go2Nav; default: the policy's own, for a scripted one CocoNav."""
    preset: str = "paper"
    """Of the environment, for scripted policies and driving by hand; a trained policy brings its own. Demonstrations
    for `urbanverse train` need the preset of the training, whose default is quick."""
    bank: pathlib.Path | None = None
    """Scene bank; default: that of the shipped streets, or the one that URBANVERSE_BANK names."""
    scenes: str = "train"
    """train, test, validation, all, or scene ids separated by commas."""
    people: bool = False
    """Streets full of people and vehicles that move."""
    env_overrides: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    """Flat dotted keys of the environment's config, such as the robot."""
    num_envs: int = 16
    """Episodes that are driven at the same time."""
    size: tuple[int, int] = (135, 240)
    """Height and width of the images in pixels, whatever the policy sees."""
    sensors: tuple[str, ...] = ()
    """Besides colour: depth, normal, semantic, instance, lidar, imu, odometry, camera_pose, contacts, boxes;
    segmentation for semantic and instance, all for everything."""
    lidar: LidarOptions = dataclasses.field(default_factory=LidarOptions)
    """Rays of the LiDAR."""
    noise: ActionNoise = dataclasses.field(default_factory=ActionNoise)
    """On the actions that drive, so that the dataset also shows how the policy comes back; recorded are its own."""
    only_successes: bool = False
    """Leave episodes that did not reach their goal out of the dataset."""
    resume: bool = False
    """Continue the recording in the folder after its last complete episode, up to --num-episodes; the other options
    must be those that began it, and the policy must have the same content."""
    seed: int = 0
    """Draws the episodes, and what is random in them."""
    quiet: bool = False
    """No progress bars."""


def record(
    out: str | os.PathLike[str],
    options: RecordOptions | None = None,
    on_ready: Callable[[str], None] = lambda _: None,
    until: Callable[[], bool] = lambda: False,
    bank: SceneBank | None = None,
) -> dict[str, Any]:
    """Records episodes into a new dataset. Whenever it is interrupted, all episodes written so far are complete.

    The camera is drawn from the driven poses: a policy without images, or with small ones, drives as fast as ever.

    Args:
      out: new or empty folder; with `resume`, it may hold a recording.
      options: see there.
      on_ready: with `teleop`, called with the page's address once it can be opened.
      until: with `teleop`, called often; the recording ends when it returns True.
      bank: taken in place of that of `options.bank`.

    Returns:
      dataset: the folder; episodes, frames: in it; results: how many of the driven ones ended how; seconds: from the
      first step on, compiling included; with `resume`, resumed: episodes that were in the folder before.

    Raises:
      ValidationError: a folder in use, no such policy, scene or sensor, fewer different episodes, or a recording that
        other options began.
      OSError: the disk is full; what was written before stays complete.
    """
    from ...datasets import DatasetWriter
    from ...progress import COMPILING, Progress
    from ...settings import num_threads

    options = options or RecordOptions()
    options = dataclasses.replace(options, policy=options.policy or ("zero" if options.teleop else "planner"))
    folder = pathlib.Path(out)
    sensors = _accepted(folder, options)
    # Imported after the first line on standard error, because it takes seconds.
    from .ahead import Ahead
    from .driving import BatchDrive, drawn_episodes
    from .encoding import EpisodeWriting

    env, machine, scenes, features = _prepared(options, sensors, bank)
    episodes = drawn_episodes(env.bank, scenes, options.num_episodes, options.seed)
    results: collections.Counter[str] = collections.Counter()
    origin = _origin(options, machine, scenes, sensors)
    with (
        naming(folder),
        open_writer(
            folder, options.format, options.size, options.lidar, features, env, origin, options.resume
        ) as writer,
        Progress(options.quiet) as progress,
    ):
        began, had = time.perf_counter(), writer.num_episodes
        ended = first = _first(episodes, writer.records, options)
        note = "preparing the page" if options.teleop else COMPILING
        report = progress.task("recording", options.num_episodes, unit="episodes", note=note)
        camera, encode = _filming(env, options, sensors)
        readings = _readings(env, sensors)

        def write(filmed: "Filmed") -> None:
            columns, metadata = _columns(env, readings, filmed.driven, noisy=bool(options.noise.deviation))
            if isinstance(writer, DatasetWriter):
                writer.add(_episode(filmed, columns, metadata))
            else:
                writer.add(frame_episode(filmed, columns, metadata))
            report(ended, note=v.counted(writer.num_frames, "frames"))

        def counted(groups: "Iterable[list[Driven]]") -> "Iterator[list[Driven]]":
            """What is recorded of the episodes in groups."""
            nonlocal ended
            for group in groups:
                results.update(episode.result for episode in group)
                ended += len(group)
                yield [e for e in group if e.result == "goal" or not options.only_successes]
                report(ended)

        with EpisodeWriting(encode, write, num_threads()) as writing:
            if first < len(episodes) and options.teleop:
                from .by_hand import HandDrive

                ready = _announced(on_ready, lambda: report(first, note="drive in the page"))
                for group in counted(HandDrive(machine, options, ready, until).run(episodes, first)):
                    _draw(camera, [group], writing)
                    # Nothing that a person drove is at risk while the next episode is driven.
                    writing.wait()
            elif first < len(episodes):
                drive = BatchDrive(machine, options.noise)
                driven = drive.run(episodes, options.num_envs, lambda: report(first, note=""), first)
                # Driving leaves cores idle that draw meanwhile.
                with Ahead(driven, _CALLS_AHEAD) as ahead:
                    _draw(camera, counted(_filmable(ahead, _BATCHES * camera.batch)), writing)
    seconds = time.perf_counter() - began
    if not writer.num_episodes:
        raise _nothing(options, results)
    return {
        "dataset": str(folder),
        "episodes": writer.num_episodes,
        "frames": writer.num_frames,
        "results": {name: results[name] for name in RESULTS if results[name]},
        "seconds": round(seconds, 1),
        **({"resumed": had} if options.resume else {}),
    }


def _announced(on_ready: Callable[[str], None], announce: Callable[[], None]) -> Callable[[str], None]:
    """The same callback, which calls `announce` before."""

    def ready(address: str) -> None:
        announce()
        on_ready(address)

    return ready


def _draw(camera: "Camera", groups: "Iterable[list[Driven]]", writing: "EpisodeWriting") -> None:
    for episode, drawn in camera.draw(groups):
        writing.add(episode, drawn)


def _nothing(options: RecordOptions, results: Mapping[str, int]) -> v.ValidationError:
    """The error of a recording without an episode."""
    if options.teleop:
        found = f"{sum(results.values())} driven episodes, none to be written"
        return v.fail("--teleop", found, "one that is driven to its end")
    found = f"none among {v.counted(options.num_episodes, 'episodes')}"
    return v.fail("--only-successes", found, "one", "drive more")


def _first(episodes: "EpisodeSet", records: "Sequence[Mapping[str, Any]]", options: RecordOptions) -> int:
    """Number of the episode after the last recorded one, of those that the command draws.

    Raises:
      ValidationError: the recorded ones are not among them.
    """
    assert episodes.seeds is not None
    drawn = list(zip(*(x.tolist() for x in (episodes.scenes, episodes.episodes, episodes.seeds)), strict=True))
    number = {place: k for k, place in enumerate(drawn)}
    found = [number.get((row["scene_index"], row["episode_row"], row["seed"])) for row in records]
    if None in found:
        said = f"{options.num_episodes} episodes without the recorded episode {found.index(None)}"
        raise v.fail("--resume", said, "those that began the recording, or more", "pass a larger --num-episodes")
    return found[-1] + 1 if found and found[-1] is not None else 0


def _filmable(ended: "Iterable[list[Driven]]", frames: int) -> "Iterator[list[Driven]]":
    """The same episodes in groups of so many frames or more, which fill the batches of the camera."""
    group: list[Driven] = []
    for episodes in ended:
        group += episodes
        if sum(len(e.steps.running) for e in group) >= frames:
            yield group
            group = []
    if group:
        yield group


def _accepted(folder: pathlib.Path, options: RecordOptions) -> tuple[str, ...]:
    """The sensors asked for; with `teleop`, a line on standard error says that the page follows.

    Raises:
      ValidationError: numbers out of range, no such sensor, or a folder in use.
    """
    from ...terminal import announce

    sensors = _checked(options)
    check_folder(folder, options.format, options.resume)
    if options.teleop:
        announce("loading the streets and the robot; the page opens after it", options.quiet)
    return sensors


def _checked(options: RecordOptions) -> tuple[str, ...]:
    """The sensors asked for, groups taken apart.

    Raises:
      ValidationError: numbers out of range, or no such sensor.
    """
    from .cameras import GROUPS, SENSORS
    from .readings import READINGS

    known = (*SENSORS, *READINGS, "boxes")
    groups = {**GROUPS, "all": known}
    options.lidar.check()
    options.noise.check()
    if options.teleop:
        from ...viewer.ports import free_port

        options.check()
        if options.noise.deviation:
            raise v.fail("--noise.deviation", "it together with --teleop", "one of them", "a person drives as they do")
        free_port(options.host, options.port)
    v.integer(options.num_episodes, "--num-episodes", 1)
    v.integer(options.num_envs, "--num-envs", 1)
    v.integer(options.seed, "--seed", 0)
    v.choice(options.format, "--format", get_args(Format))
    if options.format == "mcap":
        from ...datasets.mcap_files import require_packages

        require_packages()
    for side in options.size:
        v.integer(side, "--size", 16, 4096)
    for name in options.sensors:
        v.choice(name, "--with", (*known, *groups))
    wanted = tuple(dict.fromkeys(s for name in options.sensors for s in groups.get(name, (name,))))
    return stored(options.format, wanted)


def _images(sensors: tuple[str, ...]) -> tuple[str, ...]:
    from .cameras import SENSORS

    return tuple(name for name in sensors if name in SENSORS)


def _filming(env: "NavEnv", options: RecordOptions, sensors: tuple[str, ...]) -> "tuple[Camera, Encoding]":
    """What draws driven episodes, and what encodes them."""
    from .boxes import Boxes
    from .cameras import Camera
    from .encoding import Encoding
    from .lidar import Lidar

    images, with_boxes = _images(sensors), "boxes" in sensors
    lidar = Lidar(env, options.lidar) if "lidar" in sensors else None
    boxes = Boxes(env, masks=options.format == "coco") if with_boxes else None
    camera = Camera(env, *options.size, images, lidar, labels=with_boxes)
    return camera, Encoding(round(1.0 / env.dt), images, image_type(options.format), lidar, boxes)


def _readings(env: "NavEnv", sensors: tuple[str, ...]) -> "Readings":
    from .readings import READINGS, Readings

    return Readings(env.robot, env.mj_model, env.dt, [name for name in sensors if name in READINGS])


def _prepared(
    options: RecordOptions, sensors: tuple[str, ...], bank: SceneBank | None = None
) -> tuple["NavEnv", Any, np.ndarray, dict[str, "Feature"]]:
    """The environment, its policy, the scenes' rows of the bank, and the dataset's features."""
    from ...envs.navigation.scenarios import select_scenes
    from ..machines import IMAGE_SIZE, load_machine
    from ..training_run import bank_of

    bank = bank or bank_of(options.env_name or "CocoNav", options.quiet, options.preset, options.bank)
    scenes = np.asarray(select_scenes(bank, options.scenes))
    assert options.policy is not None
    where = (bank, options.people, options.env_name, options.preset)
    image = IMAGE_SIZE if options.teleop else None  # for the page
    machine = load_machine(options.policy, *where, image, options.env_overrides)
    env = machine.env
    if options.teleop:
        from ...viewer.teleop import STOP

        machine.action_of(STOP)
    rate = 1.0 / env.dt
    if abs(rate - round(rate)) > 1e-6:
        raise v.fail("config.ctrl_dt", f"{rate:g} steps a second", "a whole number of them", "LeRobot counts in these")
    return env, machine, scenes, _features(env, options, sensors)


def _features(env: "NavEnv", options: RecordOptions, sensors: tuple[str, ...]) -> dict[str, "Feature"]:
    from ...datasets import Feature
    from .cameras import camera_features

    waypoint = ("waypoint_forward", "waypoint_left")
    action = waypoint if env.config.action_mode == "waypoint" else tuple(f"action_{i}" for i in range(env.action_size))
    speed = ("speed_forward", "speed_left", "yaw_rate")
    pose = ("x", "y", "z", "qw", "qx", "qy", "qz")
    return {
        **camera_features(*options.size, _images(sensors), options.lidar),
        "observation.state": Feature("float32", (3 + len(action),), (*speed, *(f"last_{name}" for name in action))),
        "observation.environment_state": Feature("float32", (2,), ("goal_forward", "goal_left")),
        "action": Feature("float32", (len(action),), action),
        "next.reward": Feature("float32", (1,)),
        "next.done": Feature("bool", (1,)),
        "next.success": Feature("bool", (1,)),
        "next.contact": Feature("bool", (1,)),
        "pose": Feature("float32", (7,), pose),
        **_readings(env, sensors).features(),
        "scene_index": Feature("int64", (1,)),
        "episode_row": Feature("int64", (1,)),
        **({"applied_action": Feature("float32", (len(action),), action)} if options.noise.deviation else {}),
        **({"intervention": Feature("bool", (1,))} if options.teleop else {}),
    }


def _episode(filmed: "Filmed", columns: dict[str, np.ndarray], metadata: dict[str, Any]) -> "Episode":
    """A driven and filmed episode as a LeRobotDataset takes it."""
    from ...datasets import Episode
    from .cameras import FRONT

    videos = {FRONT: filmed.video}
    return Episode(TASK, columns, filmed.images, videos, filmed.stats, metadata, filmed.annotations)


def _columns(
    env: "NavEnv", readings: "Readings", driven: "Driven", noisy: bool = False
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """The numbers (T, ...) of a driven episode, and the metadata of it as a whole; noisy: its actions had noise."""
    steps, length = driven.steps, len(driven.steps.running)
    last = np.arange(length) == length - 1
    root = env.mj_model.body(env.robot.root_body).id
    columns = {
        "observation.state": steps.proprio,
        "observation.environment_state": steps.goal,
        "action": steps.answer,
        "next.reward": steps.reward,
        "next.done": last,
        "next.success": last & (driven.result == "goal"),
        "next.contact": steps.hit,
        "pose": np.concatenate([steps.xpos[:, root], steps.xquat[:, root]], axis=1),
        **readings.columns(steps),
        "scene_index": np.full(length, driven.scene),
        "episode_row": np.full(length, driven.row),
    }
    metadata: dict[str, Any] = {
        "scene": env.bank.scene_ids[driven.scene],
        "scene_index": driven.scene,
        "episode_row": driven.row,
        "seed": driven.seed,
        "result": driven.result,
        "route_completion": driven.route_completion,
    }
    if noisy:
        columns["applied_action"] = steps.action
    if driven.by_hand is not None:
        from ...viewer.teleop import interventions

        columns["intervention"] = driven.by_hand
        metadata["interventions"] = interventions(driven.by_hand)
    return columns, metadata


def _origin(options: RecordOptions, machine: "Machine", scenes: np.ndarray, sensors: tuple[str, ...]) -> dict[str, Any]:
    """What made the dataset, and what the labels of its images mean."""
    from ...training.policy import package_versions
    from .lidar import lidar_height
    from .readings import intrinsics

    env, policy, bank = machine.env, machine.policy, machine.env.bank
    # A policy outside JAX may answer with other bits in a batch of another size.
    batch = policy.outside and not options.teleop
    body: dict[str, Any] = {
        "policy": options.policy,
        **({"policy_content": {"name": policy.loaded, "sha256": policy.sha256}} if policy.sha256 else {}),
        **({"num_envs": min(options.num_envs, options.num_episodes)} if batch else {}),
        "format": options.format,
        "sensors": list(sensors),
        **({"teleop": True} if options.teleop else {}),
        **({"only_successes": True} if options.only_successes else {}),
        **({"noise": options.noise.described()} if options.noise.deviation else {}),
        "environment_config": env.config.to_dict(),
        "scenes": {str(row): bank.scene_ids[row] for row in scenes.tolist()},
        "seed": options.seed,
        "versions": package_versions(),
        "hashes": bank.meta.get("hashes", {}),
    }
    body["camera"] = dict(intrinsics(env.mj_model, env.robot.camera, *options.size))
    if "lidar" in sensors:
        body["lidar"] = {**options.lidar.described(), "height": lidar_height(env, options.lidar)}
    if "semantic" in sensors:
        body["semantic"] = ["sky", "robot", *bank.meta["categories"]]
    if "instance" in sensors:
        objects = bank.meta["object_ids"]
        body["instance"] = {bank.scene_ids[row]: ["sky", "robot", "agent", *objects[row]] for row in scenes.tolist()}
    return body
