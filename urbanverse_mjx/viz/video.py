"""Writes rollouts as H.264 videos with the robot from behind, its camera image, and the distance to the goal."""

import functools
import pathlib
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import imageio.v2 as imageio
import jax
import numpy as np
from PIL import Image, ImageDraw
from scipy.spatial.transform import Rotation

from ..datatypes import AgentMotion, RobotSpec, SceneBank
from ..datatypes import validation as v
from ..simulation.rendering.cameras import (
    FOLLOWING_FOV,
    following_cameras,
    free_shares,
    in_batches,
    look_at,
    without_obstacles,
)
from ..simulation.rendering.renderer import Renderer

HEIGHT, WIDTH = 180, 320
#: px, height of the line above each frame.
_LINE = 16
#: Looks a second at what hides the robot from the camera behind it, and how many are drawn together.
_LOOKS, _BATCH = 5.0, 16
#: Of the pole at the goal: m, its height above the ground, and its colour.
_POLE, _POLE_COLOUR = 2.1, (255, 225, 0)
#: m from the goal, where the pole would hide the robot.
_NEAR_POLE = 0.6
#: s at the end of an episode in which its caption names the outcome.
OUTCOME_TIME = 1.0
#: Caption of each of `datatypes.OUTCOMES`.
CAPTIONS = {
    "goal": "at the goal",
    "hit": "hit an object",
    "hit_ground": "touched the ground with its body",
    "hit_agent": "hit an agent",
    "lost": "lost the person",
    "stopped": "stopped elsewhere",
    "dropped": "dropped the parcel",
    "off_traversable": "left the walkable ground",
    "fall": "fell",
    "non_finite": "not finite",
    "timeout": "out of time",
}


def _agents(fields: Sequence[Any]) -> AgentMotion | None:
    return AgentMotion(*fields) if fields else None


def _caption(frame: np.ndarray, text: str) -> np.ndarray:
    """Adds a line above a frame, so that it hides nothing."""
    line = Image.new("RGB", (frame.shape[1], _LINE))
    ImageDraw.Draw(line).text((4, 2), text, fill=(255, 255, 255))
    return np.concatenate([np.asarray(line), frame])


def marked(
    frame: np.ndarray, goal: np.ndarray, camera_position: np.ndarray, camera_turn: np.ndarray, fov: float
) -> np.ndarray:
    """Draws a pole with a triangle on top at a goal on the ground, also where something hides it.

    Args:
      frame: (H, W, 3) uint8. goal, camera_position: (3,) m.
      camera_turn: (4,) wxyz, R_world_camera; the view is along -z, +y is up. fov: vertical field of view, rad.

    Returns:
      a frame with the pole; the frame itself if the goal is not before the camera.
    """
    height, width = frame.shape[:2]
    ends = np.asarray(goal, np.float64) + [[0.0, 0.0, 0.0], [0.0, 0.0, _POLE]]
    turn = Rotation.from_quat(camera_turn, scalar_first=True)
    x, y, z = turn.inv().apply(ends - camera_position).T
    if (z > -0.2).any():
        return frame
    focal = 0.5 * height / np.tan(0.5 * fov)
    (foot, top) = zip(0.5 * width - focal * x / z, 0.5 * height + focal * y / z, strict=True)
    image = Image.fromarray(frame)
    draw, size = ImageDraw.Draw(image), 0.022 * width
    for wider, colour in ((3, (0, 0, 0)), (1, _POLE_COLOUR)):
        draw.line([foot, top], colour, wider)
    corners = [(top[0] - 0.7 * size, top[1] - size), (top[0] + 0.7 * size, top[1] - size), top]
    draw.polygon(corners, _POLE_COLOUR, (0, 0, 0))
    return np.asarray(image)


def caption(
    scene: str, seconds: float, goal_distance: float, outcome: str, left: float, goal_name: str = "goal", note: str = ""
) -> str:
    """Returns the caption of a frame: scene, time, distance to the goal (m), and in the last second the outcome.

    Args:
      left: s until the episode ends.
      goal_name: word for the goal.
      note: addition of a task.
    """
    end = f"   ends: {CAPTIONS[outcome]}" if left < OUTCOME_TIME else ""
    return f"{scene}   {seconds:4.1f} s   {goal_name} {goal_distance:4.1f} m{f'   {note}' if note else ''}{end}"


#: Presets of x264, from large files to small ones.
ENCODER_PRESETS = ("ultrafast", "fast", "medium", "slow", "veryslow")


def write_video(
    path: pathlib.Path,
    frames: Sequence[np.ndarray],
    frames_per_second: float,
    quality: float = 7.0,
    encoder: str = "medium",
) -> None:
    """Writes (H, W, 3) uint8 frames as an H.264 mp4 that browsers play.

    Args:
      quality: imageio's, 0 to 10.
      encoder: of `ENCODER_PRESETS`.

    Raises:
      ValidationError: no frames, sizes that differ or are odd, or no such preset.
    """
    v.choice(encoder, "video.encoder", ENCODER_PRESETS)
    shapes = {f.shape for f in frames}
    if len(shapes) != 1 or any(n % 2 for n in next(iter(shapes))[:2]):
        raise v.fail("video", f"frames of shapes {sorted(shapes)}", "at least one frame, all of one even size")

    def write(temporary: pathlib.Path) -> None:
        # imageio's annotations lack the methods of its ffmpeg plugin.
        writer: Any
        with imageio.get_writer(
            temporary,
            fps=frames_per_second,
            codec="libx264",
            pixelformat="yuv420p",
            quality=quality,
            macro_block_size=2,
            ffmpeg_params=["-preset", encoder],
        ) as writer:
            for frame in frames:
                writer.append_data(frame)

    with warnings.catch_warnings():
        # JAX warns of every fork. imageio forks to start ffmpeg, and the child does nothing else.
        warnings.filterwarnings("ignore", r"os\.fork\(\) was called", RuntimeWarning)
        v.write_atomically(path, write)


def write_rollout_video(
    path: pathlib.Path,
    bank: SceneBank,
    robot: RobotSpec,
    trajectory: Any,
    columns: Sequence[int],
    scenes: Sequence[int],
    goals: Sequence[np.ndarray],
    outcomes: Sequence[str],
    frames_per_second: float,
    appearances: Sequence[int] = (),
    size: tuple[int, int] = (HEIGHT, WIDTH),
    samples: int = 1,
    quality: float = 7.0,
    encoder: str = "medium",
    on_progress: Callable[[int], None] | None = None,
    goal_names: Sequence[str] = (),
    note: Callable[[int, int], str] = lambda column, step: "",
    last: float | None = None,
    azimuth: float = 0.0,
    nearness: float = 1.0,
) -> None:
    """Renders envs of an evaluation one after another, with a view from behind on the left, in which a pole marks a
    goal that is not reached, and the robot's camera on the right.

    Args:
      path: .mp4 to write.
      bank, robot: of the simulation.
      trajectory: an `evaluation.Trajectory`.
      columns: envs of the trajectory to render.
      scenes: bank row of each env.
      goals: goal (3,) m of each env, or (T, 3) where it moves.
      outcomes: of each episode, of `datatypes.OUTCOMES`; shown in the last second of the episode.
      frames_per_second: equal to the control rate for real time.
      appearances: row of the bank's agents for each moving agent of the trajectory.
      size: height and width of each of the two images.
      samples: rays per pixel along each side.
      quality, encoder: see `write_video`.
      on_progress: called with the number of rendered envs.
      goal_names: words for the goals of these episodes in captions; default: "goal".
      note: function (env of the trajectory, step) -> addition to a caption.
      last: s at the end of each episode that are rendered; default: all.
      azimuth: deg by which the camera behind the robot is turned around it, counterclockwise seen from above; from
        the side it looks at the robot itself.
      nearness: share of its usual distance from the robot.
    """
    renderer = Renderer(bank, robot, *size, ("rgb", "depth"), shadows=True, agents=appearances, samples=samples)
    depth = jax.jit(jax.vmap(lambda s, e, t, f: renderer.view(s, e, t, f)["depth"]))

    def look(scene: int, _: np.ndarray, *views: np.ndarray) -> np.ndarray:
        total = len(views[0])
        same = np.resize(np.arange(total), max(total, _BATCH))  # batches of one size are compiled once
        return in_batches(depth, np.full(len(same), scene, np.int32), *(view[same] for view in views))[:total]

    front = jax.jit(jax.vmap(lambda s, p, q, *a: renderer(s, p, q, 0, _agents(a))["rgb"]))
    chase = jax.jit(
        jax.vmap(lambda s, e, t, p, q, *a: renderer.view(s, e, t, FOLLOWING_FOV, p, q, 0, _agents(a))["rgb"])
    )
    around = Rotation.from_euler("z", azimuth, degrees=True)
    frames: list[np.ndarray] = []
    names = goal_names or ["goal"] * len(columns)
    rows = zip(columns, scenes, goals, outcomes, names, strict=True)
    for done, (column, scene, goal, outcome, named) in enumerate(rows, 1):
        length = int(trajectory.running[:, column].sum())
        first = 0 if last is None else max(length - round(last * frames_per_second), 0)
        xpos, xquat = trajectory.xpos[first:length, column], trajectory.xquat[first:length, column]
        length -= first
        where = np.full(length, scene, np.int32)
        camera_position, _ = following_cameras(xpos, xquat, frames_per_second, robot.planner_height)
        camera_position = xpos[:, 1] + nearness * around.apply(camera_position - xpos[:, 1]).astype(np.float32)
        looks = np.unique(np.linspace(0, length - 1, max(round(length / frames_per_second * _LOOKS), 2)).round())
        looks, height = looks.astype(int), robot.planner_height
        free = free_shares(functools.partial(look, scene), xpos[looks], camera_position[looks], height)
        camera_position, turn = without_obstacles(xpos, xquat, camera_position, looks, free, frames_per_second, height)
        if azimuth:
            middle = xpos[:, 1] + np.array([0.0, 0.0, 0.5 * height])
            turn = np.stack([look_at(e, t) for e, t in zip(camera_position, middle, strict=True)]).astype(np.float32)
        moving = [] if trajectory.agents is None else [x[first : first + length, column] for x in trajectory.agents]
        left = in_batches(chase, where, camera_position, turn, xpos, xquat, *moving)
        right = in_batches(front, where, xpos, xquat, *moving)
        for t in range(length):
            there = goal if goal.ndim == 1 else goal[first + t]
            away = float(np.linalg.norm(xpos[t, 1, :2] - there[:2]))
            if away > _NEAR_POLE:
                left[t] = marked(left[t], there, camera_position[t], turn[t], FOLLOWING_FOV)
            both = np.concatenate([left[t], right[t]], axis=1)
            seconds, left_over = (first + t) / frames_per_second, (length - 1 - t) / frames_per_second
            text = caption(bank.scene_ids[scene], seconds, away, outcome, left_over, named, note(column, first + t))
            frames.append(_caption(both, text))
        if on_progress is not None:
            on_progress(done)
    write_video(path, frames, frames_per_second, quality, encoder)
