"""Rollouts as H.264 videos: the robot from behind, what its camera sees, and how far the goal is."""

import pathlib
from collections.abc import Sequence
from typing import Any

import imageio.v2 as imageio
import jax
import jax.numpy as jnp
import numpy as np
from PIL import Image, ImageDraw

from ..datatypes import AgentMotion, RobotSpec, SceneBank
from ..datatypes import validation as v
from ..geometry import rotations
from ..simulation.rendering.renderer import Renderer
from .images import look_at

HEIGHT, WIDTH = 180, 320
_BATCH = 16
#: How an episode ended, of `datatypes.RESULTS`, in words.
OUTCOMES = {
    "goal": "at the goal",
    "hit": "hit an object",
    "hit_agent": "hit an agent",
    "off_traversable": "left the walkable ground",
    "fall": "fell",
    "non_finite": "not finite",
    "timeout": "out of time",
}
#: Of a robot 1 m high; one half as high is seen from three quarters of that.
_CHASE_BACK, _CHASE_UP, _CHASE_FOV = 3.2, 1.9, 1.05  # m, m, rad
_CHASE_SMOOTH = 1.8  # s


def _chase_cameras(
    xpos: np.ndarray, xquat: np.ndarray, frames_per_second: float, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Position (T, 3) and quaternion (T, 4) of a camera behind the root body, its heading smoothed over two
    seconds.

    Args:
      height: m, of the robot.
    """
    heading = rotations.matrix(xquat[:, 1])[:, :2, 0]
    window = min(round(_CHASE_SMOOTH * frames_per_second) // 2 * 2 + 1, len(heading))
    smooth = np.stack(
        [np.convolve(np.pad(h, window // 2, "edge"), np.ones(window) / window, "valid")[: len(h)] for h in heading.T],
        -1,
    )
    smooth /= np.maximum(np.linalg.norm(smooth, axis=-1, keepdims=True), 1e-6)
    root = xpos[:, 1]
    near = 0.5 + 0.5 * height
    eye = root + near * (np.array([0.0, 0.0, _CHASE_UP]) - _CHASE_BACK * np.pad(smooth, ((0, 0), (0, 1))))
    target = root + 1.5 * np.pad(smooth, ((0, 0), (0, 1)))
    return eye, np.stack([look_at(e, t) for e, t in zip(eye, target, strict=True)])


def _batched(function: Any, *columns: np.ndarray) -> np.ndarray:
    """Runs a vmapped function over (T, ...) columns in batches of one size, so that it is compiled once."""
    total = len(columns[0])
    out = []
    for i in range(0, total, _BATCH):
        part = [np.resize(c[i : i + _BATCH], (_BATCH, *c.shape[1:])) for c in columns]
        out.append(np.asarray(function(*map(jnp.asarray, part)))[: total - i])
    return np.concatenate(out)


def _agents(fields: Sequence[Any]) -> AgentMotion | None:
    return AgentMotion(*fields) if fields else None


def _caption(frame: np.ndarray, text: str) -> np.ndarray:
    image = Image.fromarray(frame)
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 0, 6 + 6 * len(text), 15), fill=(0, 0, 0))
    draw.text((4, 2), text, fill=(255, 255, 255))
    return np.asarray(image)


def caption(scene: str, seconds: float, goal_distance: float, outcome: str) -> str:
    """The line over a frame: where, when, m to the goal, and how the episode ends."""
    return f"{scene}   {seconds:4.1f} s   goal {goal_distance:4.1f} m   ends: {OUTCOMES[outcome]}"


def write_video(
    path: pathlib.Path, frames: Sequence[np.ndarray], frames_per_second: float, quality: float = 7.0
) -> None:
    """Writes (H, W, 3) uint8 frames as an H.264 mp4 that browsers play; quality: imageio's, 0 to 10.

    Raises:
      ValidationError: no frames, or sizes that differ or are odd.
    """
    shapes = {f.shape for f in frames}
    if len(shapes) != 1 or any(n % 2 for n in next(iter(shapes))[:2]):
        raise v.fail("video", f"frames of shapes {sorted(shapes)}", "at least one frame, all of one even size")

    def write(temporary: pathlib.Path) -> None:
        # imageio's annotations do not know the methods of its ffmpeg plugin.
        writer: Any
        with imageio.get_writer(
            temporary,
            fps=frames_per_second,
            codec="libx264",
            pixelformat="yuv420p",
            quality=quality,
            macro_block_size=2,
        ) as writer:
            for frame in frames:
                writer.append_data(frame)

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
) -> None:
    """Draws some envs of an evaluation, one after the other: from behind on the left, the robot's view on the right.

    Args:
      path: .mp4 to write.
      bank, robot: what was simulated.
      trajectory: an `evaluation.Trajectory`.
      columns: which envs of it; scenes: their rows of the bank; goals: their (3,) m goals.
      outcomes: how each episode ended, of `datatypes.RESULTS`; it stands in every frame of the episode.
      frames_per_second: the control rate shows it in real time.
      appearances: row of the bank's agents for each moving agent of the trajectory.
      size: height and width of each of the two pictures; samples: rays a pixel. quality: see `write_video`.
    """
    renderer = Renderer(bank, robot, *size, shadows=True, agents=appearances, samples=samples)
    front = jax.jit(jax.vmap(lambda s, p, q, *a: renderer(s, p, q, 0, _agents(a))["rgb"]))
    chase = jax.jit(jax.vmap(lambda s, e, t, p, q, *a: renderer.view(s, e, t, _CHASE_FOV, p, q, 0, _agents(a))["rgb"]))
    frames: list[np.ndarray] = []
    for column, scene, goal, outcome in zip(columns, scenes, goals, outcomes, strict=True):
        length = int(trajectory.running[:, column].sum())
        xpos, xquat = trajectory.xpos[:length, column], trajectory.xquat[:length, column]
        where = np.full(length, scene, np.int32)
        eye, turn = (x.astype(np.float32) for x in _chase_cameras(xpos, xquat, frames_per_second, robot.planner_height))
        moving = [] if trajectory.agents is None else [x[:length, column] for x in trajectory.agents]
        left = _batched(chase, where, eye, turn, xpos, xquat, *moving)
        right = _batched(front, where, xpos, xquat, *moving)
        for t in range(length):
            away = float(np.linalg.norm(xpos[t, 1, :2] - goal[:2]))
            both = np.concatenate([left[t], right[t]], axis=1)
            frames.append(_caption(both, caption(bank.scene_ids[scene], t / frames_per_second, away, outcome)))
    write_video(path, frames, frames_per_second, quality)
